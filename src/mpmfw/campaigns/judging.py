"""The error of every run of a campaign: against a closed form, a reference, or the finest run."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd
import xarray as xr
from pydantic import Field

from mpmfw.campaigns.grid import Index, RunGrid
from mpmfw.campaigns.keys import as_number, finer
from mpmfw.campaigns.measures import exact_of, inferred, known_axis, measure_of
from mpmfw.errors import ResultsWarning, SceneError
from mpmfw.plugin.measure import About, Exact, Measure, Measured
from mpmfw.results.analysis import relative_l2
from mpmfw.scene import Scene
from mpmfw.scene.base import Axis, Table
from mpmfw.state.fields import FloatArray
from mpmfw.units import Number

#: Share of a motion below which its part along an axis counts as nothing.
NEAR_ZERO = 1e-3

#: Complete results of a combination; None where there are none.
Results = Callable[[Index], xr.DataTree | None]

#: An error about a key of the table ``error``, by its path.
At = Callable[[tuple[str, ...], str], SceneError]


class ErrorTable(Table):
    """The quantity whose error is measured, and its reference: closed form, value, file or finest run."""

    quantity: str  #: name of a measure, see :data:`mpmfw.campaigns.measures.MEASURES`
    kind: Literal["closed-form", "reference", "finest"] = "closed-form"
    body: str | None = None  #: body that is measured; by default, as for pair and axis, the motion decides
    pair: str | None = None
    axis: Axis | None = None
    #: of the difference of two curves or fields; if left out, the measure decides
    norm: Literal["largest", "l2"] | None = None
    file: str | None = None  #: CSV file with a column ``time`` [s] and one of the quantity [SI]
    column: str | None = None  #: name of the latter, where there are several
    value: Number | None = None  #: the quantity itself, where it is a number
    #: labels that choose the finest run; a dimension of numbers takes its finest, one of names its own
    finest: dict[str, Any] = Field(default={})


@dataclass(frozen=True)
class Judgement:
    """The outcome of judging one run."""

    error: float = np.nan  #: relative, not negative; NaN where it is not known
    value: float = np.nan  #: of a number, in its unit; NaN for curves and fields
    expected: float = np.nan  #: as ``value``


class Judge:
    """Measures errors of runs; ``at`` makes an error about a key, ``beside`` the path of a named file."""

    def __init__(
        self,
        error: ErrorTable,
        grid: RunGrid,
        at: At | None = None,
        beside: Callable[[Any], Any] = lambda file: file,
    ) -> None:
        self.at = at or (lambda path, message: SceneError(f"{'.'.join(path)}: {message}"))
        self.beside, self.grid, self.table = beside, grid, error
        self.measure: Measure = measure_of(error.quantity)
        self.about = About(error.body, error.pair, error.axis)
        self.norm = error.norm or self.measure.norm
        for key in ("body", "pair", "axis"):
            if getattr(self.about, key) is not None and key not in self.measure.keys:
                taken = " and ".join(self.measure.keys) or "none of body, pair and axis"
                raise self.at(("error", key), f"has no effect: {self.measure.name} takes {taken}")
        scenes = grid.runnable
        for scene in scenes.values():
            check_names(self.about, scene, self.at)
        self._file = None if error.file is None else _read_reference(error, self.at, beside)
        self._declared = self.is_exact and error.value is None and error.file is None
        if self._declared and scenes:
            self.about = known_axis(self.measure, next(iter(scenes.values())), self.about)
        self.exact = {index: self._exact(scene) for index, scene in scenes.items() if self.is_exact}

    @property
    def is_exact(self) -> bool:
        """Return True if errors are against a closed form or a reference, not against other runs."""
        return self.table.kind != "finest"

    def _exact(self, scene: Scene) -> Exact:
        error = self.table
        if error.value is not None:
            value = float(error.value)
            return Exact("reference", f"{value:g} {self.measure.unit}", lambda _: np.array([value]))
        if self._file is not None:
            return self._file
        known = exact_of(self.measure, scene, self.about)
        if known is not None and known.kind == error.kind:
            return known
        what = "closed form" if error.kind == "closed-form" else "reference"
        others = [f"kind = '{known.kind}'"] if known is not None else []
        if self.measure.kind != "field":
            given_by = "a file" if self.measure.kind == "curve" else "a value"
            others += ["kind = 'finest'", f"{given_by} with kind = 'reference'"]
        text = f"the scene '{scene.name}' has no {what} for {self.says()}"
        raise self.at(("error", "kind"), f"{text}; expected {' or '.join(others) or 'another quantity'}")

    def describe(self) -> str:
        """Return in words what errors are against."""
        if self.table.kind == "finest":
            return "the finest run of the study, interpolated in time"
        return "; ".join(dict.fromkeys(exact.says for exact in self.exact.values()))

    def says(self) -> str:
        """Return the quantity in words."""
        return said(self.measure.name, self.about)

    def measured(self, results: Results) -> dict[Index, Measured]:
        """Measure all complete runs; raise a SceneError if the quantity is negligible."""
        for index, scene in self.grid.runnable.items():
            if (tree := results(index)) is not None:
                if not self._declared:  # a closed form says itself what it is of
                    self.about = inferred(self.measure, tree, scene, self.about)
                self._check_size(tree, scene)
                break
        return measured(self.measure, self.grid, results, self.about)

    def _check_size(self, run: xr.DataTree, scene: Scene) -> None:
        """Refuse a component that is negligible beside another one."""
        if "axis" not in self.measure.keys:
            return
        sizes = {
            axis: float(np.nanmax(np.abs(self.measure.of(run, scene, replace(self.about, axis=axis)).values)))
            for axis in "xyz"[: scene.dim]
        }
        largest = max(sizes, key=sizes.__getitem__)
        if sizes[self.about.axis or "x"] < NEAR_ZERO * sizes[largest]:
            text = f"{self.says()} is negligible beside that along {largest}; expected '{largest}'"
            raise self.at(("error", "axis"), text)

    def judge(self, results: Results) -> dict[Index, Judgement]:
        """Return the errors of all runs with complete results."""
        found = self.measured(results)
        judged = dict.fromkeys(self.grid.combinations, Judgement())
        for index, one in found.items():
            if self.table.kind == "finest":
                other = self.finest(index)
                if other in found and other != index:
                    judged[index] = self.compare(one, interpolated(found[other], one))
            else:
                judged[index] = self.compare(one, self.exact[index].at(one.time))
        return judged

    def finest(self, index: Index) -> Index:
        """Return the finest run of the same problem."""
        chosen = list(index)
        for k, (dim, labels) in enumerate(self.grid.coords.items()):
            key = self.grid.keys.get(dim, dim)
            numbers = [as_number(label) for label in labels]
            if dim in self.grid.problem_dims:
                continue
            if key in self.table.finest:
                target = self.table.finest[key]
                if target not in labels:
                    message = f"{target!r} is not varied; expected one of {', '.join(map(str, labels))}"
                    raise self.at(("error", "finest", key), message)
                chosen[k] = labels.index(target)
            elif finer(key) and all(number is not None for number in numbers):
                chosen[k] = int(np.argmax(finer(key) * np.array(numbers, dtype=float)))
        return tuple(chosen)

    def compare(self, measured: Measured, expected: FloatArray) -> Judgement:
        """Return the error of one run at its times."""
        values = measured.values
        if not np.isfinite(values).all() or not np.isfinite(expected).all() or not values.size:
            return Judgement()
        if self.measure.kind == "number":
            value, exact = float(values[0]), float(expected[0])
            error = abs(value - exact) / abs(exact) if exact else np.nan
            return Judgement(error, value, exact)
        target = np.broadcast_to(expected, values.shape)
        if self.norm == "largest":
            return Judgement(float(np.max(np.abs(values - target)) / np.max(np.abs(target))))
        if self.measure.kind == "curve":
            return Judgement(relative_l2(measured.time, values, target))
        return Judgement(float(np.sqrt(np.mean((values - target) ** 2) / np.mean(target**2))))


def measured(
    measure: Measure, grid: RunGrid, results: Results, about: About | None = None
) -> dict[Index, Measured]:
    """Measure all complete runs; without ``about`` the first one decides the body, pair and axis."""
    found: dict[Index, Measured] = {}
    for index, scene in grid.runnable.items():
        if (tree := results(index)) is not None:
            about = inferred(measure, tree, scene, About()) if about is None else about
            found[index] = measure.of(tree, scene, about)
    return found


def check_names(about: About, scene: Scene, at: At) -> None:
    """Refuse a body, a pair or an axis that a scene lacks."""
    pairs = [f"{a}-{b}" for a, b, _ in scene.pairs]
    valid = {"body": list(scene.bodies), "pair": pairs, "axis": list("xyz"[: scene.dim])}
    for key, names in valid.items():
        given = getattr(about, key)
        if given is not None and given not in names:
            expected = f"expected one of {', '.join(names) or 'none'}"
            raise at(("error", key), f"'{given}' is no {key} of the scene; {expected}")


def said(measure: str, about: About) -> str:
    """Return a measure in words: ``end-displacement of block along x``."""
    of = {"body": " of ", "pair": " of ", "axis": " along "}
    parts = (f"{of[key]}{getattr(about, key)}" for key in of if getattr(about, key) is not None)
    return measure + "".join(parts)


def interpolated(reference: Measured, at: Measured) -> FloatArray:
    """Return the reference's values at another run's times; a number is unchanged."""
    return _within(at.time, reference.time, reference.values) if reference.time.size else reference.values


def judge_all(
    grid: RunGrid, measures: tuple[str, ...], reference: Mapping[str, Any] | None
) -> list[tuple[Measure, Judge | None]]:
    """Return the measures, each with its judge, if there is one."""
    judges: list[tuple[Measure, Judge | None]] = []
    for name in measures:
        given, measure = reference, measure_of(name)
        if given is None:
            try:
                known = [exact_of(measure, scene, About()) for scene in grid.runnable.values()]
            except SceneError as error:
                warnings.warn(f"no error of {name} is measured: {error}", ResultsWarning, stacklevel=4)
                known = [None]
            first = known[0] if known and None not in known else None
            given = None if first is None else {"kind": first.kind}
        table = None if given is None else ErrorTable.model_validate({"quantity": name, **given})
        judges.append((measure, None if table is None else Judge(table, grid)))
    return judges


def _read_reference(error: ErrorTable, at: At, beside: Callable[[Any], Any]) -> Exact:
    path = Path(beside(error.file))
    try:
        with warnings.catch_warnings(action="error"):  # of rows with more columns than the header
            table = pd.read_csv(path, comment="#", skipinitialspace=True, index_col=False)
        table = table.apply(pd.to_numeric, errors="coerce")
    except (OSError, ValueError, Warning) as problem:
        text = f"{error.file}: cannot be read as CSV: {str(problem).strip()}"
        raise at(("error", "file"), text) from problem
    table.columns = table.columns.str.strip()
    columns = [str(name) for name in table]
    others = [name for name in columns if name != "time"]
    column = error.column or (others[0] if len(others) == 1 else None)
    if "time" not in columns or column not in others:
        target = f"'{error.column}'" if error.column else "one other (or name it by error.column)"
        known = f"{error.file} has the columns {', '.join(columns) or 'none'}"
        raise at(("error", "column" if error.column else "file"), f"{known}; expected 'time' and {target}")
    time, values = table["time"].to_numpy(), table[column].to_numpy()
    if len(time) < 2 or not np.all(np.diff(time) > 0.0) or not np.isfinite(values).all():
        raise at(("error", "file"), f"{error.file}: expected rising times, and a number in every row")

    return Exact("reference", f"{error.file}, column {column}", lambda when: _within(when, time, values))


def _within(at: FloatArray, time: FloatArray, values: FloatArray) -> FloatArray:
    slack = 1e-9 * (time[-1] - time[0])
    inside = (at >= time[0] - slack) & (at <= time[-1] + slack)
    return np.where(inside, np.interp(at, time, values), np.nan)
