"""Work of one process: run a scene once, with nothing beside it."""

from __future__ import annotations

import copy
import functools
import hashlib
import json
import logging
import math
import os
import platform
import tempfile
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import xarray as xr

from mpmfw.campaigns.store import COSTS, Cost, Finished, Outcome
from mpmfw.codes.code import Code
from mpmfw.codes.outputs import run_code
from mpmfw.errors import MpmfwError, ResultsWarning, SceneError, SimulationError
from mpmfw.plugin.checks import cause
from mpmfw.runs.identity import code_of
from mpmfw.runs.run import run
from mpmfw.scene import Scene
from mpmfw.state.fields import STEP_STAGES

#: Cores that others may keep busy before a machine counts as loaded: daemons take a few hundredths of one.
LOADED = 0.2


@functools.cache
def processor() -> str:
    """Model of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    named = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(named, platform.processor() or platform.machine())


class Load:
    """Measures the number of cores that other processes keep busy, from its creation on."""

    def __init__(self) -> None:
        self._busy, self._own, self._wall = _busy(), _own(), time.perf_counter()

    def others(self) -> float:
        """Return the mean number of cores that others kept busy."""
        wall = time.perf_counter() - self._wall
        busy = _busy() - self._busy - (_own() - self._own)
        # The system counts in hundredths of a second: of shorter spans it says nothing
        return max(0.0, busy / wall) if wall > 0.1 else float("nan")


def _own() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def _busy() -> float:
    """Return CPU seconds of all processes since the machine started."""
    try:
        first = Path("/proc/stat").read_text(encoding="utf-8").splitlines()[0].split()
    except (OSError, IndexError):
        return float("nan")
    user, nice, system, _, _, irq, softirq = (float(part) for part in first[1:8])
    return (user + nice + system + irq + softirq) / os.sysconf("SC_CLK_TCK")


_log = logging.getLogger("mpmfw")

#: A worker with several threads would measure the CPU time of them all.
_ALONE = threading.Lock()

#: Runs of this process: from the second on, its largest memory is not that of one run.
_begun = 0


@dataclass(frozen=True)
class Task:
    """One run to do."""

    key: str  #: of the run, as in its outcome
    name: str  #: in words
    scene: Scene
    contact: Any = None  #: a strategy object instead of the scene's method; each run gets a copy
    shape: Any = None  #: as ``contact``
    code: Mapping[str, str] = field(default_factory=dict)  #: what must run it, by name; empty is not asked
    timing: str = ""  #: how its cost will be marked
    force: bool = False  #: whether it may be past the limits of steps and frames
    threads: int = 1  #: that share its work, whatever the scene says


def run_once(task: Task, progress: Callable[[float, int], None] | None = None) -> Finished:
    """Run a task and return all that it wrote."""
    with _ALONE, _warnings() as text, tempfile.TemporaryDirectory(prefix="mpmfw-") as folder:
        path = Path(folder) / "run.nc"
        outcome, tree = _try(task, path, progress)
        notes = tuple(dict.fromkeys(str(warning.message) for warning in text))
        known = replace(outcome, name=task.name, scene=task.scene.text, notes=notes, code=task.code)
        return Finished(known, path.read_bytes() if tree is not None else None)


def time_once(task: Task) -> Finished:
    """Run a task for its cost; only a digest of the series is kept."""
    with _ALONE, _warnings():
        return Finished(_try(task, None, None)[0])


def _try(
    task: Task, path: Path | None, progress: Callable[[float, int], None] | None
) -> tuple[Outcome, xr.DataTree | None]:
    global _begun
    first, load = _begun == 0, Load()

    def ended(
        status: str, tree: xr.DataTree | None = None, lasting: bool = True
    ) -> tuple[Outcome, xr.DataTree | None]:
        if tree is None:
            return Outcome(task.key, status, lasting=lasting), None
        costs = (_cost(tree, task, load.others(), first),)
        return Outcome(task.key, status, digest=_digest(tree), costs=costs), tree

    try:
        if task.code and code_of(task.scene, task.contact, task.shape) != task.code:
            return ended(
                "failed: this worker has another version of mpmfw, a plug-in or a library", lasting=False
            )
        _begun += 1
        tree = _run(task, path, progress)
    except SceneError as error:
        return ended(f"refused: {error}")
    except SimulationError as error:
        return ended(f"failed: {error}", error.results)
    except MpmfwError as error:  # a file that could not be written
        return ended(f"failed: {error}", lasting=False)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a stranger's method may raise anything; or it was the machine
        _log.exception("%s failed", task.name)
        return ended(f"failed: {cause(error)}", lasting=False)
    return ended(str(tree.attrs.get("status", "ok")), tree)


def _run(task: Task, path: Path | None, progress: Callable[[float, int], None] | None) -> xr.DataTree:
    if isinstance(task.contact, Code):
        with tempfile.TemporaryDirectory(prefix="mpmfw-code-") as folder:
            tree = run_code(task.contact, task.scene, Path(folder), path)
        if notes := json.loads(tree.attrs["notes"]):
            warnings.warn("; ".join(notes), ResultsWarning, stacklevel=2)
        return tree
    return run(
        task.scene,
        contact=copy.deepcopy(task.contact),
        shape=copy.deepcopy(task.shape),
        output=path,
        progress=progress,
        force=task.force,
        threads=task.threads,
        checkpoint=None if path is None else math.inf,
    )


@contextmanager
def _warnings() -> Iterator[list[warnings.WarningMessage]]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("ignore")
        warnings.filterwarnings("always", category=ResultsWarning)
        yield caught


def _cost(tree: xr.DataTree, task: Task, others: float, first: bool) -> Cost:
    timing = task.timing if task.threads == 1 else "shared cores"  # threads that wait take CPU time as well
    attributes = {"settle_steps": 0, **tree.attrs}
    if not first and not isinstance(task.contact, Code):  # a code runs in a separate process
        attributes.pop("peak_memory", None)
    values = {name: float(attributes.get(name, math.nan)) for name, _, _ in COSTS}
    stages = {stage: float(attributes.get(f"cpu_{stage}", math.nan)) for stage in STEP_STAGES}
    settling = {stage: float(attributes.get(f"settle_cpu_{stage}", 0.0)) for stage in STEP_STAGES}
    return Cost(timing, values, stages, settling, others, processor())


def _digest(tree: xr.DataTree) -> str:
    if "series" not in tree.children:
        return ""
    digest = hashlib.sha256()
    series = tree["series"].to_dataset()
    for name in sorted(map(str, series.data_vars)):
        digest.update(name.encode())
        digest.update(series[name].values.tobytes())
    return digest.hexdigest()[:32]
