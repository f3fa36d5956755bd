"""Which run a choice makes next: chances of methods after some of their errors."""

from __future__ import annotations

import numpy as np
import pytest

from mpmfw.studies.chances import chances
from mpmfw.studies.verdicts import Chance

METHODS = [(contact, shape) for contact in range(3) for shape in range(2)]


def test_nothing_is_known_beforehand_that_tells_methods_apart() -> None:
    found = chances(METHODS, {}, 0.02)
    assert list(found) == METHODS
    assert found == pytest.approx(dict.fromkeys(METHODS, 0.5))  # 2 % is the median that is believed
    assert all(chances(METHODS, {}, 0.005)[one] < found[one] for one in METHODS)


def test_a_contact_that_is_far_off_is_thought_so_with_the_other_shape_function_more_than_other_contacts() -> (
    None
):
    found = chances(METHODS, {(0, 0): 0.15}, 0.02)
    assert found[0, 1] < found[1, 0] < found[1, 1] < 0.5
    assert found[1, 0] == pytest.approx(found[2, 0])


def test_what_has_run_is_known_and_signs_do_not_count() -> None:
    errors = {(0, 0): -0.15, (1, 1): 0.004}
    found = chances(METHODS, errors, 0.02)
    assert found[0, 0] == pytest.approx(0.0, abs=1e-9)
    assert found[1, 1] == pytest.approx(1.0, abs=1e-9)
    assert found[1, 0] > 0.5 > found[0, 1]


def test_the_chance_is_that_of_errors_drawn_so() -> None:
    """ln e of one scene, contact, shape and method, drawn a hundred thousand times: the share below the target."""
    random = np.random.default_rng(1)
    n = 100_000
    scene, contact, shapes = (
        2.0 * random.normal(size=n),
        1.5 * random.normal(size=n),
        0.5 * random.normal(size=(2, n)),
    )
    first, second = np.exp(np.log(0.02) + scene + contact + shapes + 0.7 * random.normal(size=(2, n)))
    near = np.abs(np.log(first / 0.1)) < 0.1
    share = np.mean(second[near] < 0.02)
    assert chances(METHODS, {(0, 0): 0.1}, 0.02)[0, 1] == pytest.approx(share, abs=0.02)


@pytest.mark.parametrize("error", [1.0, 30.0])
def test_errors_of_more_than_all_count_as_all(error: float) -> None:
    assert chances(METHODS, {(0, 0): error}, 0.02) == chances(METHODS, {(0, 0): 1.0}, 0.02)


def test_a_run_is_worth_it_where_the_next_use_pays_for_it() -> None:
    assert Chance(0.3, 0.5).saves(1.0)  # half a chance of saving 0.7, for 0.3
    assert not Chance(0.4, 0.5).saves(1.0)
    assert not Chance(0.6, 1.0).saves(1.0)
    assert Chance(1.0, 0.5).price == 2.0 * Chance(1.0, 1.0).price
