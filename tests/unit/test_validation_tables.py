"""Cases as data: what their tables run and record, and what is refused in them."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from mpmfw.errors import SceneError, SimulationError
from mpmfw.validation import Case, Verdict
from mpmfw.validation.checking import check_case
from mpmfw.validation.reading import load_case
from mpmfw.validation.suite import CHECKS, find_cases, shipped_suite, suite_of

MEASURES = """
from types import SimpleNamespace

def of_run(run, factor=1.0):
    return {"value": factor * run.value, "twice": 2.0 * run.value, "none": None}

def of_all(runs):
    return sum(run.results.value for run in runs)

def alone(offset):
    return 1.0 + offset

def draw(runs):
    from mpmfw.plots.style import new_figure
    return new_figure(1, 1)

def in_place(scene):
    return SimpleNamespace(value=float(scene.grid.cell_size))
"""
RUNS = """
[[runs]]
name = "main"
scene = "rolling-cylinder-slip"
by = "measures:in_place"
[[runs.methods]]
contact = ["penalty", "bardenhagen"]
shape = ["cpdi", "gimp"]
"""
ROW = """
[[runs.rows]]
quantity = "size"
measure = "measures:of_run"
key = "value"
"""


@pytest.fixture
def check(tmp_path):
    """Check a case of these tables and return it."""

    def checked(text, quick=False):
        (tmp_path / "case.toml").write_text(text, encoding="utf-8")
        (tmp_path / "measures.py").write_text(MEASURES, encoding="utf-8")
        case = Case(tmp_path, quick)
        check_case(case)
        return case

    return checked


def verdicts(case):
    return {(row.method, row.quantity): row.verdict for row in case.rows}


def test_gates_bind_the_recommended_methods_unless_a_row_says_whose(check):
    limits = "within = [0.0, 0.1]\n"
    found = check(
        RUNS
        + (ROW + limits).replace('"size"', '"a"')
        + (ROW + limits + 'binds = "all"\n').replace('"size"', '"b"')
        + (ROW + limits + 'binds = ["bardenhagen, g*"]\n').replace('"size"', '"c"')
    )
    red = {key for key, verdict in verdicts(found).items() if verdict is Verdict.RED}
    assert {method for method, quantity in red if quantity == "a"} == {"penalty, cpdi"}
    assert len({method for method, quantity in red if quantity == "b"}) == 4
    assert {method for method, quantity in red if quantity == "c"} == {"bardenhagen, gimp"}


def test_places_set_values_and_limits_and_what_is_open_decides_nothing(check):
    places = """
[[runs.places]]
at = "coarse"
set = { "grid.cell_size" = 0.8 }
within.value = [0.0, 0.5]
[[runs.places]]
at = "fine"
set = { "grid.cell_size" = 0.4 }
within.value = [0.0, 0.1]
open.value = "not yet"
"""
    found = check(RUNS + places + ROW.replace('"size"', '"{at}: size"') + 'binds = "all"\n')
    rows = {row.quantity: row for row in found.rows if row.method == "penalty, cpdi"}
    assert (rows["coarse: size"].value, rows["coarse: size"].verdict) == (0.8, Verdict.RED)
    open_ = rows["fine: size"]
    assert (open_.value, open_.verdict, open_.tolerance) == (0.4, Verdict.OUTSIDE, "0 … 0.1")


def test_open_of_one_method_leaves_the_gates_of_another_that_is_bound(check):
    bound = """
[[runs.methods]]
contact = ["bardenhagen"]
shape = ["cpdi"]
settings = { "short steps" = { "time.safety" = 0.3 } }
binds = true
[[runs.places]]
set = { "grid.cell_size" = 0.4 }
within.value = [0.0, 0.1]
open.value."penalty, *" = "not yet"
"""
    found = check(RUNS + bound + ROW)
    verdicts = {row.method: row.verdict for row in found.rows}
    assert verdicts["bardenhagen, cpdi, short steps"] is Verdict.RED
    assert {verdict for method, verdict in verdicts.items() if "short" not in method} == {Verdict.OUTSIDE}


FIGURES = """
[[runs.methods]]
contact = ["bardenhagen"]
[[figures]]
draw = "made:classical"
methods = ["bardenhagen*"]
"""


def test_a_figure_is_drawn_of_the_methods_that_it_names(check, tmp_path):
    made = """
