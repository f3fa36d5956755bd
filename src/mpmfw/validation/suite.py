"""Find the cases of a suite and run them, several at a time."""

from __future__ import annotations

import importlib.util
import multiprocessing
import os
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from types import ModuleType

from mpmfw.errors import SceneError
from mpmfw.validation.case import Case
from mpmfw.validation.rows import Row, Verdict


@dataclass(frozen=True)
class Outcome:
    """What came of one case.

    Attributes
    ----------
    folder
        Of the case.
    rows, figures
        What it recorded; figures are PNG files.
    error
        The traceback, if ``check.py`` itself went wrong; empty if not.
    seconds
        Wall time, compilation included.
    """

    folder: Path
    rows: tuple[Row, ...]
    figures: tuple[Path, ...]
    error: str
    seconds: float

    @property
    def holds(self) -> bool:
        """Whether the case ran, and no gate is red."""
        return not self.error and all(row.verdict is not Verdict.RED for row in self.rows)


def find_cases(suite: Path, names: Sequence[str] = ()) -> list[Path]:
    """Folders of the suite with a ``check.py``: all, or the named ones.

    Raises
    ------
    SceneError
        There is no such suite, or no such case.
    """
    if not suite.is_dir():
        raise SceneError(
            f"--suite {suite}: there is no such folder; expected one with a folder for each case, "
            "such as validation/ of the mpmfw repository"
        )
    known = {check.parent.name: check.parent for check in sorted(suite.glob("*/check.py"))}
    if not known:
        raise SceneError(f"--suite {suite}: no folder in it has a check.py")
    for name in names:
        if name not in known:
            near = get_close_matches(name, known, n=1)
            hint = f"did you mean '{near[0]}'?" if near else f"expected one of {', '.join(known)}"
            raise SceneError(f"there is no case '{name}' in {suite}: {hint}")
    return [known[name] for name in names] if names else list(known.values())


def run_cases(
    cases: Sequence[Path],
    output: Path,
    quick: bool = False,
    jobs: int | None = None,
    done: Callable[[Outcome], None] | None = None,
) -> list[Outcome]:
    """Run cases, each in one process of its own, and save their figures.

    Parameters
    ----------
    cases
        Folders, of :func:`find_cases`.
    output
        Folder for the figures; made if it is not there.
    quick
        Run the reduced versions.
    jobs
        Cases at a time; None is one for each core.
    done
        Called with each outcome as it comes.

    Returns
    -------
    list of Outcome
        In the order of ``cases``.
    """
    output.mkdir(parents=True, exist_ok=True)
    jobs = min(jobs or _cores(), len(cases))
    outcomes = {}
    for outcome in _outcomes(cases, output, quick, jobs):
        outcomes[outcome.folder] = outcome
        if done is not None:
            done(outcome)
    return [outcomes[folder] for folder in cases]


def _cores() -> int:
    """Cores that this process may use, where the system says so."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed is not None else os.cpu_count() or 1


def _outcomes(cases: Sequence[Path], output: Path, quick: bool, jobs: int) -> Iterator[Outcome]:
    if jobs == 1:
        yield from (run_case(folder, output, quick) for folder in cases)
        return
    # Started afresh, not forked: threads of the parent's libraries do not survive a fork
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context) as pool:
        waiting = {pool.submit(run_case, folder, output, quick) for folder in _longest_first(cases)}
        yield from (future.result() for future in as_completed(waiting))


def _longest_first(cases: Iterable[Path]) -> list[Path]:
    """By the CPU seconds that a case says it takes (``# cost: 60`` in its check.py), so that no long one is left
    to run alone at the end."""
    return sorted(cases, key=_cost, reverse=True)


def _cost(folder: Path) -> float:
    for line in (folder / "check.py").read_text(encoding="utf-8").splitlines():
        if line.startswith("# cost:"):
            return float(line.removeprefix("# cost:").split()[0])
    return 10.0


def run_case(folder: Path, output: Path, quick: bool = False) -> Outcome:
    """Run the ``check`` of one case and save its figures; an error in it is part of the outcome."""
    start = time.perf_counter()
    case, error = Case(folder, quick), ""
    try:
        with _loaded(folder) as module:
            module.check(case)
        figures = []
        for name, figure in case.figures.items():
            path = output / f"{name}.png"
            figure.savefig(path)
            figures.append(path)
    except Exception:
        error, figures = traceback.format_exc(), []
    return Outcome(folder, tuple(case.rows), tuple(figures), error, time.perf_counter() - start)


@contextmanager
def _loaded(folder: Path) -> Iterator[ModuleType]:
    """Import ``check.py`` with its folder and the suite's on the path; afterwards both are forgotten, so that
    cases may name their modules alike."""
    folder = folder.resolve()
    before, path = set(sys.modules), list(sys.path)
    sys.path[:0] = [str(folder), str(folder.parent)]
    spec = importlib.util.spec_from_file_location("check", folder / "check.py")
    if spec is None or spec.loader is None:
        raise SceneError(f"{folder / 'check.py'} cannot be imported")
    module = importlib.util.module_from_spec(spec)
    sys.modules["check"] = module  # dataclasses look their module up
    try:
        spec.loader.exec_module(module)
        yield module
    finally:
        sys.path[:] = path
        for name in set(sys.modules) - before:
            origin = getattr(sys.modules[name], "__file__", None)
            if name == "check" or (origin and Path(origin).is_relative_to(folder.parent)):
                del sys.modules[name]
