"""Detection between material points as spheres: who is near whom, and the rows."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_scenes import impact, run
from mpmfw.runs.simulation import Simulation
from mpmfw_contact.points import NEAR, Buckets, Neighbours, Points, enclose, find_near
from scenes_for_tests import block, box

Bodies = list[tuple[np.ndarray, np.ndarray]]


def listed(bodies: Bodies, dim: int, buckets: int = 16) -> list[tuple[int, int]]:
    """Pairs of points of two bodies, each positions (n, dim) and volumes (n,), as the kernels list them."""
    sizes = [len(volume) for _, volume in bodies]
    end = np.cumsum(sizes)
    points = Points(
        begin=end - sizes,
        end=end,
        position=np.concatenate([position for position, _ in bodies]),
        volume=np.concatenate([volume for _, volume in bodies]),
        lower=np.zeros((2, dim)),
        upper=np.zeros((2, dim)),
        largest=np.zeros(2),
    )
    table = Buckets(head=np.full(buckets, -1, dtype=np.int64), after=np.zeros(end[-1], dtype=np.int64))
    found = Neighbours(**{name: np.zeros(400, dtype=np.int64) for name in Neighbours.member_names})
    spacing = (1.0,) * dim
    enclose(points, spacing)
    pair = np.array([0]), np.array([1])
    count = find_near(*pair, points, table, found, spacing)
    assert (table.head == -1).all()  # as the next pair of bodies must find it
    return list(zip(found.first[:count].tolist(), found.second[:count].tolist(), strict=True))


@pytest.mark.parametrize("dim", [2, 3])
@given(seed=st.integers(0, 10**6), buckets=st.sampled_from([1, 4, 64]))
def test_who_is_near_is_what_every_distance_says(dim, seed, buckets):
    random = np.random.default_rng(seed)
    bodies = [
        (random.uniform(-1.0, 1.0, (n, dim)) + shift, random.uniform(0.05, 0.5, n) ** dim)
        for n, shift in ((11, -0.5), (17, 0.5))
    ]
    (x, v), (y, w) = bodies
    r, s = 0.5 * v ** (1.0 / dim), 0.5 * w ** (1.0 / dim)
    near = [
        (p, 11 + q)
        for p, q in itertools.product(range(11), range(17))
        if np.linalg.norm(x[p] - y[q]) < NEAR * (r[p] + s[q])
    ]
    assert listed(bodies, dim, buckets) == near  # in this order, by which rows find their past


def blocks(dim: int, gap: float, offset: float = 0.0) -> Simulation:
    """Two squares or cubes of 0.5 m at rest, lattices of 4 points along an edge; the second ``offset``
    sideways.
    """
    upper = np.full(dim, 0.25)
    bodies = {}
    for name, left, aside in (("left", -0.5, 0.0), ("right", gap, offset)):
        low, high = [left, *-upper[1:]], [left + 0.5, *upper[1:]]
        bodies[name] = {
            "material": "soft",
            "geometry": {
                "type": "rectangle" if dim == 2 else "box",
                "lower": [low[0], low[1] + aside, *low[2:]],
                "upper": [high[0], high[1] + aside, *high[2:]],
            },
            "particles": {"layout": "lattice", "size": 0.125},
        }
    scene = box() if dim == 3 else block()
    contact = {"method": "points+penalty", "friction": 0.2}
    return Simulation({**scene, "bodies": bodies, "contact": contact, "allow_overlap": gap < 0.0})


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("gap", [0.0, -0.01, 0.02])
def test_of_aligned_lattices_gap_and_area_are_those_of_the_faces(dim, gap):
    simulation = blocks(dim, gap)
    simulation.start()
    simulation.step()
    rows = simulation.contact.last_rows
    facing = np.abs(rows.normal[: rows.count, 0]) > 1.0 - 1e-12
    assert facing.sum() == 4 ** (dim - 1)
    np.testing.assert_allclose(rows.gap[: rows.count][facing], gap, atol=1e-12)
    np.testing.assert_allclose(rows.area[: rows.count][facing].sum(), 0.5 ** (dim - 1))


def test_between_lattices_that_are_offset_the_surface_is_a_row_of_bumps():
    """Half a point aside spheres lie in the hollows: 0.134 of a diameter deeper, and no normal is that of the
    face.
    """
    simulation = blocks(2, 0.0, offset=0.0625)
    simulation.start()
    simulation.step()
    rows = simulation.contact.last_rows
    nearest = rows.gap[: rows.count] < 0.125 * (np.sqrt(1.25) - 1.0) + 1e-12
    np.testing.assert_allclose(rows.gap[: rows.count][nearest], 0.125 * (np.sqrt(1.25) - 1.0))
    np.testing.assert_allclose(np.abs(rows.normal[: rows.count, 0][nearest]), 1.0 / np.sqrt(1.25))


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_the_impulses_of_a_step_have_one_line_of_action(friction):
    """Both sides of a row are at one place: what it adds to the grid's momentum has no moment."""
    simulation = Simulation(impact(slide=0.3, friction=friction), contact="points+penalty")
    simulation.start()
    run(simulation, 30)
    rows, grid = simulation.contact.last_rows, simulation.state.grid
    assert np.abs(rows.force[: rows.count]).max() > 0.0
    force = np.zeros_like(grid.force)
    rows.add_to(force, grid.spacing)
    x = grid.position
    moment = (x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]).sum()
    assert abs(moment) < 1e-12 * np.abs(force).sum()
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * np.abs(force).sum()


def test_rows_lie_ahead_of_the_touch():
    """NEAR: they bound the step in which it comes, so that springs begin shallow; with NEAR = 1 there would
    be none.
    """
    simulation = blocks(2, 0.02)
    simulation.start()
    simulation.step()
    assert simulation.contact.last_rows.count == 4
    limit, why = simulation.contact.stable_timestep()
    assert why.endswith("springs and bulk")
    assert limit < 2.0 / simulation.contact.bulk_frequency
