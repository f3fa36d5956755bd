"""Logistic regression at shared nodes: the plane between half-spaces, and the distance across it."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import least_squares

from interpreted import interpreted
from mpmfw.contact import shared_nodes as shared
from mpmfw.contact.rows import ContactRows
from mpmfw_contact import logistic as regression
from mpmfw_contact.logistic import write_regressed_rows
from mpmfw_contact.surface_impulse import SurfaceImpulse
from support import as_points, as_table

H = 0.5
HALF = 0.25 * H  # half of the edge of a point's domain


def basis_of(normal):
    """Orthonormal columns, the first of which is the normal."""
    columns = np.linalg.qr(np.column_stack([normal, np.eye(len(normal))]))[0][:, : len(normal)]
    columns[:, 0] *= np.sign(columns[:, 0] @ normal)
    return columns


def half_spaces(normal, gap, rng):
    """Two bodies of square points along the plane with this normal, through the middle of a grid."""
    dim = len(normal)
    turn, steps = basis_of(normal), np.arange(-10, 10) * 2 * HALF
    positions = []
    for side in (-1.0, 1.0):
        across = side * (np.arange(10) * 2 * HALF + HALF + 0.5 * gap)
        along = [steps + rng.uniform(0, 2 * HALF) for _ in range(dim - 1)]
        lattice = np.stack(np.meshgrid(across, *along, indexing="ij"), axis=-1).reshape(-1, dim)
        positions.append(lattice @ turn.T)
    position = np.concatenate(positions)
    near = np.abs(position).max(axis=1) < 2.6 * H  # the grid reaches further
    body = np.repeat([0, 1], [len(p) for p in positions])[near]
    edges = np.broadcast_to(HALF * turn, (near.sum(), dim, dim)).copy()
    return position[near], body, edges


def table_of(position, body, origin, count):
    """Weights of GIMP's support; flat windows of both bodies in one grid."""
    dim = position.shape[1]
    first = np.floor((position - origin - HALF) / H).astype(int)
    index = first[:, None] + np.array(list(itertools.product(range(4), repeat=dim)))
    away = np.abs(position[:, None] - origin - H * index) / H
    near = (away < 1.0 + HALF / H).all(axis=2)
    nodes = (
        np.ravel_multi_index(index[near].T, (count,) * dim) + np.repeat(body, near.sum(axis=1)) * count**dim
    )
    weight = (1.0 - away[near] / (1.0 + HALF / H)).prod(axis=1)
    return np.concatenate([[0], np.cumsum(near.sum(axis=1))]), nodes.astype(np.int32), weight


@pytest.fixture(params=[2, 3], ids=["2D", "3D"])
def dim(request):
    return request.param


def empty_clouds(nodes, entries):
    """Room for the points of nodes, without a point."""
    sizes = {"head": nodes, "after": entries, "point": entries}
    return regression.Clouds(**{name: np.zeros(size, dtype=np.int64) for name, size in sizes.items()})


def clouds_of(split, count):
    """Points 0 to ``split`` at node 0, and those up to ``count`` at node 1."""
    clouds = empty_clouds(2, count)
    nodes = np.repeat([0, 1], [split, count - split]).astype(np.int32)
    table = as_table(np.arange(count + 1), nodes, np.ones(count))
    regression.list_points(table, np.ones(2, dtype=bool), clouds)
    return clouds


def detected(normal, gap=0.0, *, seed=0, turn=1e-5, strain=None):
    """Rows of two half-spaces; with F = ``strain``, by which positions are not moved."""
    rng, dim, count = np.random.default_rng(seed), len(normal), 9
    origin = -4.0 * H + rng.uniform(-0.5 * H, 0.5 * H, dim)
    position, body, edges = half_spaces(normal, gap, rng)
    row, nodes, weight = table_of(position, body, origin, count)
    size = count**dim
    mass = np.bincount(nodes, weight, minlength=2 * size)
    place = origin + H * np.stack(np.unravel_index(np.arange(size), (count,) * dim), axis=-1)
    none = np.zeros((0, dim))
    grid = shared.GridNodes(
        window_lower=np.zeros((2, dim), dtype=int), window_shape=np.full((2, dim), count),
        offset=np.array([0, size, 2 * size]), nodes=np.full(dim, count), mass=mass,
        start_velocity=np.zeros((2 * size, dim)), shared=np.zeros(2 * size, dtype=bool),
        last_row=np.full(2 * size, -1), gradient=none, mean=none,
    )  # fmt: skip
    ones = np.ones(1)
    pairs = shared.NodePairs(first=np.array([0]), second=np.array([1]), weight_first=ones, weight_second=ones)
    listed = shared.room_for(size)
    n = shared.find_shared_nodes(pairs, grid, listed)
    shared.mark_nodes(n, listed, grid)
    clouds = empty_clouds(2 * size, len(nodes))
    regression.list_points(as_table(row, nodes, weight), grid.shared, clouds)
    deformation = np.broadcast_to(np.eye(dim) if strain is None else strain, edges.shape).copy()
    points = as_points(position=position, deformation_gradient=deformation)
    rows = ContactRows(dim, couples=False, own=SurfaceImpulse().row_arrays(friction=False))
    rows.make_room(n + 1, 2 * n)
    rows.count = write_regressed_rows(
        n, listed, pairs, grid, np.tile(place, (2, 1)), clouds, points, edges, 1e-7, turn, 0.0, 0.0, rows,
        (H,) * dim, (1.0,) * (dim + 1),
    )  # fmt: skip
    return SimpleNamespace(
        rows=rows, clouds=clouds, listed=listed, n=n, table=(row, nodes, weight), position=position,
        body=body,
        place=place, size=size,
    )  # fmt: skip


