"""Upper bounds of what a run takes, memory, steps, frames and results, and a refusal of what cannot be meant.

A misplaced power of ten makes a run that never ends, or more memory than there is. The limits of steps and
frames are far beyond what runs of this kind take, and a run past them begins if it is forced."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.geometry.plane import PlaneGeometry
from mpmfw.state.fields import FloatArray

if TYPE_CHECKING:
    from mpmfw.results import RunHeader
    from mpmfw.runs.simulation import Simulation
    from mpmfw.scene import Scene
    from mpmfw.scene.tables import Body

#: Bytes that a material point takes at most by dimension: layout, state, table of interpolation, and what is
#: made on the way to them. Measured: 1500 in 2D and 4500 in 3D, CPDI on a disc and a ball.
POINT_BYTES = {2: 2_000, 3: 6_000}

#: Bytes that a node of a window takes at most: nodal arrays, and those of contact and inertia correction.
NODE_BYTES = {2: 400, 3: 600}

#: Bytes that a surface node takes at most by dimension: outline, search and springs.
SURFACE_BYTES = {2: 1_000, 3: 2_000}

#: Extent of a body in cells below which nothing of it is left by the layouts.
THINNEST = 1e-6

#: Flat indices of nodes are integers of 32 bits.
MOST_NODES = 2**31 - 1

#: Nodes that a window has beyond the body, on both sides together.
_BEYOND = 10

#: Steps: with the least scene a day, at 1 ms a step three hours.
MOST_STEPS = 10_000_000

#: Frames: at 10 kB each, the least that a frame takes, 1 GB.
MOST_FRAMES = 100_000

#: Bytes of results past which a run says so.
LARGE_RESULTS = 1e9


@dataclass(frozen=True)
class Size:
    """Upper bounds of what one body takes."""

    points: float  #: material points
    nodes: float  #: of its window
    surface_nodes: float  #: of its outline
    dim: int  #: number of space dimensions

    @property
    def memory(self) -> tuple[float, float, float]:
        """Bytes of points, nodes and surface nodes."""
        each = POINT_BYTES[self.dim], NODE_BYTES[self.dim], SURFACE_BYTES[self.dim]
        return self.points * each[0], self.nodes * each[1], self.surface_nodes * each[2]


def size_of(body: Body, cell_size: float) -> Size:
    """Return the size of one body, before it is discretised."""
    extent = np.subtract(*body.geometry.bounds[::-1])
    fitted = body.particles.layout == "fitted"
    if fitted and body.geometry.type == "mesh":
        points = float(len(body.geometry.elements.pieces))
    else:
        # No edge of a fitted layout may exceed the size: where it follows a curve, most are well below it
        spare = 3.0 if fitted and body.geometry.type not in ("rectangle", "box") else 1.0
        points = spare * float(np.prod(np.ceil(extent / body.particles.size) + 1.0))
    edge = body.segment_length(cell_size)
    if isinstance(body.geometry, PlaneGeometry):
        surface = 2.0 * body.geometry.outline_length / edge + 8.0
    else:
        surface = body.geometry.surface_nodes(edge)
    nodes = float(np.prod(np.ceil(extent / cell_size) + _BEYOND))
    return Size(points, nodes, surface, len(extent))


def most_memory(scene: Scene) -> float:
    """Return the memory that the scene needs at most beside the program itself [bytes]."""
    return sum(sum(size_of(body, scene.grid.cell_size).memory) for body in scene.bodies.values())


def check_memory(scene: Scene) -> None:
    """Raise SceneError for a scene that needs more memory, or more nodes, than there can be.

    The message names the largest body and the key that decides. Bodies outside the grid or far thinner than a
    cell are refused, too."""
    cell = scene.grid.cell_size
    for name, body in scene.bodies.items():  # far outside: nothing needs to be made to see it
        lower, upper = body.geometry.bounds
        check_box_inside(scene, name, lower, upper, slack=cell)
        if not (least := float(np.subtract(upper, lower).min())) > THINNEST * cell:
            raise SceneError(
                f"the body is {least:.3g} m across at its thinnest, less than {THINNEST:g} of a cell of "
                f"{cell:g} m; expected a larger body, or smaller cells",
                key=f"bodies.{name}.geometry",
            )
    sizes = {name: size_of(body, cell) for name, body in scene.bodies.items()}
    needed, limit = sum(sum(size.memory) for size in sizes.values()), min(_memory_limits(), default=math.inf)
    if needed > limit:
        largest = max(sizes, key=lambda name: sum(sizes[name].memory))
        key, made = _largest_part(scene, largest, sizes[largest])
        raise SceneError(
            f"the body '{largest}' of {_box(scene.bodies[largest])} m has up to {made}; the scene needs up "
            f"to {shown_bytes(needed)} of memory, and the limit is {shown_bytes(limit)}, the memory of this "
            f"machine; expected a larger {key}, or are lengths in millimetres?",
            key=key,
        )
    if (nodes := sum(size.nodes for size in sizes.values())) > MOST_NODES:
        raise SceneError(
            f"{nodes:.3g} nodes round the bodies are more than {MOST_NODES}, the most that can be counted; "
            "expected a larger grid.cell_size",
            key="grid.cell_size",
        )


def _largest_part(scene: Scene, name: str, size: Size) -> tuple[str, str]:
    """Return the key that decides over most of a body's memory, and a text on what it makes."""
    cell, body = scene.grid.cell_size, scene.bodies[name]
    parts = (
        (f"bodies.{name}.particles.size",
         f"{size.points:.3g} material points of {body.particles.size:g} m"),
        ("grid.cell_size", f"{size.nodes:.3g} nodes of the grid, whose cells are of {cell:g} m"),
        ("grid.cell_size" if body.segment is None else f"bodies.{name}.segment",
         f"{size.surface_nodes:.3g} surface nodes, {body.segment_length(cell):g} m apart"),
    )  # fmt: skip
    return parts[int(np.argmax(size.memory))]


