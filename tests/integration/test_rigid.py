"""Rigid bodies: at rest, moved as prescribed, or free, under contacts on surfaces and at nodes."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_restart import stop_and_go_on

import mpmfw
from mpmfw.contact import rigid_nodes, strategy
from mpmfw.effects import rigid_kinematics, rigid_motion
from mpmfw.errors import SceneError, SimulationError
from mpmfw.runs.simulation import Simulation
from mpmfw.state.surface import moments_of
from scenes_for_tests import SOFT, scene_of, with_changes

BLOCK = {"type": "rectangle", "lower": [0.0, -0.5], "upper": [2.0, 0.3]}
DISC = {"type": "disc", "centre": [1.1, 0.75], "radius": 0.4}
FREE = {
    "geometry": DISC, "segment": 0.05, "rigid": {"density": 1000.0},
    "velocity": [1.0, -2.0], "angular_velocity": 3.0,
}  # fmt: skip
#: Contacts on surfaces and at nodes, of forces and of impulses.
CONTACTS = {
    "penalty": {}, "lcp": {}, "impulse": {}, "hybrid": {}, "midplane": {}, "barrier": {}, "nairn": {},
    "bardenhagen": {"criterion": "position", "largest_strain": 0.5, "traction": True},
}  # fmt: skip


def drop(body, method="penalty", **changes):
    """A rigid disc over a floating block of rubber."""
    block = {"material": "soft", "geometry": BLOCK, "particles": {"size": 0.1}}
    scene = scene_of(
        {"disc": body, "block": block},
        *(0.1, [-1.0, -1.5], [3.0, 2.5]),
        end=0.1,
        outputs=10,
        contact={"method": method, "friction": 0.3, method: CONTACTS.get(method, {})},
        materials={"soft": {**SOFT, "bulk_modulus": 1e6, "shear_modulus": 5e5}},
        output={"particles": False, "surface": False},
    )
    return with_changes(scene, **changes)


def series_of(scene):
    """Series of a run, the rigid body's by their last index."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mpmfw.errors.ResultsWarning)
        return mpmfw.run(scene)["series"]


@pytest.mark.parametrize("method", CONTACTS)
def test_a_free_disc_and_a_block_keep_their_momentum(method):
    """And the reaction is what changes the disc's momentum, spin and energy."""
    series = series_of(drop(FREE, method, output__contact_moment=[0.0, 0.0]))
    p, moment = series["linear_momentum"].values, series["contact_moment"].values
    brought = np.abs(p[:, 1] - p[0, 1]).max()
    assert brought > 100.0
    assert np.abs(p.sum(axis=1) - p[0].sum(axis=0)).max() < 1e-12 * brought
    assert np.abs(moment.sum(axis=1)).max() < 1e-12 * np.abs(moment).max()
    interval = np.diff(series["time"].values, prepend=0.0)[:, np.newaxis]
    for name, cause in (("linear_momentum", "reaction"), ("angular_momentum", "reaction_moment")):
        change = series[name].values[:, 1] - series[name].values[0, 1]
        given = np.cumsum(interval * series[cause].values[:, 1], axis=0)
        assert np.abs(given - change).max() < 1e-10 * np.abs(change).max()
    energy = series["kinetic_energy"].values[:, 1]
    assert series["reaction_work"].values[-1, 1] == pytest.approx(energy[-1] - energy[0], rel=1e-9)
    assert np.isnan(series["reaction"].values[:, 0]).all()


DRIVEN = {
    "velocity": [[0.0, 0.0, 0.0], [0.05, 0.0, -0.8], [0.1, 0.4, -0.4]],
    "angular_velocity": [[0.0, 0.0], [0.1, 3.0]],
    "about": [1.1, 0.3],
}


