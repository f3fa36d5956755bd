"""A case as data: the tables of its ``case.toml``."""

from __future__ import annotations

import fnmatch
import itertools
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field, Strict, field_validator

from mpmfw.scene.base import Table
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
    binds
        Whether gates are for them as for the recommended method.
    """

    contact: list[str] | Literal["all", "classical", "recommended"] = "recommended"
    shape: list[str] | Literal["all", "recommended"] = Field(default=["cpdi"])
    settings: dict[str, dict[str, Any]] = Field(default={"": {}})
    binds: bool = False
    when: When = None

    def methods(self) -> Iterator[Method]:
        """The combinations, settings fastest."""
        contacts = _CONTACTS[self.contact] if isinstance(self.contact, str) else self.contact
        shapes = _SHAPES[self.shape] if isinstance(self.shape, str) else self.shape
        for contact, shape, (label, values) in itertools.product(contacts, shapes, self.settings.items()):
            yield Method(contact, shape, values, label, self.binds)


class PlaceTable(Table):
    """What a method runs beside its own values: another cell size, or another scene.

    Attributes
    ----------
    at
        What it is, for ``{at}`` in the names of quantities.
    scene, set
        In place of the runs' scene, and values by dotted key over those that all share.
    make
        Arguments of the scene where that is a function, ``module:function``, which returns it as nested mappings.
    vary
        Arguments of which every combination is a place; ``at`` has their values as ``{name}``.
    within
        Limits that hold here, by ``key`` of a row.
    open
        Rows that do not keep their limits today, by ``key``, and why: they are no gates. ``run`` is
        the run itself. The reason is every method's, or those are by patterns of the methods.
    """

    at: str = ""
    scene: str | None = None
    set: dict[str, Any] = Field(default={})
    make: dict[str, Any] = Field(default={})
    vary: dict[str, list[Number]] = Field(default={})
    within: dict[str, Limits] = Field(default={})
    open: dict[str, str | dict[str, str]] = Field(default={})
    when: When = None

    def is_open(self, key: str, method: Method) -> bool:
        """Whether it is known that a method does not keep its limit of this key here."""
        why = self.open.get(key, {})
        return isinstance(why, str) or matches(method, [*why])

    def places(self) -> Iterator[PlaceTable]:
        """One for every combination of what varies."""
        for values in itertools.product(*self.vary.values()):
            whole = (int(value) if value.is_integer() else value for value in map(float, values))
            given = dict(zip(self.vary, whole, strict=True))
            at = self.at
            for name, value in given.items():
                at = at.replace(f"{{{name}}}", f"{value:g}")
            yield self.model_copy(update={"at": at, "make": {**self.make, **given}, "vary": {}})


class VersionTable(Table):
    """The scene of every place once more, changed. Such a run has no rows of its own: rows of several runs and figures take it.

    Attributes
    ----------
    at
        What it is.
    change, args
        ``module:function`` that takes the scene as nested mappings, and these arguments, and returns the changed one; the
        scene as it is, if left out.
    """

    at: str = ""
    change: str | None = None
    args: dict[str, Any] = Field(default={})
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
        Which one of several that the function returns by name; of a single number, the name by which places have limits of it.
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
        Where it is a row, by patterns of ``at``; everywhere if left out.
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
        here = self.places is None or place is None or _is_one(place.at, self.places)
        return here and matches(method, self.methods) and not matches(method, self.without)

    def limits(self, place: PlaceTable | None = None) -> Limits | None:
        """Limits of a place, or the row's own."""
        return self.within if place is None else place.within.get(self.key or "", self.within)

    def is_gate(self, method: Method, place: PlaceTable | None = None) -> bool:
        """Whether the suite fails if the value of a method is outside the limits."""
        if self.limits(place) is None or (
            place is not None and self.key is not None and place.is_open(self.key, method)
        ):
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
        A file of the case, the name of a shipped one, or a function that makes it from what a place has as ``make``.
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
    versions: list[VersionTable] = Field(default=[VersionTable()])
    rows: list[RowTable] = Field(default=[])
    when: When = None

    @field_validator("places")
    @classmethod
    def _varied(cls, places: list[PlaceTable]) -> list[PlaceTable]:
        return [one for place in places for one in place.places()]


class TogetherTable(RowTable):
    """A row of several runs together, or, without them, of none: a function's own computation.

    Attributes
    ----------
    of
        Names of runs, which the function takes as its first argument, a list of ``CaseRun``.
    each
        Whether every method of these runs has such a row, or every method at every ``place``, with its limits and what is open
        there; else there is a single one.
    method
        What the single one is said to be of; its limits are a gate unless ``binds`` is ``none``.
    """

    of: list[str] = Field(default=[])
    each: bool | Literal["place"] = False
    method: str = ""


class FigureTable(Table):
    """A figure: ``draw`` is ``module:function``, which takes the runs of these names and methods, all if left out."""

    name: str = ""
    draw: str
    of: list[str] = Field(default=[])
    methods: Patterns = Field(default=[])
    when: When = None


class CaseTables(Table):
    """All tables of a case.

    Attributes
    ----------
    like
        A file of such tables beside the case's folder or in it: what the case does not say is as it says.
    cost
        CPU time of the full version [s], by which long cases are started first.
    """

    like: str = ""
    cost: Number = 10.0
    runs: list[RunsTable] = Field(default=[])
    rows: list[TogetherTable] = Field(default=[])
    figures: list[FigureTable] = Field(default=[])


def matches(method: Method, patterns: Sequence[str]) -> bool:
    """Whether one of the patterns is of a method."""
    return any(fnmatch.fnmatchcase(str(method), pattern) for pattern in patterns)


def _is_one(name: str, patterns: Sequence[str]) -> bool:
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)
