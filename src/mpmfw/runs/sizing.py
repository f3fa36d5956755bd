"""Upper bound of a scene's memory, from its lengths alone, before anything is allocated."""

from __future__ import annotations

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
    from mpmfw.scene import Scene
    from mpmfw.scene.tables import Body

#: Bytes that a material point takes at most by dimension: layout, state, table of interpolation, and what is
#: made on the way to them. Measured: 1500 in 2D and 4500 in 3D, CPDI on a disc and a ball.
POINT_BYTES = {2: 2_000, 3: 6_000}

#: Bytes that a node of a window takes at most: nodal arrays, and those of contact and inertia correction.
NODE_BYTES = {2: 400, 3: 600}

#: Bytes that a surface node takes at most: outline, search and springs.
SURFACE_BYTES = 1_000

#: Extent of a body in cells below which nothing of it is left by the layouts.
THINNEST = 1e-6

#: Flat indices of nodes are integers of 32 bits.
MOST_NODES = 2**31 - 1

#: Nodes that a window has beyond the body, on both sides together.
_BEYOND = 10


@dataclass(frozen=True)
class Size:
    """Upper bounds of what one body takes."""

    points: float  #: material points
    nodes: float  #: of its window
    surface_nodes: float  #: of its outline
    memory: float  #: of all of them [bytes]
    extent: FloatArray  #: edges of its bounding box, (dim,) [m]


def size_of(body: Body, cell_size: float) -> Size:
    """The size of one body, before it is discretised; a mesh file has the points that its elements make."""
    lower, upper = body.geometry.bounds
    extent = np.asarray(upper - lower, dtype=float)
    dim = len(extent)
    if body.geometry.type == "mesh" and body.particles.layout == "fitted":
        points = float(len(body.geometry.elements.pieces))
    else:
        # No edge of a fitted layout may exceed the size: where it follows a curve, most are well below it
        fitted = body.particles.layout == "fitted" and body.geometry.type not in ("rectangle", "box")
        spare = 3.0 if fitted else 1.0
        points = spare * float(np.prod(np.ceil(extent / body.particles.size) + 1.0))
    nodes = float(np.prod(np.ceil(extent / cell_size) + _BEYOND))
    edge = body.segment_length(cell_size)
    if isinstance(body.geometry, PlaneGeometry):
        surface = 2.0 * body.geometry.outline_length / edge + 8.0
    else:
        surface = body.geometry.surface_nodes(edge)
    memory = points * POINT_BYTES[dim] + nodes * NODE_BYTES[dim] + surface * SURFACE_BYTES * (dim - 1)
    return Size(points, nodes, surface, memory, extent)


def most_memory(scene: Scene) -> float:
    """Memory that the scene needs at most beside the program itself [bytes]."""
    return sum(size_of(body, scene.grid.cell_size).memory for body in scene.bodies.values())


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
    largest = max(sizes, key=lambda name: sizes[name].memory)
    needed, limit = sum(size.memory for size in sizes.values()), memory_limit()
    size = sizes[largest]
    box = " by ".join(f"{edge:.4g}" for edge in size.extent)
    if needed > limit:
        key, what = _greediest(scene.bodies[largest], size, cell, largest)
        raise SceneError(
            f"the body '{largest}' of {box} m has {what}; the scene needs up to {shown_bytes(needed)} of "
            f"memory, and the limit is {shown_bytes(limit)}, the memory of this machine; expected a larger "
            f"{key}, or are lengths in millimetres?",
            key=key,
        )
    if sum(size.nodes for size in sizes.values()) > MOST_NODES:
        raise SceneError(
            f"{sum(size.nodes for size in sizes.values()):.3g} nodes round the bodies are more than "
            f"{MOST_NODES}, the most that can be counted; expected a larger grid.cell_size",
            key="grid.cell_size",
        )


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


def warnings_about(scene: Scene) -> list[str]:
    """Return warnings about points or cells that are larger than the body that they resolve."""
    text = []
    for name, body in scene.bodies.items():
        lower, upper = body.geometry.bounds
        extent = upper - lower
        box, least = " by ".join(f"{edge:.4g}" for edge in extent), float(extent.min())
        own_elements = body.geometry.type == "mesh" and body.particles.layout == "fitted"
        if body.particles.size > least * (1.0 + 1e-9) and not own_elements:
            text.append(
                f"bodies.{name}.particles.size, {body.particles.size:g} m, is larger than the body of {box} m"
            )
        if scene.grid.cell_size > least * (1.0 + 1e-9):
            text.append(
                f"grid.cell_size, {scene.grid.cell_size:g} m, is larger than the body '{name}' of {box} m"
            )
    return text


def _greediest(body: Body, size: Size, cell_size: float, name: str) -> tuple[str, str]:
    """The key that decides over most of a body's memory, and what it makes."""
    dim = len(size.extent)
    segment = "grid.cell_size" if body.segment is None else f"bodies.{name}.segment"
    length = body.segment_length(cell_size)
    takes = {
        (
            f"bodies.{name}.particles.size",
            f"up to {size.points:.3g} material points of {body.particles.size:g} m",
        ): (size.points * POINT_BYTES[dim]),
        ("grid.cell_size", f"up to {size.nodes:.3g} nodes of the grid, whose cells are of {cell_size:g} m"): (
            size.nodes * NODE_BYTES[dim]
        ),
        (segment, f"up to {size.surface_nodes:.3g} surface nodes, {length:g} m apart"): size.surface_nodes
        * SURFACE_BYTES
        * (dim - 1),
    }
    return max(takes, key=lambda entry: takes[entry])


def memory_limit() -> float:
    """Memory of this machine, or of the group of processes that this one is in, if that may have less
    [bytes].
    """
    return min(_limits(), default=float("inf"))


def _limits() -> Iterator[float]:
    if hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        yield float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    for file in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        try:
            yield float(Path(file).read_text(encoding="ascii"))
        except (OSError, ValueError):  # absent, or the word "max"
            continue


def shown_bytes(count: float) -> str:
    """A number of bytes in the unit that suits it."""
    units = ("bytes", "kB", "MB", "GB", "TB", "PB", "EB")
    power = int(np.clip(np.log10(max(count, 1.0)) // 3, 0, len(units) - 1))
    return f"{count / 1000.0**power:.3g} {units[power]}"
