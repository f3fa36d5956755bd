"""What each constant of the barriers is for: which way it fails where it is smaller or larger."""

import numpy as np
import pytest
from scipy.optimize import brentq

from contact_kernels import PLANE, flat, join
from interpreted import interpreted
from mpmfw.contact.rows import ContactRows
from mpmfw.contact.springs import SpringArrays
from mpmfw_contact._barriers import (
    LEAST_SHARE,
    LEFT,
    USED,
    barrier,
    barrier_curvature,
    barrier_slope,
    set_barriers,
    time_to_reach,
)
from mpmfw_contact.barrier import FIRST
from support import as_table

REACH = 0.01


def foreseen(distance, approach=0.0, share=1.0, **constants):
    """Stiffness per area of a place of unit area, and its area, for the step that begins there [reach]."""
    own = dict.fromkeys((*SpringArrays.member_names, "distance"), 0) | {"tangential": None}
    rows = ContactRows(2, couples=False, own=own)
    rows.normal[0], rows.motion[0] = (0.0, 1.0), (0.0, -approach * REACH)
    rows.gap[0], rows.area[0], rows.tributary_area[0] = distance * REACH, share, 1.0
    modulus, offset = np.ones(1), np.zeros(1)
    set_them = interpreted(set_barriers, **constants)
    assert set_them(rows, 1, rows.own, modulus, offset, REACH, REACH, 0.0) == -1
    return rows.own.limit_k[0], rows.own.effective_area[0]


def part_used(distance, **constants):
    """Part of the distance [reach] from a wall that a node uses up in the longest step, at unit speed."""
    loops = join([flat(-1.0, 1.0, -1.0, 0.0, 1), [[0.0, distance * REACH], [0.5, 1.0], [-0.5, 1.0]]])
    n, top = len(loops.body), 2  # the facet from (1, 0) to (−1, 0)
    table = as_table(np.arange(n + 1), np.arange(n, dtype=np.int32), np.ones(n))
    velocity = np.where(loops.body[:, None] == 1, [0.0, -1.0], 0.0)
    step = interpreted(time_to_reach, **constants)(
        4, top, np.array([0.5, 0.5]), np.array([0.0, 1.0]), 0.0, REACH, loops.outline, table, np.ones(n),
        velocity, PLANE,
    )  # fmt: skip
    return step / (distance * REACH)


@pytest.mark.parametrize("distance", [0.02, 0.1, 0.4])
def test_the_stiffness_of_the_step_s_end_is_foreseen_and_not_much_more(distance):
    """With more left, or more used up, contact's steps are too long; with less left, far too short."""

    def over(*, used, left):
        step = part_used(distance, USED=used) * distance
        return foreseen(distance, step, LEFT=left)[0] / barrier_curvature(distance - step)

    assert 1.0 <= over(used=USED, left=LEFT) < 5.0
    assert over(used=USED, left=0.9) < 0.7
    assert over(used=0.9, left=LEFT) < 0.5
    assert over(used=USED, left=0.02) > 50.0


def test_a_node_never_arrives_and_does_not_creep_towards_the_wall_either():
    """From the reach to a thousandth of it, at unit speed."""

    def steps(used):
        distance, number = 1.0, 0
        while distance > 1e-3 and number < 200:
            distance, number = distance * (1.0 - part_used(distance, USED=used)), number + 1
        return number, distance

    number, left = steps(USED)
    assert number < 15
    assert left > 0.0
    assert steps(1.0)[1] == pytest.approx(0.0, abs=1e-15)
    assert steps(0.02)[0] == 200


def test_a_needle_s_tip_bears_and_what_lies_askew_bears_as_much_as_it_has_across():
    """A node of share 0.16 is the least of right-angled corners in impacts."""
    assert foreseen(0.1, share=0.0, LEAST_SHARE=LEAST_SHARE)[0] > 0.0
    assert foreseen(0.1, share=0.0, LEAST_SHARE=0.0)[0] == 0.0  # no force at any distance
    assert foreseen(0.1, share=0.16, LEAST_SHARE=LEAST_SHARE)[1] == 0.16
    assert foreseen(0.1, share=0.16, LEAST_SHARE=0.5)[1] == 0.5  # three times the pressure


def test_the_first_estimate_of_the_stiffness_is_that_where_a_thousandth_of_the_modulus_bears():
    """A larger one shortens steps of bodies that have not met; with a smaller one a touch is unforeseen."""
    distance = brentq(lambda s: barrier_slope(s) - 1e-3, 0.5, 1.0 - 1e-9)
    assert barrier_curvature(distance) == pytest.approx(FIRST, rel=0.02)


AT = np.array([0.01, 0.1, 0.3, 0.5, 0.9, 0.999])


def of(function, at):
    return np.array([function(float(s)) for s in at])


@pytest.mark.parametrize("function", [barrier, barrier_slope, barrier_curvature])
def test_beyond_its_reach_there_is_none(function):
    assert [function(s) for s in (1.0, 1.5)] == [0.0, 0.0]
    assert function(1.0 - 1e-9) < 1e-8


def test_the_barrier_is_that_of_the_ipc_toolkit():
    ipctk = pytest.importorskip("ipctk")
    published, reach = ipctk.ClampedLogBarrier(), 0.7
    for s in AT:
        d = float(s) * reach
        assert reach**2 * barrier(float(s)) == pytest.approx(published(d, reach), rel=1e-12)
        assert -reach * barrier_slope(float(s)) == pytest.approx(
            published.first_derivative(d, reach), rel=1e-12
        )
        assert barrier_curvature(float(s)) == pytest.approx(
            published.second_derivative(d, reach), rel=1e-9, abs=1e-12
        )
