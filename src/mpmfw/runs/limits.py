"""Limits of steps and frames, past which a run must be forced, and the size of its results.

A misplaced power of ten makes a run that never ends. Both limits are far beyond what runs of this kind take,
and a run past them begins if it is forced."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.runs.sizing import shown_bytes

if TYPE_CHECKING:
    from mpmfw.results import RunHeader
    from mpmfw.runs.simulation import Simulation

#: Steps: with the least scene a day, at 1 ms a step three hours.
MOST_STEPS = 10_000_000

#: Frames: at 10 kB each, the least that a frame takes, 1 GB.
MOST_FRAMES = 100_000

#: Bytes of results past which a run says so.
LARGE_RESULTS = 1e9


def frames_of(simulation: Simulation) -> float:
    """Frames that the run will write."""
    time = simulation.scene.time
    return max(1.0, float(math.ceil(time.end / time.output_interval - 1e-9))) + 1.0


def steps_of(simulation: Simulation, step: float) -> float:
    """Return the steps that the run will take, each of at most ``step`` [s], settling left out.

    Steps between two outputs are of equal length, but where outputs shorten none.
    """
    time = simulation.scene.time
    if time.outputs == "nearest":
        return float(math.ceil(time.end / step - 1e-9))
    return float((frames_of(simulation) - 1.0) * math.ceil(min(time.output_interval, time.end) / step - 1e-9))


def check_length(simulation: Simulation) -> None:
    """Raise SceneError, with the key that decides, for more steps or frames than anybody wants."""
    time, forced = simulation.scene.time, "; --force (force=True) runs it all the same"
    frames = frames_of(simulation)
    if frames > MOST_FRAMES:
        raise SceneError(
            f"{time.output_interval:g} s in {time.end:g} s makes {frames:.3g} frames, more than "
            f"{MOST_FRAMES}{forced}",
            key="time.output_interval",
        )
    step = simulation.stable_step()
    steps = steps_of(simulation, step)
    if steps > MOST_STEPS:
        raise SceneError(_too_many(simulation, f"{time.end:g} s", steps, step) + forced, key="time.end")
    settle = simulation.scene.settle
    if settle is not None and settle.max_time is not None and settle.max_time / step > MOST_STEPS:
        text = _too_many(simulation, f"{settle.max_time:g} s", settle.max_time / step, step)
        raise SceneError(text + forced, key="settle.max_time")


def _too_many(simulation: Simulation, span: str, steps: float, step: float) -> str:
    """``1 s in steps of 1e-300 s, which time.step sets, takes 1e+300 steps, more than
    10000000``.
    """
    owner = "time.step" if simulation.scene.time.step is not None else min(simulation.limits())[1]
    return f"{span} in steps of {step:.3g} s, set by {owner}, takes {steps:.3g} steps, more than {MOST_STEPS}"


def remark_on_size(simulation: Simulation, header: RunHeader) -> str:
    """Return a remark on results that will be large; empty for others."""
    frames, each, size = results_size(simulation, header)
    if size <= LARGE_RESULTS:
        return ""
    return (
        f"the results take up to {shown_bytes(size)}: {frames:g} frames of {shown_bytes(each)}; a longer "
        "time.output_interval or output.particle_interval, or output.particles = false, makes them smaller"
    )


def remark_on_threads(threads: int) -> str:
    """Return a remark on more threads than cores; empty for others."""
    if threads <= cores():
        return ""
    return (
        f"threads: {threads} are more than the {cores()} cores that this process may use; they wait for each "
        "other, and the run takes longer than with fewer"
    )


def cores() -> int:
    """Cores that this process may use."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed is not None else os.cpu_count() or 1


def results_size(simulation: Simulation, header: RunHeader) -> tuple[float, float, float]:
    """Number of the frames with material points, bytes of each, and of all results, outputs without points
    included.
    """
    scene, frames = simulation.scene, frames_of(simulation)
    interval, groups = scene.output.particle_interval, _bytes_of_groups(header)
    with_points = frames if interval is None else min(frames, math.floor(scene.time.end / interval) + 2.0)
    points, others = groups.pop("particles", 0.0), sum(groups.values())
    return with_points, points + others, with_points * points + frames * others


def _bytes_of_groups(header: RunHeader) -> dict[str, float]:
    """Return the bytes of one frame by group."""
    sizes = {
        "particle": sum(header.particle_count.values()),
        "surface_node": sum(header.surface_count.values()),
        "axis": header.dim,
        "axis2": header.dim,
        "rotation": 1 if header.dim == 2 else 3,
        "body": len(header.bodies),
        "pair": len(header.pairs),
    }
    known = [field for field in header.fields if all(dim in sizes for dim in field.dims)]
    found: dict[str, float] = dict.fromkeys([field.group for field in known], 0.0)
    for field in known:
        found[field.group] += np.dtype(field.dtype).itemsize * math.prod(sizes[dim] for dim in field.dims)
    return found
