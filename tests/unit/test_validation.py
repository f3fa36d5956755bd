"""The validation suite on cases of a few lines: verdicts, status, table, page, and what goes wrong."""

import csv
import math
import os
from pathlib import Path

import pytest

from command_line import called
from mpmfw.validation import Case, CaseRun, Method, Place, Runs, by_method, methods
from mpmfw.validation.page import BEGIN, END
from mpmfw.validation.suite import find_cases, rows_file, run_cases
from python_files import module_of

GREEN = """
from measures import SIX

def test_six(case):
    case.gate("six", SIX, 6.0, (5.0, 7.0), "m", method="by hand")
    case.gate("size", 2.0 if case.quick else 3.0)
"""
RED = "\ndef test_eight(case): case.gate('eight', 8.0, tolerance=(5.0, 7.0), method='by hand')\n"
KNOWN = """
from mpmfw.validation import known_red

@known_red('by hand', '{name}', 'it is more')
def test_{name}(case): case.gate('{name}', {value}, tolerance=(5.0, 7.0), method='by hand')
"""
BROKEN = "\ndef test_it(case):\n    case.gate('before', 1.0)\n    raise ZeroDivisionError('no reference')\n"
#: Ends its process if there is the file ``kill``, and writes down that it ran.
KILLED = """
import os, pathlib, signal
HERE = pathlib.Path(__file__).parents[2]

def test_it(case):
    with (HERE / "ran").open("a") as file:
        file.write(case.folder.name)
    if case.folder.name == "a" and (HERE / "kill").exists():
        os.kill(os.getpid(), signal.SIGKILL)
    case.gate("late", 1.0)

def test_more(case): case.gate("more", 2.0)
"""
FIGURE = """
from mpmfw.plots.style import new_figure

def test_line(case):
    figure = new_figure(1, 1)
    figure.subplots().plot([0, 1])
    case.figure("line", figure)
"""
MAIN = pytest.main
NINE, FIVE = KNOWN.format(name="nine", value=9.0), KNOWN.format(name="five", value=5.5)
RUNS = """
from types import SimpleNamespace

from mpmfw.errors import SimulationError
from mpmfw.validation import Place, Runs, by_method, full, known_red, methods, together

def in_place(scene):
    if scene.grid.cell_size == 0.5 and scene.contact.method == "bardenhagen":
        raise SimulationError("it broke")
    return SimpleNamespace(size=float(scene.grid.cell_size))

def size(results, factor=1.0):
    return {"size": factor * results.size, "none": None}

def total(runs):
    return sum(run.results.size for run in runs)

places = [
    Place("coarse", set={"grid.cell_size": 0.8}, within={"size": (0.0, 0.1)}),
    Place("fine", set={"grid.cell_size": 0.4}, open={"size": {"penalty, c*": "known"}}, when="full"),
    Place("broken", set={"grid.cell_size": 0.5}),
]
runs = Runs(
    "runs",
    scene="rolling-cylinder-slip",
    methods=methods(["penalty", "bardenhagen"], ["cpdi", "gimp"]),
    places=places,
    by=in_place,
    binds=["bardenhagen, cpdi"],
)

@known_red("bardenhagen, cpdi", "broken: run", "it breaks")
@runs
def test_size(run):
    run.gate(f"size, {run.place.at}", run.of(size, "size"), 0.0, 0.1, key="size")
    run.gate("nothing", run.of(size, "none"), 0.0, 0.1)
    if run.method.matches("penalty, *"):
        run.gate("twice", run.of(size, "size", factor=2.0), tolerance=(0.0, 0.1), binds=run.at("fine"))

@full
@together(runs)
def test_total(case, runs):
    for method, same in by_method(runs, "penalty*"):
        case.gate("total", 10.0 * total(same), method=method)
"""


#: Asks for a method that another case has.
OTHER = """
from mpmfw.validation import Runs, methods

@Runs("runs", "rolling-cylinder-slip", methods(["lcp"]), by=lambda scene: scene)
def test_it(run): run.gate("strong", float(run.method.matches("bardenhagen, *")))
"""


