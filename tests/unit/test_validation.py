"""The suite's own logic, on suites of a few lines: verdicts, exit status, table, page, and cases that go wrong."""

import csv
import math
import os
import signal
import tomllib
from contextlib import nullcontext
from pathlib import Path

import pytest
from typer.testing import CliRunner

from mpmfw.cli import app
from mpmfw.errors import SceneError
from mpmfw.validation import Case, Method, Row, Verdict
from mpmfw.validation.known import KnownRed, departures, read_known_red
from mpmfw.validation.suite import find_cases, kept, run_cases, shipped_suite

GREEN = """
from measures import SIX
def check(case):
    case.gate("six", SIX, within=(5.0, 7.0), reference=6.0, unit="m", method="by hand")
    case.show("size", 2.0 if case.quick else 3.0)
"""
RED = "def check(case): case.gate('six', 8.0, within=(5.0, 7.0), method='by hand')"
BROKEN = "def check(case):\n    case.show('before', 1.0)\n    raise ZeroDivisionError('no reference')"
DEADLY = {
    "killed": "import os, signal\ndef check(case): os.kill(os.getpid(), signal.SIGKILL)",
    "left": "import os\ndef check(case): os._exit(0)",
    "segfault": "import ctypes\ndef check(case): ctypes.string_at(0)",
}
FIGURE = """
from mpmfw.plots.style import new_figure
def check(case):
    figure = new_figure(1, 1)
    figure.subplots().plot([0, 1])
    case.figure("line", figure)
"""


@pytest.fixture
def suite(tmp_path):
    """Make a suite of cases: name → check.py."""

    def make(**cases):
        for name, text in cases.items():
            folder = tmp_path / "suite" / name
            folder.mkdir(parents=True)
            (folder / "check.py").write_text(text)
            (folder / "README.md").write_text(f"# Case {name}\n\nWhat it is about.\n\n## More\n")
        (tmp_path / "suite" / "measures.py").write_text("SIX = 6.0\n")
        return tmp_path / "suite"

    return make


def outcomes(folder, tmp_path, **options):
    return run_cases(find_cases(folder), tmp_path / "out", jobs=1, **options)


@pytest.mark.parametrize(
    ("value", "limits", "binds", "verdict"),
    [
        (1.0, (0.0, 2.0), True, Verdict.HOLDS),
        (2.0, (0.0, 2.0), True, Verdict.HOLDS),
        (2.1, (0.0, 2.0), True, Verdict.RED),
        (math.nan, (0.0, 2.0), True, Verdict.RED),
        (math.nan, (-math.inf, math.inf), True, Verdict.RED),
        (1.0, (0.0, 2.0), False, Verdict.WITHIN),
        (math.nan, (0.0, 2.0), False, Verdict.OUTSIDE),
        (-1.0, (0.0, math.inf), False, Verdict.OUTSIDE),
        (1.0, (-math.inf, math.inf), False, Verdict.SHOWN),
    ],
)
def test_verdict(value, limits, binds, verdict):
    assert Row("case", "method", "quantity", value, "", "", *limits, binds).verdict is verdict


def test_gates_bind_the_recommended_methods_alone(tmp_path):
    case = Case(tmp_path)
    for method in case.methods(("none", "penalty", ""), ("gimp", "cpdi"), {"": {}, "soft": {"a.b": 1}}):
        case.judge(method, "q", 3.0, within=(0.0, 1.0))
    red = {row.method for row in case.rows if row.verdict is Verdict.RED}
    assert red == {"penalty, cpdi", "cpdi"}
    assert len(case.rows) == 12


def test_a_failing_method_keeps_its_row(tmp_path):
    case = Case(tmp_path)
    grid = {"cell_size": 0.1, "lower": [0, 0], "upper": [1, 1]}
    disc = {"type": "disc", "centre": [0.9, 0.5], "radius": 0.3}  # beyond the grid
    (tmp_path / "scene.toml").write_text(
        f"grid = {toml(grid)}\ntime = {{ end = 1e-3, output_interval = 1e-3 }}\nshape = {{ method = 'cpdi' }}\n"
        f"[materials.m]\nmodel = 'neo_hookean'\ndensity = 1\nbulk_modulus = 1\nshear_modulus = 1\n"
        f"[bodies.b]\nmaterial = 'm'\ngeometry = {toml(disc)}\nparticles = {{ size = 0.05 }}\n"
    )
    assert list(case.runs([Method("", "cpdi"), Method("", "gimp")])) == []
    assert [row.verdict for row in case.rows] == [Verdict.RED, Verdict.FAILED]
    assert all("is not inside the grid" in row.note for row in case.rows)


