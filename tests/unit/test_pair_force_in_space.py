"""The force of a slave node and a triangle: its variation on faces, edges and corners, and its balance."""

import numpy as np
import pytest

from mpmfw.contact.surfaces.assembly import assemble
from mpmfw.contact.surfaces.outline import Candidates
from mpmfw.contact.surfaces.surface_rows import SurfaceRows
from mpmfw.contact.surfaces.turning import write_spins
from mpmfw.geometry.layout import neighbours_of, stars_of
from mpmfw.kernels import kernel, signed_distance
from mpmfw.kernels.contact import add_turned, pair_table, relative_motion
from mpmfw.kernels.facets import project
from mpmfw.state.structs import Surface
from support import as_table

SPACE = (1.0, 1.0, 1.0)
#: Where the foot lies on facet (1, 2, 3) of the master, a tetrahedron of nodes 1 to 4: node 0 is the slave.
PLACES = {"face": (0.2, 0.3, 0.5), "edge": (0.0, 0.4, 0.6), "corner": (0.0, 0.0, 1.0)}
FACETS = np.array([[1, 2, 3], [1, 4, 2], [2, 4, 3], [3, 4, 1], [0, 0, 0]])


def contact(place, seed):
    """Positions (5, 3) of a slave node and of a tetrahedron's, in front of the place or behind it."""
    rng = np.random.default_rng(seed)
    while True:
        master = rng.normal(size=(4, 3))
        a, b, c, top = master
        normals = [np.cross(b - a, c - a), np.cross(b - top, top - c), np.cross(c - top, top - a)]
        own, across_a, across_b = (n / np.linalg.norm(n) for n in normals)
        away = {"face": own, "edge": own + across_a, "corner": own + across_a + across_b}[place]
        # outward facets; seen from behind along the normal, a facet would have no couple
        if np.linalg.det(master[1:] - a) < -0.3 and own @ away > 0.1:
            break
    gap = rng.choice([-0.05, 0.1]) if place == "face" else 0.1
    return np.concatenate([[PLACES[place] @ master[:3] + gap * away], master])


def outline_of(position, displacement):
    """Body 0 is a lone node, body 1 the tetrahedron; its facets come first."""
    neighbours = np.zeros_like(FACETS)
    neighbours[:4] = neighbours_of(FACETS[:4])
    first, star = stars_of(FACETS[:4], 5)
    return Surface(
        position=position, displacement=displacement, tributary=np.ones(5), body=np.array([0, 1, 1, 1, 1]),
        body_first=np.array([0, 1, 5]), facet_first=np.array([0, 0, 4]), facets=FACETS, neighbours=neighbours,
        star_first=first, star=star,
    )  # fmt: skip


def distance(position):
    """Gap from facet 0, barycentric coordinates and e_n."""
    share, normal = np.zeros(3), np.zeros(3)
    gap = signed_distance(position[0], 0, outline_of(position, np.zeros_like(position)), share, normal, SPACE)
    return gap, share, normal


def row_of(position, displacement=None, *, tilts=False):
    """The row of node 0 and facet 0; its grid's nodes are the surface's."""
    facet = np.full((5, 1), -1)
    facet[0] = 0
    candidates = Candidates(facet=facet, gap=np.full((5, 1), distance(position)[0]))
    moved = np.zeros_like(position) if displacement is None else displacement
    outline = outline_of(position, moved)
    rows = SurfaceRows(3, couples=True, tilts=tilts, spins=True, own={})
    table = as_table(np.arange(6), np.arange(5, dtype=np.int32), np.ones(5))
    pairs = pair_table(np.array([0]), np.array([1]))
    rows.count = assemble(
        np.arange(2), False, -np.inf, candidates, outline, pairs, np.array([0]), table,
        np.zeros(5, dtype=np.int64), rows, rows.places, SPACE,
    )  # fmt: skip
    assert rows.count == 1
    write_spins(1, np.inf, outline, rows, rows.places, SPACE)
    return rows


def nodal_forces(rows, force):
    """Bᵀ f on the five nodes."""
    rows.force[0] = force
    out = np.zeros((5, 3))
    rows.add_to(out, SPACE)
    return out


def differences(value, position, step=1e-6):
    """Derivative of a function of the nodes' positions by each of them, central differences."""
    columns = []
    for index in np.ndindex(position.shape):
        ahead, behind = position.copy(), position.copy()
        ahead[index] += step
        behind[index] -= step
        columns.append((value(ahead) - value(behind)) / (2.0 * step))
    return np.moveaxis(np.reshape(columns, (*position.shape, *np.shape(columns[0]))), (0, 1), (-2, -1))


every_place = pytest.mark.parametrize("place", PLACES)
seeds = pytest.mark.parametrize("seed", range(8))


@every_place
@seeds
def test_a_normal_force_is_the_variation_of_the_gap(place, seed):
    """So f = −k g δg is the gradient of the pair's energy k g² / 2."""
    position = contact(place, seed)
    gap, _, normal = distance(position)
    of_gap = differences(lambda x: distance(x)[0], position)
    np.testing.assert_allclose(nodal_forces(row_of(position), normal), of_gap, atol=1e-8)
    energy = differences(lambda x: 0.5e4 * distance(x)[0] ** 2, position)
    np.testing.assert_allclose(nodal_forces(row_of(position), -1e4 * gap * normal), -energy, atol=1e-8 * 1e4)


