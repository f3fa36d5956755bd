"""What goes wrong is named: body, point, position, time and what to do; what was reached is kept."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mpmfw
from mpmfw.api import ContactStrategy, Grid, hookimpl
from mpmfw.errors import ResultsWarning, SceneError, SimulationError
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import ball, disc, two_blocks

LEAVES = disc(bodies__solid__velocity=[20.0, 0.0], time={"end": 0.1, "output_interval": 0.02})


def assert_named(error: SimulationError, what: str) -> None:
    """The message says what, which body and point, where, when, and what to try."""
    message = str(error)
    for part in (what, "body 'solid'", f"point {error.index}", "at (", " m", "at time", "Try: "):
        assert part in message
    assert error.body == "solid"
    assert isinstance(error.index, int)
    assert error.time is not None
    assert error.advice


@pytest.mark.parametrize("shape", ["linear", "cpdi", "cpdi2"])
def test_a_body_that_leaves_the_grid(shape: str) -> None:
    with pytest.raises(SimulationError) as caught:
        mpmfw.run(LEAVES, shape=shape)
    error = caught.value
    assert_named(error, "a material point left the grid")
    assert "larger grid" in str(error.advice)
    assert error.position is not None
    # the front runs from 1.03 m at 20 m/s, 25 mm a step, and stops where the last support ends, within a cell
    # and a half of 2 m
    assert 1.6 < error.position[0] < 2.03
    assert 0.02 < error.time < 0.052  # the front reaches 2 m at 0.0485 s; two steps more


def test_a_body_that_leaves_the_grid_in_3d() -> None:
    with pytest.raises(SimulationError) as caught:
        mpmfw.run(ball(bodies__solid__velocity=[0.0, 0.0, -60.0]))
    assert_named(caught.value, "a material point left the grid")
    assert caught.value.position[2] < -1.6


def test_results_up_to_the_failure_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "run.nc"
    with pytest.raises(SimulationError) as caught:
        mpmfw.run(LEAVES, output=path)
    with pytest.warns(ResultsWarning, match=r"is not complete: failed: a material point left the grid"):
        written = mpmfw.open(path)
    for tree in (written, caught.value.results):
        assert tree.attrs["status"] == f"failed: {caught.value}"
        times = tree["series"]["time"].values
        np.testing.assert_allclose(times, 0.02 * np.arange(len(times)))
        assert len(times) >= 2
        centre = tree["series"]["centre_of_mass"].sel(axis="x").values[:, 0]
        np.testing.assert_allclose(centre, centre[0] + 20.0 * times, rtol=1e-9)


def test_a_nan_is_named() -> None:
    sim = Simulation(disc())
    sim.advance(3)
    sim.state.particles.velocity[7] = np.nan
    with pytest.raises(SimulationError) as caught:
        sim.advance(3)
    assert_named(caught.value, "a value became NaN")


def test_an_inversion_is_named() -> None:
    sim = Simulation(disc())
    sim.advance(3)
    sim.state.particles.deformation_gradient[11] = np.diag([-1.0, 1.0])
    with pytest.raises(SimulationError) as caught:
        sim.advance(1)
    assert_named(caught.value, "a material point inverted (det F = -1)")
    assert caught.value.index == 11


def test_the_index_counts_within_the_body() -> None:
    sim = Simulation(two_blocks("separate"))
    sim.advance(1)
    first = sim.state.bodies[1].particles.start
    sim.state.particles.deformation_gradient[first + 2] = np.diag([-1.0, 1.0])
    with pytest.raises(SimulationError) as caught:
        sim.advance(1)
    assert (caught.value.body, caught.value.index) == ("right", 2)


def test_the_limit_is_the_courant_number_one() -> None:
    # c = sqrt(10 MPa / 1000 kg/m³) = 100 m/s, h = 0.25 m; half of it by default
    sim = Simulation(disc())
    assert sim.limits()[0][0] == pytest.approx(0.25 / 100.0)
    assert sim.stable_step() == pytest.approx(0.5 * 0.25 / 100.0)


@pytest.mark.parametrize(
    ("time", "key"),
    [({"step": 2.6e-3}, "time.step"), ({"safety": 1.1}, "time.safety")],
)
def test_a_step_past_the_limit_is_refused(time: dict[str, float], key: str) -> None:
    scene = disc(time={"end": 0.05, "output_interval": 0.05, **time})
    with pytest.raises(SceneError, match=key):
        Simulation(scene)
    scene["allow_unstable"] = True
    assert Simulation(scene).stable_step() == pytest.approx(time.get("step", 1.1 * 2.5e-3))


def test_a_body_outside_the_grid_is_refused() -> None:
    with pytest.raises(SceneError, match="solid"):
        Simulation(disc(grid__upper=[1.0, 2.0]))


class Misspelt(ContactStrategy):
    """One hook's name is wrong."""

    name = "misspelt"

    @hookimpl
    def add_nodal_forces(self, grid: Grid) -> None:
        """There is no such hook."""


class WrongArgument(ContactStrategy):
    """One argument's name is wrong."""

    name = "wrong_argument"

    @hookimpl
    def add_nodal_force(self, gird: Grid) -> None:
        """There is no such argument."""


@pytest.mark.parametrize(("strategy", "named"), [(Misspelt, "add_nodal_forces"), (WrongArgument, "gird")])
def test_a_misspelt_hook_is_an_error(strategy: Any, named: str) -> None:
    with pytest.raises(Exception, match=named):
        Simulation(two_blocks("separate"), contact=strategy())


@pytest.mark.parametrize("name", ["body", "axis", "particle", "series"])
def test_a_body_may_have_any_name_that_a_scene_accepts(name: str) -> None:
    scene = disc()
    scene["bodies"] = {name: scene["bodies"]["solid"]}
    try:
        scene = mpmfw.load_scene(scene)
    except SceneError:
        return
    tree = mpmfw.run(scene)
    assert tree["series"]["body"].values.tolist() == [name]
    assert list(tree["particles"].children) == [name]
