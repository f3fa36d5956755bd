"""Outputs of runs: at exact times or at the ends of the nearest steps, and how often points are recorded."""

import numpy as np
import pytest

import mpmfw
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import two_blocks

DENSE = {"end": 0.02, "output_interval": 0.0013}


def run(**changes):
    return mpmfw.run(two_blocks("penalty", **changes))


def test_steps_are_not_shortened_for_outputs_that_take_the_nearest_step():
    exact, nearest = run(time=DENSE), run(time={**DENSE, "outputs": "nearest"})
    free = run(time={"end": 0.02, "output_interval": 0.02})
    assert nearest.attrs["steps"] == free.attrs["steps"] < 0.9 * exact.attrs["steps"]
    times, step = nearest["series/time"].values, 0.02 / nearest.attrs["steps"]
    asked = exact["series/time"].values
    np.testing.assert_allclose(asked, np.append(np.arange(16) * 0.0013, 0.02), rtol=1e-12)
    assert len(times) == len(asked)
    apart = np.abs(times - asked)
    assert apart.max() < 0.6 * step
    assert apart[1:-1].min() > 0.0
    assert times[[0, -1]].tolist() == [0.0, 0.02]
    # What is recorded belongs to the time that is recorded: the blocks fly freely at first
    moved = nearest["series/centre_of_mass"].values[:3, 0] - nearest["series/centre_of_mass"].values[0, 0]
    np.testing.assert_allclose(
        moved, times[:3, None] * nearest["series/mean_velocity"].values[0, 0], atol=1e-12
    )


def test_the_force_at_the_nearest_steps_integrates_to_the_impulse():
    tree = run(time={**DENSE, "end": 0.2, "outputs": "nearest"}, output={"particles": False})
    series = tree["series"].to_dataset()
    force, momentum = series["contact_force"].isel(pair=0), series["linear_momentum"].isel(body=0)
    impulse = (force.values[1:] * np.diff(series["time"])[:, None]).sum(axis=0)
    assert np.abs(impulse).max() > 0.0
    np.testing.assert_allclose(
        impulse, (momentum[-1] - momentum[0]).values, rtol=1e-9, atol=1e-9 * np.abs(impulse).max()
    )


@pytest.mark.parametrize("outputs", ["exact", "nearest"])
def test_material_points_are_recorded_at_their_own_interval(outputs, tmp_path):
    time = {"end": 0.02, "output_interval": 0.001, "outputs": outputs}
    tree = mpmfw.run(
        two_blocks("penalty", time=time, output={"particle_interval": 0.006}), output=tmp_path / "run.nc"
    )
    step = 0.02 / tree.attrs["steps"]
    points = tree["particles/left"]
    np.testing.assert_allclose(points["time"], [0.0, 0.006, 0.012, 0.018, 0.02], atol=0.51 * step)
    assert set(points["time"].values) <= set(tree["series/time"].values)
    assert tree["series/time"].size == tree["surface/left/time"].size == 21
    every = mpmfw.run(two_blocks("penalty", time=time))
    same = every["particles/left"].to_dataset().sel(time=points["time"].values)
    np.testing.assert_array_equal(points["stress"], same["stress"])
    np.testing.assert_array_equal(tree["series/min_gap"], every["series/min_gap"])


def test_material_points_are_stored_in_single_precision_and_the_rest_in_double():
    simulation = Simulation(two_blocks("penalty", time={"end": 0.01, "output_interval": 0.01}))
    tree = mpmfw.run(two_blocks("penalty", time={"end": 0.01, "output_interval": 0.01}))
    simulation.run()
    points = tree["particles/left"]
    assert {str(points[name].dtype) for name in points.data_vars} == {"float32", "float64"}
    assert [name for name in points.data_vars if points[name].dtype == np.float64] == ["mass"]
    exact = simulation.state.particles.position[simulation.state.bodies[0].particles]
    np.testing.assert_array_equal(points["position"][-1], exact.astype(np.float32))
    assert {str(array.dtype) for array in tree["series"].data_vars.values()} == {"float64"}