@pytest.fixture
def suite(tmp_path):
    """Make a suite of cases: name → test file."""

    def make(**cases):
        for name, text in cases.items():
            folder = tmp_path / "suite" / name
            folder.mkdir(parents=True)
            (folder / f"test_{name}.py").write_text(text)
        (tmp_path / "suite" / "measures.py").write_text("SIX = 6.0\n")
        return tmp_path / "suite"

    return make


@pytest.fixture
def here(monkeypatch):
    """Run cases in this process: another one takes seconds to start."""
    monkeypatch.setattr(pytest, "main", lambda options: MAIN([*options, "-n0"]))


def results(folder, tmp_path, **options):
    return run_cases(find_cases(folder), tmp_path / "out", jobs=1, **options)


def validate(folder, tmp_path, *arguments, status=0):
    given = "--suite", folder, "-o", tmp_path / "out", "-j", 1, *arguments
    return called("validate", *given, status=status).output


@pytest.mark.parametrize(
    ("value", "limits", "binds", "reason", "verdict"),
    [
        (1.0, (0.0, 2.0), True, "", "holds"),
        (2.1, (0.0, 2.0), True, "", "RED"),
        (2.1, (0.0, 2.0), True, "why", "known red"),
        (1.0, (0.0, 2.0), True, "why", "RED"),
        (math.nan, (-math.inf, math.inf), True, "", "RED"),
        (1.0, (0.0, 2.0), False, "", "within"),
        (math.nan, (0.0, 2.0), False, "", "outside"),
        (1.0, (-math.inf, math.inf), False, "", "shown"),
        (1.0, None, True, "", "shown"),
    ],
)
def test_verdict(tmp_path, value, limits, binds, reason, verdict):
    case = Case(tmp_path, known={("method", "quantity"): reason})
    case.gate("quantity", value, tolerance=limits, method="method", binds=binds)
    assert case.rows[0]["verdict"] == verdict


def test_gates_bind_the_recommended_methods_alone(tmp_path):
    case = Case(tmp_path)
    for contact in ("none", "penalty", ""):
        for shape in ("gimp", "cpdi"):
            for label in ("", "soft"):
                case.gate("q", 3.0, tolerance=(0.0, 1.0), method=Method(contact, shape, {}, label))
    assert {row["method"] for row in case.rows if row["verdict"] == "RED"} == {"penalty, cpdi", "cpdi"}


@pytest.mark.usefixtures("here")
def test_runs_at_places(suite, tmp_path):
    rows = results(suite(a=RUNS, b=OTHER), tmp_path)
    assert "'bardenhagen, *' fits no name of the full version" in rows.pop()["note"]
    found = {(row["method"], row["quantity"]): row for row in rows}
    verdicts = {key: row["verdict"] for key, row in found.items()}
    assert verdicts["penalty, cpdi", "size, coarse"] == "RED"
    assert found["penalty, cpdi", "size, coarse"]["least"] == 0.0
    assert verdicts["penalty, cpdi", "size, fine"] == "outside"  # open
    assert verdicts["bardenhagen, cpdi", "size, fine"] == "outside"  # not recommended
    assert verdicts["penalty, gimp", "twice"] == "outside"
    assert verdicts["bardenhagen, gimp", "broken: run"] == "failed"
    assert verdicts["bardenhagen, cpdi", "broken: run"] == "known red"
    assert ("penalty, cpdi", "nothing") not in found
    assert found["penalty, cpdi", "total"]["value"] == pytest.approx(10.0 * (0.8 + 0.4 + 0.5))
    assert sum(row["quantity"].startswith("size") for row in rows) == 10
    quick = results(tmp_path / "suite", tmp_path, quick=True)
    assert not any("fine" in row["quantity"] or row["quantity"] == "total" for row in quick)


