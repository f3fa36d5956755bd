"""Contact at shared grid nodes against plain NumPy, in two and three dimensions."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from contact_scenes import impact
from faulty_plugins.contact.plain import PlainContact
from measures_for_tests import detect
from mpmfw.contact import shared_nodes as shared
from mpmfw.contact.rows import ContactRows
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import ball_on_a_box


@pytest.fixture(params=[2, 3], ids=["2D", "3D"])
def fields(request):
    """Three bodies' windows that overlap, with nodal masses of which some are zero."""
    dim = request.param
    rng = np.random.default_rng(dim)
    lower, shape = rng.integers(0, 3, (3, dim)), rng.integers(4, 7, (3, dim))
    offset = np.concatenate([[0], np.cumsum(np.prod(shape, axis=1))])
    mass = np.where(rng.random(offset[-1]) < 0.3, 0.0, rng.uniform(0.5, 2.0, offset[-1]))
    return SimpleNamespace(
        dim=dim,
        rng=rng,
        spacing=(0.5,) * dim,
        lower=lower,
        shape=shape,
        offset=offset,
        mass=mass,
        momentum=rng.normal(size=(offset[-1], dim)),
        first=np.array([0, 0, 1]),
        second=np.array([1, 2, 2]),
    )


def nodes_of(f, gradient=None, mean=None):
    """The grid as the kernels take it."""
    none = np.zeros((0, f.dim))
    return shared.GridNodes(
        window_lower=f.lower, window_shape=f.shape, offset=f.offset, nodes=np.full(f.dim, 10), mass=f.mass,
        start_velocity=f.momentum, shared=np.zeros(len(f.mass), dtype=bool),
        last_row=np.full(len(f.mass), -1),
        gradient=none if gradient is None else gradient, mean=none if mean is None else mean,
    )  # fmt: skip


def pairs_of(f, weight_first=None, weight_second=None):
    """The pairs as the kernels take them."""
    ones = np.ones(3)
    return shared.NodePairs(
        first=f.first,
        second=f.second,
        weight_first=ones if weight_first is None else weight_first,
        weight_second=ones if weight_second is None else weight_second,
    )


def find(f, capacity=2000):
    """The kernel's list, and the number that it returns."""
    c = shared.room_for(capacity)
    return c, shared.find_shared_nodes(pairs_of(f), nodes_of(f), c)


def write(f, first, second, given, gradient, mean, cut_off):
    """Rows of all shared nodes, with a motion over a step of 0.1 s."""
    c, count = find(f)
    rows = ContactRows(f.dim, couples=False, own={"active": 0, "compliance": 0, "across": 0, "velocity": 1})
    rows.make_room(count, 2 * count)
    nodes = nodes_of(f, gradient, mean)
    rows.count = shared.write_rows(
        count, c, pairs_of(f, first, second), nodes, given, cut_off, 0.0, 0.1, rows, f.spacing
    )
    return rows


@pytest.mark.parametrize("cut_off", [np.inf, 0.1])
@pytest.mark.parametrize("kind", ["averaged", "master", "specified"])
def test_normals_agree_with_numpy(fields, kind, cut_off):
    f = fields
    c, count = find(f)
    n = slice(count)
    first, second = (
        (np.ones(3), np.ones(3)) if kind == "averaged" else (np.array([1.0, 0, 1]), np.array([0.0, 1, 0]))
    )
    given = np.eye(f.dim)[0]
    gradient = f.rng.normal(size=f.momentum.shape)
    mean = 0.1 * f.rng.normal(size=f.momentum.shape)
    none = np.zeros((0, f.dim))
    fed = (none if kind == "specified" else gradient, none if cut_off == np.inf else mean)
    rows = write(f, first, second, given, *fed, cut_off)
    pair, i, j = c.pair[n], c.first[n], c.second[n]
    expected = second[pair, None] * gradient[j] - first[pair, None] * gradient[i]
    expected = np.tile(-given, (count, 1)) if kind == "specified" else expected
    expected = expected / np.linalg.norm(expected, axis=1, keepdims=True)
    near = np.ones(count, dtype=bool)
    if cut_off < np.inf:
        apart = ((mean[i] - mean[j]) * expected).sum(axis=1)
        near = apart < cut_off
        assert near.any()
        assert not near.all()
        np.testing.assert_allclose(rows.gap[: rows.count], (apart - cut_off)[near], atol=1e-13)
    assert rows.count == near.sum()
    np.testing.assert_allclose(rows.normal[: rows.count], expected[near], atol=1e-14)
    np.testing.assert_array_equal(rows.dof[: 2 * rows.count].reshape(-1, 2), np.stack([i, j], axis=1)[near])
    np.testing.assert_allclose(rows.motion[: rows.count], 0.1 * (f.momentum[i] - f.momentum[j])[near])
    assert (np.diff(rows.identity[: rows.count]) > 0).all()
    if kind != "specified":
        faces = [sign * (gradient[k] * expected).sum(axis=1) for sign, k in ((-1.0, i), (1.0, j))]
        area = np.maximum(np.minimum(*faces), 0.0)
        np.testing.assert_allclose(rows.area[: rows.count], area[near], atol=1e-13)


