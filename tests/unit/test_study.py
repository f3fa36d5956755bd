"""Parts of a study that run nothing: files, keys, the front, errors, the store, the conclusion, the figures."""

import functools
import json
import multiprocessing
import warnings
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mpmfw.discovery import available
from mpmfw.errors import MpmfwError, SceneError
from mpmfw.plots import figures_of
from mpmfw.scene import load_scene
from mpmfw.scene.loading import shipped_scenes
from mpmfw.studies.conclusion import conclusions
from mpmfw.studies.exact import column, incline
from mpmfw.studies.grid import make_grid
from mpmfw.studies.identity import key_of
from mpmfw.studies.judging import Judge
from mpmfw.studies.keys import as_number, dimension_names, finer, is_numerical, overrides_of
from mpmfw.studies.loading import load_study, shipped_studies
from mpmfw.studies.measures import MEASURES
from mpmfw.studies.pareto import front
from mpmfw.studies.store import Cost, Record, Store
from studies_for_tests import SLIDING, tiny_study

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


def test_the_front_keeps_the_shape_and_leaves_out_what_is_not_known():
    error = np.array([[0.1, np.nan], [0.05, 0.2]])
    cost = np.array([[1.0, 0.1], [2.0, 3.0]])
    np.testing.assert_array_equal(front(error, cost), [[True, False], [True, False]])


# -- keys


def test_short_names_stand_for_keys_of_every_body():
    scene = load_scene(SLIDING)
    assert overrides_of(scene, "cfl", 0.3) == {"time.safety": 0.3}
    assert overrides_of(scene, "segment", "1 cell") == {
        "bodies.block.segment": "1 cell",
        "bodies.plane.segment": "1 cell",
    }
    assert set(overrides_of(scene, "particles_per_cell", 4).values()) == {"0.5 cells"}
    with pytest.raises(SceneError, match="expected a positive number"):
        overrides_of(scene, "particles_per_cell", 0)


def test_keys_that_change_the_method_and_keys_that_change_the_problem():
    methods = ("contact", "shape", "cell_size", "kappa", "cfl", "particle_size", "bodies.block.segment")
    assert all(is_numerical(key) for key in (*methods, "stepping.transported", "contact.penalty.damping"))
    problems = ("contact.friction", "contact.pairs[0].friction", "gravity.tilt", "materials.soft.density")
    assert not any(is_numerical(key) for key in (*problems, "time.end", "settle.gravity.tilt"))


def test_names_of_dimensions_are_last_parts_unless_they_clash():
    names = dimension_names(["contact", "bodies.a.segment", "bodies.b.segment", "contact.pairs[0].friction"])
    assert list(names.values()) == ["contact", "bodies_a_segment", "bodies_b_segment", "friction"]
    assert dimension_names(["materials.soft.stage"])["materials.soft.stage"] == "materials_soft_stage"


def test_what_is_finer():
    assert (finer("cell_size"), finer("particles_per_cell"), finer("kappa")) == (-1, 1, 0)
    assert (as_number("0.5 cells"), as_number("2 mm"), as_number("cpdi"), as_number(True)) == (
        0.5,
        0.002,
        None,
        None,
    )


# -- files

GOOD = """\
scene = "sliding-block"

[vary]
contact = ["none", "penalty"]
cell_size = [0.2, 0.1]

[error]
quantity = "acceleration"
"""


