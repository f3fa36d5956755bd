"""Hard cases by every method, shifted and turned in a covering design."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from design import Row, label, rows, rows_in_space
from hard_cases import (
    CASES,
    IN_SPACE,
    METHODS,
    METHODS_IN_SPACE,
    MUST_HOLD,
    MUST_STAY_BOUNDED,
    complaints,
    outcome,
)
from known import KNOWN, reason
from places import CELL, PLACES_IN_SPACE, SHIFTS, TURNS, covering, placed, rotation_of

from mpmfw.geometry import Box

pytestmark = pytest.mark.stability


@pytest.mark.parametrize("row", rows() + rows_in_space(), ids=label)
def test_hard_case(row: Row):
    case, contact, shape = row[:3]
    wrong = complaints(case, contact, shape, outcome(*row))
    why = reason(case, contact, shape)
    if why is None:
        assert not wrong, "; ".join(wrong)
    elif not wrong:
        raise AssertionError(f"holds after all; the table says: {why}")
    else:
        pytest.xfail(why)


def test_design_covers_all_pairs():
    factors = [list(range(4)), list(range(3)), list(range(3)), list(range(2))]
    made = covering(*factors)
    for i, j in itertools.combinations(range(len(factors)), 2):
        assert {(row[i], row[j]) for row in made} == set(itertools.product(factors[i], factors[j]))
    assert len(made) <= 14  # 12 at least


def test_every_case_is_shifted_and_turned():
    made = rows()
    for case in CASES:
        assert {shift for name, _, _, shift, _ in made if name == case} == set(SHIFTS)
        assert {turn for name, *_, turn in made if name == case} == set(TURNS)
    assert {row[1:3] for row in made} == set(METHODS)
    for method in MUST_HOLD + MUST_STAY_BOUNDED:
        assert {row[3] for row in made if row[1:3] == method} == set(SHIFTS)
        assert {row[4] for row in made if row[1:3] == method} == set(TURNS)


def test_cases_in_space_visit_every_place_and_method():
    made = rows_in_space(full=False)
    assert [case for case, *_ in made[::2]] == list(IN_SPACE)
    assert {row[3:] for row in made} == set(PLACES_IN_SPACE)
    assert {row[1:3] for row in made} == set(METHODS_IN_SPACE)


def test_boxes_turn_and_move_as_a_whole():
    shift, turn = PLACES_IN_SPACE[-1]
    scene = IN_SPACE["space-corner-face"].build()
    for before, after in zip(
        scene["bodies"].values(), placed(scene, shift, turn)["bodies"].values(), strict=True
    ):
        (first, _), (last, _) = (Box(**body["geometry"]).surfaces(1.0)[0] for body in (before, after))
        np.testing.assert_allclose(last, first @ rotation_of(turn).T + CELL * np.array(shift), atol=1e-12)
        np.testing.assert_allclose(after["velocity"], rotation_of(turn) @ before["velocity"])


def test_known_failures_name_cases_and_methods():
    for case, contact, shape in KNOWN:
        assert case in CASES or case in IN_SPACE
        assert (contact, shape) in (METHODS if case in CASES else METHODS_IN_SPACE)