from matplotlib.figure import Figure

def classical(runs):
    assert {run.method.contact for run in runs} == {"bardenhagen"}
    return Figure()
"""
    (tmp_path / "made.py").write_text(made, encoding="utf-8")
    assert check(RUNS + FIGURES + ROW).figures
    with pytest.raises(SceneError, match=r"'bradenhagen\*' is of none of the methods: .*bardenhagen, cpdi"):
        check(RUNS + FIGURES.replace("bardenhagen*", "bradenhagen*") + ROW)


def test_rows_of_methods_scaled_and_none(check):
    found = check(
        RUNS
        + ROW
        + 'scale = 100.0\nmethods = ["penalty, *"]\nwithout = ["*, gimp"]\n'
        + ROW.replace('"value"', '"none"').replace('"size"', '"never"')
    )
    assert [(row.method, row.quantity, row.value) for row in found.rows] == [("penalty, cpdi", "size", 40.0)]


def test_rows_of_several_runs_and_of_none(check):
    together = """
[[rows]]
quantity = "sum"
measure = "measures:of_all"
of = ["main"]
each = true
[[rows]]
quantity = "one more"
measure = "measures:alone"
args = { offset = 0.5 }
method = "by hand"
within = [0.0, 1.0]
binds = "all"
[[figures]]
draw = "measures:draw"
"""
    found = check(RUNS + together)
    assert [(row.method, row.value) for row in found.rows if row.quantity == "sum"] == [
        ("penalty, cpdi", 0.4),
        ("penalty, gimp", 0.4),
        ("bardenhagen, cpdi", 0.4),
        ("bardenhagen, gimp", 0.4),
    ]
    assert verdicts(found)["by hand", "one more"] is Verdict.RED
    assert list(found.figures) == [found.name]


def test_the_reduced_version_has_its_own_rows_and_values(check):
    text = RUNS.replace("[[runs.methods]]", 'quick = { "grid.cell_size" = 0.8 }\n[[runs.methods]]')
    text += ROW + ROW.replace('"size"', '"more"') + 'when = "full"\n'
    full, quick = check(text), check(text, quick=True)
    assert {(row.quantity, row.value) for row in full.rows} == {("size", 0.4), ("more", 0.4)}
    assert {(row.quantity, row.value) for row in quick.rows} == {("size", 0.8)}


def test_a_run_that_fails_is_red_where_a_gate_binds_it(check, monkeypatch):
    def fail(*_, **__):
        raise SimulationError("it burst")

    monkeypatch.setattr("mpmfw.validation.case.Case.run", fail)
    text = RUNS.replace('by = "measures:in_place"\n', "") + ROW + 'within = [0.0, 1.0]\nbinds = ["*, gimp"]\n'
    found = check(text)
    assert {row.method: row.verdict for row in found.rows} == {
        "penalty, cpdi": Verdict.RED,  # recommended
        "penalty, gimp": Verdict.RED,
        "bardenhagen, cpdi": Verdict.FAILED,
        "bardenhagen, gimp": Verdict.RED,
    }
    assert all(row.note == "it burst" for row in found.rows)


def test_a_measure_of_a_campaign_beside_its_closed_form(check, monkeypatch):
    import numpy as np
    import xarray as xr

    time = np.linspace(0.0, 1.663, 200)
    centre = (0.5 * 8.0 * time**2)[:, None, None] * np.array([1.0, 0.0])
    series = xr.Dataset(
        {"centre_of_mass": (("time", "body", "axis"), centre)},
        {"time": time, "body": ["cylinder"], "axis": ["x", "y"]},
    )
    tree = xr.DataTree(children={"series": xr.DataTree(series)})
    monkeypatch.setattr("mpmfw.validation.case.Case.run", lambda *_, **__: tree)
    text = RUNS.replace('by = "measures:in_place"\n', "").replace(
        "[[runs.methods]]", 'set = { "time.end" = 1.6 }\n[[runs.methods]]'
    )
    row = '[[runs.rows]]\nquantity = "a"\nmeasure = "acceleration"\n'
    found = check(text + row + row.replace('"a"', '"error"') + "relative = true\n")
    values = {row.quantity: row.value for row in found.rows}
    exact = 10.0 * (math.sin(math.pi / 3.0) - 0.286 * math.cos(math.pi / 3.0))
    assert values == {"a": pytest.approx(8.0), "error": pytest.approx(8.0 / exact - 1.0)}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (RUNS + ROW + "withn = [0.0, 1.0]\n", "did you mean 'within'"),
        (RUNS + ROW + 'methods = ["penlty*"]\n', "'penlty*' is of none of the methods"),
        (RUNS + ROW + 'binds = "all"\n', "has no effect without limits"),
        (RUNS + ROW + 'places = ["fine"]\n', "there is no place 'fine'"),
        (RUNS + ROW + "relative = true\n", "only a campaign's measure knows a closed form"),
        (RUNS + '[[runs.places]]\nopen.valu = "x"\n' + ROW, "'valu' is the key of no row"),
        (RUNS + '[[runs.places]]\nopen.value."penlty*" = "x"\n' + ROW, "open: 'penlty*' is of none"),
        (
            RUNS + '[[rows]]\nquantity = "a"\nmeasure = "measures:of_all"\nof = ["man"]\n',
            "no runs are named 'man'",
        ),
        (
            RUNS + '[[rows]]\nquantity = "a"\nmeasure = "measures:alone"\neach = true\n',
            "has no effect without 'of'",
        ),
        (RUNS + ROW.replace(":of_run", ":of_rum"), "'measures:of_rum' is no function of the case"),
        (RUNS + ROW.replace("measures:of_run", "accelaration"), "did you mean 'acceleration'"),
        (RUNS + ROW.replace("measures:of_run", "displacement"), "displacement is a curve"),
        (RUNS + ROW.replace("measures:of_run", "acceleration"), "acceleration is one number"),
        (
            RUNS + '[[runs.rows]]\nquantity = "a"\nmeasure = "spin"\nargs = { pair = "x" }\n',
            "'pair' has no effect",
        ),
        ('[[rows]]\nquantity = "a"\nmeasure = "spin"\n', "expected module:function"),
        ('[[rows]]\nquantity = "a"\nmeasure = "m:f"\nplaces = []\n', "of no single run"),
        (
            '[[rows]]\nquantity = "a"\nmeasure = "m:f"\nwithin = [0, 1]\nbinds = ["*"]\n',
            "expected 'all' or 'none'",
        ),
    ],
)
def test_what_is_wrong_in_the_tables_is_said(check, text, said):
    with pytest.raises(SceneError) as error:
        check(text)
    assert said in str(error.value)
    assert "case.toml" in str(error.value)


def test_a_case_has_a_table_or_a_function(tmp_path):
    folder = tmp_path / "suite" / "both"
    folder.mkdir(parents=True)
    for name in CHECKS:
        (folder / name).write_text("")
    with pytest.raises(SceneError, match="one would have no effect"):
        find_cases(tmp_path / "suite")


def test_the_shipped_cases_are_data_but_for_a_few():
    cases = find_cases(shipped_suite())
    tables = [load_case(folder) for folder in cases if (folder / CHECKS[0]).is_file()]
    assert len(cases) - len(tables) < 8
    assert all(one.runs and (one.rows or any(runs.rows for runs in one.runs)) for one in tables)


MADE = """
def scene(cell, friction=0.2):
    from mpmfw import load_scene
    values = {"grid.cell_size": cell, "contact.friction": friction}
    return load_scene("rolling-cylinder-slip", set=values).to_mapping()