def judge_of(study):
    """All that is checked before the first run."""
    loaded = load_study(study)
    grid = make_grid(loaded)
    return Judge(loaded, grid), grid


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("contact =", "contacts =", 4, "did you mean 'contact'"),
        ("cell_size =", "cel_size =", 5, "did you mean 'cell_size'"),
        ('"none", ', '"non", ', 4, "did you mean 'none'"),
        ("[0.2, 0.1]", "[0.2, -0.1]", 5, "must be greater than 0"),
        ("[0.2, 0.1]", "0.2", 5, "expected an array"),
        ("[0.2, 0.1]", "[]", 5, "has 0 entries"),
        ("[0.2, 0.1]", "[0.2, 0.2]", 5, "0.2 is given twice"),
        ("cell_size =", '"contact.method" =', 5, "sets the same key"),
        ("cell_size =", '"bodies.blok.segment" =', 5, "did you mean 'block'"),
        ('quantity = "acceleration"', 'quantity = "aceleration"', 8, "did you mean 'acceleration'"),
        ('quantity = "acceleration"', "", 7, "quantity: missing"),
        ("[error]", "[error]\nfile = 'a.csv'", 8, "has no effect"),
        ("[error]", "[error]\nkind = 'finest'\nfinest = { shape = 'cpdi' }", 9, "is not varied"),
        ("[error]", "[error]\nnorm = 'l2'", 8, "is a number"),
        ("[error]", "[error]\nkind = 'closed'", 8, "did you mean 'closed-form'"),
        ("[error]", "[error]\nbody = 'blok'", 8, "no body of the scene"),
        ('"acceleration"', '"impulse"', 1, "kind = 'finest'"),
        ('scene = "sliding-block"', 'scene = "sliding-blok"', 1, "did you mean 'sliding-block'"),
        ('scene = "sliding-block"', "", 1, "scene: missing"),
        ("[error]", "[cost]\nrepeats = 0\n[error]", 8, "must be at least 1"),
        ("[error]", "[set]\ncell_size = 0.3\n[error]", 8, "takes its place"),
        ("[error]", "[set]\n'time.ende' = 0.3\n[error]", 8, "did you mean 'end'"),
        ("[vary]", "[vary", 3, "not valid TOML"),
    ],
)
def test_a_mistake_is_one_message_with_its_line(tmp_path, old, new, line, message):
    assert old in GOOD
    path = tmp_path / "s.toml"
    path.write_text(GOOD.replace(old, new), encoding="utf-8")
    with pytest.raises(SceneError) as error:
        judge_of(path)
    text = str(error.value)
    assert len(text.splitlines()) == 1
    assert text.startswith(f"{path}:{line}:") or "kind = 'finest'" in message
    assert message in text


