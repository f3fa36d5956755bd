"""TOML texts by name, from a file or the package; checks of content that no text may have."""

from __future__ import annotations

import functools
import os
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

from mpmfw.errors import NoSuchFileError, SceneError
from mpmfw.plugin.discovery import did_you_mean, names_code
from mpmfw.scene.override import parse_value
from mpmfw.scene.problem import Path as KeyPath
from mpmfw.scene.problem import Problem
from mpmfw.units import LARGEST

#: Tables and arrays within each other; the deepest key of a scene has six.
DEEPEST = 32

TOO_DEEP = f"tables and arrays are nested too deeply to be read; no scene needs more than {DEEPEST} levels"


def walk(content: Any, at: KeyPath = ()) -> Iterator[tuple[KeyPath, Any]]:
    """Yield ``content`` and all that is in it, with paths; a list of what is left allows any depth."""
    waiting = [(at, content)]
    while waiting:
        path, value = waiting.pop()
        yield path, value
        if isinstance(value, Mapping):
            waiting += [((*path, str(key)), item) for key, item in value.items()]
        elif isinstance(value, list | tuple):
            waiting += [((*path, index), item) for index, item in enumerate(value)]


def check_content(content: Any) -> Iterator[Problem]:
    """Return problems of single values; nesting that is too deep is reported alone."""
    problems: list[Problem] = []
    for path, value in walk(content):
        if len(path) > DEEPEST:
            yield Problem(path[:3], f"is nested more than {DEEPEST} tables and arrays deep")
            return
        if isinstance(value, Mapping):
            problems += [
                Problem(path, f"has a key {key!r}; {wrong}") for key in value if (wrong := _text(key))
            ]
        elif isinstance(value, int) and abs(value) > LARGEST:
            problems.append(Problem(path, f"is an integer past {LARGEST:g}, out of range"))
        elif isinstance(value, str) and (wrong := _text(value)):
            problems.append(Problem(path, wrong))
    yield from problems


#: Keys whose text names no plug-in.
_FREE = frozenset({"title", "path", "file", "scene", "scenes"})


def code_in(content: Any, at: KeyPath = ()) -> Iterator[Problem]:
    """Yield a problem for each ``module:Class`` among the values of a file, whose code a run would import."""
    for path, value in walk(content, at):
        if isinstance(value, str) and names_code(value):
            if path[-1] not in _FREE and path[:-1] != ("scenes",):
                trusted = "a file may name only with --trust (Python: trust=True)"
                yield Problem(path, f"'{value}' is Python code, which {trusted}")
        elif isinstance(value, str) and (read := parse_value(value)) != value:
            yield from code_in(read, path)  # a study's texts are read as TOML values


def _text(text: Any) -> str:
    if not isinstance(text, str):
        return ""
    if "\0" in text:
        return "has the character NUL; expected text"
    try:
        text.encode()
    except UnicodeEncodeError as error:
        return f"has the character {text[error.start]!a}, which is not valid Unicode; expected text"
    return ""


@dataclass(frozen=True)
class Source:
    """Source of a scene: a file, a shipped name or a mapping."""

    mapping: Mapping[str, Any]  #: the scene's tables as written, with no override
    text: str | None = None  #: the TOML text; None for a scene made from a mapping
    name: str | None = None  #: of the file
    directory: Path | None = None  #: folder that relative file names in the scene refer to
    overrides: Mapping[str, Any] = field(default_factory=dict)  #: keys set over the mapping, in order
    said: Mapping[str, str] = field(default_factory=dict)  #: names of overrides that are not ``--set KEY``


@functools.cache
def shipped_texts(folder: str) -> dict[str, str]:
    """TOML texts in a folder of the package, by name."""
    inside = (resources.files("mpmfw") / folder).iterdir()
    files = sorted((one for one in inside if one.name.endswith(".toml")), key=lambda one: one.name)
    return {one.name.removesuffix(".toml"): one.read_text(encoding="utf-8") for one in files}


def plain(value: Any) -> Any:
    """Convert mappings, tuples, arrays and paths to dict, list and scalars."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):  # NumPy arrays and scalars
        return value.tolist()
    return os.fspath(value) if isinstance(value, os.PathLike) else value


def read_source(
    given: str | os.PathLike[str] | Mapping[str, Any], kind: str, shipped: Mapping[str, str]
) -> Source:
    """Read a file, or else the text of that name among ``shipped``; mappings are taken as they are."""
    if isinstance(given, Mapping):
        try:
            return Source(plain(given))
        except RecursionError:
            raise SceneError(TOO_DEEP) from None
    listed = ", ".join(shipped)
    if not isinstance(given, str | os.PathLike):
        raise SceneError(
            f"{given!r} is not a {kind}; expected a TOML file, a shipped {kind} ({listed}) or a mapping"
        )
    name, path = os.fspath(given), Path(given)
    if "\0" in name:
        raise SceneError(f"{name!r}: has the character NUL, which no file name can have")
    if path.is_file():
        try:
            return _parse(path.read_text(encoding="utf-8-sig"), name, path.parent)
        except UnicodeDecodeError as error:
            where = f"{error.reason} at byte {error.start}"
            raise SceneError(f"{path}: not UTF-8 text, as TOML must be ({where})") from error
        except OSError as error:
            raise SceneError(f"{path}: cannot be read: {error.strerror}") from error
    if name in shipped:
        return _parse(shipped[name], f"{name}.toml", None)
    if path.is_dir():
        raise SceneError(f"{name}: is a folder; expected a TOML file or a shipped {kind} ({listed})")
    if not shipped:
        raise NoSuchFileError(f"{name}: no such file; expected a {kind}")
    hint = did_you_mean(name.removesuffix(".toml"), shipped)
    raise NoSuchFileError(f"{name}: no such file, and no shipped {kind}; {hint}")


def _parse(text: str, name: str, directory: Path | None) -> Source:
    try:
        mapping = tomllib.loads(text)
    except RecursionError:
        raise SceneError(f"{name}: {TOO_DEEP}") from None
    except tomllib.TOMLDecodeError as error:
        found = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)$", str(error))
        what = str(error)[: found.start()] if found else str(error)
        line = found.group(1) if found and found.group(1) else max(1, len(text.splitlines()))
        raise SceneError(f"{name}:{line}: not valid TOML: {what}") from error
    return Source(mapping, text, name, directory)
