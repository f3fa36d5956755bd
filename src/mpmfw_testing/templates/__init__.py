"""What ``mpmfw new`` writes: for each kind of plug-in the least that passes its checks, to be renamed and replaced."""

from __future__ import annotations

import keyword
import re
from collections.abc import Mapping
from pathlib import Path

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available, did_you_mean
from mpmfw_testing.templates.texts import MODULE_OF, PYPROJECT, README, RUN, TESTS

#: Kinds that are whole distributions among the documentation: the folder, and name and class of the plug-in in it.
WHOLE: Mapping[str, tuple[str, str, str]] = {
    "contact": ("plugin-template", "film", "Film"),
    "law": ("plugin-template", "film", "Film"),
    "shape": ("shape-template", "bounded_bspline", "BoundedBSpline"),
}

#: All kinds.
KINDS = (*WHOLE, *TESTS)

_NAME = re.compile(r"[a-z][a-z0-9_]*")


def write_package(kind: str, name: str, folder: Path) -> Path:
    """Write a distribution with a plug-in of one's own, with tests that it passes.

    Parameters
    ----------
    kind
        One of :data:`KINDS`.
    name
        What scenes will call it: small letters, digits and ``_``.
    folder
        Where the distribution's folder ``mpmfw-NAME`` is made.

    Returns
    -------
    The folder.

    Raises
    ------
    SceneError
        No such kind, no such name, a plug-in of the name is installed, or the folder is there already.
    """
    if kind not in KINDS:
        raise SceneError(f"no plug-in of the kind '{kind}' can be written; {did_you_mean(kind, KINDS)}")
    if not _NAME.fullmatch(name) or keyword.iskeyword(name):
        raise SceneError(f"{name}: expected a name of small letters, digits and '_', such as soft_wall")
    if name in _taken(kind):
        raise SceneError(f"{name}: a {kind} of this name is installed already; expected another name")
    place = folder / f"mpmfw-{name.replace('_', '-')}"
    if place.exists():
        raise SceneError(f"{place}: is there already; give another name, or another folder by --into")
    files = _copied(*WHOLE[kind], name) if kind in WHOLE else _made(kind, name)
    for path, text in files.items():
        file = place / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    return place


def _taken(kind: str) -> set[str]:
    """Names of installed plug-ins of the kind."""
    return set(available("law" if kind == "contact" else kind))  # type: ignore[arg-type]


def _copied(folder: str, known: str, kind: str, name: str) -> dict[str, str]:
    """A whole distribution with another name."""
    package = Path(__file__).parent
    source = package / folder
    if not source.is_dir():  # in the checkout that it runs from
        source = package.parents[2] / "docs" / folder
    files = {}
    for path in sorted(source.rglob("*")):
        if path.is_file() and path.suffix in (".py", ".toml", ".md", ".typed"):
            place = _renamed(path.relative_to(source).as_posix(), known, kind, name)
            text = _renamed(path.read_text(encoding="utf-8"), known, kind, name)
            # Links into mpmfw's own documentation lead nowhere from another place
            files[place] = re.sub(r"\[([^\]]+)\]\(\.\./[^)]*\)", r"\1", text)
    return files


def _made(kind: str, name: str) -> dict[str, str]:
    """A distribution of one module, with its test."""
    module = (Path(__file__).parent / f"{kind}.py").read_text(encoding="utf-8")
    facts = {
        "NAME": name,
        "DASHED": name.replace("_", "-"),
        "KIND": kind,
        "ENTRY": _class_name(name),
        "RUN": RUN.get(kind, ""),
    }
    texts = {
        "pyproject.toml": PYPROJECT,
        "README.md": README,
        f"src/mpmfw_{name}/__init__.py": MODULE_OF,
        f"tests/test_{name}.py": TESTS[kind],
    }
    files = {path: _filled(_filled(text, facts), facts) for path, text in texts.items()}
    return {
        **files,
        f"src/mpmfw_{name}/{kind}.py": module.replace("template", name).replace(
            "Template", _class_name(name)
        ),
        f"src/mpmfw_{name}/py.typed": "",
    }


def _filled(text: str, facts: Mapping[str, str]) -> str:
    """A text with the facts in place of their names, ``@NAME@``."""
    return re.sub(r"@([A-Z]+)@", lambda found: facts[found.group(1)], text)


def _class_name(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def _renamed(text: str, known: str, kind: str, name: str) -> str:
    """The text with another name of the plug-in and its class ``kind``; where it is a word of prose, after a blank, it stays."""
    text = text.replace(f"mpmfw-{known.replace('_', '-')}", f"mpmfw-{name.replace('_', '-')}")
    text = re.sub(rf"(?<! ){known}|(?<=mpmfw check ){known}", name, text)
    return re.sub(rf"\b{kind}(?=\b|Options)", _class_name(name), text)
