"""What a worker does: run a scene once, in a process that does nothing else meanwhile."""

from __future__ import annotations

import copy
import hashlib
import logging
import math
import tempfile
import threading
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import xarray as xr

from mpmfw.campaigns.machine import Load, processor
from mpmfw.campaigns.outcome import COSTS, Cost, Finished, Outcome
from mpmfw.errors import MpmfwError, ResultsWarning, SceneError, SimulationError
from mpmfw.plugin.checks import cause
from mpmfw.runs.identity import code_of
from mpmfw.runs.run import run
from mpmfw.scene import Scene
from mpmfw.state.clock import STEP_STAGES

_log = logging.getLogger("mpmfw")

#: A worker with several threads would measure the CPU time of them all.
_ALONE = threading.Lock()

#: Runs of this process: from the second on, its largest memory is not that of one run.
_begun = 0


@dataclass(frozen=True)
class Task:
    """One run to do.

    Attributes
    ----------
    key, name
        Of the run, as in its outcome.
    scene
        What to run.
    contact, shape
        Strategy objects in place of the scene's methods; each run gets a copy.
    code
        What is meant to run it, by name; empty is not asked.
    timing
        How its cost will be marked.
    force
        Whether it may be past the limits of steps and frames.
    threads
        That share its work, whatever the scene says.
    """

    key: str
    name: str
    scene: Scene
    contact: Any = None
    shape: Any = None
    code: Mapping[str, str] = field(default_factory=dict)
    timing: str = ""
    force: bool = False
    threads: int = 1


def run_once(task: Task, progress: Callable[[float, int], None] | None = None) -> Finished:
    """Run a task and return all that it wrote; nothing but an interruption is raised."""
    with _ALONE, _warnings() as text, tempfile.TemporaryDirectory(prefix="mpmfw-") as folder:
        path = Path(folder) / "run.nc"
        outcome, tree = _try(task, path, progress)
        notes = tuple(dict.fromkeys(str(warning.message) for warning in text))
        known = replace(outcome, name=task.name, scene=task.scene.text, notes=notes, code=task.code)
        return Finished(known, path.read_bytes() if tree is not None else None)


def time_once(task: Task) -> Finished:
    """Run a task for its cost; the series are kept as a digest alone."""
    with _ALONE, _warnings():
        return Finished(_try(task, None, None)[0])


def _try(
    task: Task, path: Path | None, progress: Callable[[float, int], None] | None
) -> tuple[Outcome, xr.DataTree | None]:
    """How a run went, with the digest and the cost of its results, and these, if there are any."""
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
        tree = run(
            task.scene,
            contact=copy.deepcopy(task.contact),
            shape=copy.deepcopy(task.shape),
            output=path,
            progress=progress,
            force=task.force,
            threads=task.threads,
            checkpoint=None if path is None else math.inf,
        )
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


@contextmanager
def _warnings() -> Iterator[list[warnings.WarningMessage]]:
    """Collect warnings; what a run wants its reader to know is shown however often it is said."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("ignore")
        warnings.filterwarnings("always", category=ResultsWarning)
        yield caught


def _cost(tree: xr.DataTree, task: Task, others: float, first: bool) -> Cost:
    timing = task.timing if task.threads == 1 else "shared cores"  # threads that wait take CPU time as well
    attributes = {"settle_steps": 0, **tree.attrs}
    if not first:
        attributes.pop("peak_memory", None)
    values = {name: float(attributes.get(name, math.nan)) for name, _, _ in COSTS}
    stages = {stage: float(attributes.get(f"cpu_{stage}", math.nan)) for stage in STEP_STAGES}
    settling = {stage: float(attributes.get(f"settle_cpu_{stage}", 0.0)) for stage in STEP_STAGES}
    return Cost(timing, values, stages, settling, others, processor())


def _digest(tree: xr.DataTree) -> str:
    """Hash of every bit of the series; empty of a run that broke off before it had any."""
    if "series" not in tree.children:
        return ""
    digest = hashlib.sha256()
    series = tree["series"].to_dataset()
    for name in sorted(map(str, series.data_vars)):
        digest.update(name.encode())
        digest.update(series[name].values.tobytes())
    return digest.hexdigest()[:32]
