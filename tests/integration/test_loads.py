"""Gravity, loads on sides and loads that a scene names, each against a closed form."""

import math

import numpy as np
import pytest

from measures_for_tests import momentum
from mpmfw.api import SurfaceLoad
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from msh_files import write_msh
from scenes_for_tests import DENSITY, SOFT, block, box, disc, one_body, two_blocks

HOOKE = {**SOFT, "model": "linear_elastic"}
STEP = 1e-4  # s


def after(steps, scene):
    """The simulation of a scene after some steps."""
    sim = Simulation(scene)
    sim.start()
    sim.advance(steps)
    return sim


def centre(sim):
    """Centre of mass."""
    p = sim.state.particles
    return np.asarray(p.mass @ p.position / p.mass.sum())


@pytest.mark.parametrize("make", [disc, box])
def test_free_fall_is_exact_for_the_integration_scheme(make):
    g = np.array([1.0, -9.0, 4.0][: 2 if make is disc else 3])
    sim = Simulation(make(gravity={"vector": g.tolist()}, time__step=1e-3))
    sim.start()
    begin = centre(sim)
    sim.advance(100)
    # v after the step moves the points: x = x_0 + g dt² n (n + 1) / 2, exactly
    np.testing.assert_allclose(centre(sim) - begin, g * 1e-6 * 100 * 101 / 2, rtol=1e-10)
    f = sim.state.particles.deformation_gradient
    np.testing.assert_allclose(f, np.broadcast_to(np.eye(len(g)), f.shape), atol=1e-12)


def test_a_fixed_component_leaves_the_other_free():
    scene = block(bodies__solid__sides=[{"side": "bottom", "fixed": ["y"]}], gravity={"vector": [3.0, 0.0]})
    sim = after(40, scene)
    p = sim.state.particles
    np.testing.assert_allclose(p.velocity[:, 0], 3.0 * sim.state.time, rtol=1e-9)
    np.testing.assert_allclose(p.velocity[:, 1], 0.0, atol=1e-9)


# -- sides


ARC = np.linspace(0.0, math.pi, 61)
HALF = np.stack([np.sin(ARC), -np.cos(ARC)], axis=1)
SHELL = {"type": "polygon", "points": [*(0.9 * HALF).tolist(), *(0.6 * HALF[::-1]).tolist()]}
BALL = {"type": "ball", "centre": [0.0, 0.0, 0.0], "radius": 0.9}
RING = {"type": "ring", "centre": [0.0, 0.0], "inner_radius": 0.6, "outer_radius": 0.9}


@pytest.mark.parametrize(
    ("shape", "side", "radius", "area"),
    [
        (RING, "inner", 0.6, 1.2 * math.pi),
        (RING, "outer", 0.9, 1.8 * math.pi),
        (SHELL, "inner", 0.6, 0.6 * math.pi),
        (SHELL, "outer", 0.9, 0.9 * math.pi),
        (BALL, "outer", 0.9, 3.24 * math.pi),
    ],
)
def test_a_load_finds_the_outside_and_the_holes_of_any_body(shape, side, radius, area):
    """A half-plane's shell is one outline, whose arcs end on the axis."""
    scene = one_body(shape, size=0.15, grid__cell_size=0.3)
    scene["bodies"]["solid"]["sides"] = [{"side": side, "pressure": 1.0}]
    if shape is SHELL:
        scene["grid"] |= {"lower": [0.0, -2.0], "axisymmetric": True}
    sim = Simulation(scene)
    (load,) = (plugin for plugin in sim.setup.plugins if isinstance(plugin, SurfaceLoad))
    corners = sim.state.tracked_surface.position[sim.state.tracked_surface.facets[load.facets]]
    np.testing.assert_allclose(np.linalg.norm(corners, axis=2), radius, rtol=2e-2)
    edges = np.diff(corners, axis=1)
    across = edges[:, 0] if shape is not BALL else 0.5 * np.cross(edges[:, 0], edges[:, 1])
    assert np.linalg.norm(across, axis=1).sum() == pytest.approx(area, rel=0.05)


