"""A bar between frictionless walls: uniaxial strain, so that a wave runs at c = sqrt(M / ρ)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mpmfw.runs.simulation import Simulation
from scenes_for_tests import BULK, DENSITY, SHEAR, SOFT, one_body

LENGTH = 4.0
SPEED = float(np.sqrt((BULK + 4.0 * SHEAR / 3.0) / DENSITY))
FREQUENCY = {"free": SPEED / (2.0 * LENGTH), "fixed": SPEED / (4.0 * LENGTH)}


def bar(dim: int, shape: str, end: str, cell: float = 0.25) -> dict[str, Any]:
    """4 m long, ends on grid lines; the left end free or fixed."""
    walls = [("top", "y"), ("bottom", "y"), ("back", "z"), ("front", "z")][: 2 * (dim - 1)]
    sides = [{"side": side, "fixed": [axis]} for side, axis in walls]
    if end == "fixed":
        sides.append({"side": "left", "fixed": ["x"]})
    geometry = {
        "type": "rectangle" if dim == 2 else "box",
        "lower": [-2.0] + [-0.25] * (dim - 1),
        "upper": [2.0] + [0.25] * (dim - 1),
    }
    return one_body(
        geometry,
        size=cell / 2,
        shape__method=shape,
        bodies__solid__sides=sides,
        materials__soft={**SOFT, "model": "linear_elastic"},
        grid__lower=[-3.0] + [-2.0] * (dim - 1),
        grid__upper=[3.0] + [2.0] * (dim - 1),
        grid__cell_size=cell,
    )


def vibrate(scene: dict[str, Any], end: str) -> tuple[float, float]:
    """Frequency of the first mode over its closed form, and its amplitude at the end over that at the
    start."""
    sim = Simulation(scene)
    sim.start()
    p = sim.state.particles
    x = (p.position[:, 0] + 2.0) / LENGTH
    mode = np.cos(np.pi * x) if end == "free" else np.sin(0.5 * np.pi * x)
    p.velocity[:, 0] = 1e-3 * SPEED * mode
    times, share = [0.0], [p.mass @ (mode * p.velocity[:, 0])]
    while sim.state.time < 4.3 / FREQUENCY[end]:
        sim.step(sim.stable_step())
        times.append(sim.state.time)
        share.append(p.mass @ (mode * p.velocity[:, 0]))
    t, q = np.array(times), np.array(share)
    i = np.flatnonzero(q[:-1] * q[1:] < 0.0)
    zero = t[i] - q[i] * (t[i + 1] - t[i]) / (q[i + 1] - q[i])
    frequency = 0.5 * (len(zero) - 1) / (zero[-1] - zero[0])
    last_period = t > t[-1] - 1.0 / FREQUENCY[end]
    return float(frequency / FREQUENCY[end]), float(np.abs(q[last_period]).max() / q[0])


@pytest.mark.parametrize(
    ("dim", "shape"), [*((2, shape) for shape in ("linear", "gimp", "cpdi", "bspline")), (3, "cpdi")]
)
def test_a_bar_with_free_ends_vibrates_at_its_own_frequency(dim: int, shape: str) -> None:
    frequency, amplitude = vibrate(bar(dim, shape, "free"), "free")
    assert frequency == pytest.approx(
        1.0, abs=0.01
    )  # 16 cells: (k h)²/24 = 0.16 % from lumped mass, and the ends
    assert amplitude == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize(("dim", "shape"), [(2, "linear"), (2, "gimp"), (2, "cpdi"), (3, "linear")])
def test_a_bar_with_a_fixed_end_vibrates_at_its_own_frequency(dim: int, shape: str) -> None:
    frequency, amplitude = vibrate(bar(dim, shape, "fixed"), "fixed")
    assert frequency == pytest.approx(1.0, abs=0.01)
    assert amplitude == pytest.approx(1.0, abs=0.01)


def test_a_fixed_end_of_b_splines_converges() -> None:
    # The wall acts where it is, though a quadratic B-spline is not 1 at its node: the error is of second
    # order.
    coarse, fine = (1.0 - vibrate(bar(2, "bspline", "fixed", cell), "fixed")[0] for cell in (0.25, 0.125))
    assert 0.0 < fine < coarse < 0.01
    assert fine / coarse == pytest.approx(0.25, abs=0.1)
