"""Check a case that is data: run what its tables name, and record the rows and figures that they ask for."""

from __future__ import annotations

import importlib
import itertools
import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

from mpmfw.campaigns.measures import exact_of, measure_of
from mpmfw.errors import SceneError, SimulationError
from mpmfw.plugin.measure import About
from mpmfw.scene import Scene
from mpmfw.validation.case import Case, Method
from mpmfw.validation.tables import (
    CaseTables,
    MethodsTable,
    PlaceTable,
    QuantityTable,
    RowTable,
    RunsTable,
    TogetherTable,
    VersionTable,
    When,
    matches,
)

#: A table that may count in one version of a case alone.
_Timed = TypeVar("_Timed", PlaceTable, VersionTable, RowTable, MethodsTable)


@dataclass
class CaseRun:
    """One run of a case, as functions of several runs and of figures get it.

    Attributes
    ----------
    runs
        Name of the runs that it is one of.
    place, version, method
        What ran.
    scene
        What it ran, all values set.
    results
        What ``mpmfw.run`` returned, or the function that stands in its place.
    broken
        Keys (or, without one, quantities) of its rows whose limits it does not keep, open ones included; of a changed version, of
        what would be its rows.
    """

    runs: str
    place: PlaceTable
    method: Method
    scene: Scene
    results: Any
    version: VersionTable = field(default_factory=VersionTable)
    broken: tuple[str, ...] = ()
    _measured: dict[str, Any] = field(default_factory=dict)

    def quantity(self, table: QuantityTable) -> float | None:
        """The number that a table asks for; None where this run has none."""
        name = json.dumps([table.measure, table.args, table.relative])
        if name not in self._measured:
            self._measured[name] = self._measure(table)
        return _scaled(table, self._measured[name])

    def keeps(self, row: RowTable) -> bool:
        """Whether the value of a row is within its limits here, or it has none."""
        limits, value = row.limits(self.place), self.quantity(row)
        return limits is None or value is None or limits[0] <= value <= limits[1]

    def read(self, measure: str, key: str | None = None, **args: Any) -> float:
        """The number of a measure, as a row of the tables with these keys has it; NaN where there is none."""
        found = self.quantity(QuantityTable(measure=measure, key=key, args=args))
        return math.nan if found is None else found

    def _measure(self, table: QuantityTable) -> Any:
        if ":" in table.measure:
            return function_of(table.measure)(self.results, **table.args)
        measure, about = measure_of(table.measure), About(**table.args)
        value = float(measure.of(self.results, self.scene, about).values[0])
        if not table.relative:
            return value
        exact = exact_of(measure, self.scene, about)
        if exact is None:
            raise SceneError(f"scene '{self.scene.name}' has no closed form of {table.measure}")
        return value / float(exact.at(measure.of(self.results, self.scene, about).time)[0]) - 1.0


def check_tables(case: Case, tables: CaseTables) -> None:
    """Run and record all that the tables ask for in this version of the case.

    Raises
    ------
    SceneError
        A table names no function.
    """
    now: When = "quick" if case.quick else "full"
    for name in _functions(tables):
        function_of(name)
    done: list[CaseRun] = []
    for runs in tables.runs:
        if runs.when in (None, now):
            done += _run(case, runs, now)
    for row in tables.rows:
        if row.when in (None, now):
            _together(case, row, [one for one in done if one.runs in row.of])
    for figure in tables.figures:
        if figure.when in (None, now):
            drawn = [one for one in done if not figure.of or one.runs in figure.of]
            drawn = [one for one in drawn if not figure.methods or matches(one.method, figure.methods)]
            case.figure(figure.name, function_of(figure.draw)(drawn))


def function_of(name: str) -> Callable[..., Any]:
    """The function ``module:function`` of a case or of its suite.

    Raises
    ------
    SceneError
        There is none.
    """
    module, _, function = name.partition(":")
    try:
        found: Callable[..., Any] = getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError) as error:
        raise SceneError(f"case.toml: '{name}' is no function of the case: {error}") from error
    return found


