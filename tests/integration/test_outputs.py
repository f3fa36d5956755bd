"""Series and boundary conditions that a scene names, by classes as a stranger would write them."""

import numpy as np
import pytest

import mpmfw
from mpmfw.api import Field, OutputSeries
from mpmfw.errors import PluginError, SceneError
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import block, two_blocks


class Places(OutputSeries):
    """Lowest and highest point of every body along each axis, and how often it was asked."""

    name = "places"

    def series(self):
        return [
            Field("lowest", ("body", "axis"), "m", "least coordinate of the material points"),
            Field("asked", (), "1", "number of outputs"),
        ]

    def values(self, state, interval):
        self.asked = 1 if interval == 0.0 else self.asked + 1
        lowest = [state.particles.position[body.particles].min(axis=0) for body in state.bodies]
        return {"lowest": np.array(lowest), "asked": self.asked}


class Less(Places):
    """Forgets a series that it declared."""

    name = "less"

    def values(self, state, interval):  # noqa: ARG002
        return {"asked": 1}


@pytest.fixture(autouse=True)
def installed(announce):
    """The classes of this module as if they were installed."""
    announce("boundary", "shaken", "faulty_plugins.small.other_kinds:Shaken")
    for one in (Places, Less):
        announce("output", one.name, f"{__name__}:{one.__name__}")


def test_series_of_ones_own_are_in_the_results_with_unit_and_labels():
    scene = two_blocks("separate", time__end=2e-3, time__output_interval=1e-3)
    series = mpmfw.run({**scene, "outputs": {"box": {"model": "places"}}})["series"]
    assert series["box_lowest"].dims == ("time", "body", "axis")
    assert series["box_lowest"].attrs["units"] == "m"
    assert series["box_lowest"].sel(body="left", axis="y").values[0] == pytest.approx(-0.25 + 0.0625)
    np.testing.assert_array_equal(series["box_asked"], [1, 2, 3])


def test_a_series_that_is_declared_and_not_given_ends_the_run():
    with pytest.raises(
        PluginError, match=r"'a' \(less\) answered with values of asked; expected asked, lowest"
    ):
        mpmfw.run(block(outputs={"a": {"model": "less"}}))


def test_what_is_held_moves_as_prescribed_and_its_work_is_in_the_ledger():
    """∫ V·dP of what is held, which all moves with V(t), and the energy that the body has got by it."""
    changes = {"time__step": 1e-4, "time__output_interval": 1e-4, "output__ledger": True}
    simulation, frames = Simulation(block(boundaries={"table": {"model": "shaken"}}, **changes)), []
    simulation.run(lambda frame: frames.append({name: np.copy(each) for name, each in frame.series.items()}))
    p, speed = simulation.state.particles, 10.0 * simulation.state.time
    low = p.position[:, 1] < -0.25
    np.testing.assert_allclose(p.velocity[low, 0], speed, rtol=5e-3)
    assert 0.0 < p.velocity[~low, 0].mean() < speed
    series = {name: np.array([frame[name] for frame in frames]) for name in frames[0]}
    velocity = 1e-3 * np.arange(len(frames))  # 10 t
    momentum, work = series["linear_momentum"][:, 0, 0], float(series["external_work"][-1])
    assert work > 1.0
    assert 0.5 * (velocity[1:] + velocity[:-1]) @ np.diff(momentum) == pytest.approx(work, rel=1e-2)
    energy = (series["total_energy"] + series["affine_energy"])[-1].sum() + series["transfer_dissipation"][-1]
    assert float(energy) == pytest.approx(work, rel=2e-3)


def test_a_body_that_shares_its_velocity_field_cannot_be_held():
    with pytest.raises(SceneError, match=r"boundaries\.table: the bodies share one velocity field"):
        Simulation(two_blocks("none", boundaries={"table": {"model": "shaken", "bodies": ["left"]}}))


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


@pytest.mark.parametrize(("shift", "precise"), [(0.0, np.float32), (5.8e6, np.float64)])
def test_positions_far_from_the_origin_keep_the_precision_of_the_run(shift, precise):
    scene = block(time__end=1e-3, time__output_interval=1e-3, shape__method="cpdi2")
    for place in (scene["grid"], scene["bodies"]["solid"]["geometry"]):
        place |= {end: [shift + x for x in place[end]] for end in ("lower", "upper")}
    points = mpmfw.run(scene)["particles/solid"].ds
    assert points["position"].dtype == points["corners"].dtype == precise
    assert points["stress"].dtype == np.float32
    assert len(np.unique(points["position"].isel(time=0, axis=1))) == 8
