"""Bodies of revolution: uniform states are exact, loads and masses are of the full ring, and what has no
meaning is refused."""

import numpy as np
import pytest
from test_restart import stop_and_go_on

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from mpmfw.state import structs
from mpmfw.step.schemes import add_internal_force, gather_velocity_gradient, interpolate, project
from mpmfw_material.neo_hookean import NeoHookean
from scenes_for_tests import SOFT, scene_of, solid, with_changes

RATE = np.diag([0.7, -0.4, 0.7])
SHAPES = ("cpdi", "cpdi2", "gimp", "linear", "bspline", "cubic_bspline")
#: With domains, by which a uniform pressure is integrated exactly.
WITH_DOMAINS = SHAPES[:3]


def hollow(inner=0.0, size=0.045, **changes):
    """A cylinder of 1 m in wall and height, its points at no place of the cells again and again."""
    body = solid([inner, 0.03], [inner + 1.0, 1.03], size)
    scene = scene_of({"solid": body}, 0.1, [0.0, -0.5], [2.5, 2.0], end=0.02, outputs=2)
    return with_changes(scene, **{"grid__axisymmetric": True, **changes})


def on_plane(inner=0.0, **changes):
    """The cylinder on a rigid plane, falling."""
    plane = {"geometry": {"type": "rectangle", "lower": [-0.5, -0.3], "upper": [1.5, 0.025]}, "rigid": True}
    scene = hollow(inner, bodies__plane=plane, contact={"method": "penalty"}, **changes)
    return with_changes(scene, bodies__solid__velocity=[0.0, -1.0])


def begun(scene):
    """A simulation with the table of its first step and nodes with mass."""
    simulation = Simulation(scene)
    simulation.start()
    state = simulation.state
    phi = interpolate(state, simulation.hook, simulation.clock)
    project(state.particles, phi, state.grid)
    simulation.hook.detect(grid=state.grid, phi=phi, particles=state.particles)
    return simulation, phi


@pytest.mark.parametrize("inner", [0.0, 0.33])
@pytest.mark.parametrize("shape", WITH_DOMAINS)
def test_a_uniform_pressure_is_in_balance_within_a_body(shape, inner):
    simulation, phi = begun(hollow(inner, shape__method=shape))
    p, grid = simulation.state.particles, simulation.state.grid
    p.stress[:], p.in_space.stress[:] = np.eye(2), np.eye(3)
    add_internal_force(p, phi, grid)
    r, y = grid.position.T
    around = 2.0 * np.pi * np.maximum(r, 0.1)[:, None] * 0.1
    inside = (r > (inner + 0.2 if inner else 1e-9)) & (r < inner + 0.75) & (y > 0.25) & (y < 0.85)
    assert inside.sum() > 20
    assert np.abs(grid.force[inside] / around[inside]).max() < 1e-13
    outward = grid.force[r > inner + 0.75, 0].sum()
    assert outward == pytest.approx(-2.0 * np.pi * (inner + 1.0), rel=1e-12)  # the outer side is pulled back


@pytest.mark.parametrize("shape", SHAPES)
def test_a_uniform_rate_is_that_of_every_point(shape):
    simulation, phi = begun(hollow(shape__method=shape))
    p, grid = simulation.state.particles, simulation.state.grid
    grid.velocity[:] = grid.position @ RATE[:2, :2]
    gather_velocity_gradient(p, phi, grid)
    simulation.hook.after_velocity_gradient(particles=p.in_space, grid=grid, phi=phi, dt=1e-3)
    assert np.abs(p.in_space.velocity_gradient - RATE).max() < 1e-12


@pytest.mark.parametrize("scheme", ["usl", "musl", "usf"])
@pytest.mark.parametrize("model", ["neo_hookean", "j2"])
def test_a_uniform_motion_stretches_rings_as_their_radii(scheme, model):
    """F = diag(a, b, a) with a and b from the height of a point; all in one motion keep the axis."""
    more = {} if model == "neo_hookean" else {"yield_stress": 1e12}
    scene = hollow(
        size=0.05, stepping={"scheme": scheme}, materials__soft={**SOFT, "model": model, **more},
        bodies__solid__volumetric="averaged",
    )  # fmt: skip
    simulation = Simulation(scene)
    simulation.start()
    p = simulation.state.particles
    start = p.position.copy()
    p.velocity[:] = p.position @ RATE[:2, :2]
    if p.affine is not None:
        p.affine[:] = RATE[:2, :2]
    simulation.step()
    dt = simulation.state.dt
    stretch = np.eye(3) + dt * RATE
    inner = (start[:, 0] < 0.7) & (start[:, 1] > 0.3) & (start[:, 1] < 0.7)
    assert np.abs(p.in_space.deformation_gradient[inner] - stretch).max() < 1e-3 * dt
    assert np.abs(p.deformation_gradient - p.in_space.deformation_gradient[:, :2, :2]).max() == 0.0
    assert np.allclose(p.position[inner, 0] / start[inner, 0], stretch[2, 2], atol=1e-3 * dt)
    assert np.allclose(p.volume[inner] / p.initial_volume[inner], np.linalg.det(stretch), atol=3e-3 * dt)
    difference = p.in_space.stress[inner, 2, 2] - p.stress[inner, 0, 0]
    assert np.abs(difference).max() < 1e-3 * SOFT["bulk_modulus"] * dt


