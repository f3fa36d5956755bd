"""Read ``case.toml``, and check what its tables name."""

from __future__ import annotations

import fnmatch
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from mpmfw.campaigns.measures import measure_of
from mpmfw.campaigns.tables import validated
from mpmfw.errors import SceneError
from mpmfw.scene.locator import Path as KeyPath
from mpmfw.scene.problem import Problem
from mpmfw.scene.sources import read_source
from mpmfw.validation.case import Method
from mpmfw.validation.tables import (
    CaseTables,
    PlaceTable,
    QuantityTable,
    RowTable,
    RunsTable,
    TogetherTable,
    matches,
)


def load_case(folder: Path) -> CaseTables:
    """Read and validate ``case.toml``, and what it takes over from the file that it names as ``like``.

    Raises
    ------
    SceneError
        One line for each thing that is wrong: file, line, key, what was expected.
    """
    source = read_source(folder / "case.toml", "case", {})
    return validated(CaseTables, replace(source, mapping=_whole(source.mapping, folder)), _checks)


def _whole(own: Mapping[str, Any], folder: Path) -> Mapping[str, Any]:
    """The tables with what they are like: keys that are missing are taken over, and lists go on, runs in turn."""
    if not isinstance(own.get("like"), str):
        return own
    base = read_source(folder / own["like"], "case", {}).mapping
    nothing: dict[str, Any] = {}
    runs = itertools.zip_longest(base.get("runs", []), own.get("runs", []), fillvalue=nothing)
    return {**_joined(base, own), "runs": [_joined(usual, given) for usual, given in runs]}