def toml(table):
    return "{ " + ", ".join(f"{key} = {value!r}" for key, value in table.items()) + " }"


def test_cases_run_apart_and_in_the_reduced_version(suite, tmp_path):
    folder = suite(one=GREEN, two=GREEN)
    full, quick = outcomes(folder, tmp_path), outcomes(folder, tmp_path, quick=True)
    assert [outcome.folder.name for outcome in full] == ["one", "two"]
    assert all(outcome.holds for outcome in full)
    assert (full[0].rows[1].value, quick[1].rows[1].value) == (3.0, 2.0)


def test_what_goes_wrong_in_a_case_stops_no_other(suite, tmp_path):
    broken, green = outcomes(suite(a=BROKEN, b=GREEN), tmp_path)
    assert not broken.holds
    assert "no reference" in broken.error
    assert [row.quantity for row in broken.rows] == ["before"]
    assert green.holds


def test_processes_bring_the_same_rows(suite, tmp_path):
    folder = suite(a=GREEN, b=RED)
    alone = run_cases(find_cases(folder), tmp_path / "alone", jobs=1)
    together = run_cases(find_cases(folder), tmp_path / "together", jobs=2)
    assert [(r.case, r.value, r.verdict) for o in alone for r in o.rows] == [
        (r.case, r.value, r.verdict) for o in together for r in o.rows
    ]


@pytest.mark.parametrize(
    ("cases", "arguments", "status", "said"),
    [
        ({"a": GREEN}, [], 0, "1 gates: 1 hold, 0 red"),
        ({"a": GREEN, "b": RED}, [], 1, "red, and not known to be"),
        ({"a": GREEN, "b": RED}, ["a"], 0, "1 case, 1 gates"),
        ({"a": BROKEN}, [], 1, "went wrong"),
        ({"slide": GREEN}, ["silde"], 2, "did you mean 'slide'?"),
    ],
)
def test_exit_status(suite, tmp_path, cases, arguments, status, said):
    result = command(suite(**cases), tmp_path, *arguments)
    assert result.exit_code == status
    assert said in " ".join(result.output.split())


def command(folder, tmp_path, *arguments):
    options = ["--suite", str(folder), "-o", str(tmp_path / "out"), "-j", "1"]
    return CliRunner().invoke(app, ["validate", *options, *arguments])


def test_no_suite_is_a_wrong_request(tmp_path):
    assert command(tmp_path / "nowhere", tmp_path).exit_code == 2
    with pytest.raises(SceneError, match=r"no folder in it has a case\.toml or a check\.py"):
        find_cases(tmp_path)


def test_known_red_gates_must_be_exactly_those(suite, tmp_path):
    folder, listed = suite(a=GREEN, b=RED), tmp_path / "known.toml"
    listed.write_text("[[red]]\ncase = 'b'\nmethod = 'by hand'\nquantity = 'six'\nwhy = 'eight is more'\n")
    page = tmp_path / "page.md"
    result = command(folder, tmp_path, "--known-red", str(listed), "--document", str(page))
    assert result.exit_code == 0
    assert "b: by hand, six 8 (5 … 7): eight is more" in page.read_text()
    listed.write_text(listed.read_text().replace("'b'", "'a'"))
    result = command(folder, tmp_path, "--known-red", str(listed))
    assert result.exit_code == 1
    assert "take it off the list" in result.output
    assert "red, and not known to be" in result.output


def test_a_known_gate_must_exist_where_its_case_ran_in_full():
    gate, other = KnownRed(case="a", method="b", quantity="c", why="d"), Row("a", "b", "else", 1.0)
    assert departures([], [gate]) == []
    assert departures([other], [gate], quick=True) == []
    assert departures([other], [gate]) == ["a: b, c: known as red, and there is no such gate"]


def test_a_list_that_cannot_be_read_is_a_wrong_request(tmp_path):
    path = tmp_path / "known.toml"
    path.write_text("[[red]]\ncase = 'a'\n")
    with pytest.raises(SceneError, match=r"known\.toml:1: red\[0\]\.method: "):
        read_known_red(path)
    with pytest.raises(SceneError, match=r"none\.toml: no such file; expected a list of known red gates"):
        read_known_red(tmp_path / "none.toml")