def _memory_limits() -> Iterator[float]:
    """Yield the memory of this machine, and of the group of processes that this one is in [bytes]."""
    if hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        yield float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    for file in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        try:
            yield float(Path(file).read_text(encoding="ascii"))
        except (OSError, ValueError):  # absent, or the word "max"
            continue


def check_box_inside(
    scene: Scene, name: str, lower: FloatArray, upper: FloatArray, slack: float = 0.0
) -> None:
    """Raise SceneError for a body whose bounding box leaves the grid by more than ``slack`` [m]."""
    grid = scene.grid
    if (lower < np.array(grid.lower) - slack).any() or (upper > np.array(grid.upper) + slack).any():
        raise SceneError(
            f"the body from {_point(lower)} to {_point(upper)} m is not inside the grid from "
            f"{_point(grid.lower)} to {_point(grid.upper)} m; expected a larger grid.lower … grid.upper",
            key=f"bodies.{name}",
        )


def _point(x: Iterable[float]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in x) + ")"


def _box(body: Body) -> str:
    return " by ".join(f"{edge:.4g}" for edge in np.subtract(*body.geometry.bounds[::-1]))


def warnings_about(scene: Scene) -> list[str]:
    """Return warnings about points or cells that are larger than the body that they resolve."""
    texts, cell = [], scene.grid.cell_size
    for name, body in scene.bodies.items():
        least = (1.0 + 1e-9) * float(np.subtract(*body.geometry.bounds[::-1]).min())
        own_elements = body.geometry.type == "mesh" and body.particles.layout == "fitted"
        if (size := body.particles.size) > least and not own_elements:
            texts.append(
                f"bodies.{name}.particles.size, {size:g} m, is larger than the body of {_box(body)} m"
            )
        if cell > least:
            texts.append(f"grid.cell_size, {cell:g} m, is larger than the body '{name}' of {_box(body)} m")
    return texts


def frames_of(simulation: Simulation) -> float:
    """Return the number of frames that the run will write."""
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
    time, settle = simulation.scene.time, simulation.scene.settle
    forced = "; --force (force=True) runs it all the same"
    frames = frames_of(simulation)
    if frames > MOST_FRAMES:
        raise SceneError(
            f"{time.output_interval:g} s in {time.end:g} s makes {frames:.3g} frames, more than "
            f"{MOST_FRAMES}{forced}",
            key="time.output_interval",
        )
    step = simulation.stable_step()
    spans = {"time.end": (time.end, steps_of(simulation, step))}
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


def remarks_on(simulation: Simulation, header: RunHeader | None) -> list[str]:
    """Return remarks on more threads than cores, and on a file with this header that will be large."""
    texts = remarks_on_threads(simulation.threads)
    frames, each, size = (0.0, 0.0, 0.0) if header is None else results_size(simulation, header)
    if size > LARGE_RESULTS:
        texts.append(
            f"the results take up to {shown_bytes(size)}: {frames:g} frames of {shown_bytes(each)}; a longer "
            "time.output_interval or output.particle_interval, or output.particles = false, makes them "
            "smaller"
        )
    return texts


def remarks_on_threads(threads: int) -> list[str]:
    """Return a remark on more threads than cores."""
    if threads <= cores():
        return []
    return [
        f"threads: {threads} are more than the {cores()} cores that this process may use; they wait for each "
        "other, and the run takes longer than with fewer"
    ]


def cores() -> int:
    """Return the number of cores that this process may use."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed is not None else os.cpu_count() or 1


def results_size(simulation: Simulation, header: RunHeader) -> tuple[float, float, float]:
    """Return the number of frames with material points, bytes of each, and of all results, outputs without
    points included.
    """
    scene, frames = simulation.scene, frames_of(simulation)
    interval, lengths = scene.output.particle_interval, {"axis": header.dim, "axis2": header.dim}
    lengths |= {"rotation": 1 if header.dim == 2 else 3, "body": len(header.bodies)}
    lengths |= {"pair": len(header.pairs), "particle": sum(header.particle_count.values())}
    lengths["surface_node"] = sum(header.surface_count.values())
    points = others = 0.0
    for field in header.fields:
        if all(dim in lengths for dim in field.dims):
            size = np.dtype(field.dtype).itemsize * math.prod(lengths[dim] for dim in field.dims)
            points, others = (
                (points + size, others) if field.group == "particles" else (points, others + size)
            )
    with_points = frames if interval is None else min(frames, math.floor(scene.time.end / interval) + 2.0)
    return with_points, points + others, with_points * points + frames * others


def shown_bytes(count: float) -> str:
    """Return a number of bytes in the unit that suits it."""
    units = ("bytes", "kB", "MB", "GB", "TB", "PB", "EB")
    power = int(np.clip(np.log10(max(count, 1.0)) // 3, 0, len(units) - 1))
    return f"{count / 1000.0**power:.3g} {units[power]}"
