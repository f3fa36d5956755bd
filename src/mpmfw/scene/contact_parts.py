"""``[contact] detection = "nodes"``, ``law = "penalty"``: another form of ``method = "nodes+penalty"``.

Options are in the tables of the parts, ``[contact.nodes]`` and ``[contact.penalty]``. Other modules see the
method alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available, load
from mpmfw.scene.problem import Path, Problem
from mpmfw.scene.wording import shown, unknown_name, with_options

#: The keys, each with the kind of plug-in that it names.
PARTS: tuple[Literal["detection", "law"], ...] = ("detection", "law")


@dataclass(frozen=True)
class Parts:
    """The parts that a table names."""

    table: dict[str, Any]  #: with the method that they make, and with its options in one table
    names: tuple[str, str]  #: of the tables that the options came from: detection, law


def latest_spelling(mapping: dict[str, Any], set_paths: Iterable[Path]) -> None:
    """Keep either the method or the parts in ``mapping``, whichever the last override sets."""
    table, paths = mapping.get("contact"), set(set_paths)
    if not isinstance(table, dict):
        return
    set_parts = [part for part in PARTS if ("contact", part) in paths]
    if ("contact", "method") in paths and not set_parts:
        for part in PARTS:
            table.pop(part, None)
    elif set_parts and ("contact", "method") not in paths and all(part in table for part in PARTS):
        table.pop("method", None)


def parts_of(table: Mapping[str, Any]) -> tuple[Parts | None, list[Problem]]:
    """Return the parts that ``[contact]`` names, or None if it names none, and their problems."""
    given = [part for part in PARTS if part in table]
    if not given:
        return None, []
    problems = []
    if "method" in table:
        message = "does not go with a method; expected either method, or detection and law"
        problems.append(Problem(("contact", given[0]), message))
    elif len(given) == 1:
        (other,) = (part for part in PARTS if part not in given)
        expected = f"expected one of {', '.join(available(other))}"
        message = f"missing beside {given[0]} = {shown(table[given[0]])}; {expected}"
        problems.append(Problem(("contact", other), message, "missing"))
    if problems:
        return None, problems
    for part in PARTS:
        name, valid = table[part], available(part)
        if not isinstance(name, str):
            problems.append(Problem(("contact", part), f"expected the name of a {part}, not {shown(name)}"))
        elif name not in valid:
            problems.append(unknown_name(("contact", part), name, list(valid), f"no such {part}: "))
    return (None, problems) if problems else _joined(table, (table["detection"], table["law"]))


def _joined(table: Mapping[str, Any], names: tuple[str, str]) -> tuple[Parts | None, list[Problem]]:
    """Join the parts' options in one table, after each part's options were checked in its own table."""
    method = "+".join(names)
    tables = {name: table.get(name, {}) for name in (*names, method)}
    tables = {name: own for name, own in tables.items() if isinstance(own, Mapping)}
    problems: list[Problem] = []
    for part, name in zip(PARTS, names, strict=True):
        try:
            problems += with_options(load(part, name), tables.get(name, {}), ("contact", name))[1]
        except SceneError as error:
            problems.append(Problem(("contact", part), str(error)))
    places = {key: name for name in names for key in tables.get(name, {})}
    beside = {key: value for key, value in table.items() if key not in (*PARTS, *tables)}
    message = f'[contact."{method}"] gives it too; leave one of them out'
    problems += [
        Problem(("contact", places[key], key), message) for key in tables.get(method, {}) if key in places
    ]
    if problems:
        return None, problems
    options = {key: value for own in tables.values() for key, value in own.items()}
    return Parts({**beside, "method": method, **({method: options} if options else {})}, names), []


def without_effect(overrides: Iterable[tuple[str, Path]], table: Any) -> list[Problem]:
    """Refuse options of a detection or a law that ``[contact]`` does not name."""
    if not isinstance(table, Mapping):
        return []
    named = [table.get(part) for part in PARTS]
    whole = available("contact")
    alone = {name: part for part in PARTS for name in available(part) if name not in whole}
    stands, problems = f'[contact."{table.get("method", "DETECTION+LAW")}"]', []
    for key, path in overrides:
        if len(path) > 1 and path[0] == "contact" and path[1] in alone and path[1] not in named:
            written = f"{alone[path[1]]} = '{path[1]}'"
            message = f"has no effect: [contact] does not have {written}; options belong in {stands}"
            problems.append(Problem((), message, override=key))
    return problems