def coarser(scene, by):
    return {**scene, "grid": {**scene["grid"], "cell_size": by * scene["grid"]["cell_size"]}}
"""
GENERATED = """
[[runs]]
name = "made"
scene = "made:scene"
by = "measures:in_place"
[[runs.places]]
at = "h {cell}, mu {friction}"
make = { cell = 9.0 }
vary = { cell = [0.4, 0.8], friction = [0.1, 0.3] }
within.value = [0.0, 0.5]
[[runs.versions]]
[[runs.versions]]
at = "coarser"
change = "made:coarser"
args = { by = 2.0 }
[[runs.rows]]
quantity = "{at}: size"
measure = "measures:of_run"
key = "value"
[[rows]]
quantity = "{at}: broken"
measure = "made:broken"
key = "broken"
of = ["made"]
each = "place"
"""
BROKEN = """
def broken(runs):
    return sum(run.broken == ("value",) for run in runs)
"""


@pytest.fixture
def check_made(check, tmp_path):
    (tmp_path / "made.py").write_text(MADE + BROKEN, encoding="utf-8")
    return check


def test_scenes_are_made_from_what_varies_and_run_in_versions(check_made):
    found = {row.quantity: row for row in check_made(GENERATED).rows}
    assert len(found) == 8
    assert {found[f"h {h}, mu {mu}: size"].value for h in (0.4,) for mu in (0.1, 0.3)} == {0.4}
    assert found["h 0.4, mu 0.1: size"].verdict is Verdict.HOLDS
    assert found["h 0.8, mu 0.3: size"].verdict is Verdict.RED
    # A changed version has no row of its own, and is judged all the same
    assert [found[f"h {h}, mu 0.1: broken"].value for h in (0.4, 0.8)] == [1.0, 2.0]


def test_a_place_may_say_that_a_run_does_not_end_and_other_versions_fail_by_themselves(
    check_made, monkeypatch
):
    def fail(*_, **__):
        raise SimulationError("it burst")

    monkeypatch.setattr("mpmfw.validation.case.Case.run", fail)
    text = GENERATED.replace('by = "measures:in_place"\n', "")
    rows = check_made(text).rows
    assert [(row.quantity, row.verdict) for row in rows[:2]] == [
        ("h 0.4, mu 0.1: run", Verdict.RED),
        ("h 0.4, mu 0.1, coarser: run", Verdict.FAILED),
    ]
    open_ = check_made(text.replace("make = {", 'open.run = "why"\nmake = {')).rows
    assert {row.verdict for row in open_} == {Verdict.FAILED}


def test_a_case_goes_on_from_what_it_is_like(check_made, tmp_path):
    (tmp_path / "usual.toml").write_text(GENERATED, encoding="utf-8")
    more = """
