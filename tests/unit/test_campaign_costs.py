"""The cost of a run over its repeats."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.campaigns.grid_runs import costs_of, least, over_repeats
from mpmfw.campaigns.store import COSTS, Cost
from mpmfw.state.clock import STEP_STAGES


def cost(cpu_time: float, stage: float, peak_memory: float = math.nan) -> Cost:
    values = {
        **dict.fromkeys((name for name, _, _ in COSTS), 7.0),
        "cpu_time": cpu_time,
        "peak_memory": peak_memory,
    }
    return Cost(
        "exclusive", values, dict.fromkeys(STEP_STAGES, stage), dict.fromkeys(STEP_STAGES, 0.0), 0.0, ""
    )


def test_the_cost_is_that_of_the_cheapest_repeat_with_its_own_stages():
    each = costs_of({"contact": ["a"]}, {(0,): [cost(3.0, 0.5, 9.0), cost(2.0, 0.25), cost(6.0, 0.1)]})
    one = least(each)
    assert one["cpu_time"].item() == 2.0
    assert (one["stages"] == 0.25).all()
    assert one["peak_memory"].item() == 9.0  # only a process's first run knows it
    assert over_repeats(each)["cpu_time_spread"].item() == 2.0


def test_runs_without_a_cost_have_none():
    one = least(costs_of({"contact": ["a", "b"]}, {(1,): [cost(1.0, 0.1)]}))
    assert np.isnan(one["cpu_time"].values[0])
    assert one["cpu_time"].values[1] == 1.0
    none = costs_of({"contact": ["a"]}, {})
    assert np.isnan(least(none)["cpu_time"]).all()
    assert over_repeats(none)["repeats"].item() == 0