def test_masses_energies_and_pressure_are_of_the_full_ring():
    scene = hollow(0.33, bodies__solid__sides=[{"side": "left", "pressure": 1e3}], output__ledger=True)
    simulation = Simulation(scene)
    simulation.start()
    p, grid = simulation.state.particles, simulation.state.grid
    volume = np.pi * (1.33**2 - 0.33**2)
    assert p.mass.sum() == pytest.approx(SOFT["density"] * volume, rel=1e-12)
    simulation.advance(1)
    assert grid.force.sum(axis=0) == pytest.approx([1e3 * 2.0 * np.pi * 0.33, 0.0], rel=1e-12, abs=1e-9)
    series = mpmfw.run(scene)["series"].to_dataset()
    gained = float(series["total_energy"][-1].sum()) + float(series["transfer_dissipation"][-1])
    assert gained == pytest.approx(float(series["external_work"][-1]), rel=0.02)
    assert series["linear_momentum"].attrs["units"] == "kg m s-1"


def test_springs_press_with_the_area_of_their_rings():
    scene = on_plane(0.33, bodies__solid__geometry__lower=[0.33, 0.02], allow_overlap=True)
    simulation = Simulation(scene)
    simulation.advance(1)
    rows = simulation.contact.last_rows
    flat = rows.normal[: rows.count, 1] > 0.99
    assert rows.area[: rows.count][flat].sum() == pytest.approx(np.pi * (1.33**2 - 0.33**2), rel=1e-3)


def test_a_grid_node_on_the_axis_has_the_area_of_its_disc():
    scene = on_plane(bodies__solid__geometry__lower=[0.0, 0.0], allow_overlap=True)
    scene["bodies"]["plane"] = {
        **scene["bodies"]["solid"], "velocity": [0.0, 0.0],
        "geometry": {"type": "rectangle", "lower": [0.0, -0.3], "upper": [1.7, 0.01]},
    }  # fmt: skip
    simulation = Simulation(scene, contact="nodes+penalty")
    simulation.advance(1)
    rows = simulation.contact.last_rows
    place = simulation.state.grid.position[rows.dof[rows.start[: rows.count]]]
    area = rows.area[: rows.count][place[:, 0] == 0.0]
    assert area == pytest.approx([2.0 * np.pi * 0.1**2 / 6.0], rel=0.2)


@pytest.mark.parametrize(("rigid", "holds"), [(True, False), ({"density": 1e3}, True)])
def test_free_rigid_bodies_alone_are_held_across_the_axis(rigid, holds):
    plane = {"geometry": {"type": "rectangle", "lower": [0.0, -0.3], "upper": [1.5, 0.0]}, "rigid": rigid}
    bodies = Simulation(with_changes(on_plane(), bodies__plane=plane)).state.rigid
    assert (bodies.holds, hasattr(bodies, "ledger_term")) == (holds, holds)


@pytest.mark.parametrize("form", ["density", "mass"])
def test_a_free_rigid_cylinder_has_the_mass_of_its_ring_and_moves_along_the_axis(form):
    scene = on_plane(gravity={"vector": [0.0, -10.0]}, bodies__solid__sides=[{"side": "top", "fixed": True}])
    scene["bodies"]["plane"] = {
        "geometry": {"type": "rectangle", "lower": [0.2, -0.4], "upper": [0.6, -0.1]},
        "rigid": {form: 100.0},
    }
    del scene["bodies"]["solid"]["velocity"]
    tree = mpmfw.run(scene)
    series = tree["series"].sel(body="plane")
    mass = 100.0 * (np.pi * (0.6**2 - 0.2**2) * 0.3 if form == "density" else 1.0)
    assert series["linear_momentum"].values[-1] == pytest.approx([0.0, -10.0 * mass * 0.02], rel=1e-9)


def test_the_axis_is_kept_and_two_threads_change_no_bit():
    ends = []
    for threads in (1, 2):
        simulation = Simulation(on_plane(size=0.05), threads=threads)
        simulation.start()
        simulation.advance(40)
        p = simulation.state.particles
        ends.append((p.position.copy(), p.in_space.stress.copy()))
    assert all(np.array_equal(a, b) for a, b in zip(*ends, strict=True))
    assert ends[0][0][:, 0].min() > 0.0
    surface = simulation.state.surface
    on_axis = surface.position[: surface.on_grid, 0] < 1e-9
    assert on_axis.sum() > 10
    assert surface.position[: surface.on_grid][on_axis, 0].min() == 0.0


