"""The front of a study, what it concludes, and its figures."""

import json

import numpy as np
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mpmfw.studies.conclusion import conclusions
from mpmfw.studies.dataset import front

# -- the front


def brute_force(error, cost):
    on = np.zeros(len(error), dtype=bool)
    for i in range(len(error)):
        known = np.isfinite(error[i]) and np.isfinite(cost[i])
        beaten = [
            error[j] <= error[i] and cost[j] <= cost[i] and (error[j] < error[i] or cost[j] < cost[i])
            for j in range(len(error))
        ]
        on[i] = known and not any(beaten)
    return on


# Few values, so that ties are frequent
NUMBERS = st.sampled_from([0.0, 1.0, 2.0, 3.0, 4.5, np.nan, np.inf])


@given(st.integers(0, 12).flatmap(lambda n: st.tuples(*[arrays(float, n, elements=NUMBERS)] * 2)))
def test_the_front_is_what_nothing_dominates(pairs):
    error, cost = pairs
    np.testing.assert_array_equal(front(error, cost), brute_force(error, cost))


# -- conclusion and figures


def made_up(problem=False):
    error = np.array([[[0.2, 0.05], [0.02, 0.004]], [[0.3, 0.009], [0.02, np.nan]]])
    cost = np.array([[[1.0, 8.0], [2.0, 20.0]], [[1.5, 9.0], [1.9, np.nan]]])
    dims = ("contact", "shape", "cell_size")
    coords = {"contact": ["bardenhagen", "penalty"], "shape": ["gimp", "cpdi"], "cell_size": [0.4, 0.2]}
    if problem:
        error, cost, dims = np.stack([error, error]), np.stack([cost, cost]), ("scene", *dims)
        coords["scene"] = ["slip", "no slip"]
    status = np.where(np.isfinite(error), "ok", "failed: it left the grid").astype(object)
    timing = np.full(error.shape, "exclusive", dtype=object)
    values = {
        "error": error,
        "cpu_time": cost,
        "cpu_time_spread": 0.1 * cost,
        "status": status,
        "timing": timing,
    }
    return xr.Dataset(
        {name: (dims, each) for name, each in values.items()},
        coords,
        {
            "kind": "study", "quantity": "end-displacement", "under": 0.01, "timing": "exclusive",
            "problem_dims": json.dumps(["scene"] if problem else []),
        },
    )  # fmt: skip


def test_the_cheapest_combination_under_an_error_is_named():
    (said,) = conclusions(made_up())
    assert "penalty, gimp, cell_size 0.2, 9 s ± 0.9 s" in said
    (said,) = conclusions(made_up(), under=0.1)
    assert "penalty, cpdi, cell_size 0.4, 1.9 s" in said
    (said,) = conclusions(made_up(), under=0.001)
    assert "0.4 %, has bardenhagen, cpdi, cell_size 0.2" in said
    assert [line.partition(":")[0] for line in conclusions(made_up(problem=True))] == ["slip", "no slip"]
