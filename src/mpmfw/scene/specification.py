"""A method and its options in one text: ``penalty(kappa=2, passes=one)``.

A strategy's ``label`` prints the text, and every key or option that names a method accepts it. Its options
override those of the scene's table of the method."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import Kind, choices, did_you_mean, load
from mpmfw.scene.override import parse_path, parse_value
from mpmfw.scene.problem import Path
from mpmfw.scene.toml_text import value_text
from mpmfw.scene.wording import with_options

#: Kinds of methods that a scene names by ``KIND.method``.
METHODS: tuple[Literal["contact", "shape"], ...] = ("contact", "shape")

_FORM = re.compile(r"\s*([^\s()\[\]{}=,\"']+)\s*(?:\((.*)\))?\s*", re.DOTALL)
_OPTION = re.compile(r"\s*([A-Za-z_]\w*)\s*=(.*)", re.DOTALL)
_OPENING, _CLOSING = "([{", ")]}"


@dataclass(frozen=True)
class Specification:
    """A method's name and the options beside it."""

    name: str  #: of the plug-in
    options: Mapping[str, Any] = field(default_factory=dict)  #: by name, read as ``--set`` reads them

    def __str__(self) -> str:
        """Return the text that parses to this specification, options in alphabetical order."""
        text = ", ".join(f"{key}={_bare(value)}" for key, value in sorted(self.options.items()))
        return f"{self.name}({text})" if text else self.name


def parse_specification(text: str) -> Specification:
    """Read ``NAME`` or ``NAME(option=value, …)``; a SceneError for other forms."""
    form = _FORM.fullmatch(text)
    if form is None:
        raise SceneError(f"{text}: expected NAME or NAME(option=value, …)")
    name, inner = form.groups()
    options: dict[str, Any] = {}
    for part in _parts(inner or "", text):
        option = _OPTION.fullmatch(part)
        if option is None or not option.group(2).strip():
            raise SceneError(f"{text}: '{part.strip()}' is not option=value; expected NAME(option=value, …)")
        key = option.group(1)
        if key in options:
            raise SceneError(f"{text}: option '{key}' is given twice; leave one of them out")
        options[key] = parse_value(option.group(2).strip())
    return Specification(name, options)


def split_specifications(text: str) -> list[str]:
    """Split specifications at commas outside brackets and quotes, which must be closed."""
    return [part.strip() for part in _parts(text, text)]


def checked_specification(kind: Kind, text: str) -> Specification:
    """Read the specification of an installed plug-in; a SceneError refuses its name, form or options."""
    asked = parse_specification(text)
    if asked.name not in choices(kind):
        raise SceneError(f"{text}: no such {kind} plug-in; {did_you_mean(asked.name, choices(kind))}")
    if asked.options:
        _, found = with_options(load(kind, asked.name), asked.options, (kind, asked.name))
        for problem in (problem for problem in found if len(problem.path) > 2):
            raise SceneError(f"{text}: {problem.path[2]}: {problem.message}")
    return asked


def written(kind: Kind, text: str, said: str) -> str:
    """Return a specification as labels write it; an error begins with what the request calls the plug-in."""
    try:
        return str(checked_specification(kind, text))
    except SceneError as error:
        raise SceneError(f"{said} {error}") from error


def specification_of(name: str, options: Mapping[str, Any]) -> str:
    """Return the text that names a method and its options; values of None are left out."""
    return str(Specification(name, {key: value for key, value in options.items() if value is not None}))


def keys_of(key: str, value: Any) -> dict[Path, Any]:
    """Return the keys and values that ``KIND.method = specification`` sets; none for other keys and values.

    For a method that is not installed return the name alone, so that the problem is about the name."""
    try:
        path = parse_path(key)
    except ValueError:
        return {}
    if path not in [(kind, "method") for kind in METHODS] or not isinstance(value, str) or "(" not in value:
        return {}
    text, kind = parse_specification(value), path[0]
    options = text.options if text.name in choices(kind) else {}
    return {path: text.name} | {(kind, text.name, option): given for option, given in options.items()}


def _parts(text: str, whole: str) -> list[str]:
    """Return the text between commas outside brackets and quotes; nothing for an empty text."""
    parts, start, open_, quote = [], 0, "", ""
    for at, sign in enumerate(text):
        if quote:
            quote = "" if sign == quote and text[at - 1] != "\\" else quote
        elif sign in "\"'":
            quote = sign
        elif sign in _OPENING:
            open_ += sign
        elif sign in _CLOSING:
            if not open_ or _OPENING.index(open_[-1]) != _CLOSING.index(sign):
                raise SceneError(f"{whole}: '{sign}' closes nothing; expected NAME(option=value, …)")
            open_ = open_[:-1]
        elif sign == "," and not open_:
            parts.append(text[start:at])
            start = at + 1
    if open_ or quote:
        raise SceneError(f"{whole}: {quote or open_[-1]} is not closed; expected NAME(option=value, …)")
    return [*parts, text[start:]] if text.strip() else []


def _bare(value: Any) -> str:
    """Return a value as it parses: text without quotes, unless it would be taken for another type."""
    plain = isinstance(value, str) and value == value.strip() and not re.search(r"[,()\[\]{}\"'=]", value)
    return value if plain and value and parse_value(value) == value else value_text(value)
