"""The parts of a case: methods, places, runs, and the rows that its gates record."""

from __future__ import annotations

import fnmatch
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pytest

from mpmfw.campaigns.measures import exact_of, measure_of
from mpmfw.errors import SceneError
from mpmfw.plugin.measure import About
from mpmfw.scene import Scene
from mpmfw.validation.rows import Case, Row, Verdict, limits

__all__ = [
    "CLASSICAL", "CONTACTS", "RECOMMENDED", "SHAPES", "Case", "CaseRun", "Method", "Place", "Row", "RunSet",
    "Runs", "Verdict", "each", "full", "known_red", "methods", "quick", "together",
]  # fmt: skip

#: Classical contact with its defaults and with its best settings.
CLASSICAL = ("bardenhagen", "bardenhagen(criterion=position, normal=master)")
CONTACTS = ("none", *CLASSICAL, "penalty")
SHAPES = ("linear", "gimp", "cpdi", "cpdi2", "bspline")
#: Shape functions that gates bind, with penalty contact or without contact.
RECOMMENDED = ("cpdi", "cpdi2")

#: Tests of the full version alone, and of the reduced one.
full, quick = pytest.mark.full, pytest.mark.quick
#: ``@known_red(method, quantity, reason)``: this gate is known not to hold; the case fails if it holds.
known_red = pytest.mark.known_red
#: ``@together(*runs)`` decorates a test that takes all these runs as ``runs``, a :class:`RunSet`.
together = pytest.mark.together

#: Names of the methods and places of all full versions in this process.
_METHODS: set[str] = set()
_PLACES: set[str] = set()


def _fits(name: str, patterns: Iterable[str], known: Iterable[str]) -> bool:
    """Return whether a pattern fits a name; a ValueError refuses one that fits none of the known names."""
    for pattern in patterns:
        if not fnmatch.filter(known, pattern):  # it is misspelt, and its gate would be lost
            raise ValueError(f"'{pattern}' fits no name of the full version: {', '.join(sorted(known))}")
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


@dataclass(frozen=True)
class Method:
    """One way to run a scene, with values by dotted key and a label; ``when`` is ``full`` or ``quick``."""

    contact: str
    shape: str
    set: Mapping[str, Any] = field(default_factory=dict, hash=False)
    label: str = ""
    bound: bool = field(default=False, compare=False)
    when: str = field(default="", compare=False)

    @property
    def recommended(self) -> bool:
        """Return whether gates bind it: penalty or no contact, CPDI or CPDI2, no other change."""
        usual = self.contact in ("", "penalty") and self.shape in RECOMMENDED and not self.label
        return self.bound or usual

    def matches(self, *patterns: str) -> bool:
        """Return whether a pattern such as ``penalty, cpdi*`` fits its name; it must fit one of all runs."""
        return _fits(str(self), patterns, _METHODS)

    def __str__(self) -> str:
        return ", ".join(filter(None, (self.contact, self.shape, self.label)))


def methods(
    contact: Sequence[str] = ("penalty",),
    shape: Sequence[str] = ("cpdi",),
    settings: Mapping[str, Mapping[str, Any]] | None = None,
    bound: bool = False,
    when: str = "",
) -> list[Method]:
    """Return every combination; ``settings`` are values by dotted key, by the label that names them."""
    labelled = ({"": {}} if settings is None else settings).items()
    product = itertools.product(contact, shape, labelled)
    return [Method(c, s, values, label, bound, when) for c, s, (label, values) in product]


@dataclass(frozen=True)
class Place:
    """One variant of the scene that all methods run, such as a cell size.

    ``open`` gates do not bind here, by key: the reason, or reasons by patterns; ``run`` is the run itself.
    Where ``change``, a function of the scene's mapping, makes another scene of it, gates record no rows."""

    at: str = ""
    set: Mapping[str, Any] = field(default_factory=dict)
    scene: str | Mapping[str, Any] | Callable[..., Any] | None = None
    make: Mapping[str, Any] = field(default_factory=dict)  #: arguments of a scene's function
    within: Mapping[str, tuple[float, float]] = field(default_factory=dict)  #: limits, by ``key`` of a gate
    open: Mapping[str, str | Mapping[str, str]] = field(default_factory=dict)
    when: str = ""
    change: Callable[..., Any] | None = None

    def is_open(self, key: str, method: Method) -> bool:
        """Return whether a method is known to miss the limit of this key here."""
        reason = self.open.get(key, {})
        return isinstance(reason, str) or method.matches(*reason)

    def __str__(self) -> str:
        return ", ".join(filter(None, (self.at, "changed" if self.change is not None else "")))


