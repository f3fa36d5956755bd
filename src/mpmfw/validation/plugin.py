"""Pytest's plug-in for validation cases: fixtures ``case``, ``run`` and ``runs``, and a verdict on gates.

``pytest -p mpmfw.validation.plugin validation/hertz [--quick]`` runs one case; ``mpmfw validate`` runs all.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from typing import Any

import pytest

from mpmfw.errors import SceneError, SimulationError
from mpmfw.validation.case import CaseRun, Runs, RunSet
from mpmfw.validation.rows import Case, Verdict

#: Of this process: the cases whose tests have run.
CASES: list[Case] = []
#: Of this process: errors of tests and of collection, but for the verdicts on gates.
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
    runs: Runs
    runs, place, method = request.param
    try:
        return runs.start(case, place, method)
    except (SimulationError, SceneError) as error:
        gates = method.recommended or method.matches(*runs.binds)
        binds = gates and place.change is None and not place.is_open("run", method)
        case.failed(method, str(error), binds, str(place))
        judge(request.node, case, len(case.rows) - 1)
        pytest.skip(str(error))


@pytest.fixture
def runs(request: pytest.FixtureRequest, case: Case) -> RunSet:
    """Return all runs that the test takes together; it is skipped if some were deselected."""
    taken = request.node.get_closest_marker("together").args
    versions = ("", "quick" if case.quick else "full")
    for runs in taken:
        if runs.started < sum(all(one.when in versions for one in point) for point in runs.points()):
            pytest.skip("some of its runs were deselected")
    return RunSet(run for runs in taken for run in runs.done)


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Generator[None, Any, Any]:
    """Judge the rows that a test has recorded."""
    case: Any = pyfuncitem.funcargs.get("case")
    start = len(case.rows) if case else 0
    result = yield
    if case:
        judge(pyfuncitem, case, start)
    return result


def judge(item: pytest.Item, case: Case, start: int) -> None:
    """Fail a test with red gates; mark one with known red gates alone as expected to fail."""
    known = {mark.args[:2]: mark.args[2] for mark in item.iter_markers("known_red")}
    found = [replace(row, reason=known.get((row.method, row.quantity), "")) for row in case.rows[start:]]
    case.rows[start:] = found
    wrong = [f"red: {row}" for row in found if row.verdict is Verdict.RED]
    if wrong:
        item.user_properties.append(("gates", wrong))
        pytest.fail("\n".join(wrong), pytrace=False)
    expected = [row.reason for row in found if row.verdict is Verdict.KNOWN]
    if expected:
        pytest.xfail("; ".join(dict.fromkeys(expected)))
