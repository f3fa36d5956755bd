"""Find the cases of a suite and run each by pytest, in processes that take one after the other."""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
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


@dataclass(frozen=True)
class CaseTask:
    """One case to run; as :class:`mpmfw.campaigns.work.Task`."""

    key: str
    name: str
    folder: Path
    output: Path
    quick: bool
    command: str
    code: Mapping[str, str]


@dataclass(frozen=True)
class CaseResult:
    """What came of one case: rows, figures (PNG files), an error, and the command that ran it."""

    folder: Path
    rows: tuple[Row, ...] = ()
    figures: tuple[Path, ...] = ()
    error: str = ""
    command: str = ""

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

    errors = plugin.ERRORS
    plugin.CASES.clear()
    errors.clear()
    options = ["-c", os.devnull, f"--rootdir={task.folder}", "-p", "no:cacheprovider"]
    options += ["--quick"] * task.quick
    printed = io.StringIO()
    try:
        with journal_style(), contextlib.redirect_stdout(printed), _alone(task.folder.parent):
            code = pytest.main([*options, "-p", plugin.__name__, str(task.folder)])
        nothing = code == pytest.ExitCode.NO_TESTS_COLLECTED and task.quick  # a case of full runs alone
        if code not in (0, 1) and not nothing and not errors:
            errors.append(printed.getvalue())
        for case in plugin.CASES:
            for name, figure in case.figures.items():
                write_figure(figure, task.output / f"{name}.png")
    except SystemExit as stop:
        errors.append(f"SystemExit: {stop}")
    rows = [row for case in plugin.CASES for row in case.rows]
    red = any(row.verdict is Verdict.RED for row in rows)
    status = "failed: it went wrong" if errors else "failed: a gate is red" if red else "ok"
    values = {
        "rows": [asdict(row) for row in rows],
        "figures": [f"{name}.png" for case in plugin.CASES for name in case.figures],
        "error": "\n".join(errors),
        "command": task.command,
    }
    return Finished(Outcome(task.key, status, task.name, values=values, code=task.code))


@contextlib.contextmanager
def _alone(suite: Path) -> Iterator[None]:
    """Find modules in the suite's folder, and leave nothing of a case to the next one.

    Modules, measures, the environment, the working folder and NumPy's answers to errors are as before."""
    loaded, found = {*sys.modules}, mock.patch.object(sys, "path", [str(suite), *sys.path])
    try:
        with (
            found,
            mock.patch.dict(os.environ),
            mock.patch.dict(MEASURES),
            np.errstate(),
            contextlib.chdir("."),
        ):
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
    command: str = "",
    force: bool = False,
) -> list[CaseResult]:
    """Run cases, longest first; those that today's code has done are not run again.

    ``output`` is the folder for figures and, in ``runs``, results. ``command`` is the one that results name.
    """
    output.mkdir(parents=True, exist_ok=True)
    runner = executor_of(executor, jobs) if executor is not None else Pool(jobs)
    store, code = Store(output / "runs"), code_of_plugins()
    by = f"`{command}` on {runner.cores}"
    tasks = {
        folder: CaseTask(_key(folder, quick), folder.name, folder, output, quick, by, code)
        for folder in sorted(cases, key=_cost, reverse=True)
    }
    for task in tasks.values():
        if force or not _drawn(store, task.key, output):
            store.forget(task.key)
    with resumable(store, "validation"):
        do(check_once, tasks.values(), store, runner, progress)
    return [_result(folder, output, store.outcome(tasks[folder].key)) for folder in cases]


def kept(cases: Iterable[Path], output: Path, quick: bool) -> list[CaseResult]:
    """Return what earlier runs of these cases found with today's code."""
    store = Store(output / "runs")
    keys = {folder: _key(folder, quick) for folder in cases}
    return [_result(f, output, store.outcome(key)) for f, key in keys.items() if _drawn(store, key, output)]


def _drawn(store: Store, key: str, output: Path) -> bool:
    outcome = store.outcome(key)
    names = outcome.values.get("figures", ()) if outcome is not None else ()
    return outcome is not None and all((output / name).is_file() for name in names)


def _key(folder: Path, quick: bool) -> str:
    """Return a key that changes with the files of the case and its suite, the code and libraries."""
    inner = [path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    parts = [f"{name} {version}" for name, version in sorted(code_of_plugins().items())]
    shared = [*folder.parent.glob("*.py"), *folder.parent.glob("*/*_fem/*.py")]  # several cases import these
    files = sources([*inner, *shared])
    return digest(folder.name, str(quick), files, package("mpmfw"), *parts)


def _cost(folder: Path) -> float:
    """Return the CPU seconds that a case says it takes, ``# cost: 60``."""
    for file in folder.glob("test_*.py"):
        if found := re.search(r"^# cost: *([0-9.]+)", file.read_text(encoding="utf-8"), re.MULTILINE):
            return float(found.group(1))
    return 10.0


def _result(folder: Path, output: Path, outcome: Outcome | None) -> CaseResult:
    if outcome is None or not outcome.values:
        return CaseResult(folder, error="it was not run" if outcome is None else outcome.status)
    values = dict(outcome.values)
    rows = tuple(Row(**row) for row in values.pop("rows"))
    figures = tuple(output / name for name in values.pop("figures"))
    return CaseResult(folder, rows, figures, **values)