def test_a_body_without_points_loses_nothing_to_damping():
    damping = {"bulk": 1e-3, "shear": 1e-3}
    series = series_of(drop(FREE, materials__soft__damping=damping, output__ledger=True))
    lost = series["viscous_dissipation"].sel(body=["block", "disc"]).isel(time=-1).values
    assert lost[0] > 0.0
    assert lost[1] == 0.0


def driven(method, **changes):
    """A disc that is driven into the block, whose bottom is held."""
    held = [{"side": "bottom", "fixed": True}]
    disc = {"geometry": {**DISC, "centre": [1.1, 0.7]}, "segment": 0.05, "rigid": {"motion": DRIVEN}}
    return drop(disc, method, bodies__block__sides=held, output__ledger=True, **changes)


@pytest.mark.parametrize("method", ["penalty", "lcp", "bardenhagen"])
def test_a_driven_body_moves_as_the_table_says_and_its_work_is_that_of_the_ledger(method):
    series = series_of(driven(method))
    centre, turn = series["centre_of_mass"].values[-1, 1], 0.15
    about = np.array([1.11, 0.25])
    assert centre == pytest.approx(about + 0.4 * np.array([-np.sin(turn), np.cos(turn)]), abs=1e-4)
    assert series["mean_velocity"].values[-1, 1] == pytest.approx(
        [0.4 - 3.0 * 0.4 * np.cos(turn), -0.4 - 3.0 * 0.4 * np.sin(turn)], abs=0.02
    )
    work = -float(series["reaction_work"].values[-1, 1])
    assert work > 100.0
    assert float(series["external_work"].values[-1]) == pytest.approx(work, rel=1e-3)
    assert abs(float(series["energy_residual"].values[-1])) < 0.04 * work
    if method == "penalty":
        assert abs(float(series["contact_residual"].values[-1])) < 0.02 * work


PRESSED = {"density": 1e3, "held": ["x"], "force": [[0.0, 0.0, 0.0], [0.1, 0.0, -5e3]], "torque": 5.0}
BELT = {"bodies__disc__rigid__motion__surface_velocity": [[0.0, 1.0, 0.0], [0.1, 0.0, 0.0]]}


@pytest.mark.parametrize(
    "scene",
    [
        *(drop(FREE, "lcp"), driven("penalty"), drop(FREE, "bardenhagen")),
        *(drop({**FREE, "rigid": PRESSED}), driven("penalty", **BELT)),
    ],
)
def test_a_run_that_was_saved_goes_on_to_the_bit(scene, tmp_path):
    stop_and_go_on(lambda: Simulation(scene), tmp_path / "saved", 20)


BALL = {"type": "ball", "centre": [0.0, 0.0, 0.3], "radius": 0.3}
SLAB = {"type": "box", "lower": [-2.0, -2.0, -0.3], "upper": [2.0, 2.0, 0.0]}
CUBE = {"type": "box", "lower": [-0.1, -0.2, 0.62], "upper": [0.2, 0.1, 0.92]}


@pytest.mark.parametrize("method", ["penalty", "bardenhagen", "lcp"])
def test_in_space_a_cube_falls_on_a_ball_on_a_slab_beyond_the_grid(method):
    scene = drop({"geometry": SLAB, "rigid": True, "segment": 0.5}, method)
    scene["grid"] |= {"lower": [-0.8, -0.8, -0.5], "upper": [0.8, 0.8, 1.6]}
    rubber = {"material": "soft", "geometry": BALL, "particles": {"size": 0.1}}
    motion = {"velocity": [0.3, 0.0, -2.0], "angular_velocity": [1.0, 0.0, 2.0]}
    cube = {"geometry": CUBE, "segment": 0.1, "rigid": {"motion": motion}}
    if method == "lcp":
        cube |= {"rigid": {"density": 1000.0}, **motion}
    scene["bodies"] = {"slab": scene["bodies"]["disc"], "cube": cube, "ball": rubber}
    series = series_of(with_changes(scene, time={"end": 0.04, "output_interval": 0.01}))
    assert list(series["body"].values) == ["ball", "slab", "cube"]
    p, reaction = series["linear_momentum"].values, series["reaction"].values
    given = 0.01 * reaction[:, 1:].sum(axis=(0, 1))
    assert np.abs(p[-1, 0] - p[0, 0] + given).max() < 1e-12 * np.abs(given).max()
    assert reaction[-1, 2, 2] > 0.0 > reaction[-1, 1, 2]