def some_normal(dim, seed):
    normal = np.random.default_rng(100 + seed).normal(size=dim)
    return normal / np.linalg.norm(normal)


def inner(found, normal):
    """Rows of nodes that see no end of the bodies, at most a cell from the plane."""
    place = found.place[found.rows.dof[0 : 2 * found.rows.count : 2]]
    near = (np.abs(place) < 1.3 * H).all(axis=1) & (np.abs(place @ normal) < H)
    assert near.sum() > 3
    return np.flatnonzero(near)


def leaning(found, normal):
    """Angle of each inner row's normal to that of the plane [degrees]."""
    cosine = -(found.rows.normal[inner(found, normal)] @ normal)
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def test_the_plane_between_half_spaces_is_found_to_half_a_degree(dim):
    """At any angle: with the published turn at most nodes, with a finer one at three of four."""
    published, finer = [], []
    for seed in range(8):
        normal = some_normal(dim, seed)
        found = detected(normal, seed=seed, turn=1e-9)
        published.append(leaning(detected(normal, seed=seed), normal))
        finer.append(leaning(found, normal))
    assert np.median(np.concatenate(published)) < 0.5
    assert np.quantile(np.concatenate(finer), 0.75) < 0.5
    assert np.max(np.concatenate(finer)) < 1.5


@pytest.mark.parametrize("gap", [-0.02, 0.0, 0.05])
def test_the_gap_is_the_distance_of_the_faces(dim, gap):
    normal = some_normal(dim, 1)
    found = detected(normal, gap, seed=1, turn=1e-9)
    np.testing.assert_allclose(found.rows.gap[inner(found, normal)], gap, atol=0.02 * H)


def test_points_reach_as_far_as_they_are_deformed(dim):
    """Stretched by a half across the plane, where they are, both bodies overlap by half of a point's edge."""
    normal = some_normal(dim, 2)
    strain = np.eye(dim) + 0.5 * np.outer(normal, normal)
    plain, stretched = (detected(normal, seed=2, turn=1e-9, strain=each) for each in (None, strain))
    closer = (plain.rows.gap - stretched.rows.gap)[inner(plain, normal)]
    np.testing.assert_allclose(closer, HALF, rtol=0.01)


def test_the_slope_is_that_of_penalised_least_squares():
    """A cloud that no plane separates, so that the least squares have a minimum: found by another solver."""
    rng = np.random.default_rng(3)
    position = rng.uniform(-1.0, 1.0, (40, 2))
    body = (position @ [0.8, 0.6] + 0.6 * rng.normal(size=40) > 0.0).astype(int)
    order = np.argsort(body, kind="stable")
    position, body = position[order], body[order]
    split = int((body == 0).sum())
    clouds = clouds_of(split, 40)
    normal = np.zeros(2)
    found = regression.fit_plane(
        np.arange(2), 1, 2, clouds, position, np.zeros(2), 1e-3, 1e-14, normal, (1.0, 1.0), (1.0, 1.0, 1.0)
    )
    classes = np.where(body == 0, -1.0, 1.0)

    def left(beta):
        return np.concatenate(
            [classes - np.tanh(0.5 * (position @ beta[:2] + beta[2])), np.sqrt(1e-3) * beta[:2]]
        )

    slope = least_squares(left, np.zeros(3), xtol=1e-15, ftol=1e-15, gtol=1e-15).x[:2]
    assert found
    np.testing.assert_allclose(normal, slope / np.linalg.norm(slope), atol=1e-5)


def plane_of(position, split, **constants):
    """Normal of the plane between the first ``split`` points and the others, or None."""
    count = len(position)
    clouds = clouds_of(split, count)
    normal = np.zeros(2)
    fit = interpreted(regression.fit_plane, **constants) if constants else regression.fit_plane
    found = fit(
        np.arange(2), 1, 2, clouds, position, np.zeros(2), 1e-7, 1e-5, normal, (1.0, 1.0), (1.0, 1.0, 1.0)
    )
    return normal if found else None


def test_one_iteration_is_a_linear_fit_and_leans():
    """ITERATIONS too small: points far from the plane count as much as those beside it."""
    rng = np.random.default_rng(5)
    position = rng.uniform(-1.0, 1.0, (60, 2))
    side = position @ [0.8, 0.6]
    position = np.concatenate([position[side < -0.05], position[side > 0.05], [[2.0, 3.0]]])
    split = int((side < -0.05).sum())
    exact, one = (plane_of(position, split, ITERATIONS=most) for most in (regression.ITERATIONS, 1))
    assert np.degrees(np.arccos(exact @ [0.8, 0.6])) < 2.0
    assert np.degrees(np.arccos(one @ [0.8, 0.6])) > 4.0
    np.testing.assert_array_equal(plane_of(position, split, ITERATIONS=500), exact)


def test_a_pivot_too_large_loses_planes():
    """SINGULAR too large: a thin row of points on each side of a plane has none any more."""
    along, across = np.array([0.8, 0.6]), np.array([-0.6, 0.8])
    position = np.array([x * along + y * across for y in (-0.01, 0.01) for x in np.linspace(-1.0, 1.0, 9)])
    np.testing.assert_allclose(plane_of(position, 9, SINGULAR=regression.SINGULAR), across, atol=1e-3)
    assert plane_of(position, 9, SINGULAR=0.01) is None