@pytest.mark.parametrize("scene", [impact(), ball_on_a_box()], ids=["2D", "3D"])
def test_impulses_and_normals_are_those_of_the_law_in_numpy(scene):
    """With friction, by the first momentum and the second, and as they are recorded."""
    ends = []
    for contact in ("bardenhagen", PlainContact()):
        simulation, forces = Simulation(scene, contact=contact), []
        simulation.advance(30, lambda frame, forces=forces: forces.append(frame.series["contact_force"][0]))
        ends.append((simulation.state.particles.velocity, np.array(forces)))
    for found, expected in zip(*ends, strict=True):
        assert np.abs(expected).max() > 0.1
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_gaps_are_those_of_the_mean_positions_but_for_the_cut_off():
    simulation = Simulation(impact(gap=0.003), contact="bardenhagen(criterion=position)")
    simulation.start()
    detect(simulation)
    p, grid, rows = simulation.state.particles, simulation.state.grid, simulation.contact.rows
    phi, mean = simulation.shape.table, np.zeros_like(grid.position)
    owner = np.repeat(np.arange(p.count), np.diff(phi.row))
    np.add.at(mean, phi.nodes, (phi.weight * p.mass[owner])[:, None] * p.position[owner])
    mean /= np.maximum(grid.mass, 1e-300)[:, None]
    i, j = rows.dof[: 2 * rows.count].reshape(-1, 2).T
    apart = ((mean[i] - mean[j]) * rows.normal[: rows.count]).sum(axis=1)
    assert np.ptp(apart) > 1e-3
    assert np.ptp(rows.gap[: rows.count] - apart) < 1e-12


TILES = [[0.0, 0.33], [-0.33, -0.33], [0.33, -0.33]]  # a body on two that are flush
CLAMP = [[0.0, -0.5], [0.0, 0.0], [0.0, 0.5]]  # two bodies and one between them


@pytest.mark.parametrize(
    ("means", "speeds", "row", "sides"),
    [
        (TILES, [1.0, 0.0, 0.3], 0, [[0], [1, 2]]),
        (TILES, [1.0, 0.0, 0.5], 0, [[0], [1]]),
        (TILES, [0.0, 1.0, 0.8], 0, [[0], [1, 2]]),
        # so far apart, 0.66 in TILES, that they are flush by little, and no longer
        (0.99 * shared.FLUSH / 0.66 * np.array(TILES), [1.0, 0.0, 0.0], 0, [[0], [1, 2]]),
        (1.01 * shared.FLUSH / 0.66 * np.array(TILES), [1.0, 0.0, 0.0], 0, [[0], [1]]),
        (CLAMP, [0.0, 1.0, 0.0], 0, [[0], [1]]),
        (TILES, [1.0, 0.0, 0.0], 2, [[1], [2]]),
    ],
)
def test_a_third_body_is_on_the_side_with_which_it_moves_and_is_flush(means, speeds, row, sides):
    """Three bodies at the only node, and the sides of one of their rows."""
    one = np.ones(3)
    pairs = shared.NodePairs(
        first=np.array([0, 0, 1]), second=np.array([1, 2, 2]), weight_first=one, weight_second=one
    )
    grid = shared.GridNodes(
        window_lower=np.zeros((3, 2), dtype=int), window_shape=np.ones((3, 2), dtype=int),
        offset=np.arange(4), nodes=np.ones(2, dtype=int), mass=one,
        start_velocity=np.column_stack([speeds, np.zeros(3)]), shared=np.zeros(3, dtype=bool),
        last_row=np.full(3, -1), gradient=np.array([[0.0, -1.0], [0.5, 0.5], [-0.5, 0.5]]),
        mean=np.array(means),
    )  # fmt: skip
    rows = shared.room_for(3)
    assert shared.find_shared_nodes(pairs, grid, rows) == 3
    shared.mark_nodes(3, rows, grid)
    of_first, count = shared.collect_sides(row, rows, grid, (1.0, 1.0))
    assert [rows.side[:of_first].tolist(), rows.side[of_first:count].tolist()] == sides
    gradient = np.empty((2, 2))
    shared.sum_gradients(row, rows, grid, gradient, (1.0, 1.0))
    np.testing.assert_array_equal(gradient, [grid.gradient[side].sum(axis=0) for side in sides])