def _joined(base: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    both = {key: base[key] + own[key] for key in base.keys() & own.keys() if isinstance(base[key], list)}
    return {**base, **own, **both}


def _checks(tables: CaseTables) -> Iterator[Problem]:
    """What would have no effect: patterns of no method, names of no runs, limits and keys that nothing looks at."""
    for k, runs in enumerate(tables.runs):
        methods = [method for table in runs.methods for method in table.methods()]
        for j, row in enumerate(runs.rows):
            at: KeyPath = ("runs", k, "rows", j)
            yield from _measure(row, at)
            yield from _patterns(row, methods, at)
            yield from _places(row, runs.places, at)
            if isinstance(row.reference, QuantityTable):
                yield from _measure(row.reference, (*at, "reference"))
        yield from _own_words(runs, ("runs", k), _keys(tables, runs))
        yield from _open(runs.places, methods, ("runs", k, "places"))
    names = [runs.name for runs in tables.runs if runs.name]
    for k, together in enumerate(tables.rows):
        yield from _of(together.of, names, ("rows", k))
        yield from _together(together, ("rows", k))
    for k, figure in enumerate(tables.figures):
        yield from _of(figure.of, names, ("figures", k))
        every = [method for runs in tables.runs for table in runs.methods for method in table.methods()]
        yield from _unmatched(figure.methods, every, ("figures", k, "methods"))


def _keys(tables: CaseTables, runs: RunsTable) -> set[str]:
    """What limits of a place, and what is open there, may be of."""
    together = (row for row in tables.rows if row.each == "place" and runs.name in row.of)
    return {row.key for row in (*runs.rows, *together) if row.key}


def _own_words(runs: RunsTable, at: KeyPath, keys: set[str]) -> Iterator[Problem]:
    """Of places and versions, what nothing looks at."""
    for place in runs.places:
        for key in (place.within.keys() | place.open.keys() - {"run"}) - keys:
            yield Problem((*at, "places"), f"{place.at}: '{key}' is the key of no row of these runs")
        if place.make and ":" not in (place.scene or runs.scene):
            yield Problem((*at, "places"), f"{place.at}: make has no effect, the scene is no module:function")
    if len({place.at for place in runs.places}) < len(runs.places):
        yield Problem((*at, "places"), "two places have the same name; 'at' must tell them apart")
    for version in runs.versions:
        if version.args and version.change is None:
            yield Problem((*at, "versions"), f"{version.at}: args have no effect without change")
    if all(version.change is not None for version in runs.versions) and runs.rows:
        yield Problem((*at, "versions"), "rows are of a version without change, and there is none")


def _open(places: Sequence[PlaceTable], methods: Sequence[Method], at: KeyPath) -> Iterator[Problem]:
    """Reasons of no method."""
    for place in places:
        patterns = [pattern for why in place.open.values() if not isinstance(why, str) for pattern in why]
        yield from _unmatched(patterns, methods, (*at, place.at, "open"))


def _measure(table: QuantityTable, at: KeyPath) -> Iterator[Problem]:
    """A function is looked for when the case runs, in its folder; a campaign's measure must be a number."""
    if ":" in table.measure:
        if table.relative:
            yield Problem((*at, "relative"), "has no effect: only a campaign's measure knows a closed form")
        return
    try:
        measure = measure_of(table.measure)
    except SceneError as error:
        yield Problem((*at, "measure"), str(error))
        return
    if measure.kind != "number":
        yield Problem((*at, "measure"), f"{table.measure} is a {measure.kind}; expected a number")
    if table.key is not None:
        yield Problem((*at, "key"), f"has no effect: {table.measure} is one number")
    for key in table.args.keys() - {*measure.keys}:
        looks = " and ".join(measure.keys)
        yield Problem((*at, "args"), f"'{key}' has no effect: {table.measure} looks at {looks}")


def _places(row: RowTable, places: Sequence[PlaceTable], at: KeyPath) -> Iterator[Problem]:
    known = [place.at for place in places]
    for name in row.places or ():
        if not fnmatch.filter(known, name):
            yield Problem((*at, "places"), f"there is no place '{name}'; expected one of {', '.join(known)}")
    if "binds" in row.model_fields_set and all(row.limits(place) is None for place in places):
        yield Problem((*at, "binds"), "has no effect without limits within")


def _patterns(row: RowTable, methods: Iterable[Method], at: KeyPath) -> Iterator[Problem]:
    for key in ("binds", "methods", "without"):
        given = getattr(row, key)
        yield from _unmatched(() if isinstance(given, str) else given, methods, (*at, key))


def _unmatched(patterns: Iterable[str], methods: Iterable[Method], at: KeyPath) -> Iterator[Problem]:
    for pattern in patterns:
        if not any(matches(method, [pattern]) for method in methods):
            listed = "; ".join(map(str, methods))
            yield Problem(at, f"'{pattern}' is of none of the methods: {listed}")


def _of(given: Iterable[str], names: Sequence[str], at: KeyPath) -> Iterator[Problem]:
    for name in given:
        if name not in names:
            expected = f"expected one of {', '.join(names) or 'none'}"
            yield Problem((*at, "of"), f"no runs are named '{name}'; {expected}")


def _together(row: TogetherTable, at: KeyPath) -> Iterator[Problem]:
    """Of a row that is not of single runs, keys that only these look at."""
    if ":" not in row.measure:
        yield Problem((*at, "measure"), f"'{row.measure}' reads single runs; expected module:function")
    if isinstance(row.reference, QuantityTable):
        yield Problem((*at, "reference"), "a measure reads single runs; expected a number or words")
    unseen = ["relative", "places"] + ([] if row.each else ["methods", "without"])
    for key in unseen:
        if key in row.model_fields_set:
            yield Problem((*at, key), "has no effect on a row that is of no single run")
    if row.each and not row.of:
        yield Problem((*at, "each"), "has no effect without 'of', which names runs")
    if row.each and row.method:
        yield Problem((*at, "method"), "has no effect with each = true: every method has its own")
    if not row.each and not isinstance(row.binds, str):
        yield Problem((*at, "binds"), "a single row is of no method; expected 'all' or 'none'")
    if "binds" in row.model_fields_set and row.within is None:
        yield Problem((*at, "binds"), "has no effect without limits within")
