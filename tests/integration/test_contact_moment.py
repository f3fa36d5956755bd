"""The moment of contact on every body, against forces of surface nodes, momenta, and the other body's."""

import numpy as np
import pytest

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.state.surface import closed_surface, nodes_left
from mpmfw_testing.contact.motion import moment
from scenes_for_tests import box, scene_of, solid, two_blocks, with_changes


def cubes(method, **changes):
    """Two cubes of 0.5 m that meet askew at 2 m/s and turn each other."""
    scene, bodies = box(contact={"method": method, "friction": 0.3}), {}
    for name, left, low, speed in (("left", -0.505, -0.2, 1.0), ("right", 0.005, -0.3, -1.0)):
        corners = [left, low, -0.23], [left + 0.5, low + 0.5, 0.27]
        bodies[name] = solid(*corners, 0.125, velocity=[speed, 0.4 * speed, -0.2 * speed])
    return with_changes({**scene, "bodies": bodies}, **changes)


def recorded(scene, about, steps=12, **output):
    """A run with an output after every step."""
    step = 5e-4
    time = {"end": steps * step, "step": step, "output_interval": step}
    output = {"gap": False, "contact_moment": about, "particles": False, "surface": False, **output}
    return mpmfw.run({**scene, "time": time, "output": output})


@pytest.mark.parametrize("scene", [two_blocks, cubes])
def test_moment_is_that_of_the_surface_nodes_forces(scene):
    """One pass: only nodes of the left body are pushed, each by the force that the results have of it."""
    mapping = scene("penalty", contact__penalty={"passes": "one", "master": "right"})
    tree = recorded(mapping, "centre_of_mass", surface=True)
    series, surface = tree["series"].to_dataset(), tree["surface/left"].to_dataset()
    found, own = series["contact_moment"], series.sel(body="left")
    assert found.dims == ("time", "body", "rotation")
    assert found.sizes["rotation"] == (1 if scene is two_blocks else 3)
    assert found.attrs["units"] == ("N m m-1" if scene is two_blocks else "N m")
    assert found.attrs["cell_methods"] == "time: mean"
    arms = surface["position"].values[:-1] - own["centre_of_mass"].values[:-1, None]
    exerted = [moment(arm, force) for arm, force in zip(arms, surface["force"].values[1:], strict=True)]
    largest = np.abs(exerted).max()
    assert largest > 0.0
    np.testing.assert_allclose(own["contact_moment"].values[1:], exerted, rtol=0.0, atol=1e-9 * largest)


def test_point_and_centre_differ_by_the_force_times_the_way_and_looking_changes_nothing():
    point = np.array([0.3, -0.7])
    plain, own, other = (
        recorded(two_blocks("bardenhagen"), about)["series"].to_dataset().sel(body="left")
        for about in (None, "centre_of_mass", point.tolist())
    )
    force = own["contact_force"].isel(pair=0).values[1:]
    way = own["centre_of_mass"].values[:-1] - point
    shift = way[:, 0] * force[:, 1] - way[:, 1] * force[:, 0]
    moved = (other["contact_moment"] - own["contact_moment"]).values[1:, 0]
    np.testing.assert_allclose(moved, shift, rtol=0.0, atol=1e-9 * np.abs(shift).max())
    assert "contact_moment" not in plain
    for name in plain.data_vars:
        np.testing.assert_array_equal(own[name].values, plain[name].values, err_msg=str(name))


def test_mean_over_an_interval_is_the_mean_of_its_steps():
    every = recorded(two_blocks("bardenhagen"), "centre_of_mass")["series"]["contact_moment"].values
    scene = {**two_blocks("bardenhagen"), "output": {"contact_moment": "centre_of_mass"}}
    scene["time"] = {"end": 6e-3, "step": 5e-4, "output_interval": 3e-3}
    fifth = mpmfw.run(scene)["series"]["contact_moment"].values
    assert (fifth[0] == 0.0).all()
    np.testing.assert_allclose(fifth[1], every[1:7].mean(axis=0), rtol=1e-9)
    np.testing.assert_allclose(fifth[2], every[7:13].mean(axis=0), rtol=1e-9)


def test_a_point_of_the_wrong_dimension_is_refused():
    with pytest.raises(SceneError, match=r"output\.contact_moment.*2"):
        recorded(two_blocks("penalty"), [0.0, 0.0, 0.0])


def pass_nodes_left(method, from_x=-0.4, **still):
    """Let a body come upon nodes that another has left below, from a place on; return its simulation and the
    momentum that it gained."""
    bodies = {
        "still": solid([-0.5, 0.0], [0.5, 0.5], 0.125, **still),
        "comes": solid([-0.5, -1.75], [0.5, -1.25], 0.125, velocity=[0.0, 5.0]),
    }
    scene = scene_of(bodies, 0.25, [-2.0, -3.0], [2.0, 2.0], end=0.2, contact={"method": method})
    simulation = Simulation(load_scene(scene))
    simulation.start()
    surface, particles = simulation.state.surface, simulation.state.particles
    own = surface.position[surface.of(0)]
    low = (own[:, 1] < 1e-9) & (own[:, 0] > from_x) & (own[:, 0] < 0.4)
    own[low, 1] -= 1.24
    start = particles.mass @ particles.velocity
    simulation.registry.plugins["verdict"].diagnostics(simulation.state, 0.0)
    while simulation.state.time < 0.17:
        simulation.step()
    return simulation, particles.mass @ particles.velocity - start


@pytest.mark.parametrize("method", ["penalty", "lcp", "midplane"])
def test_bodies_pass_nodes_that_have_left_their_points(method):
    """Nothing would take the opposite force, so the momentum stays; and the bodies have not crossed."""
    simulation, gained = pass_nodes_left(method)
    np.testing.assert_allclose(gained, 0.0, atol=1e-6)
    state, gap = simulation.state, simulation.registry.plugins["gap"]
    np.testing.assert_allclose(gap.diagnostics(state)["min_gap"], 1.25 - 5.0 * state.time, rtol=1e-6)
    assert simulation.status == "ok"


def test_a_body_of_which_all_nodes_have_left_their_points_stays():
    simulation = Simulation(load_scene(two_blocks("penalty")))
    simulation.advance(1)
    surface = simulation.state.surface
    surface.table.weight[: surface.table.row[surface.body_first[1]]] = 0.0
    assert nodes_left(surface).sum() == surface.body_first[1]
    np.testing.assert_array_equal(closed_surface(surface).position, surface.position)


def test_a_force_on_a_side_acts_where_there_are_points():
    force = {"sides": [{"side": "bottom", "force": [0.0, 300.0]}]}
    simulation, gained = pass_nodes_left("penalty", 0.0, **force)
    np.testing.assert_allclose(gained, [0.0, 300.0 * simulation.state.time], rtol=1e-9, atol=1e-6)
