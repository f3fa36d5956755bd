"""Series and boundary conditions that a scene names, by classes as a stranger would write them."""

import numpy as np
import pytest

import mpmfw
from mpmfw.api import Boundary, Field, OutputSeries
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


class Shaken(Boundary):
    """The lower three eighths move along x with 10 t, and are free along y: of the nodes at y = −1/4 seven
    eighths, at 0 one.
    """

    name = "shaken"

    def holds(self, position):
        return position[:, 1] < -0.1

    def velocity(self, position, time):
        velocity = np.full_like(position, np.nan)
        velocity[:, 0] = 10.0 * time
        return velocity


@pytest.fixture(autouse=True)
def installed(announce):
    """The classes of this module as if they were installed."""
    for kind, one in (("output", Places), ("output", Less), ("boundary", Shaken)):
        announce(kind, one.name, f"{__name__}:{one.__name__}")


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
