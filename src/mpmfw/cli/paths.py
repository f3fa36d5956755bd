"""Files that commands write: their names, and refusals before long work."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from mpmfw.errors import SceneError

if TYPE_CHECKING:
    from mpmfw.scene import Scene

#: What follows the scene's name in the name of a result of each kind.
_ENDINGS = {"run": "", "compare": "-compare", "choice": "-choose", "stability": "-stability"}


def check_result(path: Path, kind: str, force: bool = False) -> Path:
    """Return the path; a SceneError if results would replace a file without ``force`` or finished runs."""
    from mpmfw.campaigns.store import own_files
    from mpmfw.results.replacing import check_replaceable

    check_replaceable(path, kind)
    exists = path.is_file() and path.stat().st_size > 0
    resumable, hint = False, ""
    if kind == "run":
        if Path(f"{path}.checkpoint").exists():
            _check_checkpoint(Path(f"{path}.checkpoint"), path, force or exists)
            hint = f", of a run that did not end; mpmfw resume {path} goes on with it"
    elif (folder := Path(f"{path}.runs")).exists():
        if not folder.is_dir():
            raise SceneError(f"{folder}: is a file, and no folder of finished runs; give another name")
        resumable = bool(own_files(folder))
    if exists and not force and not resumable:
        raise SceneError(f"{path}: is there already{hint}; give another name, or --force to replace it")
    return path


def _check_checkpoint(checkpoint: Path, path: Path, may_replace: bool) -> None:
    from mpmfw.runs.restart import is_foreign

    if is_foreign(str(checkpoint)):
        raise SceneError(f"{checkpoint}: is not a checkpoint of a run, for {path}; give another name")
    if not may_replace:
        text = f"{checkpoint}: is the checkpoint of a run whose results are not there"
        raise SceneError(f"{text}; give another name, or --force to replace it")


def result_path(output: Path | None, scene: Scene, kind: str, force: bool, **others: Path | None) -> Path:
    """Return the path of a scene's results; ``others`` must be other files."""
    path = Path(f"{scene.name}{_ENDINGS[kind]}.nc") if output is None else output
    taken = {}
    if scene.source.name is not None and scene.source.directory is not None:
        taken[os.path.realpath(scene.source.name)] = "the scene"
    for option, file in {"output": path, **others}.items():
        if file is None:
            continue
        if (place := os.path.realpath(file)) in taken:
            raise SceneError(f"--{option} {file}: is the file of {taken[place]}; give another name")
        taken[place] = f"--{option}"
    return check_result(path, kind, force)


def new_path(path: Path, force: bool) -> Path:
    """Return the path of a figure, a page or an export, if it can be written."""
    from mpmfw.results.replacing import check_new, check_writable

    return check_new(check_writable(path), force)


def figure_path(path: Path) -> Path:
    """Return the name of a figure's file, by default PNG."""
    if path.suffix.lower() not in ("", ".png", ".pdf", ".svg"):
        raise SceneError(f"{path}: expected a figure whose name ends in .png, .pdf or .svg")
    return path if path.suffix else path.with_suffix(".png")
