"""The error of a run: against a closed form, a reference or the finest run."""

import json

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mpmfw.campaigns.measures import MEASURES, About
from mpmfw.errors import SceneError
from mpmfw.scene import load_scene
from mpmfw.studies.conclusion import conclusions
from mpmfw.studies.dataset import front
from studies_for_tests import judge_of, tiny_study


def judged(error, **changes):
    return judge_of(tiny_study(error=error, **changes))


def run_of(distance, end=0.02, n=11):
    """A run whose block moves by a known way, as a parabola in time."""
    time = np.linspace(0.0, end, n)
    x = np.zeros((n, 2, 2))
    x[:, 0, 0] = distance * (time / 0.02) ** 2
    series = xr.Dataset(
        {"centre_of_mass": (("time", "body", "axis"), x)},
        coords={"time": time, "body": ["block", "plane"], "axis": ["x", "y"]},
    )
    return xr.DataTree.from_dict({"/series": series})


EXACT = 0.5 * 10.0 * (np.sin(0.4) - 0.1 * np.cos(0.4)) * 0.02**2


def test_error_against_the_closed_form():
    judge, grid = judged({"quantity": "end-displacement"})
    ways = dict(zip(grid.combinations, (1.1, 0.8, 1.0, 1.0), strict=True))
    ok = {index: k < 3 for k, index in enumerate(grid.combinations)}
    found = judge.judge(lambda index: run_of(ways[index] * EXACT) if ok[index] else None)
    errors = [one.error for one in found.values()]
    assert errors == pytest.approx([0.1, 0.2, 0.0, np.nan], nan_ok=True, abs=1e-9)
    assert found[0, 0].value == pytest.approx(1.1 * EXACT)
    assert found[0, 0].expected == pytest.approx(EXACT)


def test_error_of_a_curve_in_two_norms():
    curve = {"quantity": "displacement"}
    for norm, expected in (("largest", 0.1), ("l2", 0.1)):
        judge, _ = judged({**curve, "norm": norm})
        found = judge.judge(lambda _: run_of(1.1 * EXACT))
        assert found[0, 0].error == pytest.approx(expected)


def test_error_against_the_finest_run_interpolates_in_time():
    judge, grid = judged({"quantity": "displacement", "kind": "finest", "finest": {"contact": "penalty"}})
    assert {judge.finest(index) for index in grid.combinations} == {(1, 1)}
    ways = {(0, 0): 1.2, (0, 1): 1.5, (1, 0): 0.9, (1, 1): 1.0}
    found = judge.judge(lambda index: run_of(ways[index], n=2001 if index == (1, 1) else 7))
    expected = [0.2, 0.5, 0.1, np.nan]
    assert [one.error for one in found.values()] == pytest.approx(expected, nan_ok=True, abs=1e-5)


def test_error_against_a_file(tmp_path):
    (tmp_path / "way.csv").write_text("# made up\ntime,way\n0,0\n0.01,1\n0.02,2\n", encoding="utf-8")
    file = str(tmp_path / "way.csv")
    judge, _ = judged({"quantity": "displacement", "kind": "reference", "file": file})
    found = judge.judge(lambda _: run_of(2.0, n=3))
    assert found[0, 0].error == pytest.approx(0.25)
    beyond = judge.judge(lambda _: run_of(2.0, end=0.03, n=3))
    assert np.isnan(beyond[0, 0].error)
    bad = {
        "time,a,b\n0,0,0\n1,1,1\n": "error.column",
        "time,a\n1,0\n0,1\n": "rising",
        "time,a\n0,0,3\n1,1,3\n": "cannot be read as CSV: Length of header",
    }
    for text, message in bad.items():
        (tmp_path / "way.csv").write_text(text, encoding="utf-8")
        with pytest.raises(SceneError, match=message):
            judged({"quantity": "displacement", "kind": "reference", "file": file})


@pytest.mark.parametrize("quantity", MEASURES)
@pytest.mark.parametrize(("key", "given"), [("body", "block"), ("pair", "block-plane"), ("axis", "x")])
def test_a_key_that_a_measure_does_not_look_at_is_refused(quantity, key, given):
    error = {"quantity": quantity, "kind": "finest", key: given}
    if MEASURES[quantity].kind == "field":
        error["kind"] = "closed-form"
    if key in MEASURES[quantity].keys:
        assert judged(error)[0].measure is MEASURES[quantity]
        return
    with pytest.raises(SceneError, match=rf"^error\.{key}: has no effect: {quantity} takes "):
        judged(error)


def seen_run():
    """A run in which every body, pair and axis has a way, an energy and a force of its own."""
    time = np.linspace(0.0, 0.02, 5)
    t = time[:, None]
    way = t[..., None] ** 2 * np.array([[1.0, 2.0], [3.0, 4.0]])
    series = xr.Dataset(
        {
            "centre_of_mass": (("time", "body", "axis"), way),
            "angular_velocity": (("time", "body", "rotation"), (t * [1.0, 2.0])[..., None]),
            "kinetic_energy": (("time", "body"), t * [1.0, 2.0]),
            "contact_force": (("time", "pair", "axis"), t[..., None] * [[[1.0, 2.0], [3.0, 4.0]]]),
        },
        coords={"time": time, "body": ["block", "plane"], "axis": ["x", "y"], "pair": PAIRS},
    )
    points = {
        f"/particles/{body}": xr.Dataset(
            {"position": (("time", "axis"), way[:, k])}, coords={"axis": ["x", "y"]}
        )
        for k, body in enumerate(NAMES["body"])
    }
    return xr.DataTree.from_dict({"/series": series, **points})


PAIRS = ["block-plane", "block-third"]
NAMES = {"body": ("block", "plane"), "pair": tuple(PAIRS), "axis": ("x", "y")}


def with_pairs():
    """The scene with a third body, so that there is more than one pair."""
    _, grid = judged({"quantity": "acceleration"})
    scene = next(iter(grid.scenes.values()))
    third = {**scene.to_mapping()["bodies"]["block"]}
    third["geometry"] = {"type": "rectangle", "lower": [0.81, 0.013], "upper": [1.21, 0.413]}
    return load_scene({**scene.to_mapping(), "bodies": {**scene.to_mapping()["bodies"], "third": third}})


@pytest.mark.parametrize(("quantity", "key"), [(m.name, key) for m in MEASURES.values() for key in m.keys])
def test_a_key_that_a_measure_looks_at_changes_what_it_measures(quantity, key):
    scene, run = with_pairs(), seen_run()
    found = [MEASURES[quantity].of(run, scene, About(**{key: name})).values for name in NAMES[key]]
    assert not np.allclose(found[0], found[1])


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"axis": "y"}, "error.kind: the scene 'scene' has no closed form for displacement along y; expected kind = 'finest'"),  # noqa: E501
        ({"body": "plane", "axis": "y"}, "error.kind: .* no closed form for displacement of plane along y; "),
        ({"axis": "z"}, "error.axis: 'z' is no axis of the scene; expected one of x, y"),
        ({"body": "blok"}, "error.body: 'blok' is no body of the scene; expected one of block, plane"),
    ],
)  # fmt: skip
def test_what_has_no_closed_form_is_named(given, said):
    with pytest.raises(SceneError, match=f"^{said}"):
        judged({"quantity": "displacement", **given})


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
