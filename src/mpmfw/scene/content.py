"""Content that no scene may hold: endless nesting, text that no file takes, a stranger's code."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from mpmfw.plugin.discovery import names_code
from mpmfw.scene.locator import Path
from mpmfw.scene.override import parse_value
from mpmfw.scene.problem import Problem
from mpmfw.units import LARGEST

#: Tables and arrays within each other; the deepest key of a scene has six.
DEEPEST = 32

TOO_DEEP = f"tables and arrays are nested too deeply to be read; no scene needs more than {DEEPEST} levels"


def walk(content: Any, at: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Yield ``content`` and all that is in it, with paths; a list of what is left allows any depth."""
    waiting = [(at, content)]
    while waiting:
        path, value = waiting.pop()
        yield path, value
        if isinstance(value, Mapping):
            waiting += [((*path, str(key)), item) for key, item in value.items()]
        elif isinstance(value, list | tuple):
            waiting += [((*path, index), item) for index, item in enumerate(value)]


def check_content(content: Any, at: Path = ()) -> Iterator[Problem]:
    """Problems of the values as such, at a place of the scene; too deep nesting comes alone."""
    problems: list[Problem] = []
    for path, value in walk(content, at):
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


def code_in(content: Any, at: Path = ()) -> Iterator[Problem]:
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
        return f"has the character {text[error.start]!a}, which is none of Unicode; expected text"
    return ""