def test_several_mistakes_are_a_line_each(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(GOOD.replace("contact =", "contacts =").replace("acceler", "acelr"), encoding="utf-8")
    with pytest.raises(SceneError) as error:
        load_study(path)
    assert [line.split(":")[1] for line in str(error.value).splitlines()] == ["4", "8"]


def test_shipped_studies_are_valid_and_their_scenes_have_the_error_that_they_ask_for(monkeypatch):
    installed = functools.cache(available)  # they do not change, and are looked up for every scene
    monkeypatch.setattr("mpmfw.discovery.available", installed)
    monkeypatch.setattr("mpmfw.scene.options.available", installed)
    assert {"rolling-cylinder", "rings", "contact-stress", "sliding-block"} == set(shipped_studies())
    for name in shipped_studies():
        judge, grid = judge_of(name)
        assert judge.exact
        assert all(one.scene is not None for one in grid.combinations.values())


def test_an_unknown_study_is_refused_with_the_nearest_name():
    with pytest.raises(SceneError, match="did you mean 'rings'"):
        load_study("ring")


# -- what is known of scenes


def test_closed_forms_of_shipped_scenes():
    shipped = shipped_scenes()
    block = incline(load_scene("sliding-block"))
    assert block is not None
    assert block.acceleration == pytest.approx(10.0 * (0.5 - 0.3 * np.sqrt(0.75)))
    rolls = incline(load_scene("rolling-cylinder-slip"))
    assert rolls is not None
    assert rolls.until == pytest.approx(1.663, abs=1e-3)
    pressed = column(load_scene("contact-stress"))
    assert pressed is not None
    assert (pressed.lower, pressed.upper, pressed.pressure) == ("lower", "upper", 2e5)
    assert [name for name in shipped if incline(load_scene(name))] == [
        "rolling-cylinder-no-slip",
        "rolling-cylinder-slip",
        "sliding-block",
    ]


@pytest.mark.parametrize(
    "change",
    [
        {"contact.friction": 0.9},
        {"bodies.block.velocity": [1.0, 0.0]},
        {"bodies.block.geometry": {"type": "rectangle", "lower": [0.1, 0.013], "upper": [0.2, 0.9]}},
        {"gravity": {"vector": [1.0, -9.0]}},
    ],
)
def test_a_block_that_need_not_slide_has_no_closed_form(change):
    assert incline(load_scene("sliding-block", set=change)) is None


# -- the same run


def test_a_run_is_known_by_its_meaning():
    scene = load_scene("sliding-block")
    key = key_of(scene)
    assert key_of(load_scene("sliding-block", set={"title": "another"})) == key
    assert key_of(load_scene("sliding-block", set={"contact.penalty.kappa": 2.0})) != key
    without = [
        load_scene("sliding-block", set={"contact.method": "none", "grid.cell_size": h}) for h in (0.2, 0.1)
    ]
    assert key_of(without[0]) != key_of(without[1])
    with_other = {"contact.method": "none", "contact.penalty.kappa": 2.0, "grid.cell_size": 0.2}
    assert key_of(load_scene("sliding-block", set=with_other)) == key_of(without[0])


# -- errors


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
    found = judge.judge(lambda index: run_of(ways[index] * EXACT), ok)
    errors = [one.error for one in found.values()]
    assert errors == pytest.approx([0.1, 0.2, 0.0, np.nan], nan_ok=True, abs=1e-9)
    assert found[0, 0].value == pytest.approx(1.1 * EXACT)
    assert found[0, 0].expected == pytest.approx(EXACT)


def test_error_of_a_curve_in_two_norms():
    curve = {"quantity": "displacement"}
    for norm, expected in (("largest", 0.1), ("l2", 0.1)):
        judge, grid = judged({**curve, "norm": norm})
        found = judge.judge(lambda _: run_of(1.1 * EXACT), dict.fromkeys(grid.combinations, True))
        assert found[0, 0].error == pytest.approx(expected)


def test_error_against_the_finest_run_interpolates_in_time():
    judge, grid = judged({"quantity": "displacement", "kind": "finest", "finest": {"contact": "penalty"}})
    assert {judge.finest(index) for index in grid.combinations} == {(1, 1)}
    ways = {(0, 0): 1.2, (0, 1): 1.5, (1, 0): 0.9, (1, 1): 1.0}
    found = judge.judge(
        lambda index: run_of(ways[index], n=2001 if index == (1, 1) else 7),
        dict.fromkeys(grid.combinations, True),
    )
    expected = [0.2, 0.5, 0.1, np.nan]
    assert [one.error for one in found.values()] == pytest.approx(expected, nan_ok=True, abs=1e-5)


def test_each_method_has_its_own_finest_run_unless_one_is_chosen():
    judge, grid = judged({"quantity": "displacement", "kind": "finest"})
    assert [judge.finest(index)[0] for index in grid.combinations] == [0, 0, 1, 1]
    assert {judge.finest(index)[1] for index in grid.combinations} == {1}


def test_error_against_a_file(tmp_path):
    (tmp_path / "way.csv").write_text("# made up\ntime,way\n0,0\n0.01,1\n0.02,2\n", encoding="utf-8")
    file = str(tmp_path / "way.csv")
    judge, grid = judged({"quantity": "displacement", "kind": "reference", "file": file})
    found = judge.judge(lambda _: run_of(2.0, n=3), dict.fromkeys(grid.combinations, True))
    assert found[0, 0].error == pytest.approx(0.25)
    beyond = judge.judge(lambda _: run_of(2.0, end=0.03, n=3), dict.fromkeys(grid.combinations, True))
    assert np.isnan(beyond[0, 0].error)
    for text, message in (("time,a,b\n0,0,0\n1,1,1\n", "error.column"), ("time,a\n1,0\n0,1\n", "rising")):
        (tmp_path / "way.csv").write_text(text, encoding="utf-8")
        with pytest.raises(SceneError, match=message):
            judged({"quantity": "displacement", "kind": "reference", "file": file})


def test_error_against_a_value():
    judge, grid = judged({"quantity": "acceleration", "kind": "reference", "value": 4.0})
    found = judge.judge(lambda _: run_of(0.5 * 5.0 * 0.02**2), dict.fromkeys(grid.combinations, True))
    assert found[0, 0].error == pytest.approx(0.25)


def test_measures_say_what_they_are():
    for measure in MEASURES.values():
        assert measure.meaning
        assert measure.unit


# -- the store

COST = Cost("exclusive", {"cpu_time": 1.5}, {"shape": 0.5})


def record(key, status="ok"):
    return Record(key, status, "a run", "title = 'x'", "", ("a note",), (COST,))


def test_a_record_comes_back_as_it_was(tmp_path):
    Store(tmp_path / "runs").put(record("a"))
    assert Store(tmp_path / "runs").record("a") == record("a")
    assert Store(tmp_path / "runs").record("b") is None


def test_what_would_not_last_is_not_stored(tmp_path):
    store = Store(tmp_path)
    store.put(replace(record("a", "failed: no disk"), lasting=False))
    assert store.record("a").status == "failed: no disk"
    assert Store(tmp_path).record("a") is None


@pytest.mark.parametrize("damage", ["", "{", '{"key": "a"}', "[]"])
def test_a_damaged_record_is_run_again(tmp_path, damage):
    Store(tmp_path).put(record("a"))
    (tmp_path / "a.json").write_text(damage, encoding="utf-8")
    assert Store(tmp_path).record("a") is None


def test_a_record_without_its_results_is_run_again(tmp_path):
    Store(tmp_path).put(replace(record("a"), digest="0123"))
    assert Store(tmp_path).record("a") is None


def write_for_ever(folder, mark):
    store = Store(folder)
    for k in range(100_000):
        store.put(Record("a", "ok", mark * 20_000, str(k)))


def test_files_are_whole_at_every_moment(tmp_path):
    context = multiprocessing.get_context("spawn")
    writers = [context.Process(target=write_for_ever, args=(tmp_path, mark)) for mark in "xy"]
    for writer in writers:
        writer.start()
    path, seen = tmp_path / "a.json", set()
    try:
        while len(seen) < 40:
            if path.exists():
                found = json.loads(path.read_text(encoding="utf-8"))
                assert found["name"] in ("x" * 20_000, "y" * 20_000)
                seen.add((found["name"][0], found["scene"]))
    finally:
        for writer in writers:
            writer.kill()
            writer.join()
    assert Store(tmp_path).record("a") is not None


def test_a_folder_that_cannot_be_written_is_said(tmp_path):
    (tmp_path / "runs").write_text("a file", encoding="utf-8")
    with pytest.raises(MpmfwError, match="cannot write"):
        Store(tmp_path / "runs").put(record("a"))


# -- conclusion and figures


def made_up(problem=False, **changes):
    error = np.array([[[0.2, 0.05], [0.02, 0.004]], [[0.3, 0.009], [0.02, np.nan]]])
    cost = np.array([[[1.0, 8.0], [2.0, 20.0]], [[1.5, 9.0], [1.9, np.nan]]])
    dims, coords = ("contact", "shape", "cell_size"), {}
    coords = {"contact": ["bardenhagen", "penalty"], "shape": ["gimp", "cpdi"], "cell_size": [0.4, 0.2]}
    if problem:
        error, cost, dims = np.stack([error, error]), np.stack([cost, cost]), ("scene", *dims)
        coords["scene"] = ["slip", "no slip"]
    status = np.where(np.isfinite(error), "ok", "failed: it left the grid").astype(object)
    on = np.stack([front(e, c) for e, c in zip(error, cost, strict=True)]) if problem else front(error, cost)
    stages = ["shape", "projection", "force", "contact", "gather", "material"]
    dataset = xr.Dataset(
        {
            "error": (dims, error),
            "cpu_time": (dims, cost),
            "cpu_time_spread": (dims, 0.1 * cost),
            "pareto": (dims, on),
            "status": (dims, status),
            "timing": (dims, np.full(error.shape, "exclusive", dtype=object)),
            "steps": (dims, np.full(error.shape, 100.0)),
            "stage_time": ((*dims, "stage"), cost[..., None] * np.full(6, 1.0 / 6.0)),
        },
        coords={**coords, "stage": stages},
        attrs={
            "kind": "study",
            "title": "made up",
            "quantity": "end-displacement",
            "under": 0.01,
            "timing": "exclusive",
            "problem_dims": json.dumps(["scene"] if problem else []),
        },
    )
    return dataset.assign_attrs(changes)


def test_the_cheapest_combination_under_an_error_is_named():
    (said,) = conclusions(made_up())
    assert said.startswith(
        "The cheapest combination under 1 % error is penalty, gimp, cell_size 0.2, 9 s ± 0.9 s"
    )
    (said,) = conclusions(made_up(), under=0.1)
    assert "bardenhagen, cpdi" not in said
    assert "penalty, cpdi, cell_size 0.4, 1.9 s" in said
    (said,) = conclusions(made_up(), under=0.001)
    assert "no combination is under 0.1 %; the least, 0.4 %, has bardenhagen, cpdi, cell_size 0.2" in said
    assert [line.partition(":")[0] for line in conclusions(made_up(problem=True))] == ["slip", "no slip"]


@pytest.mark.parametrize("problem", [False, True])
def test_figures_of_a_study(problem, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figures = figures_of(made_up(problem))
        for name, (figure, caption) in figures.items():
            figure.savefig(tmp_path / f"{name}.png")
            assert caption
    assert list(figures) == ["front", "stages"]
    axes = figures["front"][0].axes
    assert len(axes) == 1 + problem
    assert (axes[0].get_xscale(), axes[0].get_yscale()) == ("log", "log")
    assert "[s]" in axes[0].get_xlabel()
    assert "[%]" in axes[0].get_ylabel()
    bars = figures["stages"][0].axes[0].patches
    assert sum(bar.get_width() for bar in bars) == pytest.approx(8.0 + 20.0 + 9.0)


def test_figures_of_a_study_without_any_result():
    empty = made_up()
    for name in ("error", "cpu_time", "stage_time"):
        empty[name] = np.nan * empty[name]
    assert figures_of(empty) == {}


def test_figures_of_a_study_of_one_method():
    one = made_up().isel(contact=0, shape=0)
    assert list(figures_of(one)) == ["front", "stages"]
    bare = made_up().isel(contact=0, shape=0).drop_vars(["contact", "shape"])
    assert list(figures_of(bare)) == ["front", "stages"]