@seeds
def test_a_tangential_force_is_the_variation_of_the_foot_on_the_face(seed):
    """t·Σ x_a δξ_a for any t in the face's plane."""
    position = contact("face", seed)
    _, _, normal = distance(position)

    def coordinates(x):
        own, foot = np.zeros(3), np.zeros(3)
        project(x[0], x[1:4].copy(), foot, own, SPACE)
        return foot

    of_share = differences(coordinates, position)
    rows = row_of(position)
    for along in np.eye(3):
        tangent = along - along @ normal * normal
        expected = np.einsum("a,aij->ij", position[1:4] @ tangent, of_share)
        np.testing.assert_allclose(nodal_forces(rows, tangent), expected, atol=1e-8)


@pytest.mark.parametrize("tilts", [False, True])
@every_place
@seeds
def test_no_force_and_no_moment_is_left(place, seed, tilts):
    position = contact(place, seed)
    rows = row_of(position, tilts=tilts)
    force = np.random.default_rng(seed).normal(size=3)
    out = nodal_forces(rows, force)
    scale = np.abs(out).sum()
    assert np.abs(out.sum(axis=0)).max() < 1e-14 * scale
    assert np.abs(np.cross(position, out).sum(axis=0)).max() < 1e-13 * scale * np.abs(position).max()
    if not tilts:  # the rows' velocity does the work of the force
        velocity, motion = np.random.default_rng(seed + 8).normal(size=(5, 3)), np.zeros((1, 3))
        relative_motion(rows, 1, velocity, 2.0, motion, SPACE)
        assert motion[0] @ force == pytest.approx(2.0 * np.sum(velocity * out), abs=1e-12 * scale)


@kernel
def carry(force, old, rows, out):
    """The force of the only row of the last step, as the row of this one has it."""
    add_turned(force, 0, old, 0, rows, out)


def turned_by(angle):
    """Rotation by a vector of angles [rad] (Rodrigues)."""
    size = max(np.linalg.norm(angle), 1e-12)
    x, y, z = angle / size
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(size) * cross + (1.0 - np.cos(size)) * cross @ cross


def carried(position, rotation, force):
    """A tangential force after both bodies turned as one, in their frame."""
    after = position @ rotation.T
    old, rows = row_of(position), row_of(after, after - position)
    out = np.zeros((1, 3))
    carry(force[None], old, rows, out)
    return out[0] @ rotation


@every_place
@seeds
def test_a_stored_force_turns_with_bodies_that_stick_and_turn_as_one(place, seed):
    """About any axis, and so about the normal: what is left is of the third order in a step's angle."""
    position, rng = contact(place, seed), np.random.default_rng(seed)
    normal = row_of(position).normal[0]
    axis, force = rng.normal(size=3), np.cross(normal, rng.normal(size=3))
    axis /= np.linalg.norm(axis)
    off = [np.linalg.norm(carried(position, turned_by(a * axis), force) - force) for a in (0.1, 0.05)]
    assert off[0] < 2e-3 * np.linalg.norm(force)
    assert off[1] < 0.2 * off[0] + 1e-12
    fixed = force @ turned_by(0.1 * normal)  # as it would be without the turn about the normal
    assert np.linalg.norm(fixed - force) > 0.09 * np.linalg.norm(force)


@pytest.mark.parametrize(("of_table", "of_body"), [(0.02, 0.0), (0.0, 0.02), (0.02, -0.02), (0.02, 0.02)])
def test_of_surfaces_that_turn_apart_it_is_the_mean(of_table, of_body):
    """A tip on a table, each a tetrahedron that turns about the vertical by itself [rad]."""
    corners = np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
    table = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 1.0, 0.0], [0.4, 0.4, -1.0]])
    body = np.array([[0.1, 0.1, 0.8], [0.9, 0.2, 0.8], [0.2, 0.9, 0.8], [0.4, 0.3, 0.0]])
    parts = ((table, of_table), (body, of_body))
    moved = [each - each @ turned_by(np.array([0.0, 0.0, angle])) for each, angle in parts]
    facets = np.concatenate([corners, corners + 4])
    first, star = stars_of(facets, 8)
    outline = Surface(
        position=np.concatenate([table, body]), displacement=np.concatenate(moved), tributary=np.ones(8),
        body=np.repeat([0, 1], 4), body_first=np.array([0, 4, 8]), facet_first=np.array([0, 4, 8]),
        facets=facets,
        neighbours=neighbours_of(facets), star_first=first, star=star,
    )  # fmt: skip
    rows = SurfaceRows(3, couples=True, spins=True, own={})
    rows.places.slave[:], rows.places.facet[:], rows.normal[:], rows.gap[:2] = (
        7,
        0,
        (0.0, 0.0, 1.0),
        (0.1, 0.2),
    )
    write_spins(2, 0.1, outline, rows, rows.places, SPACE)
    assert rows.spin[0] == pytest.approx(0.5 * (of_table + of_body), abs=1e-5)
    assert rows.spin[1] == 0.0  # beyond what the law acts across
