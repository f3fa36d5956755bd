"""A case as data: the tables of its ``case.toml``."""

from __future__ import annotations

import fnmatch
import itertools
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field, Strict

from mpmfw.campaigns.measures import measure_of
from mpmfw.campaigns.tables import validated
from mpmfw.errors import SceneError
from mpmfw.scene.base import Table
from mpmfw.scene.locator import Path as KeyPath
from mpmfw.scene.problem import Problem
from mpmfw.scene.sources import read_source
from mpmfw.units import Number
from mpmfw.validation.case import CLASSICAL, CONTACTS, RECOMMENDED, SHAPES, Method

#: Groups of methods by name, see ``methods.toml``.
_CONTACTS = {"all": CONTACTS, "classical": CLASSICAL, "recommended": tuple(RECOMMENDED["contacts"])}
_SHAPES = {"all": SHAPES, "recommended": tuple(RECOMMENDED["shapes"])}

#: In which version of a case a table counts; both if left out.
When: TypeAlias = Literal["full", "quick"] | None
#: Least and largest value; either may be infinite.
Limits: TypeAlias = Annotated[tuple[float, float], Strict(False)]
#: Patterns of methods as the table shows them, such as ``penalty, cpdi*``.
Patterns: TypeAlias = list[str]


class MethodsTable(Table):
    """Every combination of contacts, shapes and settings: one way each to run a scene.

    Attributes
    ----------
    contact, shape
        Names, or of a group: ``all``, ``recommended``, ``classical``; an empty contact is a scene without.
    settings
        Values by dotted key, under the label that says what they are.
    """

    contact: list[str] | Literal["all", "classical", "recommended"] = "recommended"
    shape: list[str] | Literal["all", "recommended"] = Field(default=["cpdi"])
    settings: dict[str, dict[str, Any]] = Field(default={"": {}})
    when: When = None

    def methods(self) -> Iterator[Method]:
        """The combinations, settings fastest."""
        contacts = _CONTACTS[self.contact] if isinstance(self.contact, str) else self.contact
        shapes = _SHAPES[self.shape] if isinstance(self.shape, str) else self.shape
        for contact, shape, (label, values) in itertools.product(contacts, shapes, self.settings.items()):
            yield Method(contact, shape, values, label)


class PlaceTable(Table):
    """What a method runs beside its own values: another cell size, or another scene.

    Attributes
    ----------
    at
        What it is, for ``{at}`` in the names of quantities.
    scene, set
        In place of the runs' scene, and values by dotted key over those that all share.
    within
        Limits that hold here, by ``key`` of a row.
    open
        Rows that do not keep their limits today, by ``key``, and why: shown beside the limit, they decide nothing.
    """

    at: str = ""
    scene: str | None = None
    set: dict[str, Any] = Field(default={})
    within: dict[str, Limits] = Field(default={})
    open: dict[str, str] = Field(default={})
    when: When = None


class QuantityTable(Table):
    """A number that is read off something.

    Attributes
    ----------
    measure
        Name of a measure of a campaign, such as ``acceleration``, or ``module:function`` of the case or the suite.
    args
        Arguments of it: ``body``, ``pair`` and ``axis`` of a campaign's measure, those of the function behind its first.
    key
        Which one of several that the function returns by name.
    scale
        Factor of it, as 100 for per cent.
    relative
        Whether it is the relative departure from what the scene's own closed form says; of a campaign's measure.
    """

    measure: str
    args: dict[str, Any] = Field(default={})
    key: str | None = None
    scale: Number = 1.0
    relative: bool = False


