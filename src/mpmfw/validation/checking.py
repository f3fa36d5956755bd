"""Run one case: in a process of its own, which loads no more than the case needs."""

from __future__ import annotations

import importlib
import sys
import time
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from mpmfw.campaigns.outcome import Finished, Outcome
from mpmfw.validation.case import Case
from mpmfw.validation.measuring import check_tables
from mpmfw.validation.reading import load_case
from mpmfw.validation.rows import Verdict


@dataclass(frozen=True)
class CaseTask:
    """One case to run; as :class:`mpmfw.campaigns.work.Task`."""

    key: str
    name: str
    folder: Path
    output: Path
    quick: bool
    command: str
    cores: str
    code: Mapping[str, str]


def check_once(task: CaseTask) -> Finished:
    """Check a case and save its figures; an error in it is part of the outcome, beside the rows before it."""
    from mpmfw.plots import write_figure  # matplotlib, which the process that only starts cases does without
    from mpmfw.plots.style import journal_style

    start = time.perf_counter()
    case, error = Case(task.folder, task.quick), ""
    try:
        with journal_style():
            check_case(case)
        for name, figure in case.figures.items():
            write_figure(figure, task.output / f"{name}.png")
    except (Exception, SystemExit):
        case.figures.clear()
        error = traceback.format_exc()
    red = any(row.verdict is Verdict.RED for row in case.rows)
    status = "failed: it went wrong" if error else "failed: a gate is red" if red else "ok"
    values = {
        "rows": [asdict(row) for row in case.rows],
        "figures": [f"{name}.png" for name in case.figures],
        "error": error,
        "seconds": time.perf_counter() - start,
        "command": task.command,
        "cores": task.cores,
    }
    return Finished(Outcome(task.key, status, task.name, values=values, code=task.code))


def check_case(case: Case) -> None:
    """Do what the tables of a case say, or its ``check.py``."""
    with _on_the_path(case.folder.resolve()):
        if (case.folder / "case.toml").is_file():
            check_tables(case, load_case(case.folder))
        else:
            importlib.import_module("check").check(case)


@contextmanager
def _on_the_path(folder: Path) -> Iterator[None]:
    """Context in which modules of a case and of its suite can be imported; afterwards they are forgotten, so that cases
    may name their modules alike."""
    before, path = set(sys.modules), list(sys.path)
    sys.path[:0] = [str(folder), str(folder.parent)]
    try:
        yield
    finally:
        sys.path[:] = path
        for name in set(sys.modules) - before:
            origin = getattr(sys.modules[name], "__file__", None)
            if origin and Path(origin).is_relative_to(folder.parent):
                del sys.modules[name]
