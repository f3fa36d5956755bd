"""The force of a slave node and a master segment: its variation, its balance, its friction."""

from __future__ import annotations

import numpy as np
import pytest

from contact_kernels import Law, OneNode, empty_candidates, find, forces, join, rows_of, star
from mpmfw.kernels.facets import segment_coordinate

LAW = Law()
K, MU = LAW.stiffness, LAW.friction


def random_pair(seed):
    """x_s, x_1, x_2 with the projection within the segment, (3, 2)."""
    rng = np.random.default_rng(seed)
    start, angle, length = rng.normal(size=2), rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 2.0)
    tangent = np.array([np.cos(angle), np.sin(angle)])
    slave = start + rng.uniform(0.0, length) * tangent + rng.uniform(-0.5, 0.5) * tangent[::-1] * (1, -1)
    return np.array([slave, start, start + length * tangent])


def projection(points):
    """ξ, g_n, l and e_t of the rows x_s, x_1, x_2."""
    xi, gap, length, tx, ty = segment_coordinate(*points.ravel())
    return xi, gap, length, np.array([tx, ty])


def analytic(points):
    """N, C_t = T + (g_n / l) P and Q of a pair, (3, 2) each, from the weights, couple and tilt of its row."""
    loops = join(
        [
            [points[0], points[0] + (0.0, 9.0), points[0] + (-9.0, 9.0)],
            [points[1], points[2], points[1] + 9.0],
        ]
    )
    found = empty_candidates(len(loops.body), 1)
    xi, gap, length, (tx, ty) = projection(points)
    found.master[0], found.facet[0], found.share[0, 0], found.gap[0], found.normal[0] = (
        1,
        3,
        (1.0 - xi, xi),
        gap,
        (ty, -tx),
    )
    rows = rows_of(loops, found, ties=False, tilts=True)
    force, out = np.array([[ty, -tx], [tx, ty]]), np.zeros((2, 6, 2))
    tilt = rows.tilt.copy()
    rows.tilt[:] = 0.0
    for along, values in zip(force, out, strict=True):
        rows.force[0] = along
        rows.add_to(values, (1.0, 1.0))
    q = np.zeros((6, 2))
    q[rows.dof[: rows.start[1]]] = -length / gap * tilt[: rows.start[1]]
    return out[0][[0, 3, 4]], out[1][[0, 3, 4]], q[[0, 3, 4]]


def differences(points):
    """δg_n and l δξ by central differences of step 1e-6 l, (3, 2) each."""
    length = projection(points)[2]
    h = 1e-6 * length
    d_gap, d_xi = np.empty((2, 3, 2))
    for index in np.ndindex(3, 2):
        ahead, behind = points.copy(), points.copy()
        ahead[index] += h
        behind[index] -= h
        (xi_a, gap_a, *_), (xi_b, gap_b, *_) = projection(ahead), projection(behind)
        d_gap[index], d_xi[index] = (gap_a - gap_b) / (2.0 * h), length * (xi_a - xi_b) / (2.0 * h)
    return d_gap, d_xi


def moment(points, values):
    """Σ x × f."""
    return np.sum(points[:, 0] * values[:, 1] - points[:, 1] * values[:, 0])


@pytest.mark.parametrize("seed", range(12))
def test_rows_are_the_variations_of_gap_and_coordinate(seed):
    points = random_pair(seed)
    normal, tangential, _ = analytic(points)
    d_gap, d_xi = differences(points)
    np.testing.assert_allclose(normal, d_gap, atol=1e-8)
    np.testing.assert_allclose(tangential, d_xi, atol=1e-8)


@pytest.mark.parametrize("seed", range(12))
def test_pair_leaves_no_force_and_no_moment(seed):
    points = random_pair(seed)
    for rows in analytic(points):
        scale = np.abs(rows).sum()
        assert np.abs(rows.sum(axis=0)).max() < 1e-14 * scale
        assert abs(moment(points, rows)) < 1e-14 * scale * np.abs(points).max()


