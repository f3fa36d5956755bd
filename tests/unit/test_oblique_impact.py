"""The elastic sphere of the case oblique-spheres against what is known of it, and the case's measures of a rigid one."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

CASE = Path(__file__).resolve().parents[2] / "validation" / "oblique-spheres"


@pytest.fixture
def case(monkeypatch):
    """The modules of the case."""
    monkeypatch.syspath_prepend(str(CASE))
    names = ("thrown", "elastic", "bounce")
    yield {name: __import__(name) for name in names}
    for name in names:
        sys.modules.pop(name, None)


def test_sphere_slides_throughout_beyond_the_limit_and_not_below(case):
    elastic = case["elastic"]
    for psi in (4.0 * elastic.CHI - 0.9, 6.0, 9.0):
        slope = psi * 0.3 / elastic.RATIO
        assert psi * elastic.rebound(slope) == pytest.approx(psi - 4.0 * elastic.CHI, abs=1e-6)
    slope = (4.0 * elastic.CHI - 1.5) * 0.3 / elastic.RATIO
    assert elastic.psi(slope) * elastic.rebound(slope) > elastic.psi(slope) - 4.0 * elastic.CHI + 1e-3


def test_friction_takes_energy_and_the_contact_goes_back_between_sticking_and_sliding(case):
    """Never faster than it came; and what it has does not depend on stiffness, mass or speed, but on ψ1 and ν alone."""
    elastic = case["elastic"]
    psi = np.linspace(0.4, 7.0, 23)
    left = np.array([one * elastic.rebound(one * 0.3 / elastic.RATIO) for one in psi])
    assert (np.abs(left) < psi).all()
    assert (left[(psi > 1.2) & (psi < 4.0 * elastic.CHI)] < 0.0).all()
    assert (np.diff(left)[psi[1:] > 4.0] > 0.0).all()


def results(case, along: float, spin: float, back: float) -> xr.DataTree:
    """A run whose sphere has v_t = v_n before and these velocities over v_n after it, on a slab that stays."""
    thrown = case["thrown"]
    velocity = np.zeros((2, 2, 3))
    velocity[0, 0] = thrown.ALONG - thrown.NORMAL
    velocity[1, 0] = along * thrown.ALONG + back * thrown.NORMAL
    turning = np.zeros((2, 2, 3))
    turning[1, 0] = spin * thrown.ACROSS
    dims, bodies = ("time", "body", "axis"), {"body": ["sphere", "slab"]}
    series = xr.Dataset(
        {
            "mean_velocity": (dims, velocity),
            "angular_velocity": (dims, turning),
            "centre_of_mass": (dims, np.zeros((2, 2, 3))),
        },
        coords=bodies,
    )
    return xr.DataTree(children={"series": xr.DataTree(series)})


def test_measures_are_zero_of_rigid_spheres_and_tell_wrong_friction_and_a_wrong_turn(case):
    bounce, taken = case["bounce"], 0.3 * 1.9  # μ (1 + e) with e = 0.9
    sliding = bounce.against_sliding(results(case, 1.0 - taken, 2.5 * taken, 0.9))
    assert sliding == pytest.approx({"along": 0.0, "spin": 0.0}, abs=1e-9)
    less = bounce.against_sliding(results(case, 1.0 - 0.9 * taken, 2.5 * 0.9 * taken, 0.9))
    assert less == pytest.approx({"along": -10.0, "spin": -10.0})
    assert bounce.against_sliding(results(case, 1.0 - taken, -2.5 * taken, 0.9))["spin"] == pytest.approx(
        -200.0
    )
    rolling = bounce.against_rolling(results(case, 5.0 / 7.0, 5.0 / 7.0, 0.9))
    assert rolling == pytest.approx({"along": 0.0, "spin": 0.0}, abs=1e-9)