def test_a_free_top_keeps_energy_and_angular_momentum_over_a_hundred_turns():
    """Its step alone is taken: nothing touches it. Axes that are not made orthogonal again err by 1e-7."""
    far = {"type": "box", "lower": [-0.7, -0.7, -0.7], "upper": [-0.5, -0.5, -0.5]}
    top = {"type": "box", "lower": [-0.1, -0.2, -0.1], "upper": [0.2, 0.3, 0.1]}
    spin = {"rigid": {"density": 1000.0}, "angular_velocity": [1.0, 20.0, 2.0], "segment": 0.5}
    scene = drop({"geometry": top, **spin}, "lcp", grid__lower=[-1.0] * 3, grid__upper=[1.0] * 3)
    scene["bodies"]["block"]["geometry"] = far
    bodies = Simulation(scene).state.rigid
    assert bodies.spread[0] == pytest.approx(1000.0 * 0.03 / 12.0 * np.array([0.2, 0.3, 0.5]) ** 2)
    energy, moment = bodies.kinetic_energy.copy(), bodies.moment.copy()
    begin, rate = bodies.turn[0].copy(), bodies.spin[0] @ bodies.turn[0]
    bodies._turn(1e-6)
    assert bodies.turn[0] - begin == pytest.approx(1e-6 * rate, abs=1e-9)
    for _ in range(3_000):
        bodies._turn(100 * 2.0 * np.pi / 20.0 / 3_000)
    assert bodies.kinetic_energy == pytest.approx(energy, rel=1e-11)
    assert np.abs(bodies.moment - moment).max() < 1e-11 * np.abs(moment).max()
    assert rigid_motion.ITERATIONS > 20  # five are used


@settings(max_examples=20, deadline=None)
@given(st.tuples(*[st.floats(-3.0, 3.0)] * 3), st.tuples(*[st.floats(-5.0, 5.0)] * 3), st.floats(0.1, 3.0))
def test_turned_and_moved_a_body_moves_as_before(angles, place, length):
    """Velocities are affine in those of the points of mass, and energy does not depend on the axes."""
    nodes = np.array([[0.0, 0, 0], [length, 0, 0], [0, 1, 0], [0, 0, 2]])
    facets = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    turn = rigid_kinematics.rotations(rigid_kinematics.matrix_of(angles, 3)[np.newaxis])[0]
    volume, centre, second = moments_of((nodes,), (facets,))
    turned = moments_of((nodes @ turn.T + place,), (facets,))
    assert volume == pytest.approx(length / 3.0, rel=1e-12)
    assert turned[0] == pytest.approx(volume, rel=1e-9)
    assert turned[1] == pytest.approx(turn @ centre + place, abs=1e-9)
    assert turned[2] == pytest.approx(turn @ second @ turn.T, abs=1e-9)
    assert np.allclose(turn @ turn.T, np.eye(3), atol=1e-14)
    corners = rigid_kinematics.simplex(3)
    assert corners.T @ corners == pytest.approx(4.0 * np.eye(3))


def test_the_centroid_is_that_of_the_area_not_of_the_nodes():
    nodes = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 3.0], [0.0, 2.0], [0.0, 1.0]])
    facets = np.array([[0, 1], [1, 2], [2, 3], [3, 4], [4, 0]])
    volume, centre, _ = moments_of((nodes,), (facets,))
    assert volume == pytest.approx(4.5, rel=1e-14)
    assert centre == pytest.approx([1.0, 1.0], rel=1e-14)