@dataclass(eq=False)
class Runs:
    """A scene at places, with methods; as a decorator it makes a test of each run.

    ``by`` takes the scene instead of a run. ``binds``: patterns of methods whose failure is red as well."""

    name: str
    scene: str | Callable[..., Any] = "scene.toml"
    methods: Sequence[Method] = field(default_factory=methods)
    places: Sequence[Place] = (Place(),)
    set: Mapping[str, Any] = field(default_factory=dict)
    quick: Mapping[str, Any] = field(default_factory=dict)
    by: Callable[[Scene], Any] | None = None
    binds: Sequence[str] = ()
    when: str = ""
    done: list[CaseRun] = field(default_factory=list)
    started: int = 0

    def __post_init__(self) -> None:
        if self.when == "quick":
            return
        names = [str(method) for method in self.methods if method.when != "quick"]
        _METHODS.update(names)
        _PLACES.update(place.at for place in self.places if place.when != "quick")
        reasons = [reason for place in self.places for reason in place.open.values()]
        for patterns in (self.binds, *(reason for reason in reasons if not isinstance(reason, str))):
            _fits("", patterns, names)

    def __call__(self, function: Callable[..., Any]) -> Any:
        return each(self)(function)

    def points(self) -> Iterator[tuple[Runs, Place, Method]]:
        """Yield these runs with every combination of place and method."""
        return itertools.product([self], self.places, self.methods)

    def scene_at(self, case: Case, place: Place, method: Method) -> Scene:
        """Return the scene of a place, with the method."""
        given = place.scene or self.scene
        values = {**self.set, **(self.quick if case.quick else {}), **place.set}
        made = given(**place.make) if callable(given) else given
        if place.change is not None:
            made, values = place.change(case.scene(made, None, values).to_mapping()), {}
        return case.scene(made, method, values)

    def start(self, case: Case, place: Place, method: Method) -> CaseRun:
        """Run one point; errors are those of :func:`mpmfw.run`."""
        self.started += 1
        scene = self.scene_at(case, place, method)
        if self.by is None:
            results = case.run(scene)
        else:
            with case.timed():
                results = self.by(scene)
        self.done.append(CaseRun(case, self.name, place, method, scene, results))
        return self.done[-1]


def each(*runs: Runs) -> Any:
    """Decorate a test that takes each run of these as ``run``."""
    params = []
    for point in itertools.chain(*(one.points() for one in runs)):
        marks = [getattr(pytest.mark, part.when) for part in point if part.when]
        name = " | ".join(filter(None, (point[0].name, *map(str, point[1:]))))
        params.append(pytest.param(point, id=name, marks=marks))
    return pytest.mark.parametrize("run", params, indirect=True)


@dataclass
class CaseRun:
    """One run: what ran, its results, and the keys of gates that it misses."""

    case: Case
    runs: str
    place: Place
    method: Method
    scene: Scene
    results: Any
    broken: list[str] = field(default_factory=list)
    _measured: dict[str, Any] = field(default_factory=dict)

    def at(self, *patterns: str) -> bool:
        """Return whether a pattern fits the name of its place; it must fit a place of all runs."""
        return _fits(self.place.at, patterns, _PLACES)

    def of(
        self,
        measure: str | Callable[..., Any],
        key: str | None = None,
        scale: float = 1.0,
        relative: bool = False,
        **args: Any,
    ) -> float | None:
        """Return what a function of the results, or a campaign's measure, gives: a number, or None.

        ``key`` takes one of several; ``relative`` is the departure from the closed form."""
        name = f"{measure} {args} {relative}"
        if name not in self._measured:
            found = measure(self.results, **args) if callable(measure) else self._of(measure, relative, args)
            self._measured[name] = found
        return _number(self._measured[name], key, scale)

    def _of(self, name: str, relative: bool, args: Mapping[str, Any]) -> float:
        measure, about = measure_of(name), About(**args)
        measured = measure.of(self.results, self.scene, about)
        exact = exact_of(measure, self.scene, about) if relative else None
        if relative and exact is None:
            raise SceneError(f"scene '{self.scene.name}' has no closed form of {name}")
        value = float(measured.values[0])
        return value if exact is None else value / float(exact.at(measured.time)[0]) - 1.0

    def gate(
        self,
        quantity: str,
        value: float | None,
        *rest: Any,
        key: str = "",
        binds: bool | None = None,
        **named: Any,
    ) -> None:
        """Record a value as :meth:`Case.gate`, which takes the ``rest``, within the limits of its place."""
        if value is None:
            return
        named |= dict(zip(("reference", "tolerance", "unit"), rest, strict=False))
        tolerance = named["tolerance"] = self.place.within.get(key, named.get("tolerance"))
        least, most = limits(tolerance)
        if not least <= value <= most and tolerance is not None:
            self.broken.append(key or quantity)
        if self.place.change is None:
            binds = self.method.recommended if binds is None else binds
            binds = binds and not (key and self.place.is_open(key, self.method))
            self.case.gate(quantity, value, method=self.method, binds=binds, **named)

    def gates(
        self,
        measure: str | Callable[..., Any],
        *rows: tuple[Any, ...],
        binds: bool | None = None,
        **args: Any,
    ) -> None:
        """Record values of a measure: rows of a quantity with ``{at}``, a key, and what a gate takes."""
        for quantity, key, *rest in rows:
            self.gate(quantity.format(at=self.place.at), self.of(measure, key, **args), *rest, binds=binds)


class RunSet(list[CaseRun]):
    """Runs that are judged together."""

    def of(
        self, measure: Callable[..., Any], key: str | None = None, scale: float = 1.0, **args: Any
    ) -> float | None:
        """Return what a function of all these runs gives: a number, or None."""
        return _number(measure(self, **args), key, scale)

    def by_method(self, *patterns: str) -> Iterator[tuple[Method, RunSet]]:
        """Yield each method whose name a pattern fits, all without patterns, with its runs."""
        for method in dict.fromkeys(run.method for run in self):
            if not patterns or method.matches(*patterns):
                yield method, RunSet(run for run in self if run.method == method)

    def only(self, *patterns: str) -> RunSet:
        """Return the runs of methods whose names a pattern fits."""
        return RunSet(run for run in self if run.method.matches(*patterns))


def _number(found: Any, key: str | None, scale: float) -> float | None:
    value = found[key] if isinstance(found, Mapping) and key is not None else found
    return None if value is None else scale * float(value)
