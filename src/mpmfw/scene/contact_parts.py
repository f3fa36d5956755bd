"""``[contact] detection = "nodes"``, ``law = "penalty"``: the other way to write ``method =
"nodes+penalty"``.

Options stand in the tables of the parts, ``[contact.nodes]`` and ``[contact.penalty]``. The table is brought
into the form with a method, so that nothing behind this module knows of two."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available, load
from mpmfw.scene.locator import Path
from mpmfw.scene.problem import Problem
from mpmfw.scene.wording import shown, unknown_name, with_options

#: The keys, each with the kind of plug-in that it names.
PARTS: tuple[Literal["detection", "law"], ...] = ("detection", "law")


@dataclass(frozen=True)
class Parts:
    """The parts that a table names."""

    table: dict[str, Any]  #: with the method that they make, and with its options in one table
    names: tuple[str, str]  #: of the tables that the options came from: detection, law

    @property
    def method(self) -> str:
        """``DETECTION+LAW``."""
        return "+".join(self.names)


def latest_spelling(mapping: dict[str, Any], set_paths: Iterable[Path]) -> None:
    """Keep of a method and of parts in ``mapping`` those that were set over the scene last."""
    table, paths = mapping.get("contact"), set(set_paths)
    if not isinstance(table, dict):
        return
    set_parts = [part for part in PARTS if ("contact", part) in paths]
    if ("contact", "method") in paths and not set_parts:
        for part in PARTS:
            table.pop(part, None)
    elif set_parts and ("contact", "method") not in paths and all(part in table for part in PARTS):
        table.pop("method", None)
    if "method" in table or not all(isinstance(table.get(part), str) for part in PARTS):
        return
    names = tuple(table[part] for part in PARTS)
    whole = "+".join(names)
    for path in paths:
        if len(path) == 3 and path[0] == "contact" and path[1] in (*names, whole):
            for other in (whole,) if path[1] in names else names:
                if isinstance(table.get(other), dict):
                    table[other].pop(path[2], None)


def parts_of(table: Mapping[str, Any]) -> tuple[Parts | None, list[Problem]]:
    """The parts that ``[contact]`` names, or None where it names none; and what is wrong with them."""
    given = [part for part in PARTS if part in table]
    if not given:
        return None, []
    problems = []
    if "method" in table:
        message = "a method is named beside it; expected either method, or detection and law"
        problems.append(Problem(("contact", given[0]), message))
    elif len(given) == 1:
        (other,) = (part for part in PARTS if part not in given)
        names = ", ".join(available(other))
        message = f"missing beside {given[0]} = {shown(table[given[0]])}; expected one of {names}"
        problems.append(Problem(("contact", other), message, "missing"))
    if problems:
        return None, problems
    for part in PARTS:
        name, valid = table[part], available(part)
        if not isinstance(name, str):
            problems.append(Problem(("contact", part), f"expected the name of a {part}, not {shown(name)}"))
        elif name not in valid:
            problems.append(unknown_name(("contact", part), name, list(valid), f"no such {part}: "))
    return (None, problems) if problems else _checked(table, (table["detection"], table["law"]))


def _checked(table: Mapping[str, Any], names: tuple[str, str]) -> tuple[Parts | None, list[Problem]]:
    """The parts after the options of each were judged by its own model, at the place where they stand."""
    problems: list[Problem] = []
    method = "+".join(names)
    whole = table.get(method, {})
    options: dict[str, Any] = {}
    for part, name in zip(PARTS, names, strict=True):
        own = table.get(name, {})
        if not isinstance(own, Mapping):
            message = f"expected a table of options of {part} '{name}', not {shown(own)}"
            problems.append(Problem(("contact", name), message))
            continue
        try:
            problems += with_options(load(part, name), own, ("contact", name))[1]
        except SceneError as error:
            problems.append(Problem(("contact", part), str(error)))
        options |= own
        for option in own.keys() & (whole.keys() if isinstance(whole, Mapping) else ()):
            message = f'[contact."{method}"] gives it too; leave one of them out'
            problems.append(Problem(("contact", name, option), message))
    if not problems:
        try:
            load("contact", method)
        except SceneError as error:
            problems.append(Problem(("contact", "law"), str(error)))
    if problems:
        return None, problems
    beside = {key: value for key, value in table.items() if key not in (*PARTS, *names)}
    joined = {**options, **whole} if isinstance(whole, Mapping) else whole
    return Parts({**beside, "method": method, **({method: joined} if joined else {})}, names), []
