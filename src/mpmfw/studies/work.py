"""What a worker does: run a scene once, in a process that does nothing else meanwhile."""

from __future__ import annotations

import hashlib
import math
import tempfile
import threading
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from mpmfw.clock import STEP_STAGES
from mpmfw.errors import MpmfwError, ResultsWarning, SceneError, SimulationError
from mpmfw.runs import run
from mpmfw.scene import Scene
from mpmfw.studies.identity import code_of
from mpmfw.studies.store import COSTS, Cost, Record

#: A worker with several threads would measure the CPU time of them all.
_ALONE = threading.Lock()


@dataclass(frozen=True)
class Task:
    """One run to do.

    Attributes
    ----------
    key, name
        Of the run, as in its record.
    scene
        What to run.
    code
        Hash of the code that is meant to run it.
    timing
        How its cost will be marked.
    """

    key: str
    name: str
    scene: Scene
    code: str
    timing: str


@dataclass(frozen=True)
class Finished:
    """What came of a task: its record, and the file that it wrote, if any."""

    record: Record
    results: bytes | None = None


def run_once(task: Task) -> Finished:
    """Run a task and return all that it wrote; nothing but an interruption is raised."""
    with _ALONE, _warnings() as said, tempfile.TemporaryDirectory(prefix="mpmfw-") as folder:
        path = Path(folder) / "run.nc"
        status, lasting, tree = _try(task, path)
        record = Record(
            task.key,
            status,
            task.name,
            task.scene.text,
            "" if tree is None else _digest(tree),
            tuple(dict.fromkeys(str(warning.message) for warning in said)),
            () if tree is None else (_cost(tree, task.timing),),
            lasting,
        )
        return Finished(record, path.read_bytes() if tree is not None else None)


def time_once(task: Task) -> Finished:
    """Run a task for its cost; the series are kept as a digest alone."""
    with _ALONE, _warnings():
        status, lasting, tree = _try(task, None)
        if tree is None:
            return Finished(Record(task.key, status, lasting=lasting))
        return Finished(Record(task.key, status, digest=_digest(tree), costs=(_cost(tree, task.timing),)))


def _try(task: Task, path: Path | None) -> tuple[str, bool, xr.DataTree | None]:
    """The status, whether it would be the same again, and the results if there are any."""
    try:
        if code_of(task.scene) != task.code:
            return "failed: this worker has another version of mpmfw or of a plug-in", False, None
        tree = run(task.scene, output=path)
    except SceneError as error:
        return f"refused: {error}", True, None
    except SimulationError as error:
        return f"failed: {error}", True, error.results
    except MpmfwError as error:  # a file that could not be written
        return f"failed: {error}", False, None
    except Exception as error:  # a stranger's method may raise anything; it may have been the machine as well
        where = traceback.extract_tb(error.__traceback__)[-1]
        said = f"{type(error).__name__}: {error} ({Path(where.filename).name}, line {where.lineno})"
        return f"failed: {said}", False, None
    return str(tree.attrs.get("status", "ok")), True, tree


@contextmanager
def _warnings() -> Iterator[list[warnings.WarningMessage]]:
    """Collect warnings; what a run wants its reader to know is shown however often it is said."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("ignore")
        warnings.filterwarnings("always", category=ResultsWarning)
        yield caught


def _cost(tree: xr.DataTree, timing: str) -> Cost:
    attributes = {"settle_steps": 0, **tree.attrs}
    values = {name: float(attributes.get(name, math.nan)) for name, _, _ in COSTS}
    stages = {stage: float(attributes.get(f"cpu_{stage}", math.nan)) for stage in STEP_STAGES}
    settling = {stage: float(attributes.get(f"settle_cpu_{stage}", 0.0)) for stage in STEP_STAGES}
    return Cost(timing, values, stages, settling)


def _digest(tree: xr.DataTree) -> str:
    """Hash of every bit of the series."""
    digest = hashlib.sha256()
    series = tree["series"].to_dataset()
    for name in sorted(map(str, series.data_vars)):
        digest.update(name.encode())
        digest.update(series[name].values.tobytes())
    return digest.hexdigest()[:32]
