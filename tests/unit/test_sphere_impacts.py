"""Of the case sphere-impacts: its elastic sphere against known limits, and its measures."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

CASE = Path(__file__).resolve().parents[2] / "validation" / "sphere-impacts"


@pytest.fixture
def case(monkeypatch):
    """The modules of the case."""
    monkeypatch.syspath_prepend(str(CASE))
    names = ("spheres", "elastic", "bounce")
    yield {name: __import__(name) for name in names}
    for name in names:
        sys.modules.pop(name, None)


@pytest.mark.parametrize("poisson", [0.2, 0.3, 0.4])
def test_sphere_slides_throughout_beyond_the_limit_and_not_below(case, poisson):
    elastic = case["elastic"]
    limit, ratio = elastic.sliding_from(poisson), elastic.ratio(poisson)
    for psi in (limit + 0.1, limit + 1.5, limit + 4.0):
        assert psi * elastic.rebound(psi / ratio, poisson) == pytest.approx(psi - limit - 1.0, abs=1e-6)
    psi = limit - 0.5
    assert psi * elastic.rebound(psi / ratio, poisson) > psi - limit - 1.0 + 1e-3


def results(case, along: float, spin: float, back: float) -> xr.DataTree:
    """A run whose sphere has v_t = v_n before, and these velocities over v_n after it."""
    spheres = case["spheres"]
    velocity = np.zeros((2, 2, 3))
    velocity[0, 0] = spheres.ALONG - spheres.NORMAL
    velocity[1, 0] = along * spheres.ALONG + back * spheres.NORMAL
    turning = np.zeros((2, 2, 3))
    turning[1, 0] = spin / spheres.SPHERES["5 steel"].radius * spheres.ACROSS
    dims, bodies = ("time", "body", "axis"), {"body": ["sphere", "slab"]}
    series = xr.Dataset(
        {
            "mean_velocity": (dims, velocity),
            "angular_velocity": (dims, turning),
            "centre_of_mass": (dims, np.zeros((2, 2, 3))),
        },
        coords=bodies,
    )
    title = spheres.scene("5 steel", 6)["title"]
    tree = xr.DataTree(children={"series": xr.DataTree(series)})
    tree.attrs["scene"] = f'title = "{title}"'
    return tree


def test_measures_are_zero_of_rigid_spheres_and_tell_wrong_friction_and_a_wrong_turn(case):
    """At 45°, where the rigid sphere rolls at the end."""
    bounce, taken = case["bounce"], 0.3 * 1.9  # μ (1 + e) with e = 0.9

    def rigid(along: float, spin: float) -> tuple[float, float]:
        found = bounce.errors(results(case, along, spin, 0.9))
        return found["along, rigid"], found["spin, rigid"]

    rolls = 2.0 / 7.0  # less than friction could take
    assert taken > rolls
    assert rigid(1.0 - rolls, 2.5 * rolls) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert rigid(1.0 - 0.9 * rolls, 2.25 * rolls) == pytest.approx((-10.0, -10.0))
    assert rigid(1.0 - rolls, -2.5 * rolls)[1] == pytest.approx(-200.0)


def test_measures_are_zero_of_the_elastic_sphere(case):
    left = case["elastic"].rebound(1.0 / 0.3, 0.3)
    taken = (1.0 - left) / 3.5
    found = case["bounce"].errors(results(case, 1.0 - taken, 2.5 * taken, 1.0))
    assert [found[name] for name in ("along", "spin", "contact")] == pytest.approx([0.0] * 3, abs=1e-9)
