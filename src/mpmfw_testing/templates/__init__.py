"""Write the distributions of ``mpmfw new``: for each kind of plug-in the least that passes its checks.

A template is one folder of files or several laid over each other, some of them in the documentation.
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Mapping
from pathlib import Path

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available, did_you_mean

#: Folders of each kind, and name and class of the plug-in in them.
TEMPLATES: Mapping[str, tuple[tuple[str, ...], str, str]] = {
    "contact": (("plugin-template",), "film", "Film"),
    "law": (("plugin-template",), "film", "Film"),
    "shape": (("shape-template",), "bounded_bspline", "BoundedBSpline"),
    **{
        kind: (("common", kind), "template", "Template")
        for kind in ("material", "load", "friction", "detection", "geometry")
    },
}

_NAME = re.compile(r"[a-z][a-z0-9_]*")


def write_package(kind: str, name: str, folder: Path) -> Path:
    """Write a distribution with a new plug-in, and with tests that it passes.

    ``kind`` is one of :data:`TEMPLATES`; scenes call the plug-in ``name``, of small letters, digits and
    ``_``. The distribution's folder ``mpmfw-NAME`` is made in ``folder``, and returned.

    Raises
    ------
    SceneError
        No such kind, no such name, a plug-in of the name is installed, or the folder exists.
    """
    if kind not in TEMPLATES:
        raise SceneError(f"there is no template of the kind '{kind}'; {did_you_mean(kind, TEMPLATES)}")
    if not _NAME.fullmatch(name) or keyword.iskeyword(name):
        raise SceneError(f"{name}: expected a name of small letters, digits and '_', such as soft_wall")
    if name in available("law" if kind == "contact" else kind):  # type: ignore[arg-type]
        raise SceneError(f"{name}: a {kind} of this name is installed already; expected another name")
    place = folder / f"mpmfw-{name.replace('_', '-')}"
    if place.exists():
        raise SceneError(f"{place}: exists already; give another name, or another folder by --into")
    for source in map(_folder, TEMPLATES[kind][0]):
        for path in sorted(source.rglob("*")):
            if path.is_file() and path.suffix in (".py", ".toml", ".md", ".typed"):
                file = place / _renamed(path.relative_to(source).as_posix(), kind, name)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(_renamed(path.read_text(encoding="utf-8"), kind, name), encoding="utf-8")
    return place


def _folder(name: str) -> Path:
    """Return the folder of a template: beside this file, or in the checkout's documentation."""
    package = Path(__file__).parent
    return package / name if (package / name).is_dir() else package.parents[2] / "docs" / name


def _renamed(text: str, kind: str, name: str) -> str:
    """Return the text with the plug-in's name and class; as a word of prose it stays."""
    _, known, of_class = TEMPLATES[kind]
    text = text.replace("KIND", kind).replace(
        f"mpmfw-{known.replace('_', '-')}", f"mpmfw-{name.replace('_', '-')}"
    )
    text = re.sub(rf"(?<! ){known}|(?<=mpmfw check ){known}", name, text)
    text = re.sub(
        rf"\b{of_class}(?=\b|Options)", "".join(part.capitalize() for part in name.split("_")), text
    )
    # Links into mpmfw's own documentation lead nowhere from another place
    return re.sub(r"\[([^\]]+)\]\(\.\./[^)]*\)", r"\1", text)
