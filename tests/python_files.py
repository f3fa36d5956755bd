"""Python files outside of packages, and what an installation leaves beside them."""

import importlib.util
import sys
import tomllib

METADATA = "Metadata-Version: 2.1\nName: {}\nVersion: 1.0\n"


def module_of(path):
    """The module that a file is."""
    spec = importlib.util.spec_from_file_location(f"{path.parent.name}_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def write_metadata(folder, name, groups):
    """Write the metadata of a distribution with its entry points, by group and name."""
    info = folder / f"{name.replace('-', '_')}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(METADATA.format(name))
    with (info / "entry_points.txt").open("w") as file:
        for group, entries in groups.items():
            print(f"[{group}]", *(f"{key} = {value}" for key, value in entries.items()), sep="\n", file=file)


def write_project_metadata(root):
    """Write the metadata of a project, beside its package."""
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    write_metadata(root / "src", project["name"], project["entry-points"])
