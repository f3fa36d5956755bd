"""Material points as spheres: who is near whom, rows, and the law of de Vaucorbeil & Nguyen (2021)."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_scenes import impact, run
from measures_for_tests import detect
from mpmfw.contact.rows import ContactRows
from mpmfw.kernels.facets import Boxes, bounding_boxes
from mpmfw.runs.simulation import Simulation
from mpmfw_contact.points import NEAR, find_near
from scenes_for_tests import block, box, solid
from support import as_points

Bodies = list[tuple[np.ndarray, np.ndarray]]
OVERLAP, MU = 0.01, 0.3


def listed(bodies: Bodies, dim: int, buckets: int = 16) -> list[tuple[int, int]]:
    """Pairs of points of two bodies, each positions (n, dim) and volumes (n,), as the kernels list them."""
    sizes = [len(volume) for _, volume in bodies]
    end = np.cumsum(sizes)
    position = np.concatenate([position for position, _ in bodies])
    volume = np.concatenate([volume for _, volume in bodies])
    first, boxes = np.array([0, *end]), Boxes(lower=np.zeros((2, dim)), upper=np.zeros((2, dim)))
    bounding_boxes(first, position, boxes.lower, boxes.upper)
    reach = NEAR * volume.max() ** (1.0 / dim)
    head, after = np.full(buckets, -1, dtype=np.int64), np.zeros(end[-1], dtype=np.int64)
    rows = ContactRows(dim, couples=False)
    rows.make_room(400, 1)
    points = as_points(position=position, volume=volume)
    count = find_near(np.array([[0, 1]]), first, points, reach, boxes, head, after, rows)
    assert (head == -1).all()  # as the next pair of bodies must find it
    return [divmod(int(identity), end[-1]) for identity in rows.identity[:count]]


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


def blocks(dim, gap, *, offset=0.0, method="points+penalty", slide=0.0, friction=0.2):
    """Two squares or cubes of 0.5 m, lattices of 4 points along an edge; the second ``offset`` sideways."""
    bodies = {}
    for name, left, aside, speed in (("left", -0.5, 0.0, slide), ("right", gap, offset, 0.0)):
        lower = np.array([left, aside - 0.25, -0.25])[:dim]
        corners = lower.tolist(), (lower + 0.5).tolist()
        bodies[name] = solid(*corners, 0.125, velocity=[0.0, speed, 0.0][:dim])
    scene = box() if dim == 3 else block()
    contact = {"method": method, "friction": friction}
    made = Simulation({**scene, "bodies": bodies, "contact": contact, "allow_overlap": gap < 0.0})
    made.start()
    return made


def rows_of(simulation):
    """Gaps, areas and normals of the rows after a step."""
    simulation.step()
    rows = simulation.contact.last_rows
    return rows.gap[: rows.count], rows.area[: rows.count], rows.normal[: rows.count]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("gap", [0.0, -0.01, 0.02])
def test_of_aligned_lattices_gap_and_area_are_those_of_the_faces(dim, gap):
    """NEAR: rows lie ahead of the touch too, and bound the step in which it comes."""
    simulation = blocks(dim, gap)
    gaps, area, normal = rows_of(simulation)
    facing = np.abs(normal[:, 0]) > 1.0 - 1e-12
    assert facing.sum() == 4 ** (dim - 1)
    np.testing.assert_allclose(gaps[facing], gap, atol=1e-12)
    np.testing.assert_allclose(area[facing].sum(), 0.5 ** (dim - 1))
    limit, why = simulation.contact.stable_timestep()
    assert why.endswith("springs and bulk")
    assert limit < 2.0 / simulation.contact.bulk_frequency


def test_between_lattices_that_are_offset_the_surface_is_a_row_of_bumps():
    """Half a point aside spheres lie in the hollows: deeper, and no normal is that of the face."""
    gaps, _, normal = rows_of(blocks(2, 0.0, offset=0.0625))
    deeper = 0.125 * (np.sqrt(1.25) - 1.0)
    nearest = gaps < deeper + 1e-12
    np.testing.assert_allclose(gaps[nearest], deeper)
    np.testing.assert_allclose(np.abs(normal[nearest, 0]), 1.0 / np.sqrt(1.25))


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


def change_of(simulation, dt):
    """Change of the first body's momentum in a step (dim,)."""
    p, own = simulation.state.particles, simulation.state.bodies[0].particles
    before = p.mass[own] @ p.velocity[own]
    simulation.step(dt)
    return p.mass[own] @ p.velocity[own] - before


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("dt", [1e-4, 2e-4])
def test_the_impulse_takes_the_overlap_out_in_one_step(dim, dt):
    """Σ m_p m_q / (m_p + m_q) overlap / Δt over the points that face each other; bulk alone limits Δt."""
    simulation = blocks(dim, -OVERLAP, method="particles", friction=0.0)
    detect(simulation)
    assert [owner for _, owner in simulation.limits()] == ["bulk wave speed (h / c)"]
    change = change_of(simulation, dt)
    mass = 0.125**dim * simulation.state.bodies[0].density
    expected = 4 ** (dim - 1) * 0.5 * mass * OVERLAP / dt
    np.testing.assert_allclose(change, [-expected, *[0.0] * (dim - 1)], rtol=1e-12, atol=1e-12 * expected)
    np.testing.assert_allclose(simulation.contact.records.impulse[0], change, rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("slide", [1e-6, 1.0])
def test_friction_is_that_of_the_moment_however_slow_the_slip(slide):
    change = change_of(blocks(2, -OVERLAP, method="particles", slide=slide, friction=MU), 1e-4)
    np.testing.assert_allclose(change[1], MU * change[0], rtol=1e-6)


def test_points_that_touch_exchange_nothing():
    simulation = blocks(2, -OVERLAP, method="particles")
    simulation.state.particles.position[simulation.state.bodies[1].particles, 0] += OVERLAP + 1e-9
    simulation.step(1e-4)
    assert not simulation.contact.records.impulse.any()