@pytest.mark.parametrize(
    ("outline", "second"),
    [
        ({"type": "rectangle", "lower": [1.0, 1.0], "upper": [1.6, 1.2]},
         [0.6 * 0.2**3 / 12, 0.2 * 0.6**3 / 12]),
        ({"type": "disc", "centre": [1.0, 1.0], "radius": 0.4}, [np.pi * 0.4**4 / 4] * 2),
        ({"type": "ring", "centre": [1.0, 1.0], "inner_radius": 0.2, "outer_radius": 0.4},
         [np.pi * (0.4**4 - 0.2**4) / 4] * 2),
    ],
)  # fmt: skip
def test_the_inertia_of_a_density_is_that_of_the_area(outline, second):
    """∫ x² dA about the centroid, of the polygon that the surface is."""
    body = {"geometry": outline, "segment": 0.01, "rigid": {"density": 1e3}}
    assert Simulation(drop(body)).state.rigid.spread[0] == pytest.approx(1e3 * np.array(second), rel=1e-3)


def test_mass_and_inertia_are_as_given():
    scene = drop({**FREE, "rigid": {"mass": 3.0, "inertia": 0.2}})
    bodies = Simulation(scene).state.rigid
    assert bodies.mass == pytest.approx([3.0])
    assert bodies.kinetic_energy == pytest.approx([0.5 * 3.0 * 5.0 + 0.5 * 0.2 * 9.0])


def test_two_bodies_whose_motion_is_prescribed_are_no_pair():
    scene = drop({"geometry": {**BLOCK, "lower": [-9.0, -1.0]}, "rigid": True}, allow_overlap=True)
    scene["bodies"]["wall"] = {"geometry": {**DISC, "radius": 0.2}, "rigid": True}
    assert [pair.label for pair in Simulation(scene).state.pairs] == ["block-disc", "block-wall"]
    scene["bodies"]["wall"] = {**FREE, "geometry": {**DISC, "centre": [1.1, 1.7]}}
    assert [pair.label for pair in Simulation(scene).state.pairs] == ["block-disc", "block-wall"]
    lcp = Simulation({**scene, "contact": {"method": "lcp"}}).state
    assert [pair.label for pair in lcp.pairs] == ["block-disc", "block-wall", "disc-wall"]


@pytest.mark.parametrize("dim", [2, 3])
def test_walls_of_a_box_may_overlap_and_nothing_else(dim):
    """Half-spaces meet behind every corner; motions that are prescribed need no contact."""
    kind, here = ("rectangle", [0.4] * 2) if dim == 2 else ("box", [0.4] * 3)
    bodies = {"cube": {"material": "soft", "geometry": {"type": kind, "lower": [0.0] * dim, "upper": here},
                       "particles": {"size": 0.1}}}  # fmt: skip
    for axis in range(dim):
        plane = {"type": "half_space", "point": [0.0] * dim, "normal": np.eye(dim)[axis].tolist()}
        bodies[f"wall{axis}"] = {"geometry": plane, "rigid": True}
    scene = scene_of(bodies, 0.2, [-1.0] * dim, [1.0] * dim, end=0.1, materials={"soft": SOFT})
    scene["contact"] = {"method": "penalty"}
    assert len(Simulation(scene).state.pairs) == dim
    bodies["wall0"]["geometry"]["point"] = [0.1] * dim
    with pytest.raises(SceneError, match=r"bodies\.cube: overlaps body 'wall0'"):
        Simulation(scene)
    bodies["free"] = {"geometry": bodies["cube"]["geometry"], "rigid": {"density": 1000.0}}
    bodies["cube"]["geometry"] = {"type": kind, "lower": [0.5] * dim, "upper": [0.8] * dim}
    with pytest.raises(SceneError, match="overlaps body 'free'"):
        Simulation(scene)