def _functions(tables: CaseTables) -> Iterator[str]:
    """All functions that the tables name."""
    rows = [*tables.rows, *(row for runs in tables.runs for row in runs.rows)]
    yield from (row.measure for row in rows if ":" in row.measure)
    yield from (row.reference.measure for row in rows if isinstance(row.reference, QuantityTable))
    for runs in tables.runs:
        named = [runs.by, runs.scene, *(place.scene for place in runs.places)]
        named += [version.change for version in runs.versions]
        yield from (name for name in named if name is not None and ":" in name)
    yield from (figure.draw for figure in tables.figures)


def _run(case: Case, runs: RunsTable, now: When) -> list[CaseRun]:
    """Run the scene at every place, in every version, with every method.

    A run that fails keeps its row, red if a gate binds it.
    """
    done = []
    rows = list(_of_now(runs.rows, now))
    methods = [method for table in _of_now(runs.methods, now) for method in table.methods()]
    for place, version, method in itertools.product(
        _of_now(runs.places, now), list(_of_now(runs.versions, now)), methods
    ):
        own = [row for row in rows if row.is_of(method, place)]
        try:
            scene = scene_at(case, runs, place, version, method, now)
            results = _results(case, runs, scene)
        except (SimulationError, SceneError) as error:
            gates = method.recommended or any(row.is_gate(method, place) for row in own)
            binds = gates and version.change is None and not place.is_open("run", method)
            case.failed(method, str(error), binds=binds, at=", ".join(filter(None, (place.at, version.at))))
            continue
        run = CaseRun(runs.name, place, method, scene, results, version)
        run.broken = tuple(row.key or row.quantity for row in own if not run.keeps(row))
        done.append(run)
        for row in own if version.change is None else ():
            reference = run.quantity(row.reference) if isinstance(row.reference, QuantityTable) else None
            _record(case, row, method, run.quantity(row), row.is_gate(method, place), place, reference)
    return done


def _of_now(tables: Iterable[_Timed], now: When) -> Iterator[_Timed]:
    """Those that count in this version of the case."""
    return (one for one in tables if one.when in (None, now))


def scene_at(
    case: Case, runs: RunsTable, place: PlaceTable, version: VersionTable, method: Method, now: When
) -> Scene:
    """The scene of a place in a version: made, set, changed, and with the method."""
    name = place.scene or runs.scene
    values = {**runs.set, **(runs.quick if now == "quick" else {}), **place.set}
    given = function_of(name)(**place.make) if ":" in name else name
    if version.change is not None:
        mapping = case.scene(given, None, values).to_mapping()
        given, values = function_of(version.change)(mapping, **version.args), {}
    return case.scene(given, method, values)


def _results(case: Case, runs: RunsTable, scene: Scene) -> Any:
    if runs.by is None:
        return case.run(scene)
    with case.timed():
        return function_of(runs.by)(scene)


def _record(
    case: Case,
    row: RowTable,
    method: Method | str,
    value: float | None,
    binds: bool,
    place: PlaceTable | None = None,
    reference: float | str | None = None,
) -> None:
    """A row with its limits, of a place if there is one; none where there is no value."""
    if value is not None:
        given = row.reference if reference is None else reference
        assert not isinstance(given, QuantityTable)
        name = row.quantity.replace("{at}", place.at) if place else row.quantity
        limits = row.limits(place)
        case.gate(
            name,
            value,
            within=limits,
            reference=given,
            unit=row.unit,
            method=method,
            binds=binds and limits is not None,
        )


def _together(case: Case, row: TogetherTable, runs: Sequence[CaseRun]) -> None:
    """A row of all these runs, or one for each of their methods; without runs, of the function alone."""
    function = function_of(row.measure)
    if not row.of:
        with case.timed():
            found = function(**row.args)
        _record(case, row, row.method, _scaled(row, found), row.binds != "none")
    elif not row.each:
        found = function(runs, **row.args)
        _record(case, row, row.method, _scaled(row, found), row.binds != "none")
    else:
        apart = {(run.method, run.place.at if row.each == "place" else ""): run.place for run in runs}
        for (method, at), place in apart.items():
            if row.is_of(method):
                same = [run for run in runs if run.method == method and at in ("", run.place.at)]
                here = place if at else None
                found = function(same, **row.args)
                _record(case, row, method, _scaled(row, found), row.is_gate(method, here), here)


def _scaled(table: QuantityTable, found: Any) -> float | None:
    value = found[table.key] if isinstance(found, Mapping) and table.key is not None else found
    return None if value is None else table.scale * float(value)