class RowTable(QuantityTable):
    """One row of the table of results, for each run that it is of.

    Attributes
    ----------
    quantity, unit, reference
        As the table shows them; a reference is a number, words, or a quantity of the run.
    within
        Limits of the value.
    binds
        Whose limits are gates: of ``recommended`` methods, of ``all``, of ``none``, or of methods of these patterns.
    methods, without
        Patterns of the methods whose row it is, all if left out, and of those whose it is not.
    places
        Where it is a row, by ``at``; everywhere if left out.
    """

    quantity: str
    unit: str = ""
    reference: Number | str | QuantityTable = ""
    within: Limits | None = None
    binds: Literal["recommended", "all", "none"] | Patterns = "recommended"
    methods: Patterns = Field(default=["*"])
    without: Patterns = Field(default=[])
    places: list[str] | None = None
    when: When = None

    def is_of(self, method: Method, place: PlaceTable | None = None) -> bool:
        """Whether a method has this row at a place."""
        here = self.places is None or place is None or place.at in self.places
        return here and matches(method, self.methods) and not matches(method, self.without)

    def limits(self, place: PlaceTable | None = None) -> Limits | None:
        """Those of a place, or the row's own."""
        return self.within if place is None else place.within.get(self.key or "", self.within)

    def is_gate(self, method: Method, place: PlaceTable | None = None) -> bool:
        """Whether the suite fails if the value of a method is outside the limits."""
        if self.limits(place) is None or (place is not None and self.key in place.open):
            return False
        named = {"recommended": method.recommended, "all": True, "none": False}
        return named[self.binds] if isinstance(self.binds, str) else matches(method, self.binds)


class RunsTable(Table):
    """A scene with methods at places, and the rows of each run.

    Attributes
    ----------
    name
        By which rows and figures of several runs name them.
    scene
        A file of the case, or the name of a shipped one.
    set, quick
        Values by dotted key that all share, and those that the reduced version sets over them.
    by
        ``module:function`` that takes the scene in place of a run, and returns what its rows are read off.
    """

    name: str = ""
    scene: str = "scene.toml"
    set: dict[str, Any] = Field(default={})
    quick: dict[str, Any] = Field(default={})
    by: str | None = None
    methods: list[MethodsTable] = Field(default=[MethodsTable()])
    places: list[PlaceTable] = Field(default=[PlaceTable()])
    rows: list[RowTable] = Field(default=[])
    when: When = None


class TogetherTable(RowTable):
    """A row of several runs together, or, without them, of none: a function's own computation.

    Attributes
    ----------
    of
        Names of runs, which the function takes as its first argument, a list of ``CaseRun``.
    each
        Whether every method of these runs has such a row, else there is a single one.
    method
        What the single one is said to be of; its limits are a gate unless ``binds`` is ``none``.
    """

    of: list[str] = Field(default=[])
    each: bool = False
    method: str = ""


class FigureTable(Table):
    """A figure: ``draw`` is ``module:function``, which takes the runs of these names, all if left out."""

    name: str = ""
    draw: str
    of: list[str] = Field(default=[])
    when: When = None


class CaseTables(Table):
    """All tables of a case; ``cost`` is the CPU time of the full version [s], by which long cases are started first."""

    cost: Number = 10.0
    runs: list[RunsTable] = Field(default=[])
    rows: list[TogetherTable] = Field(default=[])
    figures: list[FigureTable] = Field(default=[])


def load_case(folder: Path) -> CaseTables:
    """Read and validate ``case.toml``.

    Raises
    ------
    SceneError
        One line for each thing that is wrong: file, line, key, what was expected.
    """
    return validated(CaseTables, read_source(folder / "case.toml", "case", {}), _checks)


def matches(method: Method, patterns: Sequence[str]) -> bool:
    """Whether one of the patterns is of a method."""
    return any(fnmatch.fnmatchcase(str(method), pattern) for pattern in patterns)


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
        keys = {row.key for row in runs.rows}
        for j, place in enumerate(runs.places):
            for key in {*place.within, *place.open} - keys:
                yield Problem(("runs", k, "places", j), f"'{key}' is the key of no row of these runs")
    names = [runs.name for runs in tables.runs if runs.name]
    for k, together in enumerate(tables.rows):
        yield from _of(together.of, names, ("rows", k))
        yield from _together(together, ("rows", k))
    for k, figure in enumerate(tables.figures):
        yield from _of(figure.of, names, ("figures", k))


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
        if name not in known:
            yield Problem((*at, "places"), f"there is no place '{name}'; expected one of {', '.join(known)}")
    if "binds" in row.model_fields_set and all(row.limits(place) is None for place in places):
        yield Problem((*at, "binds"), "has no effect without limits within")


def _patterns(row: RowTable, methods: Iterable[Method], at: KeyPath) -> Iterator[Problem]:
    for key in ("binds", "methods", "without"):
        given = getattr(row, key)
        for pattern in () if isinstance(given, str) else given:
            if not any(matches(method, [pattern]) for method in methods):
                listed = "; ".join(map(str, methods))
                yield Problem((*at, key), f"'{pattern}' is of none of the methods: {listed}")


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
