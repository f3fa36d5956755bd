"""Pytest's plug-in for cases, and the suite: each case by pytest, in processes that take one after the other.

``pytest -p mpmfw.validation.suite validation/hertz [--quick]`` runs one case; ``mpmfw validate`` runs all."""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from collections.abc import Generator, Iterable, Iterator, Sequence
from math import nan
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

import numpy as np
import pytest

from mpmfw.campaigns.executors import Pool, executor_of
from mpmfw.campaigns.running import Progress, do, resumable
from mpmfw.campaigns.store import Finished, Outcome, Store
from mpmfw.errors import SceneError, SimulationError
from mpmfw.plots import write_figure
from mpmfw.plots.style import journal_style
from mpmfw.results.selection import checked_name
from mpmfw.runs.identity import code_of_plugins, digest, package, sources
from mpmfw.validation.case import Case, CaseRun, Method, Place, Runs
from mpmfw.validation.page import said

#: Of this process: the cases whose tests have run, and errors of tests and of collection, not of gates.
CASES: list[Case] = []
ERRORS: list[str] = []


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--quick``."""
    parser.addoption("--quick", action="store_true", help="Run the reduced version of validation cases.")


def pytest_configure(config: pytest.Config) -> None:
    """Announce the marks of cases, and leave out tests of the other version."""
    other = "full" if config.getoption("--quick") else "quick"
    asked = config.option.markexpr
    config.option.markexpr = f"({asked}) and not {other}" if asked else f"not {other}"
    for mark in ("full", "quick", "together(runs, ...)", "known_red(method, quantity, reason)"):
        config.addinivalue_line("markers", mark)


def pytest_runtest_logreport(report: pytest.TestReport | pytest.CollectReport) -> None:
    """Keep an error of a test or of collection."""
    if report.failed and not getattr(report, "user_properties", ()):
        ERRORS.append(f"{report.nodeid}\n{report.longreprtext}")


pytest_collectreport = pytest_runtest_logreport


@pytest.fixture(scope="module")
def case(request: pytest.FixtureRequest) -> Case:
    """Return the case that the module's tests record."""
    CASES.append(Case(request.path.parent, request.config.getoption("--quick")))
    return CASES[-1]


@pytest.fixture
def run(request: pytest.FixtureRequest, case: Case) -> CaseRun:
    """Run one point of the test's runs; one that fails keeps its row, red if a gate binds it."""
    point: tuple[Runs, Place, Method] = request.param
    runs, place, method = point
    case.known = known_of(request.node)
    binds = runs.bound(method) and not place.is_open("run", method)
    try:
        return runs.start(case, place, method)
    except (SimulationError, SceneError) as error:
        case.failed(method, str(error), binds, place.at)
        judge(request.node, case.rows[-1:])
        pytest.skip(str(error))


@pytest.fixture
def runs(request: pytest.FixtureRequest) -> list[CaseRun]:
    """Return all runs that the test takes together; it is skipped if some may be deselected."""
    found = [run for one in request.node.get_closest_marker("together").args for run in one.done]
    if request.config.option.keyword or not found:
        pytest.skip("some of its runs may be left out")
    return found


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Generator[None, Any, Any]:
    """Judge the rows that a test has recorded."""
    case = pyfuncitem.funcargs.get("case")
    if not isinstance(case, Case):
        return (yield)
    case.known = known_of(pyfuncitem)
    start, result = len(case.rows), (yield)
    judge(pyfuncitem, case.rows[start:])
    return result


def known_of(item: pytest.Item) -> dict[Any, str]:
    """Return why gates of a test are known not to hold, by method and quantity."""
    return {mark.args[:2]: mark.args[2] for mark in item.iter_markers("known_red")}


def judge(item: pytest.Item, rows: Sequence[dict[str, Any]]) -> None:
    """Fail a test with red gates; mark one with known red gates alone as expected to fail."""
    if wrong := [f"red: {said(row)}" for row in rows if row["verdict"] == "RED"]:
        item.user_properties.append(("gates", wrong))
        pytest.fail("\n".join(wrong), pytrace=False)
    if expected := [row["reason"] for row in rows if row["verdict"] == "known red"]:
        pytest.xfail("; ".join(dict.fromkeys(expected)))


class CaseTask(NamedTuple):
    """One case to run; as :class:`mpmfw.campaigns.work.Task`."""

    key: str
    name: str
    folder: Path
    output: Path
    quick: bool


