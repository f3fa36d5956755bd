"""Find the cases of a suite and run each by pytest, in processes that take one after the other."""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

import numpy as np

from mpmfw.campaigns.executors import Pool, executor_of
from mpmfw.campaigns.measures import MEASURES
from mpmfw.campaigns.running import Progress, do, resumable
from mpmfw.campaigns.store import Finished, Outcome, Store
from mpmfw.errors import SceneError
from mpmfw.results.selection import checked_name
from mpmfw.runs.identity import code_of_plugins, digest, package, sources
from mpmfw.validation.rows import Row, Verdict


class CaseTask(NamedTuple):
    """One case to run; as :class:`mpmfw.campaigns.work.Task`."""

    key: str
    name: str
    folder: Path
    output: Path
    quick: bool


@dataclass(frozen=True)
class CaseResult:
    """Results of one case: rows, figures (PNG files), and an error."""

    folder: Path
    rows: tuple[Row, ...] = ()
    figures: tuple[Path, ...] = ()
    error: str = ""

    @property
    def wrong(self) -> bool:
        """Return whether the case went wrong or a gate is red."""
        return bool(self.error) or any(row.verdict is Verdict.RED for row in self.rows)


def check_once(task: CaseTask) -> Finished:
    """Check a case by pytest and save its figures; an error is part of the outcome."""
    import pytest

    from mpmfw.plots import write_figure
    from mpmfw.plots.style import journal_style
    from mpmfw.validation import plugin

    cases, errors, printed = plugin.CASES, plugin.ERRORS, io.StringIO()
    cases.clear()
    errors.clear()
    options = ["-c", os.devnull, f"--rootdir={task.folder}", "-p", "no:cacheprovider", "-p", plugin.__name__]
    options += ["--quick"] * task.quick
    with journal_style(), contextlib.redirect_stdout(printed), _alone(task.folder.parent):
        code = pytest.main([*options, str(task.folder)])
    nothing = code == pytest.ExitCode.NO_TESTS_COLLECTED and task.quick  # a case of full runs alone
    if code not in (0, 1) and not nothing and not errors:
        errors.append(printed.getvalue())
    figures = {f"{name}.png": figure for case in cases for name, figure in case.figures.items()}
    for name, figure in figures.items():
        write_figure(figure, task.output / name)
    rows = [row for case in cases for row in case.rows]
    wrong = errors or any(row.verdict is Verdict.RED for row in rows)
    values = {"rows": [asdict(row) for row in rows], "figures": [*figures], "error": "\n".join(errors)}
    status = "failed: it went wrong, or a gate is red" if wrong else "ok"
    return Finished(Outcome(task.key, status, task.name, values=values, code=code_of_plugins()))


@contextlib.contextmanager
def _alone(suite: Path) -> Iterator[None]:
    """Find modules in the suite's folder, and leave nothing of a case to the next one.

    Modules, measures, the environment, the working folder and NumPy's answers to errors are as before."""
    loaded, found = {*sys.modules}, mock.patch.object(sys, "path", [str(suite), *sys.path])
    kept = mock.patch.dict(os.environ), mock.patch.dict(MEASURES)
    try:
        with found, kept[0], kept[1], np.errstate(), contextlib.chdir("."):
            yield
    finally:
        for name in {*sys.modules} - loaded:
            file = Path(getattr(sys.modules[name], "__file__", None) or "/")
            if file.is_relative_to(suite) and "site-packages" not in file.relative_to(suite).parts:
                del sys.modules[name]


def suite_of(given: Path | None = None) -> Path:
    """Return the folder of a suite: as given, one of mpmfw's own by name (``hard``), or the main one.

    Its own are installed with it, or in the checkout that it runs from."""
    package = Path(__file__).parents[1]
    own = package / "cases" if (package / "cases").is_dir() else package.parents[1] / "validation"
    if given is None:
        return own
    inside = len(given.parts) == 1 and not given.is_dir() and (own / given).is_dir()
    return own / given if inside else given


def find_cases(suite: Path, names: Sequence[str] = ()) -> list[Path]:
    """Return the folders of the suite with a ``test_*.py``, all or the named ones; else a SceneError."""
    if not suite.is_dir():
        raise SceneError(f"--suite {suite}: is not a folder; expected one with a folder for each case")
    known = {file.parent.name: file.parent for file in sorted(suite.resolve().glob("*/test_*.py"))}
    if not known:
        raise SceneError(f"--suite {suite}: no folder in it has a test_*.py")
    return [known[checked_name("case", name, list(known))] for name in names or sorted(known)]


def run_cases(
    cases: Sequence[Path],
    output: Path,
    quick: bool = False,
    jobs: int | None = None,
    progress: Progress | None = None,
    *,
    executor: Any = None,
    force: bool = False,
) -> list[CaseResult]:
    """Run cases, longest first; those that today's code has done are not run again.

    ``output`` is the folder for figures and, in ``runs``, results.
    """
    output.mkdir(parents=True, exist_ok=True)
    runner, store = executor_of(executor, jobs) if executor is not None else Pool(jobs), _store(output)
    ordered = sorted(cases, key=_cost, reverse=True)
    tasks = [CaseTask(_key(one, quick), one.name, one, output, quick) for one in ordered]
    for task in tasks:
        if force or _result(task.folder, output, store.outcome(task.key)) is None:
            store.forget(task.key)
    with resumable(store, "validation"):
        do(check_once, tasks, store, runner, progress)
    found = {task.folder: store.outcome(task.key) for task in tasks}
    whole = {folder: _result(folder, output, outcome) for folder, outcome in found.items()}
    return [
        whole[one] or CaseResult(one, error=getattr(found[one], "status", "it was not run")) for one in cases
    ]


def kept(cases: Iterable[Path], output: Path, quick: bool) -> list[CaseResult]:
    """Return what earlier runs of these cases found with today's code."""
    store = _store(output)
    found = (_result(folder, output, store.outcome(_key(folder, quick))) for folder in cases)
    return [one for one in found if one is not None]


def _store(output: Path) -> Store:
    return Store(output / "runs")


def _key(folder: Path, quick: bool) -> str:
    """Return a key that changes with the files of the case and its suite, the code and libraries."""
    inner = [path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    parts = [f"{name} {version}" for name, version in sorted(code_of_plugins().items())]
    shared = [*folder.parent.glob("*.py"), *folder.parent.glob("*/*_fem/*.py")]  # several cases import these
    return digest(folder.name, str(quick), sources([*inner, *shared]), package("mpmfw"), *parts)


def _cost(folder: Path) -> float:
    """Return the CPU seconds that a case says it takes, ``# cost: 60``."""
    for file in folder.glob("test_*.py"):
        if found := re.search(r"^# cost: *([0-9.]+)", file.read_text(encoding="utf-8"), re.MULTILINE):
            return float(found.group(1))
    return 10.0


def _result(folder: Path, output: Path, outcome: Outcome | None) -> CaseResult | None:
    """Return what an outcome says, None if it says nothing or its figures are gone."""
    if outcome is None or not outcome.values:
        return None
    figures = tuple(output / name for name in outcome.values["figures"])
    rows = tuple(Row(**row) for row in outcome.values["rows"])
    result = CaseResult(folder, rows, figures, outcome.values["error"])
    return result if all(figure.is_file() for figure in figures) else None
