"""Impulses that a spring bounds: one row, in closed form."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mpmfw.contact.rows import ContactRows
from mpmfw_contact.hybrid import Hybrid

MODULUS, AREA, MASSES = 50.0, 0.2, (2.0, 3.0)
TOGETHER = MASSES[0] * MASSES[1] / sum(MASSES)


def impulse(
    *, gap: float, approach: float, dt: float, slip: float = 0.0, friction: float = 0.0, moves: bool = True
) -> np.ndarray:
    """On the first of two nodes that approach along x by ``approach`` [m/s] and slip along y."""
    law = Hybrid()
    law.modulus, law.strain_first, law.dt = np.array([MODULUS]), False, dt
    rows = ContactRows(2, couples=False, own=law.row_arrays(friction=True))
    rows.allocate_friction(cohesion=False)
    rows.count = 1
    rows.start[:2], rows.dof[:2], rows.weight[:2] = [0, 2], [0, 1], [1.0, -1.0]
    rows.normal[0], rows.gap[0], rows.area[0], rows.friction[0] = [-1.0, 0.0], gap, AREA, friction
    grid = SimpleNamespace(
        mass=np.array(MASSES),
        momentum=np.array([[MASSES[0] * approach, MASSES[0] * slip], [0.0, 0.0]]),
        spacing=(1.0, 1.0),
    )
    law.impulses(rows, grid, np.zeros(2), np.zeros(1) if moves else None, projected=False)
    return rows.force[0].copy()


@pytest.mark.parametrize("dt", [1e-3, 1e-2, 1.0])
@pytest.mark.parametrize("gap", [-1e-3, -0.1])
def test_the_impulse_is_the_lesser_of_spring_and_approach(gap: float, dt: float) -> None:
    expected = min(MODULUS * AREA * -gap * dt, TOGETHER * 0.5)
    np.testing.assert_allclose(impulse(gap=gap, approach=0.5, dt=dt), [-expected, 0.0], rtol=1e-13)


def test_both_bounds_are_met() -> None:
    """Else one of the two would not be tested above."""
    assert MODULUS * AREA * 1e-3 * 1e-3 < TOGETHER * 0.5 < MODULUS * AREA * 0.1 * 1.0


def test_bodies_that_only_touch_exchange_nothing() -> None:
    np.testing.assert_array_equal(impulse(gap=0.0, approach=0.5, dt=1.0), 0.0)


@pytest.mark.parametrize("dt", [1e-3, 1.0])
def test_bodies_that_overlap_and_separate_are_pushed(dt: float) -> None:
    expected = min(MODULUS * AREA * 0.1 * dt, TOGETHER * 0.5)
    np.testing.assert_allclose(impulse(gap=-0.1, approach=-0.5, dt=dt), [-expected, 0.0], rtol=1e-13)


def test_the_momentum_of_the_strain_is_only_stopped() -> None:
    """MUSL's second momentum moves no point, and has been pushed already."""
    np.testing.assert_array_equal(impulse(gap=-0.1, approach=-0.5, dt=1.0, moves=False), 0.0)
    assert impulse(gap=-0.1, approach=0.5, dt=1.0, moves=False)[0] < 0.0


def test_friction_is_within_the_cone_of_the_bounded_impulse() -> None:
    bounded = MODULUS * AREA * 0.01 * 0.1
    found = impulse(gap=-0.01, approach=0.5, dt=0.1, slip=2.0, friction=0.3)
    np.testing.assert_allclose(found, [-bounded, -0.3 * bounded], rtol=1e-13)