def test_table_and_page_and_figures_are_written(suite, tmp_path):
    page = tmp_path / "docs" / "validation.md"
    page.parent.mkdir()
    result = command(suite(a=GREEN, b=FIGURE), tmp_path, "--document", str(page))
    assert result.exit_code == 0
    with (tmp_path / "out" / "validation.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [(row["quantity"], float(row["value"]), row["verdict"]) for row in rows] == [
        ("six", 6.0, "holds"),
        ("size", 3.0, "shown"),
    ]
    text = page.read_text()
    assert "## Case a\n\nWhat it is about." in text
    assert "Every gate holds." in text
    assert "| by hand | six | 6 m | 6 m | 5 … 7 | holds |" in text
    assert (page.parent / "validation" / "b-line.png").stat().st_size > 1000
    assert "(validation/b-line.png)" in text


def test_a_suite_among_ones_own_is_called_by_its_name(suite, tmp_path, monkeypatch):
    inner = suite(a=GREEN)
    (inner / "README.md").write_text("# Hard ones\n\nMore.\n")
    for module in ("suite", "report"):
        monkeypatch.setattr(f"mpmfw.validation.{module}.shipped_suite", lambda: tmp_path)
    page = tmp_path / "page.md"
    result = command(Path("suite"), tmp_path, "--document", str(page))
    assert result.exit_code == 0
    text = page.read_text()
    assert text.startswith("# Hard ones: what holds\n\nWritten by `mpmfw validate --suite suite --jobs 1`")
    assert f"(../{tmp_path.name}/suite/a/README.md); `mpmfw validate --suite suite a`" in text


def test_the_page_opens_with_cases_by_methods(suite, tmp_path):
    page = tmp_path / "page.md"
    judged = """
def check(case):
    for value in (6.0, 8.0):
        case.gate("six", value, within=(5.0, 7.0), method="none, cpdi", binds=False)
    case.failed("none, cpdi", "it broke", binds=False)
    case.gate("six", 6.0, within=(5.0, 7.0), method="penalty, bspline")
    case.show("size", 1.0, method="bardenhagen, cpdi")
"""
    command(suite(a=judged, b=GREEN), tmp_path, "--document", str(page))
    head = page.read_text().partition("## Case a")[0].strip().splitlines()[-3:]
    table = [[cell.strip() for cell in line.strip("|").split("|")] for line in head]
    assert table[0][:2] == ["case", "none, cpdi"]
    values = dict(zip(table[0], table[2], strict=True))
    assert {name: value for name, value in values.items() if value} == {
        "case": "`a`",
        "none, cpdi": "1 / 3",
        "penalty, bspline": "1 / 1",
    }


def test_cases_run_one_by_one_make_one_table(suite, tmp_path):
    folder, page = suite(a=GREEN, b=RED), tmp_path / "page.md"
    assert command(folder, tmp_path, "b").exit_code == 1
    assert command(folder, tmp_path, "a", "--document", str(page)).exit_code == 0
    with (tmp_path / "out" / "validation.csv").open() as file:
        assert [row["case"] for row in csv.DictReader(file)] == ["a", "a", "b"]
    assert "## Case b" in page.read_text()
    assert "**RED**" in page.read_text()
    (row,) = kept([folder / "b"], tmp_path / "out", quick=False)[0].rows
    assert (row.value, row.least, row.most, row.verdict) == (8.0, 5.0, 7.0, Verdict.RED)
    assert math.isnan(row.cpu_time)
    assert kept([folder / "b"], tmp_path / "out", quick=True) == []


def test_what_a_run_found_is_in_the_table_though_its_case_was_edited_meanwhile(suite, tmp_path):
    """A note in the case's README, say: what was found is of the files as the run began."""
    edits = (
        "import pathlib\n\n\ndef check(case):\n    pathlib.Path(case.folder / 'note.md').write_text('seen')\n"
    )
    folder = suite(a=f"{edits}    case.gate('six', 6.0, within=(5.0, 7.0))\n", b=GREEN)
    assert command(folder, tmp_path, "a").exit_code == 0
    with (tmp_path / "out" / "validation.csv").open() as file:
        assert [row["case"] for row in csv.DictReader(file)] == ["a"]
    assert kept([folder / "a"], tmp_path / "out", quick=False) == []


