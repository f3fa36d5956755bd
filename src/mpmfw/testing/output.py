"""The checks of an output's series, on a square or a cube that moves."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.fields import AnyArray
from mpmfw.output_series import OutputSeries
from mpmfw.results import Frame
from mpmfw.simulation import Simulation
from mpmfw.snapshot import NotSaved
from mpmfw.testing.check import Check, Violation
from mpmfw.testing.load.bench import dims_of, simulation_with
from mpmfw.testing.other_units import factor_of
from mpmfw.testing.sent import SENT
from mpmfw.testing.subject import Subject
from mpmfw.units import powers_of

#: Steps of a run, with an output after each.
STEPS = 4
#: Difference that sums in another order make, as a share of the largest value.
ROUNDING = 1e-9
#: What lengths, times or densities are multiplied by: a power of two changes no digit.
LARGER = 1024.0
#: By what share of the largest a value may change where outputs are half as frequent.
OFTEN = 0.3


def series_of(simulation: Simulation, steps: int = STEPS) -> list[dict[str, AnyArray]]:
    """The plug-in's series at the start and after each step, by name."""
    found: list[dict[str, AnyArray]] = []

    def write(frame: Frame) -> None:
        own = {name: values for name, values in frame.series.items() if name.startswith("checked_")}
        found.append({name: np.array(values, dtype=float) for name, values in own.items()})

    simulation.advance(steps, write)
    return found


def runs(subject: Subject) -> None:
    """Every series that is declared, with a unit and a meaning, has a value for each of its bodies, pairs and axes."""
    for dim in dims_of(subject):
        simulation = simulation_with(subject, "outputs", dim, beside=True)
        (own,) = (each for each in simulation.manager.get_plugins() if isinstance(each, OutputSeries))
        lengths = {"body": 2, "pair": 1, "axis": dim, "rotation": 1 if dim == 2 else 3}
        for frame in series_of(simulation):
            for each in own.series():
                case = {"dim": dim, "series": each.name}
                if not (each.unit and each.long_name):
                    raise Violation("a series has no unit or no meaning; '1' is the unit of a number", case)
                try:
                    powers_of(each.unit)
                except ValueError as error:
                    raise Violation(str(error), case) from error
                values = frame[f"checked_{each.name}"]
                expected = [lengths.get(name, n) for name, n in zip(each.dims, values.shape, strict=False)]
                if list(values.shape) != expected or len(each.dims) != values.ndim:
                    raise Violation(
                        f"a series of dims {each.dims} has values of the shape {values.shape}; expected {expected}",
                        case,
                    )
                if np.isinf(values).any() or (np.isnan(values).any() and not each.missing):
                    raise Violation("a series is not finite; NaN needs Field(…, missing=True)", case)


def changes_nothing(subject: Subject) -> None:
    """A run with the series after each step moves to the bit as one without them."""
    for dim in dims_of(subject):
        asked, silent = (simulation_with(subject, "outputs", dim, named=named) for named in (True, False))
        series_of(asked)
        silent.advance(STEPS)
        for name in ("position", "velocity", "stress", "deformation_gradient", "volume", "mass"):
            if not np.array_equal(*(getattr(each.state.particles, name) for each in (asked, silent))):
                raise Violation(f"the motion depends on the output: another {name}", {"dim": dim})


def saved(subject: Subject) -> None:
    """A run that is saved in the middle and loaded goes on to the same values: what an output sums up is in its attributes."""
    for dim in dims_of(subject):
        first, second = (simulation_with(subject, "outputs", dim) for _ in range(2))
        series_of(first)
        try:
            second.restore(first.snapshot())
        except NotSaved as error:
            raise Violation(str(error)) from error
        for one, other in zip(series_of(first), series_of(second), strict=True):
            for name, values in one.items():
                if not np.array_equal(values, other[name], equal_nan=True):
                    raise Violation(f"the series {name} goes on otherwise after loading", {"dim": dim})


def order(subject: Subject) -> None:
    """Bodies that are listed the other way round have the same values, to 1e-9: those by body in the other order."""
    for dim in dims_of(subject):
        there = simulation_with(subject, "outputs", dim, beside=True)
        back = simulation_with(subject, "outputs", dim, backwards=True)
        (own,) = (each for each in there.manager.get_plugins() if isinstance(each, OutputSeries))
        declared: dict[str, Any] = {f"checked_{each.name}": each for each in own.series()}
        for one, other in zip(series_of(there), series_of(back), strict=True):
            for name, values in one.items():
                dims = declared[name].dims
                if "pair" in dims:
                    continue  # the pair's first body is another one
                expected = np.flip(values, dims.index("body")) if "body" in dims else values
                largest = np.abs(np.nan_to_num(expected)).max(initial=0.0)
                if not np.allclose(other[name], expected, rtol=0.0, atol=ROUNDING * largest, equal_nan=True):
                    raise Violation("values depend on the order of the bodies", {"dim": dim, "series": name})


def unit_is_that_of_the_values(subject: Subject) -> None:
    """With lengths, times or densities of the scene 1024 times as large the values are in such units, to 1e-9 of the largest.

    Options that say a unit go with it.
    """
    for dim in dims_of(subject):
        plain = simulation_with(subject, "outputs", dim, beside=True)
        (own,) = (each for each in plain.manager.get_plugins() if isinstance(each, OutputSeries))
        found, units = series_of(plain), {f"checked_{each.name}": each.unit for each in own.series()}
        for quantity in ("length", "time", "density"):
            other = series_of(simulation_with(subject, "outputs", dim, beside=True, units={quantity: LARGER}))
            for name, unit in units.items():
                factor = factor_of(unit, **{quantity: LARGER})
                first, second = (np.array([each[name] for each in one]) for one in (found, other))
                largest = np.abs(np.nan_to_num(first)).max(initial=0.0)
                if not np.allclose(second / factor, first, rtol=0.0, atol=ROUNDING * largest, equal_nan=True):
                    raise Violation(
                        f"the values are not in {unit}: with a {quantity} {LARGER:g} times as large they are not "
                        f"{factor:g} times as large",
                        {"dim": dim, "series": name},
                    )


def outputs(subject: Subject) -> None:
    """With outputs after every second step alone the values change by at most 30 % of the largest."""
    for dim in dims_of(subject):
        often, seldom = (simulation_with(subject, "outputs", dim, beside=True) for _ in range(2))
        first = series_of(often)[2::2]
        second: list[dict[str, AnyArray]] = []
        for _ in first:
            seldom.step()
            second += series_of(seldom, 1)[-1:]
        for name in first[0]:
            one, other = (np.array([each[name] for each in found]) for found in (first, second))
            largest = np.abs(np.nan_to_num(one)).max(initial=0.0)
            if not np.allclose(other, one, rtol=0.0, atol=OFTEN * largest, equal_nan=True):
                raise Violation(
                    "the values depend on how often outputs are asked for", {"dim": dim, "series": name}
                )


def output_checks() -> list[Check]:
    """All checks of an output: those first whose failure makes others fail as well."""
    return [
        Check("runs", "What is declared has values at each output.", runs),
        Check("changes-nothing", "The motion is that without the output.", changes_nothing),
        Check("saved", "A run that is saved and loaded goes on to the same values.", saved),
        Check("order", "The order of the bodies does not matter.", order),
        Check("unit", "The unit is that of the values.", unit_is_that_of_the_values),
        Check("outputs", "The values are of the motion, not of how often outputs are asked for.", outputs),
        SENT,
    ]
