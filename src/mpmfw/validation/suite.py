"""Find the cases of a suite and run them, each in a process of its own."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from mpmfw.campaigns.executors import Pool, executor_of
from mpmfw.campaigns.outcome import Outcome
from mpmfw.campaigns.running import Progress, do, resumable
from mpmfw.campaigns.store import Store
from mpmfw.errors import SceneError
from mpmfw.runs.identity import code_of_plugins, digest, package, sources
from mpmfw.validation.checking import CaseTask, check_once
from mpmfw.validation.rows import Row, Verdict

#: What says how a case is checked: tables, or a function.
CHECKS = ("case.toml", "check.py")


@dataclass(frozen=True)
class CaseResult:
    """What came of one case.

    Attributes
    ----------
    folder
        Of the case.
    rows, figures
        What it recorded; figures are PNG files.
    error
        The traceback, if the check itself went wrong; empty if not.
    seconds
        Wall time, compilation included.
    command, cores
        What it was run by, and on how many cores.
    """

    folder: Path
    rows: tuple[Row, ...]
    figures: tuple[Path, ...]
    error: str
    seconds: float
    command: str = ""
    cores: str = ""

    @property
    def holds(self) -> bool:
        """Whether the case ran, and no gate is red."""
        return not self.error and all(row.verdict is not Verdict.RED for row in self.rows)


def shipped_suite() -> Path:
    """The folder of mpmfw's own cases: installed with it, or in the checkout that it runs from."""
    package = Path(__file__).parents[1]
    installed = package / "cases"
    return installed if installed.is_dir() else package.parents[1] / "validation"


def suite_of(given: Path | None) -> Path:
    """The folder of a suite: as it is given, or one of mpmfw's own by name, such as ``hard``; without one, all of mpmfw's own
    cases that are in no such folder."""
    if given is None or given.is_dir():
        return given or shipped_suite()
    own = shipped_suite() / given
    return own if len(given.parts) == 1 and own.is_dir() else given


def find_cases(suite: Path, names: Sequence[str] = ()) -> list[Path]:
    """Folders of the suite with a ``case.toml`` or a ``check.py``: all, or the named ones.

    Raises
    ------
    SceneError
        There is no such suite, or no such case, or one has both files.
    """
    if not suite.is_dir():
        raise SceneError(
            f"--suite {suite}: there is no such folder; expected one with a folder for each case, "
            "such as validation/ of the mpmfw repository"
        )
    known = {file.parent.name: file.parent for name in CHECKS for file in suite.glob(f"*/{name}")}
    if not known:
        raise SceneError(f"--suite {suite}: no folder in it has a {' or a '.join(CHECKS)}")
    for folder in known.values():
        if all((folder / check).is_file() for check in CHECKS):
            raise SceneError(
                f"{folder}: has a {' and a '.join(CHECKS)}, and one would have no effect; leave one of them out"
            )
    for name in names:
        if name not in known:
            near = get_close_matches(name, known, n=1)
            hint = f"did you mean '{near[0]}'?" if near else f"expected one of {', '.join(known)}"
            raise SceneError(f"there is no case '{name}' in {suite}: {hint}")
    return [known[name] for name in names or sorted(known)]


def run_cases(
    cases: Sequence[Path],
    output: Path,
    quick: bool = False,
    jobs: int | None = None,
    progress: Progress | None = None,
    *,
    executor: Any = None,
    command: str = "mpmfw.validation.run_cases",
    force: bool = False,
) -> list[CaseResult]:
    """Run cases, each in a process of its own, and save their figures; those that are done, by today's code, are not run again.

    Parameters
    ----------
    cases
        Folders, of :func:`find_cases`.
    output
        Folder for the figures, made if it is not there; results are kept in its folder ``runs``.
    quick
        Run the reduced versions.
    jobs, executor
        As :func:`mpmfw.campaign` takes them, but that no case runs in this process: one that brings down its own takes no
        other with it.
    progress
        Called with an :class:`mpmfw.campaigns.running.Event` after each case.
    command
        What the results are said to be written by.
    force
        Run cases again that are done.

    Returns
    -------
    list of CaseResult
        In the order of ``cases``.
    """
    output.mkdir(parents=True, exist_ok=True)
    runner = executor_of(executor, jobs) if executor is not None else Pool(jobs, fresh=True)
    store, code = Store(output / "runs"), code_of_plugins()
    tasks = {
        folder: CaseTask(_key(folder, quick), folder.name, folder, output, quick, command, runner.cores, code)
        for folder in _longest_first(cases)
    }
    for task in tasks.values():
        if force or not _drawn(store, task.key, output):
            store.forget(task.key)
    with resumable(store, "validation"):
        do(check_once, tasks.values(), store, runner, progress)
    return [_result(folder, output, store.outcome(tasks[folder].key)) for folder in cases]


def kept(cases: Iterable[Path], output: Path, quick: bool) -> list[CaseResult]:
    """What earlier runs of these cases, reduced or full, found with the code of today, in the order of ``cases``."""
    store = Store(output / "runs")
    keys = {folder: _key(folder, quick) for folder in cases}
    return [_result(f, output, store.outcome(key)) for f, key in keys.items() if _drawn(store, key, output)]


def _drawn(store: Store, key: str, output: Path) -> bool:
    """Whether a case is done and its figures are there."""
    outcome = store.outcome(key)
    return outcome is not None and all(
        (output / name).is_file() for name in outcome.values.get("figures", ())
    )


def _key(folder: Path, quick: bool) -> str:
    """A name for the run of a case: the same for the same files of it and of the suite, code and libraries."""
    inner = [path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    shared = [*folder.parent.glob("*.py"), *_like(folder)]
    parts = [f"{name} {is_}" for name, is_ in sorted(code_of_plugins().items())]
    return digest(folder.name, str(quick), sources([*inner, *shared]), package("mpmfw"), *parts)


def _like(folder: Path) -> list[Path]:
    """The file that a case's tables go on from, if there is one."""
    named = _said(folder, r"like = \"([^\"]+)\"")
    return [folder / named] if named and (folder / named).is_file() else []


def _result(folder: Path, output: Path, outcome: Outcome | None) -> CaseResult:
    if outcome is None or not outcome.values:
        error = "it was not run" if outcome is None else outcome.status
        return CaseResult(folder, (), (), f"{error}\n", 0.0)
    known = dict(outcome.values)
    rows = tuple(Row(**row) for row in known.pop("rows"))
    figures = tuple(output / name for name in known.pop("figures"))
    return CaseResult(folder, rows, figures, **known)


def _longest_first(cases: Iterable[Path]) -> list[Path]:
    """By the CPU seconds that a case says it takes (``cost = 60`` in its table, ``# cost: 60`` in its check.py), so that no
    long one is left to run alone at the end."""
    return sorted(cases, key=_cost, reverse=True)


def _cost(folder: Path) -> float:
    found = _said(folder, r"(?:# cost:|cost =) *([0-9.]+)")
    return float(found) if found else 10.0


def _said(folder: Path, line: str) -> str | None:
    """What the group of a pattern is in a line of a case's file."""
    file = next(folder / name for name in CHECKS if (folder / name).is_file())
    found = re.search(f"^{line}", file.read_text(encoding="utf-8"), re.MULTILINE)
    return found.group(1) if found else None
