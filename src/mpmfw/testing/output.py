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
from mpmfw.testing.subject import Subject

#: Steps of a run, with an output after each.
STEPS = 4
#: Difference that sums in another order make, as a share of the largest value.
ROUNDING = 1e-9


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


def output_checks() -> list[Check]:
    """All checks of an output: those first whose failure makes others fail as well."""
    return [
        Check("runs", "What is declared has values at each output.", runs),
        Check("changes-nothing", "The motion is that without the output.", changes_nothing),
        Check("saved", "A run that is saved and loaded goes on to the same values.", saved),
        Check("order", "The order of the bodies does not matter.", order),
    ]
