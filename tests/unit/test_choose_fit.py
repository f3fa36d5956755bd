"""What coarse runs let expect of finer ones: on errors and costs that are made up."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpmfw.studies.fitting import CostFit, ErrorFit, Pilot
from mpmfw.studies.verdicts import Chance, Task, best_of, verdict, with_reasons


def runs(*errors: float, coarsest: float = 0.8, cost: float = 1.0) -> list[Pilot]:
    """Runs at cells of the coarsest over 1, 2, 3; costs are those of (2e-4 + 1e-6 points) s a step."""
    cells = [coarsest / k for k in range(1, len(errors) + 1)]
    steps, points = [800.0 / h for h in cells], [100.0 / h**2 for h in cells]
    return [
        Pilot(h, e, cost * s * (2e-4 + 1e-6 * n), s, n)
        for h, e, s, n in zip(cells, errors, steps, points, strict=True)
    ]


def task(target: float, signed: bool = False, slack: float = 0.0) -> Task:
    return Task(target, [0.8 / k for k in (1, 2, 3, 4, 6, 8)], signed, 2, slack)


@pytest.mark.parametrize("order", [0.8, 1.0, 2.0])
def test_an_error_that_falls_as_a_power_is_within_the_bounds(order: float) -> None:
    fit = ErrorFit(runs(*(0.04 / k**order for k in (1, 2))), signed=False)
    for k in (3, 4):  # at order 2 and a quarter of these a limit cannot be ruled out
        found = fit.at(0.8 / k)
        assert found.low < 0.04 / k**order < found.high
    assert fit.at(0.1).median < fit.at(0.2).median < fit.at(0.4).median


def test_the_chance_of_an_error_is_a_half_at_its_median() -> None:
    fit = ErrorFit(runs(0.04), signed=False)
    found = fit.at(0.4)
    chances = [fit.chance(0.4, size) for size in (found.low, found.median, found.high)]
    assert chances == pytest.approx([0.05, 0.5, 0.95], abs=1e-4)


def test_an_error_that_has_levelled_off_is_not_thought_to_fall() -> None:
    fit = ErrorFit(runs(0.0126, 0.0122), signed=False)
    assert fit.level().low > 0.003
    assert fit.at(0.1).low < 0.012 < fit.at(0.1).high
    assert fit.at(0.1).median > 0.007


def test_a_third_run_narrows_the_bounds() -> None:
    two, three = (
        ErrorFit(runs(*errors), signed=False).at(0.1) for errors in ((0.04, 0.02), (0.04, 0.02, 0.0133))
    )
    assert three.high - three.low < two.high - two.low


def test_errors_that_change_sign_are_not_thought_to_vanish() -> None:
    """−2 % and +0.5 %: sizes alone would promise a fall without end."""
    signed, unsigned = (
        ErrorFit(runs(sign * 0.02, 0.005), signed).at(0.1) for sign, signed in ((-1, True), (1, False))
    )
    assert signed.high > 0.009
    assert signed.median > unsigned.median


def test_a_run_before_convergence_is_left_out() -> None:
    assert ErrorFit(runs(0.996, 0.008), signed=False).at(0.2).high > 0.01
    assert ErrorFit(runs(0.05, 0.008), signed=False).at(0.2).high < 0.01


@given(
    limit=st.floats(0.0, 0.02),
    slope=st.floats(0.001, 0.1),
    order=st.floats(0.6, 2.5),
    scatter=st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1)),
)
def test_bounds_hold_what_errors_with_some_scatter_come_to(
    limit: float, slope: float, order: float, scatter: tuple[float, float]
) -> None:
    """At the next cells of the ladder, whatever the order and the limit are: the upper bound, twice as far as it is wide."""
    errors = [limit + slope / k**order for k in (1, 2, 3)]
    coarse = [error * (1.0 + noise) for error, noise in zip(errors, scatter, strict=False)]
    found = ErrorFit(runs(*coarse), signed=False).at(0.8 / 3)
    assert 0.0 <= found.low <= found.median <= found.high
    assert errors[2] < found.median + 2.0 * (found.high - found.median)


def test_costs_are_steps_times_calls_and_points() -> None:
    pilots = runs(0.04, 0.02, 0.01)
    fit = CostFit(pilots[:2], 2)
    assert fit.at(pilots[2].cell_size) == pytest.approx(pilots[2].cost)
    assert fit.at(0.1) == pytest.approx(8000.0 * (2e-4 + 1e-6 * 1e4))


def test_one_run_alone_is_taken_to_cost_its_points() -> None:
    pilots = runs(0.04)
    assert CostFit(pilots, 2).at(0.4) == pytest.approx(8.0 * pilots[0].cost)
    assert CostFit(pilots, 3).at(0.4) == pytest.approx(16.0 * pilots[0].cost)


def test_a_run_that_meets_the_target_is_an_answer_without_bounds() -> None:
    found = verdict(runs(0.04, 0.008), task(0.01))
    assert (found.kind, found.cell_size) == ("measured", 0.4)
    assert found.error.low == found.error.high == 0.008


def test_a_target_below_all_runs_is_predicted_where_it_is_nearly_certain() -> None:
    found = verdict(runs(0.04, 0.01), task(0.008))
    assert found.kind == "predicted"
    assert found.cell_size < 0.4
    assert found.error.high <= 0.008
    assert found.cost > runs(0.04, 0.01)[1].cost


def test_what_levels_off_is_out_of_reach_and_what_may_fall_is_unsure() -> None:
    assert verdict(runs(0.0126, 0.0122), task(0.002)).kind == "out of reach"
    assert verdict(runs(0.04, 0.02), task(0.006)).kind == "unsure"
    assert verdict([], task(0.01)).kind == "failed"


def test_what_errors_are_against_adds_to_their_bounds() -> None:
    assert verdict(runs(0.04, 0.008), task(0.01, slack=0.001)).error.high == pytest.approx(0.009)
    assert verdict(runs(0.04, 0.008), task(0.01, slack=0.003)).kind != "measured"
    assert verdict(runs(0.04, 0.008), task(0.01, slack=np.inf)).kind == "unsure"


def test_every_method_has_a_reason() -> None:
    asked = task(0.01)
    verdicts = {
        (0, 0): verdict(runs(0.04, 0.008), asked),
        (0, 1): verdict(runs(0.04, 0.009, cost=2.0), asked),
        (1, 0): verdict(runs(0.126, 0.122), asked),
        (1, 1): verdict([], asked),
        (2, 0): verdict(runs(0.04), asked),
    }
    assert best_of(verdicts) == (0, 0)
    found = with_reasons(
        verdicts, {(1, 1): "failed: it fell over"}, {(2, 0): Chance(3.0 * verdicts[0, 0].cost, 0.4)}, asked
    )
    assert found[0, 0].why == "the answer: a pilot run has it"
    assert found[0, 1].why == "meets it at 0.4 m, at 2 times the cost of the answer"
    assert found[1, 0].why.startswith("does not meet it: ")
    assert "; levels off at " in found[1, 0].why
    assert found[1, 1].why == "failed: it fell over"
    assert found[2, 0].why == "its finer cells take at least 3 times the cost of the answer"
    cheaper = with_reasons(verdicts, {}, {(2, 0): Chance(0.7 * verdicts[0, 0].cost, 0.2)}, asked)
    assert cheaper[2, 0].why.endswith(
        "0.7 times the cost of the answer, and to meet the target with a probability of 20 %"
    )
