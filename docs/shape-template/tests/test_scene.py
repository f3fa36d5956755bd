"""Runs of scenes: found by name, exact where a closed form says what to expect."""

from __future__ import annotations

import mpmfw
import numpy as np
import pytest
from mpmfw.api.types import SceneError

SCENE = {
    "grid": {"cell_size": 0.1, "lower": [0.0, 0.0], "upper": [1.0, 1.0]},
    "time": {"end": 0.05, "output_interval": 0.05},
    "shape": {"method": "bounded_bspline"},
    "materials": {
        "rubber": {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 1e5, "shear_modulus": 5e4}
    },
    "bodies": {
        "disc": {
            "material": "rubber",
            "geometry": {"type": "disc", "centre": [0.5, 0.5], "radius": 0.2},
            "particles": {"layout": "fitted", "size": 0.05},
            "velocity": [1.0, 0.0],
        }
    },
    "gravity": {"vector": [0.0, -9.81]},
}


def test_free_flight_is_exact():
    tree = mpmfw.run(SCENE)
    series = tree["series"].to_dataset().sel(body="disc").isel(time=[0, -1])
    moved = series["centre_of_mass"].diff("time").values.ravel()
    velocity = series["mean_velocity"].isel(time=-1).values
    np.testing.assert_allclose(velocity, [1.0, -9.81 * 0.05], rtol=1e-9)
    # symplectic Euler is ahead of g t²/2 by g t Δt / 2
    dt = 0.05 / int(tree.attrs["steps"])
    assert moved[0] == pytest.approx(0.05, rel=1e-9)
    assert moved[1] == pytest.approx(-9.81 * 0.05**2 / 2.0, abs=9.81 * 0.05 * dt)
    stress = np.abs(tree["particles/disc"]["stress"].isel(time=-1)).max()
    assert float(stress) < 1e-6 * 1e5


@pytest.mark.parametrize("where", ["modified", "refuse"])
def test_a_body_in_the_grids_last_cell(where):
    """A square at the grid's first corner flies inwards; unless the end is modified, its points are
    refused.
    """
    square = {"type": "rectangle", "lower": [0.0, 0.0], "upper": [0.4, 0.4]}
    body = {**SCENE["bodies"]["disc"], "geometry": square, "velocity": [1.0, 1.0]}
    scene = {
        **{key: value for key, value in SCENE.items() if key != "gravity"},
        "bodies": {"square": body},
        "shape": {"method": "bounded_bspline", "bounded_bspline": {"grid_end": where}},
    }
    if where == "refuse":
        with pytest.raises(SceneError, match="reaches beyond the grid"):
            mpmfw.run(scene)
        return
    series = mpmfw.run(scene)["series"].to_dataset().sel(body="square")
    moved = series["centre_of_mass"].isel(time=-1) - series["centre_of_mass"].isel(time=0)
    np.testing.assert_allclose(moved, 0.05, rtol=1e-9)