@pytest.mark.parametrize("method", ["penalty", "midplane", "bardenhagen"])
def test_rigid_bodies_that_no_force_keeps_apart_end_the_run_where_they_touch(method):
    scene = drop({**FREE, "geometry": {**DISC, "centre": [1.1, 1.5]}}, method)
    scene["bodies"]["wall"] = {**FREE, "geometry": {**DISC, "centre": [1.1, 2.34]}, "velocity": [1.0, -4.0]}
    message = (
        f"the rigid bodies '.*' and '.*' touch, and contact '{method}.*' has no force between them.*0.02"
    )
    with pytest.raises(SimulationError, match=message):
        Simulation(scene).run()


def test_a_node_counts_as_near_up_to_a_cell_from_a_rigid_surface():
    """At a whole cell it would have no mass of a body at the surface, and rounding decide."""
    assert 0.99 < rigid_nodes.NEAR < 1.0


def test_a_rigid_body_counts_as_stiffer_than_any_other():
    """With its infinite modulus differences of two would be no number."""
    scene = drop(FREE, "lcp")
    scene["bodies"]["other"] = {**FREE, "geometry": {**DISC, "centre": [1.1, 1.7]}}
    assert strategy.stiffness_ranks(Simulation(scene).state.bodies).tolist() == [0, 1, 1]
    assert strategy.STIFFEST > 1e30


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"material": "soft"}, "material: does not apply to a rigid body"),
        ({"rigid": False}, "false is a boolean; expected true, or a table"),
        ({"rigid": {}}, "has no key; expected exactly one of: motion, density, mass and inertia, or rigid"),
        ({"rigid": {"mass": 1.0}}, "has mass; expected exactly one of"),
        ({"rigid": True}, "velocity: has no effect: the body is at rest; expected rigid.motion.velocity"),
        ({"rigid": {"motion": {}}}, "motion: moves nothing; expected velocity, angular_velocity or surf"),
        ({"rigid": {"motion": {"velocity": [1, 2, 3]}}}, r"has 3 entries; expected 2"),
        ({"rigid": {"motion": {"angular_velocity": [1, 2, 3]}}}, r"expected a number in rad/s"),
        ({"rigid": {"motion": {"about": [0, 0, 0], "velocity": [1, 0]}}}, "has 3 entries; expected 2"),
        ({"rigid": {"motion": {"surface_velocity": [1, 2, 3]}}}, "has 3 entries; expected 2"),
        ({"rigid": {"density": 1.0, "force": [1, 2, 3]}}, "has 3 entries; expected 2"),
        ({"rigid": {"mass": 1.0, "inertia": [1.0, 1.0, 1.0]}}, r"expected a number in kg m\^2"),
        ({"rigid": {"density": 1.0, "held": ["z"]}}, "'z' is a component in 3D; expected x, y or rotation"),
        ({"rigid": {"density": 1.0, "held": ["x", "x"]}}, "names a component twice"),
        ({"rigid": {"density": 1.0, "held": ["rotation-x"]}}, "'rotation-x' is a component in 3D; expected"),
        ({"rigid": {"density": 1.0, "held": ["x", "y", "rotation"]}}, "holds the whole motion; expected"),
        ({"rigid": {"held": ["x"], "motion": {"velocity": [1, 0]}}}, "held: has no effect: rigid.motion"),
        ({"rigid": {"density": 1.0, "torque": [[0, 1], [0, 2]]}}, "times must increase"),
        ({"rigid": {"force": [1, 2]}}, "has force, and no mass; expected density, or mass and inertia"),
        ({"rigid": {"density": 1.0, "held": ["x"], "force": [1, 2]}}, r"rigid\.force: has no effect along x"),
        (
            {"rigid": {"density": 1.0, "held": ["y"], "force": [[0, 0, 0], [1, 0, 2]]}},
            r"rigid\.force: has no effect along y, which is held",
        ),
        ({"rigid": {"density": 1.0, "held": ["rotation"], "torque": 5.0}}, r"rigid\.torque: has no effect"),
    ],
)  # fmt: skip
def test_what_does_not_apply_is_refused(changes, message):
    with pytest.raises(SceneError, match=message):
        mpmfw.load_scene(drop({**FREE, **changes}))