[[runs.places]]
at = "more"
make = { cell = 0.2 }
[[figures]]
draw = "measures:draw"
"""
    case = check_made('like = "usual.toml"\n[[runs]]\n' + more)
    assert {row.quantity for row in case.rows} >= {"more: size", "h 0.8, mu 0.3: size"}
    assert case.figures


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('scene = "made:scene"', 'scene = "sliding-block"', "make has no effect"),
        ('at = "h {cell}, mu {friction}"', 'at = "mu {friction}"', "two places have the same name"),
        ('change = "made:coarser"\n', "", "args have no effect without change"),
        ("[[runs.versions]]\n[[", "[[", "of a version without change"),
        ("within.value", "within.valu", "'valu' is the key of no row"),
        ('change = "made:coarser"', 'change = "made:corser"', "'made:corser' is no function"),
    ],
)
def test_what_is_wrong_with_places_and_versions_is_said(check_made, old, new, said):
    assert old in GENERATED
    with pytest.raises(SceneError, match=said):
        check_made(GENERATED.replace(old, new, 1))


def test_a_suite_of_ones_own_cases_is_named():
    own = shipped_suite()
    assert suite_of(None) == own
    assert suite_of(Path("hard")) == own / "hard"
    assert suite_of(Path("hrad")) == Path("hrad")
    loaded = [load_case(folder) for folder in find_cases(own / "hard")]
    assert sum(len(runs.places) for case in loaded for runs in case.runs) >= 60
