"""The parts of a case: methods, places, runs, and the rows that its gates record."""

from __future__ import annotations

import contextlib
import fnmatch
import itertools
import json
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, nan
from pathlib import Path
from typing import Any

import pytest

from mpmfw.errors import ResultsWarning
from mpmfw.plots import write_figure
from mpmfw.results.replacing import replace_bytes
from mpmfw.runs.run import run as run_scene
from mpmfw.scene import Scene, load_scene

__all__ = [
    "CLASSICAL", "CONTACTS", "RECOMMENDED", "SHAPES", "Case", "CaseRun", "Method", "Place", "Runs",
    "by_method", "each", "full", "known_red", "methods", "quick", "together",
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
#: ``@together(*runs)`` decorates a test that takes all these runs as ``runs``, a list.
together = pytest.mark.together

Values = Mapping[str, Any]
#: Names of the methods and places of the full version of the case.
NAMES: set[str] = set()


def _fits(name: str, patterns: Sequence[str]) -> bool:
    """Return whether a pattern fits a name; a ValueError refuses one that fits none of the case."""
    for pattern in patterns:
        if not fnmatch.filter(NAMES, pattern):  # it is misspelt, and its gate would be lost
            raise ValueError(f"'{pattern}' fits no name of the full version: {', '.join(sorted(NAMES))}")
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


@dataclass(frozen=True)
class Method:
    """One way to run a scene, with values by dotted key and a label; ``when`` is ``full`` or ``quick``."""

    contact: str
    shape: str
    set: Values = field(default_factory=dict, hash=False)
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
        return _fits(str(self), patterns)

    def __str__(self) -> str:
        return ", ".join(filter(None, (self.contact, self.shape, self.label)))


def methods(
    contact: Sequence[str] = ("penalty",), shape: Sequence[str] = ("cpdi",),
    settings: Mapping[str, Values] = {"": {}}, bound: bool = False, when: str = "",
) -> list[Method]:  # fmt: skip
    """Return every combination; ``settings`` are values by dotted key, by the label that names them."""
    product = itertools.product(contact, shape, settings.items())
    return [Method(c, s, values, label, bound, when) for c, s, (label, values) in product]


@dataclass(frozen=True)
class Place:
    """One variant of the scene that all methods run, such as a cell size; ``make``: arguments of a function.

    ``within`` has limits by ``key`` of a gate; ``open`` gates that do not bind here, and ``run``, the run
    itself: the reason, or reasons by patterns of methods."""

    at: str = ""
    set: Values = field(default_factory=dict)
    make: Values = field(default_factory=dict)
    within: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    open: Mapping[str, str | Mapping[str, str]] = field(default_factory=dict)
    when: str = ""

    def is_open(self, key: str, method: Method) -> bool:
        """Return whether a method is known to miss the limit of this key here."""
        reason = self.open.get(key, {})
        return isinstance(reason, str) or method.matches(*reason)


@dataclass(eq=False)
class Runs:
    """A scene, of the case, shipped or a function, at places, with methods; it decorates a test of each run.

    ``by`` takes the scene. ``binds``: patterns of methods whose failure is red as well."""

    name: str
    scene: str | Callable[..., Any] = "scene.toml"
    methods: Sequence[Method] = field(default_factory=methods)
    places: Sequence[Place] = (Place(),)
    set: Values = field(default_factory=dict)
    quick: Values = field(default_factory=dict)
    by: Callable[[Scene], Any] = run_scene
    binds: Sequence[str] = ()
    when: str = ""
    done: list[CaseRun] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.when != "quick":
            NAMES.update(str(method) for method in self.methods if method.when != "quick")
            NAMES.update(place.at for place in self.places if place.when != "quick")
            self.bound(Method("", ""))

    def __call__(self, function: Callable[..., Any]) -> Any:
        return each(self)(function)

    def points(self) -> Iterator[tuple[Runs, Place, Method]]:
        """Yield these runs with every combination of place and method."""
        return itertools.product([self], self.places, self.methods)

    def scene_at(self, case: Case, place: Place, method: Method) -> Scene:
        """Return the scene of a place, with the method."""
        given = self.scene(**place.make) if callable(self.scene) else self.scene
        return case.scene(given, method, {**self.set, **(self.quick if case.quick else {}), **place.set})

    def bound(self, method: Method) -> bool:
        """Return whether the failure of a method's run is red."""
        return method.recommended or method.matches(*self.binds)

    def start(self, case: Case, place: Place, method: Method) -> CaseRun:
        """Run one point; errors are those of :func:`mpmfw.run`."""
        scene = self.scene_at(case, place, method)
        self.done.append(CaseRun(case, self.name, place, method, scene, case.run(scene, self.by)))
        return self.done[-1]


def each(*runs: Runs) -> Any:
    """Decorate a test that takes each run of these as ``run``."""
    params = []
    for point in itertools.chain(*(one.points() for one in runs)):
        marks = [getattr(pytest.mark, part.when) for part in point if part.when]
        name = " | ".join(filter(None, (point[0].name, point[1].at, str(point[2]))))
        params.append(pytest.param(point, id=name, marks=marks))
    return pytest.mark.parametrize("run", params, indirect=True)


@dataclass
class CaseRun:
    """One run: what ran, and its results."""

    case: Case
    runs: str
    place: Place
    method: Method
    scene: Scene
    results: Any
    _measured: dict[str, Any] = field(default_factory=dict)

    def at(self, *patterns: str) -> bool:
        """Return whether a pattern fits the name of its place; it must fit a place of all runs."""
        return _fits(self.place.at, patterns)

    def of(self, measure: Callable[..., Any], key: str | None = None, scale: float = 1.0, **args: Any) -> Any:
        """Return what a function of the results gives: a number, or None; ``key`` takes one of several."""
        name = f"{measure} {args}"
        if name not in self._measured:
            self._measured[name] = measure(self.results, **args)
        found = self._measured[name]
        value = found[key] if isinstance(found, Mapping) and key is not None else found
        return None if value is None else scale * float(value)

    def gate(
        self, quantity: str, value: Any, reference: Any = "", tolerance: Any = None, unit: str = "",
        *, key: str = "", binds: bool | None = None,
    ) -> None:  # fmt: skip
        """Record a value as :meth:`Case.gate`, within the limits that its place has for the ``key``."""
        binds = self.method.recommended if binds is None else binds
        binds = binds and not (key and self.place.is_open(key, self.method))
        within = self.place.within.get(key, tolerance)
        self.case.gate(quantity, value, reference, within, unit, self.method, binds)

    def gates(
        self, measure: Callable[..., Any], *rows: tuple[Any, ...], binds: bool | None = None, **args: Any
    ) -> None:
        """Record values of a measure: rows of a quantity with ``{at}``, a key, and what a gate takes."""
        for quantity, key, *rest in rows:
            self.gate(quantity.format(at=self.place.at), self.of(measure, key, **args), *rest, binds=binds)


def by_method(runs: Sequence[CaseRun], *patterns: str) -> Iterator[tuple[Method, list[CaseRun]]]:
    """Yield each method whose name a pattern fits, all without patterns, with its runs."""
    for method in dict.fromkeys(run.method for run in runs):
        if not patterns or method.matches(*patterns):
            yield method, [run for run in runs if run.method == method]


@dataclass
class Case:
    """A case while it is checked: folder, version, file of its rows, and rows.

    ``known``: why gates of the test that runs are known not to hold, by method and quantity; ``names``: of
    the methods and places of the full version."""

    folder: Path
    quick: bool = False
    file: Path | None = None
    rows: list[dict[str, Any]] = field(default_factory=list)
    known: Mapping[Any, str] = field(default_factory=dict)
    names: set[str] = field(default_factory=set)
    _seconds: float = nan

    def scene(self, given: Any, method: Method, values: Values) -> Scene:
        """Return a file of the case, a shipped scene or a mapping as a scene, with values and method."""
        if isinstance(given, str) and (self.folder / given).exists():
            given = str(self.folder / given)
        chosen = {"contact.method": method.contact, "shape.method": method.shape}
        chosen = {key: name for key, name in chosen.items() if name}
        return load_scene(given, set={**chosen, **values, **method.set})

    def run(self, scene: Scene, by: Callable[[Scene], Any] = run_scene) -> Any:
        """Run a scene; settling that ends with a warning is in the rows."""
        with warnings.catch_warnings(), self.timed():
            warnings.simplefilter("ignore", ResultsWarning)
            results = by(scene)
        attrs = getattr(results, "attrs", {})
        if "cpu_time" in attrs:  # without compilation
            self._seconds = float(attrs["cpu_time"]) + float(attrs.get("settle_time", 0.0))
        return results

    def gate(
        self, quantity: str, value: Any, reference: Any = "", tolerance: Any = None, unit: str = "",
        method: Any = "", binds: bool | None = None, note: str = "",
    ) -> None:  # fmt: skip
        """Record a value beside its reference, None not; ``tolerance`` is t for ± t, or least and largest.

        If it ``binds``, by default of recommended methods, the suite fails where the value is outside. The
        verdict is ``holds``, ``RED`` or ``known red`` of a gate, else ``within``, ``outside``, ``shown``
        without limits, or ``failed``, of a run that did, for the reason in ``note``."""
        if value is None:
            return
        binds = (isinstance(method, str) or method.recommended) if binds is None else binds
        limits = (-inf, inf) if tolerance is None else tolerance
        least, most = limits if isinstance(limits, tuple) else (-limits, limits)
        inside, reason = least <= value <= most, self.known.get((str(method), quantity), "")  # NaN is not
        if binds and tolerance is not None:
            verdict = ("RED" if inside else "known red") if reason else ("holds" if inside else "RED")
        else:
            bare = "failed" if note else "shown" if least == -most == -inf else ""
            verdict = bare or ("within" if inside else "outside")
        self.rows.append({
            "case": self.folder.name, "method": str(method), "quantity": quantity, "reference": reference,
            "value": float(value), "unit": unit, "least": float(least), "most": float(most),
            "verdict": verdict, "seconds": nan if note else self._seconds, "note": note, "reason": reason,
        })  # fmt: skip

    def failed(self, method: Method, why: str, binds: bool | None = None, at: str = "") -> None:
        """Record why a method got no result at a place; red of the recommended, or as ``binds`` says."""
        self.gate(f"{at}: run" if at else "run", nan, "ends", (0.0, inf), "", method, binds, note=why)

    def figure(self, name: str, figure: Any) -> None:
        """Write a figure as ``<case>-<name>.png``, or ``<case>.png`` without a name, if there is a folder."""
        if self.file is not None:
            stem = f"{self.folder.name}-{name}" if name else self.folder.name
            write_figure(figure, self.file.parents[1] / f"{stem}.png")

    def write(self, *errors: str) -> None:
        """Add a red row for each error; write the rows, if there is a file for them."""
        for error in errors:
            self.gate("case", nan, "ends", (0.0, 0.0), note=f"went wrong: {error}")
        if self.file is not None:
            replace_bytes(json.dumps(self.rows, default=float).encode(), self.file)

    @contextlib.contextmanager
    def timed(self) -> Iterator[None]:
        """Take the CPU time of the block as that of the rows recorded afterwards."""
        start, self._seconds = time.process_time(), nan
        try:
            yield
        finally:
            self._seconds = time.process_time() - start
