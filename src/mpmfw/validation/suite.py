"""Pytest's plug-in for cases, and the suite, whose cases pytest-xdist runs in several processes.

``pytest -p mpmfw.validation.suite validation/hertz [--quick]`` runs one case; ``mpmfw validate`` runs all."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shlex
import signal
import sys
from collections.abc import Generator, Iterator, Sequence
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest

from mpmfw.campaigns.executors import ONE_THREAD
from mpmfw.errors import Interrupted, SceneError, SimulationError
from mpmfw.plots.style import journal_style
from mpmfw.results.selection import checked_name
from mpmfw.runs.identity import code_of_plugins, digest, package, sources
from mpmfw.runs.interruption import interruptible
from mpmfw.runs.limits import cores
from mpmfw.validation.case import NAMES, Case, CaseRun, Method, Place, Runs
from mpmfw.validation.page import said

#: The case of a module.
_CASE = pytest.StashKey[Case]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options of cases."""
    parser.addoption("--quick", action="store_true", help="Run the reduced version of validation cases.")
    parser.addoption("--results", metavar="FOLDER", help="Folder for rows and figures of validation cases.")


def pytest_configure(config: pytest.Config) -> None:
    """Announce the marks of cases, and leave out tests of the other version."""
    other = "full" if config.option.quick else "quick"
    asked = config.option.markexpr
    config.option.markexpr = f"({asked}) and not {other}" if asked else f"not {other}"
    for mark in ("full", "quick", "together(runs, ...)", "known_red(method, quantity, reason)"):
        config.addinivalue_line("markers", mark)


def case_of(node: Any) -> Case:
    """Return the case of a test, or of its module."""
    return node.getparent(pytest.Module).stash[_CASE]  # type: ignore[no-any-return]


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Generator[None, Any, Any]:
    """Import a module as a case, with the modules of its folder and the names of its runs."""
    if not isinstance(collector, pytest.Module):
        return (yield)
    folder, options = collector.path.parent, collector.config.option
    for path in folder.glob("*.py"):  # another case may have modules so named
        sys.modules.pop(path.stem, None)
    file = rows_file(folder, options.quick, Path(options.results)) if options.results else None
    collector.stash[_CASE] = Case(folder, options.quick, file)
    NAMES.clear()
    report = yield
    collector.stash[_CASE].names |= NAMES
    return report


@pytest.fixture(scope="module")
def case(request: pytest.FixtureRequest) -> Iterator[Case]:
    """Yield the case that the module's tests record; what it changes in the process is undone."""
    case = case_of(request.node)
    if case.file is not None and case.file.exists():  # a worker that began it is gone
        case.rows += json.loads(case.file.read_bytes())
        pytest.fail("red: its process ended abruptly", pytrace=False)
    case.write("its process ended abruptly")
    case.rows.clear()
    NAMES.clear()
    NAMES.update(case.names)
    with journal_style(), np.errstate(), mock.patch.dict(os.environ):
        yield case


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Set why gates of a test are known not to hold."""
    case_of(item).known = {mark.args[:2]: mark.args[2] for mark in item.iter_markers("known_red")}


@pytest.fixture
def run(request: pytest.FixtureRequest, case: Case) -> CaseRun:
    """Run one point of the test's runs; one that fails keeps its row, red if a gate binds it."""
    point: tuple[Runs, Place, Method] = request.param
    runs, place, method = point
    binds = runs.bound(method) and not place.is_open("run", method)
    try:
        return runs.start(case, place, method)
    except (SimulationError, SceneError) as error:
        case.failed(method, str(error), binds, place.at)
        judge(case.rows[-1:])
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
    case = case_of(pyfuncitem)
    start, result = len(case.rows), (yield)
    judge(case.rows[start:])
    return result


