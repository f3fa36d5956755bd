"""Measures that are wrong in one place."""

from __future__ import annotations

from typing import Any

import numpy as np

from faulty_plugins.sealed import Sealed
from mpmfw.api import About, Exact, FloatArray, Measure, Measured


class Sound(Measure):
    """Largest speed of a body's centre along an axis."""

    name = "sound"
    unit = "m s-1"
    kind = "number"
    keys = ("body", "axis")

    def of(self, run: Any, scene: Any, about: About) -> Measured:
        return Measured(np.array([self.largest(np.abs(self.speed(run, scene, about)))]), np.empty(0))

    def speed(self, run: Any, scene: Any, about: About) -> FloatArray:
        """Velocity of the body over time (time,) [m/s]."""
        body = about.body or next(iter(scene.bodies))
        return np.asarray(run["series"]["mean_velocity"].sel(body=body, axis=about.axis).values, dtype=float)

    def largest(self, values: FloatArray) -> float:
        """The number that is read off a curve."""
        return float(values.max())


class Curve(Sound):
    """Displacement of a body's centre along an axis over time."""

    name = "curve"
    unit = "m"
    kind = "curve"

    def of(self, run: Any, scene: Any, about: About) -> Measured:
        body = about.body or next(iter(scene.bodies))
        series = run["series"]
        x = np.asarray(series["centre_of_mass"].sel(body=body, axis=about.axis).values, dtype=float)
        return Measured(x - x[0], np.asarray(series["time"].values, dtype=float))

    def exact(self, scene: Any, about: About) -> Exact | None:
        return (
            Exact("closed-form", "no force", lambda t: 0.5 * np.asarray(t))
            if about.axis == "x" and scene
            else None
        )


class ThreeNumbers(Sound):
    """Three numbers in place of one."""

    name = "three"

    def of(self, run: Any, scene: Any, about: About) -> Measured:
        return Measured(np.repeat(super().of(run, scene, about).values, 3), np.empty(0))


class NoTime(Curve):
    """A curve without its times."""

    name = "no-time"

    def of(self, run: Any, scene: Any, about: About) -> Measured:
        return Measured(super().of(run, scene, about).values, np.empty(0))


class MisspeltUnit(Sound):
    """A unit that there is not."""

    name = "misspelt"
    unit = "metres per tick"


class Sorts(Sound):
    """Sorts the results' own array."""

    name = "sorts"

    def speed(self, run: Any, scene: Any, about: About) -> FloatArray:
        values = run["series"]["mean_velocity"].values
        values.sort(axis=0)
        return super().speed(run, scene, about)


class Remembers(Sound):
    """The largest of all runs that it has seen."""

    name = "remembers"
    seen = 0.0

    def largest(self, values: FloatArray) -> float:
        self.seen = max(self.seen, float(values.max())) + 1e-6
        return self.seen


class FirstBody(Sound):
    """Always of the first body."""

    name = "first-body"

    def speed(self, run: Any, scene: Any, about: About) -> FloatArray:
        return super().speed(run, scene, About(axis=about.axis))


class MoreKeys(Sound):
    """Looks at the axis and does not say so."""

    name = "more-keys"
    keys = ("body",)


class OtherUnit(Curve):
    """Metres, declared as a speed."""

    name = "per-second"
    unit = "m s-1"


class Threshold(Sound):
    """Speeds below 1 m/s count as rest."""

    name = "threshold"

    def largest(self, values: FloatArray) -> float:
        return float(values.max()) if values.max() > 1.0 else 0.0


class Summed(Sound):
    """Sums over outputs without their distance in time."""

    name = "summed"

    def largest(self, values: FloatArray) -> float:
        return float(values.sum())


class WrongShape(Curve):
    """One value for whatever times."""

    name = "wrong-shape"

    def exact(self, scene: Any, about: About) -> Exact | None:
        return Exact("closed-form", "at rest", lambda _: np.zeros(1)) if scene and about else None


class Cumulated(Curve):
    """The value at a time is summed up over the times that are asked for."""

    name = "cumulated"

    def exact(self, scene: Any, about: About) -> Exact | None:
        return Exact("closed-form", "a sum", lambda t: np.cumsum(np.asarray(t))) if scene and about else None


class NoKind(Curve):
    """Of a kind that there is not."""

    name = "no-kind"

    def exact(self, scene: Any, about: About) -> Exact | None:
        return Exact("guess", "", lambda t: np.asarray(t)) if scene and about else None


class Closed(Sealed, Curve):
    """Holds a function."""

    name = "closed"


FAULTS: dict[Any, str] = {
    ThreeNumbers: "runs", NoTime: "runs", MisspeltUnit: "runs", Sorts: "changes-nothing", Remembers: "repeatable",
    FirstBody: "keys", MoreKeys: "keys", OtherUnit: "unit", Threshold: "unit", Summed: "outputs", WrongShape: "exact",
    Cumulated: "exact", NoKind: "exact", Closed: "sent",
}  # fmt: skip