def in_space(inertia):
    """A plate that falls on a slab of rubber."""
    plate = {"type": "box", "lower": [-0.3, -0.3, 0.02], "upper": [0.3, 0.3, 0.1]}
    free = {"rigid": {"mass": 30.0, "inertia": inertia}, "angular_velocity": [3.0, 0.0, 1.0], "segment": 0.3}
    grid = {"grid__lower": [-0.6, -0.6, -0.6], "grid__upper": [0.6, 0.6, 0.6]}
    scene = drop({"geometry": plate, **free}, **grid, time={"end": 0.02, "output_interval": 0.02})
    block = {"type": "box", "lower": [-0.4, -0.4, -0.3], "upper": [0.4, 0.4, 0.0]}
    scene["bodies"]["block"] |= {"geometry": block, "particles": {"size": 0.1}}
    return with_changes(scene, bodies__disc__velocity=[0.0, 0.0, -2.0])


def test_a_plate_without_thickness_keeps_its_energy_and_meets_others():
    """Its largest inertia is the sum of the others, so that it has no mass along its normal."""
    bodies = Simulation(in_space([0.9, 0.9, 1.8])).state.rigid
    energy, moment = bodies.kinetic_energy.copy(), bodies.moment.copy()
    assert energy == pytest.approx([0.5 * (30.0 * 4.0 + 0.9 * 9.0 + 1.8 * 1.0)])
    for _ in range(1_000):
        bodies._turn(2.0 * np.pi / 1_000)
    assert bodies.kinetic_energy == pytest.approx(energy, rel=1e-6)
    assert np.abs(bodies.moment - moment).max() < 1e-6 * np.abs(moment).max()
    series = series_of(in_space([0.9, 0.9, 1.8]))
    force, other = (
        each["reaction"].values[-1, 1] for each in (series, series_of(in_space([0.9, 0.9, 1.799])))
    )
    assert force[2] > 100.0
    assert force == pytest.approx(other, abs=0.02 * force[2])
    p = series["linear_momentum"].values
    assert np.abs(p.sum(axis=1) - p[0].sum(axis=0)).max() < 1e-10 * np.abs(p).max()


def test_no_body_has_an_inertia_beyond_the_sum_of_the_others():
    with pytest.raises(SceneError, match=r"rigid\.inertia: 5 kg m\^2 exceeds the other two.*at most 2"):
        mpmfw.load_scene(in_space([1.0, 5.0, 1.0]))


def test_what_counts_as_a_plate_without_thickness():
    """A share that rounding of the inertia may make, and far below that of a sheet of a hundredth."""
    assert 1e-14 < rigid_motion.FLAT < 1e-3 * 0.01**2


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"contact": {"method": "none"}}, "needs a contact that gives every body a velocity field"),
        ({"contact": {"method": "particles"}}, "finds material points, of which a rigid body has none"),
        ({"sleep": {}}, "sleep: does not go with rigid bodies"),
        ({"bodies": {"disc": FREE}}, "every body is rigid; expected one that deforms"),
        (
            {"contact": {"method": "penalty", "penalty": {"passes": "one", "master": "block"}}},
            "'block' touches rigid bodies alone, which are always master",
        ),
        (
            {
                "bodies": drop({"geometry": DISC, "rigid": True})["bodies"],
                "loads": {"air": {"model": "drag", "bodies": ["disc"], "rate": 1.0}},
            },
            "'disc' is rigid, and does not move by forces",
        ),
    ],
)
def test_what_cannot_meet_a_rigid_body_is_refused(changes, message):
    with pytest.raises(SceneError, match=message):
        Simulation({**drop(FREE), **changes})