def judge(rows: Sequence[dict[str, Any]]) -> None:
    """Fail a test with red gates; mark one with known red gates alone as expected to fail."""
    if wrong := [f"red: {said(row)}" for row in rows if row["verdict"] == "RED"]:
        pytest.fail("\n".join(wrong), pytrace=False)
    if expected := [row["reason"] for row in rows if row["verdict"] == "known red"]:
        pytest.xfail("; ".join(dict.fromkeys(expected)))


def pytest_exception_interact(node: Any, report: pytest.TestReport | pytest.CollectReport) -> None:
    """Record an error of a test or of its collection as a red row, unless a gate is red."""
    if node.getparent(pytest.Module) is not None and not report.longreprtext.startswith("red: "):
        case_of(node).write(f"{report.nodeid}\n{report.longreprtext}")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> Generator[None, Any, Any]:
    """Write the rows of a case after its last test."""
    if nextitem is None or nextitem.path != item.path:
        case_of(item).write()
    return (yield)


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
    cases: Sequence[Path], output: Path, quick: bool = False, jobs: int | None = None, force: bool = False
) -> list[dict[str, Any]]:
    """Run cases by pytest, longest first, but those that today's code has finished; return their rows.

    Rows of a case that changes meanwhile count, and it runs again next time. ``output`` is the folder for
    figures and, in ``runs``, rows."""
    files = {case: rows_file(case, quick, output) for case in sorted(cases, key=_cost, reverse=True)}
    waiting = [case for case, file in files.items() if force or not _is_finished(file)]
    (output / "runs").mkdir(parents=True, exist_ok=True)
    for case in waiting:
        files[case].unlink(missing_ok=True)
    suite, code = cases[0].parent, int(pytest.ExitCode.INTERRUPTED)
    options = [
        *("-c", os.devnull, f"--rootdir={suite}", "-o", f"pythonpath={shlex.quote(str(suite))}"),
        *("-p", "no:cacheprovider", "-p", __name__, f"--results={output.resolve()}", *["--quick"] * quick),
        *("-n", str(min(jobs or cores(), len(waiting))), "--dist=loadfile", "--no-loadscope-reorder"),
        *(f"--max-worker-restart={len(waiting)}", "--continue-on-collection-errors"),
        *("-q", "--tb=no", "-rN", "--disable-warnings", *map(str, waiting)),
    ]
    with mock.patch.dict(os.environ, ONE_THREAD), interruptible(), contextlib.suppress(KeyboardInterrupt):
        code = pytest.main(options) if waiting else 0
    if code == pytest.ExitCode.INTERRUPTED:
        text = f"interrupted: {output / 'runs'} keeps finished cases; the same validation continues from them"
        raise Interrupted(signal.SIGINT, text)
    for case in waiting:
        if not files[case].exists():  # nothing is of the quick version of a case of full runs alone
            ran = quick and code in (0, 1, pytest.ExitCode.NO_TESTS_COLLECTED)
            Case(case, quick, files[case]).write(*[] if ran else ["it was not run"])
    return [row for case in cases for row in json.loads(files[case].read_bytes())]


def rows_file(case: Path, quick: bool, output: Path) -> Path:
    """Return the file of a case's rows; it changes with the files of case and suite, code and libraries."""
    inner = [path for path in case.rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    parts = [f"{name} {version}" for name, version in sorted(code_of_plugins().items())]
    shared = [*case.parent.glob("*.py"), *case.parent.glob("*/*_fem/*.py")]  # several cases import these
    key = digest(case.name, str(quick), sources([*inner, *shared]), package("mpmfw"), *parts)
    return output / "runs" / f"{key}.json"


def _is_finished(file: Path) -> bool:
    return file.exists() and all(row["quantity"] != "case" for row in json.loads(file.read_bytes()))


def _cost(folder: Path) -> float:
    """Return the CPU seconds that a case says it takes, ``# cost: 60``."""
    texts = "".join(file.read_text(encoding="utf-8") for file in folder.glob("test_*.py"))
    found = re.search(r"^# cost: *([0-9.]+)", texts, re.MULTILINE)
    return float(found.group(1)) if found else 10.0
