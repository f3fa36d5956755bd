"""Ranking: counted by hand on studies that are made up."""

import json

import numpy as np
import pytest
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.plots.records import profile
from mpmfw.studies.ranking import rank, summary


def study(title="S", **runs):
    """A study of contacts at two cell sizes: (error, CPU time) of each; NaN is a run that failed."""
    contacts = [name.replace("_best", "(best=yes)") for name in runs]
    pairs = np.array(list(runs.values()))
    dims = ("contact", "cell_size")
    status = np.where(np.isfinite(pairs[..., 0]), "ok", "failed: it fell over")
    return xr.Dataset(
        {
            "error": (dims, pairs[..., 0]),
            "cpu_time": (dims, pairs[..., 1]),
            "noise": (dims, np.full(pairs.shape[:2], 0.03)),
            "status": (dims, status.astype(object)),
        },
        coords={"contact": contacts, "cell_size": [0.8, 0.4]},
        attrs={"kind": "study", "title": title, "problem_dims": json.dumps([])},
    )


ONE = study(
    fine=[(0.04, 1.0), (0.008, 10.0)], plain=[(0.3, 0.5), (0.15, 5.0)], plain_best=[(0.09, 2.0), (0.04, 20.0)]
)
TWO = study(
    "T",
    fine=[(np.nan, np.nan), (0.012, 6.0)],
    plain=[(0.02, 1.0), (0.009, 3.0)],
    plain_best=[(0.5, 1.0), (0.2, 2.0)],
)
UNBOUNDED = study(fine=[(np.inf, 1.0), (0.008, np.inf)])
UNBOUNDED["status"][:] = "ok"
ALONG_X = ONE.assign_attrs(quantity="impulse", about='{"axis": "x"}')


def test_a_ranking_says_what_errors_are_of():
    assert rank([ALONG_X, ALONG_X], about={"axis": "x"}).attrs["errors"] == "impulse along x"


def test_a_method_counts_at_the_cheapest_of_its_settings():
    cost = rank([ONE])["cost"].sel(quantity="error", problem="S")
    assert cost.sel(contact="fine").values.tolist()[:4] == [1.0, 1.0, 10.0, 10.0]
    assert np.isnan(cost.sel(contact="fine", level=0.005))
    assert cost.sel(contact="plain").values.tolist()[:2] == [2.0, 20.0]
    best = rank([ONE])["best"].sel(quantity="error", problem="S", contact="plain", level=0.1).item()
    assert best == "(best=yes) cell_size 0.8"


def test_the_table_counts_problems_and_compares_costs_with_the_cheapest():
    fine, plain = summary(rank([ONE, TWO]), "error")
    assert (fine["method"], plain["method"]) == ("fine", "plain")
    assert [fine[f"{level} %"] for level in ("10", "5", "2", "1", "0.5")] == [2, 2, 2, 1, 0]
    assert [plain[f"{level} %"] for level in ("10", "5", "2", "1", "0.5")] == [2, 2, 1, 1, 0]
    # fine over the best: 1, 1, 1, 1 of S and 6, 6, 6 of T; plain: 2, 20 of S and 1, 1, 1, 1 of T
    assert (fine["over best"], fine["cheapest"]) == (1.0, 4)
    assert (plain["over best"], plain["cheapest"]) == (1.0, 4)


def test_a_profile_ends_at_the_share_that_is_solved():
    ranking = rank([ONE, TWO])
    ratio, share = profile(ranking, "error", "fine")
    assert ratio.tolist() == [1, 1, 1, 1, 6, 6, 6]
    assert share[-1] == pytest.approx(7 / 8)  # eight problems and levels can be solved at all


def test_silence_alone_is_no_virtue():
    noise = rank([ONE])["cost"].sel(quantity="noise", problem="S", level=0.05)
    assert noise.sel(contact="plain").item() == 2.0  # its run of 0.5 s is as quiet, and wrong by 30 %


def test_a_law_that_ran_alone_stands_beside_the_others():
    mine = study(mine=[(0.04, 0.5), (0.008, 5.0)])
    ranking = rank([ONE, mine])
    assert ranking.sizes["problem"] == 1
    assert summary(ranking, "error")[0]["method"] == "mine"
    assert ranking["over_best"].sel(quantity="error", problem="S", contact="fine", level=0.01).item() == 2.0


def test_a_problem_that_a_method_did_not_run_does_not_count_against_it():
    ranking = rank([ONE, study("U", fine=[(0.2, 1.0), (0.09, 5.0)])])
    rows = {row["method"]: row for row in summary(ranking, "error")}
    assert (rows["fine"]["problems"], rows["plain"]["problems"]) == (2, 1)
    assert profile(ranking, "error", "plain")[1][-1] == pytest.approx(2 / 4)  # of the four levels of S alone


@pytest.mark.parametrize(
    ("results", "options", "said"),
    [
        ([ONE.assign_attrs(kind="run")], {}, "dataset: expected the results of a study"),
        ([ONE], {"by": "shape"}, "does not vary 'shape'; it varies contact, cell_size"),
        ([], {}, "nothing to rank: no run has an error and a cost"),
        ([UNBOUNDED], {}, "nothing to rank: no run has an error and a cost"),
        ([ALONG_X], {"about": {"axis": "y"}}, "axis y: dataset has the error of impulse along x"),
        ([ONE], {"about": {"body": "disc"}}, "body disc: dataset has the error of"),
    ],
)
def test_what_cannot_be_ranked_is_refused(results, options, said):
    with pytest.raises(SceneError, match=said):
        rank(results, **options)
