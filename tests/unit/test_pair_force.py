"""The force of a slave node and a master segment: its variation, its balance, its friction."""

from __future__ import annotations

import numpy as np
import pytest

from contact_kernels import Law, OneNode, empty_candidates, join, rows_of
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
def test_rows_are_the_variations_of_gap_and_coordinate_and_leave_no_force_and_no_moment(seed):
    """Q, which eq. 7 adds, is no part of the variation of the gap."""
    points = random_pair(seed)
    normal, tangential, q = analytic(points)
    d_gap, d_xi = differences(points)
    np.testing.assert_allclose(normal, d_gap, atol=1e-8)
    np.testing.assert_allclose(tangential, d_xi, atol=1e-8)
    for rows in (normal, tangential, q):
        scale = np.abs(rows).sum()
        assert np.abs(rows.sum(axis=0)).max() < 1e-14 * scale
        assert abs(moment(points, rows)) < 1e-14 * scale * np.abs(points).max()
    _, gap, length, _ = projection(points)
    assert np.abs(normal - gap / length * q - d_gap).max() > 0.5 * abs(gap) / length


def pressed(law=LAW, depth=0.001, x=0.05):
    """A tip that has just been pressed in, straight, without sliding."""
    node = OneNode(law, x=x, y=0.0)
    node.move(0.0, -depth)
    return node


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


def test_release_forgets_the_force():
    node = pressed()
    node.move(1e-3, 0.0)
    assert node.move(0.0, 0.01) == (0.0, 0.0)
    assert node.move(0.0, -0.01)[1] == 0.0


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