@pytest.mark.parametrize("make", [block, box])
@pytest.mark.parametrize("key", ["traction", "force", "point force"])
def test_a_load_gives_its_impulse_in_any_direction(key, make):
    """The side of 1 m or 1 m² gets t A, so small a load that A does not change; a point the force itself."""
    dim = 2 if make is block else 3
    load = [3.0, -2.0, 1.0][:dim]
    tables = {"bodies__solid__sides": [{"side": "top", key: load}]}
    if key == "point force":
        tables = {"loads__push": {"model": "point_force", "at": [0.2, 0.1, 0.0][:dim], "force": load}}
    found = momentum(after(20, make(materials__soft=HOOKE, time__step=STEP, **tables)))
    np.testing.assert_allclose(found, np.multiply(load, 20 * STEP), rtol=1e-6)


ROOF = [[-1.0, 0.001], [1.0, 0.6]]
HOUSE = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.0], [-0.5, 0.0], [0.0, 0.5]]


def house(folder, dim, within, **load):
    """A body of a file, with a gable roof of 45 degrees, and the loads within two boxes of its outside."""
    path = folder / ("house.msh" if dim == 2 else "house.stl")
    if dim == 2:
        write_msh(
            path, [[*corner, 0.0] for corner in HOUSE], {"quad": [[0, 1, 2, 3]], "triangle": [[3, 2, 4]]}
        )
    else:
        points = [[*corner, z] for corner in HOUSE for z in (-0.5, 0.5)]
        pytest.importorskip("trimesh").PointCloud(points).convex_hull.export(path)
    geometry = {"type": "mesh" if dim == 2 else "surface_mesh", "path": str(path)}
    boxes = [[[*corner, z][:dim] for corner, z in zip(box, (-0.49, 0.49), strict=True)] for box in within]
    sides = [{"side": "outer", "within": box, **load} for box in boxes]
    return one_body(geometry, size=0.125, bodies__solid__sides=sides, materials__soft=HOOKE, time__step=STEP)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_load_acts_on_a_region_of_a_files_surface(tmp_path, dim):
    """One slope of a roof, of √½ m or m² and n = (1, 1)/√2; both slopes keep the balance along x."""
    right, left = [[0.0, 0.001], [1.0, 0.6]], [[-1.0, 0.001], [0.0, 0.6]]
    for within, exact in (([right], [-0.5, -0.5]), ([right, left], [0.0, -1.0]), ([ROOF], [0.0, -1.0])):
        found = momentum(after(20, house(tmp_path, dim, within, pressure=1.0)))
        np.testing.assert_allclose(found[:2], np.multiply(exact, 20 * STEP), rtol=1e-5, atol=1e-8)
    found = momentum(after(20, house(tmp_path, dim, [right], force=[3.0, -2.0, 1.0][:dim])))
    np.testing.assert_allclose(found, np.multiply([3.0, -2.0, 1.0][:dim], 20 * STEP), rtol=1e-6)


@pytest.mark.parametrize(
    ("side", "message"),
    [
        ({"fixed": True}, r"sides\[0\].within: expected a load"),
        ({"pressure": 1.0, "within": [[1.0, 0.0], [0.0, 1.0]]}, "first corner must be below the second"),
        ({"pressure": 1.0, "within": [[1.0, 0.0, 0.0], [2.0, 1.0]]}, r"within: has 3 entries; expected 2"),
        ({"traction": [1, 2, 3]}, r"traction: has 3 entries; expected 2"),
        ({"pressure": 1, "traction": [1, 0]}, "has pressure and traction; expected exactly one of"),
        (
            {"pressure": 1.0, "within": [[3.0, 3.0], [4.0, 4.0]]},
            "no surface facet lies on the side top",
        ),
    ],
)
def test_loads_on_a_side_without_sense_are_refused(side, message):
    with pytest.raises(SceneError, match=message):
        Simulation(block(bodies__solid__sides=[{"side": "top", "within": ROOF, **side}]))


ROWS = [[1e-3, 0.0, 0.0], [2e-3, 4.0, 2.0]]