def test_nodes_on_the_axis_alone_are_held(monkeypatch):
    def held(**changes):
        for name, value in changes.items():
            monkeypatch.setattr(structs, name, value)
        simulation, _ = begun(hollow())
        grid = simulation.state.grid
        grid.momentum[:] = 1.0
        simulation.registry.plugins["axisymmetry"].constrain_momentum(grid=grid)
        return set(grid.position[grid.momentum[:, 0] == 0.0, 0].round(9).tolist())

    assert held(ON_AXIS=structs.ON_AXIS) == {0.0}
    assert held(ON_AXIS=1.5) == {0.0, 0.1}


def test_a_saved_run_goes_on_to_the_bit(tmp_path):
    scene = on_plane(materials__soft={**SOFT, "model": "j2", "yield_stress": 1e3}, output__ledger=True)
    stop_and_go_on(lambda: Simulation(scene), tmp_path / "saved", 30)


class OfThePlane(NeoHookean):
    """A material that takes the grid's dimensions for those of F."""

    name = "of_the_plane"

    @mpmfw.api.hookimpl
    def setup(self, setup):
        """Take the plane."""
        super().setup(setup)
        self.constants = (*self.constants[:2], setup.state.grid.spacing)


def test_a_material_without_hoop_stress_is_refused():
    scene = hollow(materials__soft={**SOFT, "model": f"{__name__}:OfThePlane"})
    simulation = Simulation(mpmfw.load_scene(scene))
    simulation.start()
    with pytest.raises(SceneError, match="no stress round the axis"):
        simulation.advance(1)


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"grid__lower": [-0.1, -0.5]}, r"grid\.lower: begins at a negative radius"),
        ({"shape__method": "ck"}, r"shape\.method: 'ck' has no form"),
        ({"sleep": {}}, r"sleep: does not go with"),
        ({"gravity": {"vector": [1.0, -9.0]}}, r"gravity: pulls across the axis"),
        ({"gravity": {"table": [[0.0, 0.0, 0.0], [1.0, 0.5, 0.0]]}}, r"gravity: pulls across"),
        ({"bodies__solid__thickness": 0.5}, r"solid\.thickness"),
        ({"bodies__solid__angular_velocity": 1.0}, r"solid\.angular_velocity"),
        ({"bodies__solid__rotation": "spin"}, r"solid\.rotation"),
        ({"bodies__solid__velocity": [1.0, 0.0]}, r"solid\.velocity: across the axis"),
        ({"bodies__solid__geometry__lower": [-0.1, 0.0], "grid__lower": [0.0, 0.0]}, r"solid\.geometry"),
        ({"output__contact_moment": "centre_of_mass"}, r"output\.contact_moment: has no meaning"),
        ({"output__side_moment": [0.0, 0.0]}, r"output\.side_moment: has no meaning"),
        ({"bodies__plane__rigid": {"density": 1.0}}, r"plane\.geometry: reaches a negative radius"),
        ({"bodies__plane__rigid": {"density": 1.0, "force": [1.0, 2.0]}}, r"rigid\.force: across the axis"),
        ({"bodies__plane__rigid": {"density": 1.0, "held": ["rotation"]}}, r"rigid\.held: has no effect"),
        ({"bodies__plane__rigid": {"density": 1.0, "held": ["y"]}}, r"rigid\.held: holds the whole motion"),
        ({"bodies__plane__rigid": {"mass": 1.0, "inertia": 1.0}}, r"rigid\.inertia: has no effect"),
        (
            {"bodies__solid__sides": [{"side": "left", "velocity": [0.1, "free"]}]},
            r"sides\[0\]\.velocity: 0.1 m/s along x, but the side lies on the axis",
        ),
        ({"bodies__plane__rigid": {"motion": {"velocity": [1.0, 0.0]}}}, r"velocity: across the axis"),
        (
            {"bodies__plane__rigid": {"motion": {"surface_velocity": [1.0, 0.0]}}},
            r"surface_velocity: across the axis",
        ),
        ({"bodies__plane__rigid": {"motion": {"angular_velocity": 1.0}}}, r"plane\.rigid: turns"),
    ],
)
def test_what_has_no_meaning_is_refused(changes, match):
    with pytest.raises(SceneError, match=match):
        mpmfw.load_scene(with_changes(on_plane(), **changes))


def test_space_and_detections_without_a_radius_are_refused():
    with pytest.raises(SceneError, match="is for two dimensions"):
        mpmfw.load_scene(with_changes(hollow(), grid__lower=[0.0] * 3, grid__upper=[2.5] * 3))
    scene = hollow(contact={"method": "points+penalty"})
    scene["bodies"]["other"] = {
        **scene["bodies"]["solid"],
        "geometry": {"type": "rectangle", "lower": [0.0, 1.2], "upper": [1.0, 1.5]},
    }
    with pytest.raises(SceneError, match="no radius of its rows"):
        Simulation(scene)