@pytest.mark.parametrize("seed", range(10))
def test_q_is_self_equilibrated_and_no_part_of_the_variation(seed):
    points = random_pair(seed)
    _, gap, length, _ = projection(points)
    normal, _, q = analytic(points)
    assert np.abs(q.sum(axis=0)).max() == 0.0
    assert abs(moment(points, q)) < 1e-14 * np.abs(points).max()
    d_gap, _ = differences(points)
    assert (
        np.abs(normal - gap / length * q - d_gap).max() > 0.5 * abs(gap) / length
    )  # eq. 7 is off by all of it


@pytest.mark.parametrize("keep_q", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_forces_of_two_outlines_balance_at_vertices_too(seed, keep_q):
    rng = np.random.default_rng(seed)
    loops = join([star(rng, (-0.93, 0.1), 1.0), star(rng, (0.93, -0.1), 1.0)])
    loops.displacement[:] = 1e-3 * rng.normal(size=loops.displacement.shape)
    found = find(loops, slots=1)
    touching = (found.facet >= 0) & (found.gap < 0.0)
    force, *_ = forces(loops, found, Law(keep_q=keep_q))
    scale = np.abs(force).sum()
    assert touching.any()
    assert scale > 0.0
    assert np.abs(force.sum(axis=0)).max() < 1e-14 * scale
    assert abs(moment(loops.position, force)) < 1e-14 * scale * np.abs(loops.position).max()


HEAD_ON = {
    "round on round": (12, 12),
    "round on flat": (12, 4),
    "corner on round": (4, 12),
    "corner on corner": (4, 4),
}


@pytest.mark.parametrize("keep_q", [False, True])
@pytest.mark.parametrize("name", HEAD_ON)
@pytest.mark.parametrize("first", range(3))
def test_head_on_contact_is_symmetric_whichever_node_comes_first(name, first, keep_q):
    """Regular polygons, mirror images of themselves about x, whose nodes meet on the line of centres."""

    def polygon(n, sign, centre):
        angle = 2.0 * np.pi * np.arange(n) / n
        loop = np.stack([sign * np.cos(angle) + centre, sign * np.sin(angle)], axis=1)
        return np.roll(loop, first, axis=0)

    n, m = HEAD_ON[name]
    right = polygon(m, 1.0, 0.98)
    if name == "round on flat":
        right = np.roll(np.array([[0.0, -1], [1, -1], [1, 1], [0, 1], [0, 0]]) - [0.02, 0], first, axis=0)
    loops = join([polygon(n, 1.0, -1.0), right if name == "round on flat" else polygon(m, -1.0, 0.98)])
    x = loops.position
    image = [
        int(np.argmin(np.hypot(*(x - p * (1, -1)).T) + (loops.body != b)))
        for p, b in zip(x, loops.body, strict=True)
    ]
    random = np.random.default_rng(3).normal(size=x.shape)
    loops.displacement[:] = 1e-3 * (random + random[image] * (1, -1))
    force, *_ = forces(loops, find(loops, slots=1), Law(keep_q=keep_q))
    assert np.abs(force).max() > 0.01 * K
    assert np.abs(force[image] * (1, -1) - force).max() < 1e-12 * np.abs(force).max()
    assert abs(moment(x, force)) < 1e-12 * np.abs(force).max()


def pressed(law=LAW, depth=0.001, x=0.05):
    """A tip that has just been pressed in, straight, without sliding."""
    node = OneNode(law, x=x, y=0.0)
    node.move(0.0, -depth)
    return node


def test_the_slave_is_pushed_out():
    normal, tangential = pressed().move(0.0, 0.0)
    assert normal == pytest.approx(K * 0.001, rel=1e-12)
    assert tangential == 0.0


def test_stick_then_slip_then_reversal():
    node = pressed()
    limit = MU * K * 0.001
    assert node.move(1e-4, 0.0)[1] == pytest.approx(-K * 1e-4, rel=1e-12)  # stick
    assert node.work == 0.0
    assert node.move(1e-3, 0.0)[1] == pytest.approx(-limit, rel=1e-12)  # slip
    assert node.work == pytest.approx(limit * (1.1e-3 - limit / K), rel=1e-12)  # force times the sliding part
    assert node.move(-1e-4, 0.0)[1] == pytest.approx(
        -limit + K * 1e-4, rel=1e-12
    )  # reversal unloads the spring
    assert node.move(-1e-3, 0.0)[1] == pytest.approx(limit, rel=1e-12)


def test_force_is_carried_across_segments():
    node = pressed(x=0.2499)
    before = node.move(5e-5, 0.0)[1]  # still on the segment that ends at x = 0.25
    after = node.move(1e-4, 0.0)[1]
    assert node.loops.position[0, 0] > 0.25
    assert after == pytest.approx(before - K * 1e-4, rel=1e-12)


def test_first_contact_counts_only_the_penetrated_part_of_the_step():
    node = OneNode(LAW, y=0.003)
    normal, tangential = node.move(1e-4, -0.004)  # three quarters of the step in the air
    assert normal == pytest.approx(K * 0.001)
    assert tangential == pytest.approx(-K * 1e-4 / 4, rel=1e-12)


def test_release_forgets_the_force():
    node = pressed()
    node.move(1e-3, 0.0)
    assert node.move(0.0, 0.01) == (0.0, 0.0)
    assert node.move(0.0, -0.01)[1] == 0.0


def test_falling_normal_force_takes_friction_along():
    node = pressed()
    node.move(1e-3, 0.0)
    normal, tangential = node.move(0.0, 0.0005)
    assert normal == pytest.approx(K * 0.0005)
    assert tangential == pytest.approx(-MU * normal, rel=1e-12)


def test_friction_does_not_depend_on_the_time_step():
    """The same path in steps four times as long."""

    def last(steps):
        node = pressed()
        return [node.move(0.00002 / steps, 0.0)[1] for _ in range(steps)][-1]

    assert last(8) == pytest.approx(last(32), rel=1e-9)
    assert last(8) == pytest.approx(-K * 0.00002, rel=1e-9)


def test_dashpot_slows_approach_and_never_pulls():
    law = Law(damping=0.5 * K, friction=0.0)
    approaching = OneNode(law, y=0.0).move(0.0, -0.001)[0]
    assert approaching == pytest.approx(1.5 * K * 0.001)
    node = OneNode(law, y=0.0)
    node.move(0.0, -0.01)
    assert node.move(0.0, 0.0099)[0] == pytest.approx(
        0.0, abs=1e-9
    )  # pulled back faster than the spring pushes


def test_a_candidate_ahead_of_a_segment_s_end_has_finite_rows():
    """The normal at the vertex lies along the segment: there is no lever, and nothing is carried."""
    tip = np.array([[0.1, 0.0], [0.3, 1.0], [0.2, 1.0]])
    plate = np.array([[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0]])
    loops = join([tip, plate])
    found = empty_candidates(len(loops.body), 1)
    found.master[0], found.facet[0], found.share[0, 0], found.gap[0], found.normal[0] = (
        1,
        3,
        (0.0, 1.0),
        0.1,
        (1, 0),
    )
    rows = rows_of(loops, found)
    assert rows.count == 1
    for array in (rows.motion, rows.couple, rows.places.turn):
        assert np.isfinite(array).all()


def test_a_node_that_meets_two_segments_alike_is_theirs_by_the_squares_of_their_lengths():
    """w_i = L_i² / (L_1² + L_2²): lengths of 0.4 and 0.2 meet at the origin, just over the tip."""
    top = [[1.0, 0.0], [0.4, 0.0], [0.0, 0.0], [-0.2, 0.0], [-1.0, 0.0]]
    loops = join([[[0.0, -0.01], [0.5, 1.0], [-0.5, 1.0]], [[-1.0, -1.0], [1.0, -1.0], *top]])
    found = empty_candidates(len(loops.body), 1)
    found.master[0], found.facet[0], found.share[0, 0], found.gap[0], found.normal[0] = (
        1,
        6,
        (0, 1),
        -0.01,
        (0, 1),
    )
    rows = rows_of(loops, found)
    assert rows.count == 2
    assert rows.area[:2] / rows.area[:2].sum() == pytest.approx([0.8, 0.2])