@pytest.mark.parametrize(
    "tables",
    [
        {"bodies__solid__sides": [{"side": "right", "traction": ROWS}]},
        {"bodies__solid__sides": [{"side": "left", "pressure": [row[:2] for row in ROWS]}]},
        {"loads": {"push": {"model": "point_force", "at": [0, 0], "force": ROWS}}},
    ],
    ids=["traction", "pressure", "point force"],
)
def test_loads_in_time_are_linear_in_between_and_constant_outside(tables):
    # From the start of every step: 0 to 1 ms, the sum of 1 … 9 tenths to 2 ms, then 20 steps of the whole
    exact = np.array([4.0, 2.0]) * (0.1 * sum(range(10)) + 20) * STEP
    found = momentum(after(40, block(time__step=STEP, **tables)))
    np.testing.assert_allclose(found[0], exact[0], rtol=1e-6)
    assert "pressure" in str(tables) or found[1] == pytest.approx(exact[1], rel=1e-6)


# -- loads by name


@pytest.mark.parametrize("at", [[0.31, -0.17], [0.5, 0.5]])
def test_a_point_force_has_its_moment(at):
    """One step gives L = Δt x × F, at a corner as well: the force acts at the place that was asked for."""
    load = {"model": "point_force", "at": at, "force": [3.0, -2.0]}
    sim = after(1, block(loads={"push": load}, time__step=STEP, bodies__solid__rotation="lumped"))
    grid, x = sim.state.grid, sim.state.grid.position
    nodal = grid.mass[:, None] * (grid.velocity - grid.start_velocity)
    moment = float((x[:, 0] * nodal[:, 1] - x[:, 1] * nodal[:, 0]).sum())
    assert moment == pytest.approx(STEP * (at[0] * -2.0 - at[1] * 3.0), abs=1e-12)


def test_a_body_force_goes_with_the_undeformed_volume_and_that_of_rho_g_is_gravity():
    weight = {"weight": {"model": "body_force", "force": [0.0, -10.0 * DENSITY]}}
    sim = Simulation(block(loads=weight, time__step=STEP))
    sim.start()
    sim.state.particles.volume *= 3.0
    sim.step(STEP)
    by_gravity = after(1, block(gravity={"vector": [0.0, -10.0]}, time__step=STEP))
    np.testing.assert_allclose(momentum(sim), momentum(by_gravity), rtol=1e-10, atol=1e-12)


def test_drag_lets_the_velocity_decay_towards_the_medium():
    """v = u + (v_0 − u) exp(−c t), first order in Δt; so fast a decay limits the step."""
    load = {"model": "drag", "rate": 20.0, "medium": [1.0, 0.0]}
    sim = after(500, block(loads={"air": load}, bodies__solid__velocity=[0.0, 2.0], time__step=STEP))
    decay = math.exp(-20.0 * 0.05)
    velocity = momentum(sim) / sim.state.particles.mass.sum()
    np.testing.assert_allclose(velocity, [1.0 - decay, 2.0 * decay], rtol=2 * 20.0 * STEP)
    assert (2e-6, "drag") in after(0, block(loads={"air": {"model": "drag", "rate": 1e6}})).limits()


DRAG = {"model": "drag", "rate": 1.0}
PUSH = {"model": "point_force", "at": [0, 0], "force": [1, 0]}


@pytest.mark.parametrize(
    ("load", "said"),
    [
        ({**DRAG, "bodies": ["lft"]}, r"a\.bodies\[0\]: no such body: 'lft' is unknown; did you mean 'left'"),
        ({**DRAG, "bodies": ["left", "left"]}, r"a\.bodies\[1\]: names 'left' twice"),
        ({**DRAG, "medium": [1, 2, 3]}, r"a\.medium: has 3 entries; expected 2"),
        ({**PUSH, "bodies": ["left"], "at": [9, 0]}, r"a\.at: the nearest material point is .* cells away"),
        (PUSH, r"a\.bodies: a point force acts on one body, not on left, right"),
    ],
)
def test_a_load_that_cannot_be_meant_is_refused(load, said):
    with pytest.raises(SceneError, match=rf"loads\.{said}"):
        Simulation(two_blocks("penalty", loads={"a": load}))