def test_a_case_that_was_red_is_not_shown_green_when_its_code_has_changed(suite, tmp_path):
    folder, page = suite(a=GREEN, b=GREEN), tmp_path / "page.md"
    assert command(folder, tmp_path).exit_code == 0
    (folder / "b" / "check.py").write_text(RED)
    assert command(folder, tmp_path, "a", "--document", str(page)).exit_code == 0
    assert "## Case b" not in page.read_text()  # what it said was of another check
    (folder / "measures.py").write_text("SIX = 6.5\n")
    assert kept(find_cases(folder), tmp_path / "out", quick=False) == []


def test_results_are_of_the_code_that_ran(suite, tmp_path, monkeypatch):
    folder = suite(a=GREEN)
    outcomes(folder, tmp_path)
    assert len(kept(find_cases(folder), tmp_path / "out", quick=False)) == 1
    monkeypatch.setattr("mpmfw.validation.suite.package", lambda _: "changed")
    assert kept(find_cases(folder), tmp_path / "out", quick=False) == []


def test_a_case_that_is_done_is_not_run_again_unless_forced(suite, tmp_path):
    folder = suite(a=FIGURE)
    events = []
    for arguments, runs in (({}, 1), ({}, 0), ({"force": True}, 1)):
        outcomes(folder, tmp_path, progress=events.append, **arguments)
        assert events[-1].total == runs
    (tmp_path / "out" / "a-line.png").unlink()
    outcomes(folder, tmp_path, progress=events.append)
    assert events[-1].total == 1


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this platform")
@pytest.mark.parametrize(("jobs", "how"), [(2, "killed"), (1, "killed"), (1, "left"), (1, "segfault")])
def test_a_case_that_dies_takes_no_other_with_it(suite, tmp_path, jobs, how):
    folder, events = suite(a=GREEN, b=DEADLY[how], c=GREEN), []
    a, b, c = run_cases(find_cases(folder), tmp_path / "out", jobs=jobs)
    assert a.holds
    assert c.holds
    assert "its process ended abruptly" in b.error
    run_cases(find_cases(folder), tmp_path / "out", jobs=jobs, progress=events.append)
    assert events[-1].total == 1  # the others are kept, and it is tried again


def test_each_case_has_a_process_of_its_own(suite, tmp_path):
    """What one leaves behind in its process, or an end of it by ``sys.exit``, is no other's business."""
    leave = "import os, sys\ndef check(case):\n    case.show('process', os.getpid())\n    sys.exit()"
    a, b = outcomes(suite(a=leave, b=leave), tmp_path)
    assert len({row.value for one in (a, b) for row in one.rows} | {float(os.getpid())}) == 3
    assert "SystemExit" in a.error


def test_ctrl_c_says_what_is_kept_and_the_same_command_goes_on(suite, tmp_path, monkeypatch):
    def stop(event):
        if event.done == 1:
            raise KeyboardInterrupt

    folder, events = suite(a=GREEN, b=GREEN), []
    with pytest.raises(KeyboardInterrupt, match=r"runs keeps the 1 runs that were done; the same validation"):
        outcomes(folder, tmp_path, progress=stop)
    monkeypatch.setattr("mpmfw.cli.validate.campaign_progress", lambda _: nullcontext((events.append, None)))
    assert command(folder, tmp_path).exit_code == 0
    assert events[-1].total == 1


def test_the_page_says_what_was_run_and_on_how_many_cores(suite, tmp_path):
    page = tmp_path / "page.md"
    command(suite(a=GREEN, b=GREEN), tmp_path, "a")
    command(tmp_path / "suite", tmp_path, "b", "--quick")
    command(tmp_path / "suite", tmp_path, "b", "--document", str(page))
    text = page.read_text()
    assert (
        "Written by `mpmfw validate a --jobs 1` on one core, `mpmfw validate b --jobs 1` on one core;" in text
    )


def test_the_cases_are_found_wherever_one_is(tmp_path, monkeypatch):
    """They ship in the wheel, as the folder ``mpmfw/cases``."""
    monkeypatch.chdir(tmp_path)
    assert "hertz" in [folder.name for folder in find_cases(shipped_suite())]
    settings = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
    wheel = settings["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert wheel["force-include"]["validation"] == "mpmfw/cases"
    result = CliRunner().invoke(app, ["validate", "herz"])
    assert (result.exit_code, "did you mean 'hertz'?" in result.output) == (2, True)
