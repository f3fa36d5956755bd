"""Half-spaces as rigid walls and floors, turned any way."""

import numpy as np
import pytest
from test_rigid import BALL, drop, series_of
from test_rigid_control import box

import mpmfw
from mpmfw.contact.rigid_nodes import RigidSurfaces
from mpmfw.effects.rigid_kinematics import rotations
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import with_changes


def wall(point, normal, **own):
    return {"geometry": {"type": "half_space", "point": point, "normal": normal}, "rigid": True, **own}


@pytest.mark.parametrize(
    ("method", "angle"),
    [("penalty", 2.0), ("midplane", 0.35), ("bardenhagen", 0.35)],
)
def test_a_block_slides_down_a_half_space(method, angle):
    """(g_t − μ g_n) t² / 2 along it."""
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    scene = drop(wall(along.tolist(), (2.0 * across).tolist()), method, contact__friction=0.2)
    scene["bodies"]["block"] |= {"geometry": box([0.0, 0.0], [0.4, 0.2], angle), "particles": {"size": 0.05}}
    scene["materials"]["soft"] |= {"bulk_modulus": 4e6, "shear_modulus": 2e6}
    scene["gravity"] = {"vector": (5.0 * along - 8.66 * across).tolist()}
    scene["settle"] = {"gravity": {"vector": (-8.66 * across).tolist()}}
    series = series_of(scene)
    way = (series["centre_of_mass"].values[-1, 0] - series["centre_of_mass"].values[0, 0]) @ along
    assert way == pytest.approx(0.5 * (5.0 - 0.2 * 8.66) * 0.1**2, rel=0.02)
    assert series["centre_of_mass"].values[-1, 1] == pytest.approx(along)


@pytest.mark.parametrize(
    ("point", "normal", "changes"),
    [
        ([510.0, -0.5], [0.0, 1.0], {}),
        ([-300.0, -400.5], [-4.0, 3.0], {}),
        ([1.0, -0.5], [0.0, 1.0], {"geometry__extent": 0.2}),
        ([1.0, -0.5], [0.0, 1.0], {"geometry__extent": 4.0, "rigid__motion__velocity": [900.0, 0.0]}),
        ([9.0, -0.5], [0.0, 1.0], {"geometry__extent": 4.0, "rigid__motion__angular_velocity": 0.5}),
        ([1.0, 1e4], [0.0, -1.0], {}),
    ],
)
def test_the_face_covers_the_grid_throughout_the_run(point, normal, changes):
    """Distances over the grid are those of the plane, at the start and when the half-space has moved."""
    motion = {"rigid": {"motion": {"velocity": [0.0, 0.0]}}}
    simulation = Simulation(drop(with_changes(wall(point, normal, **motion), **changes), allow_overlap=True))
    state, bodies = simulation.state, simulation.state.rigid
    bodies.moves = True
    x = np.stack(np.meshgrid([-1.0, 1.0, 3.0], [-1.5, 0.0, 2.5]), axis=-1).reshape(-1, 2)
    end = simulation.scene.time.end
    for time in (0.0, end):
        turn = rotations(time * bodies.spin)[0]
        place = bodies.centre[0] + time * bodies.velocity[0] + bodies.place @ turn.T
        state.tracked_surface.position[-len(place) :] = place
        distance, _ = RigidSurfaces(state).measure(x, state.tracked_surface.facets_of(1))
        across = turn @ normal / np.linalg.norm(normal)
        assert distance == pytest.approx((x - point - time * bodies.velocity[0]) @ across, abs=1e-8)


def test_in_space_a_ball_bounces_off_along_the_normal():
    """Without friction; distances are those of the plane."""
    normal = np.array([1.0, 2.0, 2.0]) / 3.0
    scene = drop(wall((-0.31 * normal).tolist(), normal.tolist()), "penalty", contact__friction=0.0)
    ball = {**BALL, "centre": [0.0] * 3}
    scene["bodies"]["block"] |= {"geometry": ball, "velocity": (-2.0 * normal).tolist()}
    scene["grid"] = {"cell_size": 0.1, "lower": [-0.8] * 3, "upper": [0.8] * 3}
    state = Simulation(scene).state
    points = np.random.default_rng(1).uniform(-0.5, 0.5, (50, 3))
    distance, at = RigidSurfaces(state).measure(points, state.tracked_surface.facets_of(1))
    assert distance == pytest.approx(points @ normal + 0.31, abs=1e-10)
    assert at == pytest.approx(np.tile(normal, (50, 1)), abs=1e-10)
    series = series_of(with_changes(scene, time={"end": 0.02, "output_interval": 0.02}))
    reaction = series["reaction"].values[-1, 1]
    assert -reaction @ normal > 100.0
    assert reaction == pytest.approx(reaction @ normal * normal, abs=0.03 * abs(reaction @ normal))


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (wall([1.0, 0.0], [0.0, 0.0]), "normal has no length"),
        (wall([1.0, 0.0], [0.0, 0.0, 1.0]), "point has 2 entries, and normal 3"),
        (wall([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), "'half_space' is 3D, but the grid is 2D"),
        (wall([1.0, 0.0], [0.0, 1.0], rigid={"density": 1.0}), "a half_space has no mass; expected"),
        *(
            (wall([1.0, 0.0], [3.0, 4.0], rigid={"motion": motion}), rf"motion\.surface_velocity: {text}")
            for motion, text in (
                ({"surface_velocity": [0.0, 1.0]}, "0.8 m/s along the normal of the half_space"),
                ({"surface_velocity": [[0.0, 4.0, -3.0], [1.0, 1.0, 0.0]]}, "0.6 m/s along the normal"),
                ({"surface_velocity": [4.0, -3.0], "angular_velocity": 1.0}, "does not go with"),
            )
        ),
    ],
)
def test_a_half_space_without_a_meaning_is_refused(body, message):
    with pytest.raises(SceneError, match=message):
        mpmfw.load_scene(drop(body))


def test_a_half_space_does_not_deform():
    scene = drop(wall([1.0, 0.0], [0.0, 1.0]))
    scene["bodies"]["block"]["geometry"] = scene["bodies"]["disc"]["geometry"]
    with pytest.raises(SceneError, match="a half_space has no points; expected rigid = true"):
        mpmfw.load_scene(scene)
