"""Springs whose share or rest changes while they are loaded, and new ones: no energy of nothing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_scenes import impact, wave_speed
from mpmfw.runs.simulation import Simulation
from mpmfw_contact._springs import NOISE, WEAK, changed_spring, new_rest

CELL = 0.1  # m
shares = st.floats(WEAK, 1.0)
gaps = st.floats(-0.5 * CELL, -1e-6 * CELL)
rests = st.floats(-0.5 * CELL, 0.0)
slides = st.floats(-2.0 * CELL, 2.0 * CELL)


def energy(share: float, rest: float, gap: float) -> float:
    """Of a spring of unit factor [m²]."""
    return 0.5 * share * max(rest - gap, 0.0) ** 2


@given(part=shares, old_part=shares, rest=rests, slid=slides, gap=gaps)
def test_a_spring_that_changes_never_pulls(part, old_part, rest, slid, gap):
    _, left = changed_spring(part, old_part, rest, slid, gap, CELL)
    assert left >= gap


@given(part=shares, old_part=shares, rest=rests, gap=gaps)
def test_a_spring_that_grows_keeps_its_force_and_one_that_shrinks_its_rest(part, old_part, rest, gap):
    rest = max(rest, gap)  # no more than unloaded
    share, left = changed_spring(part, old_part, rest, 0.0, gap, CELL)
    if part > old_part * (1.0 + NOISE):
        assert share * (left - gap) == pytest.approx(
            old_part * (rest - gap), rel=1e-9, abs=1e-17
        )  # forces are up to 1e-2
    else:
        assert left == rest
    assert share == (old_part if abs(part - old_part) <= NOISE * old_part else part)
    assert energy(old_part, rest, gap) - energy(share, left, gap) >= -1e-18  # nothing is gained


@given(gap=gaps, approached=st.floats(-0.2 * CELL, 0.5 * CELL))
def test_a_new_spring_has_at_most_the_force_of_what_approached(gap, approached):
    rest = new_rest(gap, approached)
    assert gap <= rest <= 0.0
    assert rest - gap == pytest.approx(min(max(approached, 0.0), -gap), abs=1e-15)


def test_a_node_that_comes_in_by_the_face_has_all_of_its_force():
    """At a fifth of the wave speed it comes far deeper in a step than bodies at rest ever lie."""
    mapping = impact(gap=0.0481, speed=0.2 * wave_speed("soft"), slide=0.0)
    mapping["contact"] = {"method": "penalty", "friction": 0.0}
    simulation = Simulation(mapping, shape="cpdi")
    rows = simulation.contact.old
    while not (rows.gap[: rows.count] < 0.0).any():
        simulation.advance(1)
        rows = simulation.contact.old
    loaded = np.flatnonzero(rows.gap[: rows.count] < 0.0)
    depth = -rows.gap[loaded]
    assert depth.min() > 0.015 * CELL
    assert (rows.own.rest[loaded] == 0.0).all()


def test_the_step_of_the_first_touch_is_no_longer_than_that_of_equal_bodies_in_contact():
    """With the depth that it leaves springs begin, and with its square grows the energy that nothing paid
    for.
    """
    simulation = Simulation(
        impact(gap=0.0481, speed=0.02 * wave_speed("soft"), slide=0.0), contact="penalty", shape="bspline"
    )
    contact = simulation.contact
    while True:
        simulation.advance(1)
        rows = contact.old
        if (rows.gap[: rows.count] < 0.0).any():
            break
        assert rows.count
        assert contact.omega_squared >= contact.law.estimate_frequency(contact.bulk_frequency)
    assert simulation.state.steps > 10