def check_once(task: CaseTask) -> Finished:
    """Check a case by pytest and save its figures; an error is a red row."""
    printed, options = io.StringIO(), ["-p", "no:cacheprovider", "-p", __name__, *["--quick"] * task.quick]
    CASES.clear()
    ERRORS.clear()
    with journal_style(), contextlib.redirect_stdout(printed), _alone(task.folder.parent):
        code = pytest.main(["-c", os.devnull, f"--rootdir={task.folder}", *options, str(task.folder)])
    nothing = code == pytest.ExitCode.NO_TESTS_COLLECTED and task.quick  # a case of full runs alone
    if code not in (0, 1) and not nothing and not ERRORS:
        ERRORS.append(printed.getvalue())
    for name, figure in ((name, figure) for case in CASES for name, figure in case.figures.items()):
        write_figure(figure, task.output / f"{name}.png")
    rows = [row for case in CASES for row in case.rows] + broken(task.folder, *ERRORS)
    red = any(row["verdict"] == "RED" for row in rows)
    status = "failed: it went wrong, or a gate is red" if red else "ok"
    return Finished(Outcome(task.key, status, task.name, values={"rows": rows}, code=code_of_plugins()))


def broken(folder: Path, *errors: str) -> list[dict[str, Any]]:
    """Return a red row for each error of a case."""
    case = Case(folder)
    for error in errors:
        case.gate("case", nan, "ends", (0.0, 0.0), note=f"went wrong: {error}")
    return case.rows


@contextlib.contextmanager
def _alone(suite: Path) -> Iterator[None]:
    """Find modules in the suite's folder, and leave none to the next case, which may have others so named."""
    loaded = {*sys.modules}
    with mock.patch.object(sys, "path", [str(suite), *sys.path]), mock.patch.dict(os.environ), np.errstate():
        yield
    for name in {*sys.modules} - loaded:
        file = Path(getattr(sys.modules[name], "__file__", None) or "/")
        if file.is_relative_to(suite) and "site-packages" not in file.relative_to(suite).parts:
            del sys.modules[name]


def suite_of(given: Path | None = None) -> Path:
    """Return the folder of a suite: as given, one that is shipped by name (``hard``), or the main one."""
    package = Path(__file__).parents[1]
    own = package / "cases" if (package / "cases").is_dir() else package.parents[1] / "validation"
    inside = given is not None and len(given.parts) == 1 and not given.is_dir() and (own / given).is_dir()
    return own if given is None else own / given if inside else given


def find_cases(suite: Path, names: Sequence[str] = ()) -> list[Path]:
    """Return the folders of the suite with a ``test_*.py``, all or the named ones; else a SceneError."""
    if not suite.is_dir():
        raise SceneError(f"--suite {suite}: is not a folder; expected one with a folder for each case")
    known = {file.parent.name: file.parent for file in sorted(suite.resolve().glob("*/test_*.py"))}
    if not known:
        raise SceneError(f"--suite {suite}: no folder in it has a test_*.py")
    return [known[checked_name("case", name, list(known))] for name in names or sorted(known)]


def run_cases(
    cases: Sequence[Path], output: Path, quick: bool = False, jobs: int | None = None,
    progress: Progress | None = None, *, executor: Any = None, force: bool = False,
) -> list[dict[str, Any]]:  # fmt: skip
    """Run cases, longest first, but those that today's code has done; return their rows.

    ``output`` is the folder for figures and, in ``runs``, results."""
    output.mkdir(parents=True, exist_ok=True)
    runner, store = (
        executor_of(executor, jobs) if executor is not None else Pool(jobs),
        Store(output / "runs"),
    )
    ordered = sorted(cases, key=_cost, reverse=True)
    tasks = [CaseTask(_key(one, quick), one.name, one, output, quick) for one in ordered]
    for task in tasks:
        if force or not getattr(store.outcome(task.key), "values", ()):
            store.forget(task.key)
    with resumable(store, "validation"):
        do(check_once, tasks, store, runner, progress)
    return rows_of(cases, store, quick, "it was not run")


def rows_of(cases: Iterable[Path], store: Store, quick: bool, missing: str = "") -> list[dict[str, Any]]:
    """Return the rows that runs of these cases have with today's code; ``missing`` is why one has none."""
    rows = []
    for folder in cases:
        outcome = store.outcome(_key(folder, quick))
        if outcome is not None and outcome.values:
            rows += outcome.values["rows"]
        elif why := outcome.status if outcome is not None else missing:
            rows += broken(folder, why)
    return rows


def _key(folder: Path, quick: bool) -> str:
    """Return a key that changes with the files of the case and its suite, the code and libraries."""
    inner = [path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    parts = [f"{name} {version}" for name, version in sorted(code_of_plugins().items())]
    shared = [*folder.parent.glob("*.py"), *folder.parent.glob("*/*_fem/*.py")]  # several cases import these
    return digest(folder.name, str(quick), sources([*inner, *shared]), package("mpmfw"), *parts)


def _cost(folder: Path) -> float:
    """Return the CPU seconds that a case says it takes, ``# cost: 60``."""
    texts = "".join(file.read_text(encoding="utf-8") for file in folder.glob("test_*.py"))
    found = re.search(r"^# cost: *([0-9.]+)", texts, re.MULTILINE)
    return float(found.group(1)) if found else 10.0
