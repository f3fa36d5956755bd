"""The error of every run of a study: against a closed form, a reference, or the finest run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.analysis import relative_l2
from mpmfw.fields import FloatArray
from mpmfw.scene import Scene
from mpmfw.studies.exact import Exact
from mpmfw.studies.grid import Grid, Index
from mpmfw.studies.keys import as_number, finer
from mpmfw.studies.loading import Study
from mpmfw.studies.measures import MEASURES, About, Measure, Measured

#: Results of a combination; None where there are none.
Results = Callable[[Index], xr.DataTree | None]


@dataclass(frozen=True)
class Judgement:
    """What came of judging one run.

    Attributes
    ----------
    error
        Relative, not negative; NaN where it is not known.
    value, expected
        Of a number, in its unit; NaN for curves and fields.
    """

    error: float = np.nan
    value: float = np.nan
    expected: float = np.nan


class Judge:
    """Judges the runs of a study.

    Parameters
    ----------
    study, grid
        What was asked for.

    Raises
    ------
    SceneError
        A scene has no closed form or reference of the quantity, or the file of the reference is wrong.
    """

    def __init__(self, study: Study, grid: Grid) -> None:
        error = study.tables.error
        self.study, self.grid, self.table = study, grid, error
        self.measure: Measure = MEASURES[error.quantity]
        self.about = About(error.body, error.pair, error.axis)
        self.norm = error.norm or self.measure.norm
        self._check_names()
        self._file = None if error.file is None else _read_reference(study)
        self.exact: dict[Index, Exact] = {}
        if error.kind != "finest":
            for index, one in grid.combinations.items():
                if one.scene is not None:
                    self.exact[index] = self._exact(one.scene)

    def _check_names(self) -> None:
        for scene in self.grid.scenes.values():
            bodies, pairs = list(scene.bodies), [f"{a}-{b}" for a, b, _ in scene.pairs]
            for key, given, known in (("body", self.about.body, bodies), ("pair", self.about.pair, pairs)):
                if given is not None and given not in known:
                    message = (
                        f"'{given}' is no {key} of the scene; expected one of {', '.join(known) or 'none'}"
                    )
                    raise self.study.at(("error", key), message)
            if self.about.axis not in "xyz"[: scene.dim]:
                message = f"'{self.about.axis}' is no axis of the scene, which has {scene.dim} dimensions"
                raise self.study.at(("error", "axis"), message)

    def _exact(self, scene: Scene) -> Exact:
        error = self.table
        if error.value is not None:
            value = float(error.value)
            return Exact("reference", f"{value:g} {self.measure.unit}", lambda _: np.array([value]))
        if self._file is not None:
            return self._file
        known = self.measure.exact(scene, self.about)
        if known is not None and known.kind == error.kind:
            return known
        if known is None:
            self._check_about(scene)
        others = [f"kind = '{known.kind}'"] if known is not None else []
        others += ["kind = 'finest'"] if self.measure.kind != "field" else []
        given = {"curve": ["a file with kind = 'reference'"], "number": ["a value with kind = 'reference'"]}
        others += given.get(self.measure.kind, [])
        what = "closed form" if error.kind == "closed-form" else "reference of its own"
        raise self.study.at(
            ("error", "kind"),
            f"the scene '{scene.name}' has no {what} for {error.quantity}; expected "
            f"{' or '.join(others) or 'another quantity'}",
        )

    def _check_about(self, scene: Scene) -> None:
        """Name the keys that the scene has no closed form or reference for, where it has one without them."""
        error, plain = self.table, About()
        without = self.measure.exact(scene, plain)
        if without is None or without.kind != error.kind:
            return
        given = [key for key in self.measure.keys if getattr(self.about, key) != getattr(plain, key)]
        alone = {key: replace(self.about, **{key: getattr(plain, key)}) for key in given}
        guilty = [
            key for key, about in alone.items() if self.measure.exact(scene, about) is not None
        ] or given
        said = " and ".join(f"{key} = '{getattr(self.about, key)}'" for key in guilty)
        what = "closed form" if error.kind == "closed-form" else "reference"
        raise self.study.at(
            ("error", guilty[0]),
            f"the scene '{scene.name}' has a {what} of {error.quantity}, but none for {said}; leave "
            f"{' and '.join(guilty)} out, or take kind = 'finest'",
        )

    def describe(self) -> str:
        """What errors are against, in words; several scenes have several."""
        if self.table.kind == "finest":
            return "the finest run of the study, interpolated in time"
        return "; ".join(dict.fromkeys(exact.says for exact in self.exact.values()))

    def judge(self, results: Results, succeeded: Mapping[Index, bool]) -> dict[Index, Judgement]:
        """Errors of all runs that went through; NaN for the others, and for a run that is the reference."""
        found: dict[Index, Measured] = {}
        for index, one in self.grid.combinations.items():
            tree = results(index) if succeeded.get(index) else None
            if tree is not None and one.scene is not None:
                found[index] = self.measure.of(tree, one.scene, self.about)
        judged = dict.fromkeys(self.grid.combinations, Judgement())
        for index, measured in found.items():
            if self.table.kind == "finest":
                other = self.finest(index)
                if other in found and other != index:
                    judged[index] = self._compare(measured, _interpolated(found[other], measured))
            else:
                judged[index] = self._compare(measured, self.exact[index].at(measured.time))
        return judged

    def finest(self, index: Index) -> Index:
        """The run that another one is compared with: the same problem, on the finest discretisation."""
        chosen = list(index)
        for k, (dim, labels) in enumerate(self.grid.coords.items()):
            key = self.grid.keys.get(dim, dim)
            numbers = [as_number(label) for label in labels]
            if dim in self.grid.problem_dims:
                continue
            if key in self.table.finest:
                chosen[k] = self._label_index(key, labels)
            elif finer(key) and all(number is not None for number in numbers):
                chosen[k] = int(np.argmax(finer(key) * np.array(numbers, dtype=float)))
        return tuple(chosen)

    def _label_index(self, key: str, labels: list[Any]) -> int:
        wanted = self.table.finest[key]
        if wanted not in labels:
            message = f"{wanted!r} is not varied; expected one of {', '.join(map(str, labels))}"
            raise self.study.at(("error", "finest", key), message)
        return labels.index(wanted)

    def _compare(self, measured: Measured, expected: FloatArray) -> Judgement:
        values = measured.values
        if not np.isfinite(values).all() or not np.isfinite(expected).all() or not values.size:
            return Judgement()
        if self.measure.kind == "number":
            value, exact = float(values[0]), float(expected[0])
            error = abs(value - exact) / abs(exact) if exact else np.nan
            return Judgement(error, value, exact)
        wanted = np.broadcast_to(expected, values.shape)
        if self.norm == "largest":
            return Judgement(float(np.max(np.abs(values - wanted)) / np.max(np.abs(wanted))))
        if self.measure.kind == "curve":
            return Judgement(relative_l2(measured.time, values, wanted))
        return Judgement(float(np.sqrt(np.mean((values - wanted) ** 2) / np.mean(wanted**2))))


def _interpolated(reference: Measured, at: Measured) -> FloatArray:
    """The reference's values at another run's times; a number as it is."""
    if not reference.time.size:
        return reference.values
    return _within(at.time, reference.time, reference.values)


def _read_reference(study: Study) -> Exact:
    """A CSV file as what a curve must be.

    Raises
    ------
    SceneError
        The file is not there or has not the columns.
    """
    error = study.tables.error
    path = Path(study.beside(error.file))
    try:
        # NumPy takes the columns' names from the first line even if that is a comment
        lines = [line for line in path.read_text("utf-8").splitlines() if line.strip() and line[0] != "#"]
        table: Any = np.genfromtxt(lines, delimiter=",", names=True)
    except (OSError, ValueError) as problem:
        raise study.at(("error", "file"), f"{error.file}: cannot be read as CSV: {problem}") from problem
    columns = list(table.dtype.names or ())
    others = [name for name in columns if name != "time"]
    column = error.column or (others[0] if len(others) == 1 else None)
    if "time" not in columns or column not in others:
        wanted = f"'{error.column}'" if error.column else "one other (or error.column, which says which)"
        raise study.at(
            ("error", "column" if error.column else "file"),
            f"{error.file} has the columns {', '.join(columns) or 'none'}; expected 'time' and {wanted}",
        )
    time, values = np.atleast_1d(table["time"]), np.atleast_1d(table[column])
    if len(time) < 2 or not np.all(np.diff(time) > 0.0) or not np.isfinite(values).all():
        raise study.at(("error", "file"), f"{error.file}: expected rising times, and a number in every row")

    return Exact("reference", f"{error.file}, column {column}", lambda when: _within(when, time, values))


def _within(at: FloatArray, time: FloatArray, values: FloatArray) -> FloatArray:
    """A curve at other times; NaN before its start and after its end, round-off apart."""
    slack = 1e-9 * (time[-1] - time[0])
    inside = (at >= time[0] - slack) & (at <= time[-1] + slack)
    return np.where(inside, np.interp(at, time, values), np.nan)