def test_a_pattern_that_fits_no_method_or_place_is_refused(tmp_path):
    place = Place("coarse", open={"size": {"penlty, c*": "known"}})
    runs = Runs("runs", methods=methods(["penalty", "bardenhagen"]), places=[place, Place("fine")])
    method = runs.methods[0]
    run = CaseRun(Case(tmp_path), "runs", place, method, None, None)
    assert method.matches("penalty, *")
    assert run.at("coarse")
    for misspelt in (
        lambda: method.matches("penlty, *"),
        lambda: run.at("coarze"),
        lambda: list(by_method([run], "penlty*")),
        lambda: Runs("runs", binds=["penlty, *"]),
        lambda: run.place.is_open("size", method),
    ):
        with pytest.raises(ValueError, match="fits no name of the full version"):
            misspelt()


@pytest.mark.usefixtures("here")
def test_whatever_goes_wrong_is_said_and_ends_with_status_1(suite, tmp_path):
    folder = suite(a=GREEN + RED + NINE + FIVE + BROKEN, b="import nothing_of_this_name")
    output = " ".join(validate(folder, tmp_path, status=1).split())
    for said in (
        "RED: a: by hand, eight: 8 (5 … 7)",
        "known red: a: by hand, nine: 9 (5 … 7): it is more",
        "marked as known red",
        "no reference",
        "No module named 'nothing_of_this_name'",
    ):
        assert said in output
    with (tmp_path / "out" / "validation.csv").open() as file:
        assert [row["quantity"] for row in csv.DictReader(file) if row["verdict"] == "holds"] == ["six"]
    assert "did you mean 'a'?" in validate(folder, tmp_path, "aa", status=2)


def test_a_case_whose_process_is_killed_is_red_and_alone_runs_again(suite, tmp_path, monkeypatch):
    folder = suite(a=KILLED, b=KILLED)
    (tmp_path / "kill").touch()
    assert "its process ended abruptly" in validate(folder, tmp_path, status=1)
    (tmp_path / "kill").unlink()
    monkeypatch.setattr(pytest, "main", lambda options: MAIN([*options, "-n0"]))
    validate(folder, tmp_path)
    assert (tmp_path / "ran").read_text() == "aba"
    with (tmp_path / "out" / "validation.csv").open() as file:
        rows = [(row["case"], row["quantity"]) for row in csv.DictReader(file)]
    assert rows == [("a", "late"), ("a", "more"), ("b", "late"), ("b", "more")]


@pytest.mark.parametrize(("text", "status"), [(GREEN + RED, 1), (GREEN + NINE, 0), (FIVE, 1)])
def test_pytest_alone_tells_whether_gates_are_red(suite, text, status):
    folder = suite(a=text)
    plugin = ["-p", "mpmfw.validation.suite", "-p", "no:cacheprovider", "-o", f"pythonpath={folder}"]
    assert MAIN(["-q", "-n0", "-c", os.devnull, f"--rootdir={folder}", *plugin, str(folder / "a")]) == status


@pytest.mark.usefixtures("here")
def test_table_figures_and_the_marked_part_of_a_page_are_written(suite, tmp_path):
    page = tmp_path / "docs" / "page.md"
    page.parent.mkdir()
    page.write_text(f"# Mine\n\n{BEGIN}\nold\n{END}\n\n![line](page/a-line.png)\n")
    validate(suite(a=GREEN + FIGURE + NINE), tmp_path, "--document", page)
    text = page.read_text()
    assert text.startswith("# Mine\n")
    assert "\nold\n" not in text
    assert "- `a`: by hand, nine: 9 (5 … 7): it is more" in text
    assert (tmp_path / "docs" / "page" / "a-line.png").stat().st_size > 1000
    with (tmp_path / "docs" / "page" / "rows.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [(row["quantity"], float(row["value"]), row["verdict"]) for row in rows] == [
        ("six", 6.0, "holds"),
        ("size", 3.0, "shown"),
        ("nine", 9.0, "known red"),
    ]


