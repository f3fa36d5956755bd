"""Run one case: in a process of its own, which loads no more than the case needs."""

from __future__ import annotations

import importlib.util
import sys
import time
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType

from mpmfw.campaigns.outcome import Finished, Outcome
from mpmfw.errors import SceneError
from mpmfw.validation.case import Case
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
    """Run the ``check`` of a case and save its figures; an error in it is part of the outcome, beside the rows before it."""
    start = time.perf_counter()
    case, error = Case(task.folder, task.quick), ""
    try:
        with _loaded(task.folder) as module:
            module.check(case)
        for name, figure in case.figures.items():
            figure.savefig(task.output / f"{name}.png")
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
