"""Errors as messages and exit statuses."""

from __future__ import annotations

import functools
import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from mpmfw.errors import Interrupted, MpmfwError, ResultsWarning, SceneError

if TYPE_CHECKING:
    from mpmfw.scene import Scene


def exit_status(command: Callable[..., Any]) -> Callable[..., None]:
    """Return the command with errors on stderr as one message, and 1 or 2 as the exit status."""

    @functools.wraps(command)
    def guarded(*args: Any, **kwargs: Any) -> None:
        try:
            with _plain_warnings():
                command(*args, **kwargs)
        except BrokenPipeError:
            raise
        except (MpmfwError, Interrupted, OSError) as error:
            text = str(error)
            if isinstance(error, OSError):  # of a file that no command asked about before
                reason = error.strerror or text
                text = f"'{error.filename}': {reason}" if error.filename else reason
            typer.echo(text, err=True)
            status = 2 if isinstance(error, SceneError) else 1
            raise typer.Exit(128 + error.number if isinstance(error, Interrupted) else status) from error

    return guarded


@contextmanager
def _plain_warnings() -> Iterator[None]:
    """Show what a run's reader must know as one line; other warnings as Python does."""
    shown = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *rest: Any, **named: Any) -> None:
        if issubclass(category, ResultsWarning):
            typer.echo(f"note: {message}", err=True)
        else:
            shown(message, category, *rest, **named)

    warnings.showwarning = show
    try:
        yield
    finally:
        warnings.showwarning = shown


#: By the kind of a result: what follows the scene's name in its file's name, and what it is called.
_RESULTS = {
    "run": ("", "run's results"),
    "compare": ("-compare", "comparison"),
    "choice": ("-choose", "result of mpmfw choose"),
    "stability": ("-stability", "map of stability"),
    "study": ("", "study's results"),
}


def check_result(path: Path, kind: str, force: bool = False) -> Path:
    """Return the path, if results can be written there without loss of a file.

    Parameters
    ----------
    path
        Of the file to write.
    kind
        Its attribute ``kind``.
    force
        Whether another result of the kind is replaced. A campaign whose finished runs lie beside its result
        continues from them, which replaces nothing.
    """
    from mpmfw.campaigns.store import own_files
    from mpmfw.results.replacing import check_replaceable

    check_writable(path)
    check_replaceable(path, kind, _RESULTS[kind][1])
    exists = path.is_file() and path.stat().st_size > 0
    resumable, hint = False, ""
    if kind == "run":
        if Path(f"{path}.checkpoint").exists():
            _check_checkpoint(Path(f"{path}.checkpoint"), path, force or exists)
            hint = f", of a run that did not end; mpmfw resume {path} goes on with it"
    elif (folder := Path(f"{path}.runs")).exists():
        if not folder.is_dir():
            raise SceneError(
                f"{path}: its finished runs are kept in {folder}, which is a file; give another name"
            )
        resumable = bool(own_files(folder))
    if exists and not force and not resumable:
        raise SceneError(f"{path}: is there already{hint}; give another name, or --force to replace it")
    return path


def _check_checkpoint(checkpoint: Path, path: Path, may_replace: bool) -> None:
    """Refuse to replace a file that is not a checkpoint, or one whose results are missing."""
    from mpmfw.runs.restart import is_foreign

    if is_foreign(str(checkpoint)):
        raise SceneError(
            f"{checkpoint}: is not a checkpoint of a run, and would be replaced by that of {path}; give "
            "another name"
        )
    if not may_replace:
        raise SceneError(
            f"{checkpoint}: is the checkpoint of a run whose results are not there; give another name, or "
            "--force to replace it"
        )


def result_path(output: Path | None, scene: Scene, kind: str, force: bool, **others: Path | None) -> Path:
    """Return the path of a scene's results: the one that is given, or one named as the scene.

    Parameters
    ----------
    output, scene
        The path, if one is given, and the scene.
    kind, force
        As :func:`check_result` takes them.
    others
        Files to write beside it, by the name of the option.
    """
    path = Path(f"{scene.name}{_RESULTS[kind][0]}.nc") if output is None else output
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
    """Return the path of a figure, a page or an export, if it can be written without loss of a file."""
    from mpmfw.results.replacing import check_new

    return check_new(check_writable(path), force)


def figure_path(path: Path) -> Path:
    """Return the name of a figure's file, PNG where it says no format."""
    if path.suffix.lower() not in ("", ".png", ".pdf", ".svg"):
        raise SceneError(
            f"{path}: figures are PNG, PDF or SVG files; give a name that ends in .png, .pdf or .svg"
        )
    return path if path.suffix else path.with_suffix(".png")


def check_writable(path: Path) -> Path:
    """Return the path, if a file can be written there; checked before long work."""
    folder = path.parent
    if os.path.islink(os.path.realpath(path)):
        raise SceneError(f"{path}: is a link that leads to itself; give the name of a file")
    if path.is_dir():
        raise SceneError(f"{path}: is a folder; give the name of a file")
    if path.exists() and not path.is_file():
        raise SceneError(f"{path}: is a device or a pipe; give the name of a file")
    if not folder.is_dir():
        raise SceneError(f"{path}: the folder {folder} does not exist")
    if not os.access(path if path.exists() else folder, os.W_OK):
        raise SceneError(f"{path}: cannot be written")
    return path