@pytest.mark.usefixtures("here")
def test_rows_of_a_later_run_replace_those_of_its_cases_alone(suite, tmp_path, monkeypatch):
    """By ``docs/add_rows.py``: page, rows and gates; the page names the cases that ran later."""
    page, folder = tmp_path / "docs" / "page.md", suite(a=GREEN, b=NINE)
    page.parent.mkdir()
    page.write_text(f"{BEGIN}\n{END}\n")
    validate(folder, tmp_path, "--document", page)
    gates = page.parent / "page" / "gates.csv"
    named = ",".join(
        f"{name} {when}" for when in ("with κ = 1", "now") for name in ("limits", "value", "verdict")
    )
    before = "a,by hand,six,5 … 7,5.5 m,holds,5 … 7,6 m,holds"
    gates.write_text(
        f"case,method,quantity,{named}\n{before}\nb,by hand,nine,5 … 7,8,RED,5 … 7,9,known red\n"
    )
    (folder / "b" / "test_b.py").write_text(NINE.replace("9.0", "8.5") + GREEN.replace("six", "more"))
    validate(folder, tmp_path / "later", "b")
    script = module_of(Path(__file__).resolve().parents[2] / "docs" / "add_rows.py")
    monkeypatch.setattr(script, "PAGE", page)
    monkeypatch.setattr(
        script.sys, "argv", ["add_rows.py", str(tmp_path / "later" / "out" / "validation.csv")]
    )
    for _ in range(2):  # to add them once more changes nothing
        script.main()
        assert gates.read_text().splitlines()[1:] == [
            before,
            "b,by hand,nine,5 … 7,8,RED,5 … 7,8.5,known red",
            "b,by hand,more,,,,5 … 7,6 m,holds",
        ]
        with (page.parent / "page" / "rows.csv").open() as file:
            rows = [(row["case"], row["quantity"], float(row["value"])) for row in csv.DictReader(file)]
        assert rows == [
            *(("a", "six", 6.0), ("a", "size", 3.0)),
            *(("b", "nine", 8.5), ("b", "more", 6.0), ("b", "size", 3.0)),
        ]
        assert page.read_text().count("; later `mpmfw validate b`, Python") == 1
        assert "- `b`: by hand, nine: 8.5" in page.read_text()


def test_rows_are_those_of_a_case_as_it_is_now(suite, tmp_path):
    case = suite(a=GREEN) / "a"
    files = [rows_file(case, quick, tmp_path) for quick in (True, False)]
    for changed in (case / "test_a.py", case.parent / "measures.py"):
        changed.write_text(changed.read_text() + "\n")
        files.append(rows_file(case, False, tmp_path))
    assert len(set(files)) == 4


@pytest.mark.usefixtures("here")
def test_a_case_that_changes_while_it_runs_is_not_lost(suite, tmp_path):
    changes = GREEN + "\n\ndef test_own(case): (case.folder / 'more').touch()\n"
    assert "1 hold, 0 red" in validate(suite(a=changes), tmp_path)


LEAVES = """
import os
import numpy as np
from helper import NAME

def test_it(case):
    case.gate(NAME, float("LEFT" in os.environ), tolerance=0.0)
    case.gate("errors", float(np.geterr()["invalid"] == "raise"), tolerance=0.0)
    np.seterr(invalid="raise")
    os.environ["LEFT"] = "1"
"""


@pytest.mark.usefixtures("here")
@pytest.mark.filterwarnings("default")
def test_a_case_leaves_nothing_to_the_next_one(suite, tmp_path, monkeypatch):
    folder = suite(a=LEAVES, b=LEAVES)
    for name in ("a", "b"):
        (folder / name / "helper.py").write_text(f"NAME = '{name}'\n")
    monkeypatch.chdir(tmp_path)
    found = run_cases(find_cases(folder.relative_to(tmp_path)), tmp_path / "out", jobs=1)
    assert [(row["case"], row["quantity"], row["verdict"]) for row in found] == [
        ("a", "a", "holds"),
        ("a", "errors", "holds"),
        ("b", "b", "holds"),
        ("b", "errors", "holds"),
    ]


@pytest.mark.usefixtures("here")
def test_a_folder_of_others_is_not_written_to(suite, tmp_path):
    """Unlike that of a validation that was interrupted before its first case."""
    (tmp_path / "out" / "runs").mkdir(parents=True)
    (tmp_path / "out" / "a.png").write_text("mine")
    folder = suite(a=GREEN)
    assert "contains other files" in validate(folder, tmp_path, status=2)
    (tmp_path / "out" / "a.png").unlink()
    validate(folder, tmp_path)
