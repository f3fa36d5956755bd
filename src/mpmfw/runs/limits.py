"""Upper bounds of memory, steps, frames and results, and refusal of unreasonable values."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.geometry.plane import PlaneGeometry
from mpmfw.scene.bodies import RigidBody
from mpmfw.state.fields import FloatArray

if TYPE_CHECKING:
    from mpmfw.results import RunHeader
    from mpmfw.runs.simulation import Simulation
    from mpmfw.scene import Scene
    from mpmfw.scene.bodies import Body

#: Most bytes of a material point, a node of a window and a surface node, by dimension. Measured of a point:
#: 1500 in 2D and 4500 in 3D, CPDI on a disc.
BYTES = {2: (2_000, 400, 1_000), 3: (6_000, 600, 2_000)}

#: Extent of a body in cells below which nothing of it is left by the layouts.
THINNEST = 1e-6

#: Flat indices of nodes are integers of 32 bits, which would overflow in silence.
MOST_NODES = 2**31 - 1

#: Nodes that a window has beyond the body, on both sides together.
_BEYOND = 10


def largest_counts(body: Body, cell_size: float) -> FloatArray:
    """Return the most points, window nodes and surface nodes of a body, (3,)."""
    geometry, extent = body.geometry, np.subtract(*body.geometry.bounds[::-1])
    edge = body.segment_length(cell_size)
    if isinstance(geometry, PlaneGeometry):
        surface = 2.0 * geometry.outline_length / edge + 8.0
    else:
        surface = geometry.surface_nodes(edge)
    if isinstance(body, RigidBody):
        return np.array([0.0, 0.0, surface])
    fitted = body.particles.layout == "fitted"
    # No edge of a fitted layout may exceed the size: where it follows a curve, most are well below it
    spare = 3.0 if fitted and geometry.type not in ("rectangle", "box") else 1.0
    points = spare * float(np.prod(np.ceil(extent / body.particles.size) + 1.0))
    if fitted and geometry.type == "mesh":
        points = float(len(geometry.pieces))
    return np.array([points, np.prod(np.ceil(extent / cell_size) + _BEYOND), surface])


def most_memory(scene: Scene) -> float:
    """Return the most memory that the scene needs [bytes]."""
    cell, each = scene.grid.cell_size, np.array(BYTES[scene.dim])
    return float(sum(largest_counts(body, cell) @ each for body in scene.bodies.values()))


def check_memory(scene: Scene) -> None:
    """Refuse too much memory, too many nodes, and bodies outside the grid or far thinner than a cell."""
    cell, each, counts = scene.grid.cell_size, np.array(BYTES[scene.dim]), {}
    for name, body in scene.bodies.items():
        if not isinstance(body, RigidBody):
            lower, upper = body.geometry.bounds
            check_box_inside(scene, name, lower, upper, slack=cell)
            if not (least := float(np.subtract(upper, lower).min())) > THINNEST * cell:
                raise SceneError(
                    f"the body is {least:.3g} m across at its thinnest, less than {THINNEST:g} of a cell of "
                    f"{cell:g} m; expected a larger body, or smaller cells",
                    key=f"bodies.{name}.geometry",
                )
        counts[name] = largest_counts(body, cell)
    needed = sum(float(count @ each) for count in counts.values())
    if needed > (limit := min(_memory_limits(), default=math.inf)):
        name = max(counts, key=lambda name: float(counts[name] @ each))
        body, part = scene.bodies[name], int(np.argmax(counts[name] * each))
        key, what = (
            (f"bodies.{name}.particles.size",
             f"material points of {getattr(body.particles, 'size', 0.0):g} m"),
            ("grid.cell_size", f"nodes of the grid, whose cells are of {cell:g} m"),
            ("grid.cell_size" if body.segment is None else f"bodies.{name}.segment",
             f"surface nodes, {body.segment_length(cell):g} m apart"),
        )[part]  # fmt: skip
        raise SceneError(
            f"the body '{name}' of {_box(body)} m has up to {counts[name][part]:.3g} {what}; the scene needs "
            f"up to {shown_bytes(needed)} of memory, and the limit is {shown_bytes(limit)}, the memory of "
            f"this machine; expected a larger {key}, or are lengths in millimetres?",
            key=key,
        )
    if (nodes := sum(count[1] for count in counts.values())) > MOST_NODES:
        raise SceneError(
            f"{nodes:.3g} nodes round the bodies are more than {MOST_NODES}, the most that can be counted; "
            "expected a larger grid.cell_size",
            key="grid.cell_size",
        )


def _memory_limits() -> Iterator[float]:
    """Yield the memory of this machine and of this group of processes [bytes]."""
    if hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        yield float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    for file in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        try:
            yield float(Path(file).read_text(encoding="ascii"))
        except (OSError, ValueError):  # absent, or the word "max"
            continue


def shown_bytes(count: float) -> str:
    """Return a number of bytes in the unit that suits it."""
    units = ("bytes", "kB", "MB", "GB", "TB", "PB", "EB")
    power = int(np.clip(np.log10(max(count, 1.0)) // 3, 0, len(units) - 1))
    return f"{count / 1000.0**power:.3g} {units[power]}"


def check_box_inside(
    scene: Scene, name: str, lower: FloatArray, upper: FloatArray, slack: float = 0.0
) -> None:
    """Refuse a body that leaves the grid by more than ``slack`` [m]."""
    grid = scene.grid
    if (lower < np.array(grid.lower) - slack).any() or (upper > np.array(grid.upper) + slack).any():
        ends = (lower, upper, grid.lower, grid.upper)
        low, high, first, last = ("(" + ", ".join(f"{x:.6g}" for x in end) + ")" for end in ends)
        raise SceneError(
            f"the body from {low} to {high} m is not inside the grid from {first} to {last} m; expected a "
            "larger grid.lower … grid.upper",
            key=f"bodies.{name}",
        )


def _box(body: Body) -> str:
    return " by ".join(f"{edge:.4g}" for edge in np.subtract(*body.geometry.bounds[::-1]))


def coarse_bodies(scene: Scene) -> list[str]:
    """Return warnings about points or cells larger than their body."""
    texts, cell = [], scene.grid.cell_size
    for name, body in scene.bodies.items():
        if isinstance(body, RigidBody):
            continue
        least = (1.0 + 1e-9) * float(np.subtract(*body.geometry.bounds[::-1]).min())
        own_elements = body.geometry.type == "mesh" and body.particles.layout == "fitted"
        if (size := body.particles.size) > least and not own_elements:
            texts.append(
                f"bodies.{name}.particles.size, {size:g} m, is larger than the body of {_box(body)} m"
            )
        elif size > (1.0 + 1e-9) * cell and not own_elements:
            texts.append(
                f"bodies.{name}.particles.size, {size:g} m, is larger than a cell of {cell:g} m: points may "
                "lose touch with each other"
            )
        if cell > least:
            texts.append(f"grid.cell_size, {cell:g} m, is larger than the body '{name}' of {_box(body)} m")
    return texts


#: Steps: with the least scene a day, at 1 ms a step three hours.
MOST_STEPS = 10_000_000

#: Frames: at 10 kB each, the least that a frame takes, 1 GB.
MOST_FRAMES = 100_000


def outputs_of(scene: Scene) -> int:
    """Return the number of outputs after time zero."""
    return int(max(1, math.ceil(scene.time.end / scene.time.output_interval - 1e-9)))


def steps_of(scene: Scene, step: float) -> float:
    """Return the steps that a run will take, each of at most ``step`` [s]."""
    time = scene.time
    if time.outputs == "nearest":
        return float(math.ceil(time.end / step - 1e-9))
    return float(outputs_of(scene) * max(1, math.ceil(min(time.output_interval, time.end) / step - 1e-9)))


def check_length(simulation: Simulation) -> None:
    """Refuse an excessive number of steps or frames."""
    time, settle = simulation.scene.time, simulation.scene.settle
    forced = "; --force (force=True) runs it all the same"
    frames = outputs_of(simulation.scene) + 1.0
    if frames > MOST_FRAMES:
        raise SceneError(
            f"{time.output_interval:g} s in {time.end:g} s makes {frames:.3g} frames, more than "
            f"{MOST_FRAMES}{forced}",
            key="time.output_interval",
        )
    step = simulation.stable_step()
    spans = {"time.end": (time.end, steps_of(simulation.scene, step))}
    if settle is not None and settle.max_time is not None:
        spans["settle.max_time"] = settle.max_time, settle.max_time / step
    for key, (span, steps) in spans.items():
        if steps > MOST_STEPS:
            owner = "time.step" if time.step is not None else min(simulation.limits())[1]
            raise SceneError(
                f"{span:g} s in steps of {step:.3g} s, set by {owner}, takes {steps:.3g} steps, more than "
                f"{MOST_STEPS}{forced}",
                key=key,
            )


def remarks_on_threads(threads: int) -> list[str]:
    """Return a warning about more threads than cores."""
    text = (
        f"threads: {threads} are more than the {cores()} cores that this process may use; they wait for each "
        "other, and the run takes longer than with fewer"
    )
    return [text] if threads > cores() else []


def cores() -> int:
    """Return the number of cores that this process may use."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed is not None else os.cpu_count() or 1


def results_size(scene: Scene, header: RunHeader) -> tuple[float, float, float]:
    """Return frames with points, bytes of each, and bytes of all results."""
    lengths = {"axis": header.dim, "axis2": header.dim, "rotation": 1 if header.dim == 2 else 3}
    lengths |= {"body": len(header.bodies), "pair": len(header.pairs), "side": len(header.sides)}
    lengths |= {"particle": sum(header.particle_count.values())}
    lengths |= {"surface_node": sum(header.surface_count.values())}
    points = others = 0.0
    for field in header.fields:
        size = np.dtype(field.dtype).itemsize * math.prod(lengths.get(dim, 0) for dim in field.dims)
        points += size * (field.group == "particles")
        others += size * (field.group != "particles")
    frames, interval = outputs_of(scene) + 1.0, scene.output.particle_interval
    with_points = frames if interval is None else min(frames, math.floor(scene.time.end / interval) + 2.0)
    return with_points, points + others, with_points * points + frames * others
