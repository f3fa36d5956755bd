"""Check a case that is data: run what its tables name, and record the rows and figures that they ask for."""

from __future__ import annotations

import importlib
import json
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from mpmfw.campaigns.measures import About, exact_of, measure_of
from mpmfw.errors import SceneError, SimulationError
from mpmfw.scene import Scene
from mpmfw.validation.case import Case, Method
from mpmfw.validation.tables import (
    CaseTables,
    PlaceTable,
    QuantityTable,
    RowTable,
    RunsTable,
    TogetherTable,
    When,
)


@dataclass
class CaseRun:
    """One run of a case, as functions of several runs and of figures get it.

    Attributes
    ----------
    runs
        Name of the runs that it is one of.
    place, method
        What ran.
    scene
        What it ran, all values set.
    results
        What ``mpmfw.run`` returned, or the function that stands in its place.
    """

    runs: str
    place: PlaceTable
    method: Method
    scene: Scene
    results: Any
    _measured: dict[str, Any] = field(default_factory=dict)

    def quantity(self, table: QuantityTable) -> float | None:
        """The number that a table asks for; None where this run has none."""
        name = json.dumps([table.measure, table.args, table.relative])
        if name not in self._measured:
            self._measured[name] = self._measure(table)
        return _scaled(table, self._measured[name])

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
    yield from (runs.by for runs in tables.runs if runs.by is not None)
    yield from (figure.draw for figure in tables.figures)


def _run(case: Case, runs: RunsTable, now: When) -> list[CaseRun]:
    """Run the scene at every place with every method; a run that fails keeps its row, red if a gate binds it."""
    done = []
    rows = [row for row in runs.rows if row.when in (None, now)]
    shared = {**runs.set, **(runs.quick if now == "quick" else {})}
    for place in (place for place in runs.places if place.when in (None, now)):
        for method in (m for table in runs.methods if table.when in (None, now) for m in table.methods()):
            name, values = place.scene or runs.scene, {**shared, **place.set}
            own = [row for row in rows if row.is_of(method, place)]
            try:
                scene = case.scene(name, method, values)
                if runs.by is None:
                    results = case.run(scene)
                else:
                    with case.timed():
                        results = function_of(runs.by)(scene)
            except (SimulationError, SceneError) as error:
                binds = method.recommended or any(row.is_gate(method, place) for row in own)
                case.failed(method, str(error), binds=binds)
                continue
            done.append(CaseRun(runs.name, place, method, scene, results))
            for row in own:
                _record(case, row, done[-1])
    return done


def _record(case: Case, row: RowTable, run: CaseRun) -> None:
    """The row of a run; one that is open is shown beside the limit that it does not keep."""
    value, limits = run.quantity(row), row.limits(run.place)
    if value is None:
        return
    reference = run.quantity(row.reference) if isinstance(row.reference, QuantityTable) else row.reference
    if row.key in run.place.open and limits is not None:
        reference, limits = limits[1], None
    assert reference is not None
    name, binds = row.quantity.replace("{at}", run.place.at), row.is_gate(run.method, run.place)
    case.gate(name, value, within=limits, reference=reference, unit=row.unit, method=run.method, binds=binds)


def _together(case: Case, row: TogetherTable, runs: Sequence[CaseRun]) -> None:
    """A row of all these runs, or one for each of their methods; without runs, of the function alone."""
    function = function_of(row.measure)
    if not row.of:
        with case.timed():
            found = function(**row.args)
        _whole(case, row, row.method, found, row.binds != "none")
    elif not row.each:
        _whole(case, row, row.method, function(runs, **row.args), row.binds != "none")
    else:
        for method in dict.fromkeys(run.method for run in runs):
            if row.is_of(method):
                found = function([run for run in runs if run.method == method], **row.args)
                _whole(case, row, method, found, row.is_gate(method))


def _whole(case: Case, row: TogetherTable, method: Method | str, found: Any, binds: bool) -> None:
    value = _scaled(row, found)
    if value is not None:
        assert not isinstance(row.reference, QuantityTable)
        binds = binds and row.within is not None
        limits: dict[str, Any] = {"within": row.within, "reference": row.reference, "unit": row.unit}
        case.gate(row.quantity, value, **limits, method=method, binds=binds)


def _scaled(table: QuantityTable, found: Any) -> float | None:
    value = found if table.key is None or found is None else found[table.key]
    return None if value is None else table.scale * float(value)
