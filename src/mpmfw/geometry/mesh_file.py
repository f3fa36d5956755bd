"""Body given by a finite element mesh."""

from __future__ import annotations

from collections import defaultdict
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
import shapely
from pydantic import model_validator

from mpmfw.geometry.elements import Elements, IntArray, read_elements
from mpmfw.geometry.layout import FloatArray, Layout, layout_of_quadrilaterals
from mpmfw.geometry.plane import PlaneGeometry
from mpmfw.geometry.polylines import subdivided


class MeshFile(PlaneGeometry):
    """A gmsh file (.msh) of first-order triangles and quads in the x-y plane, coordinates in [m].

    The elements themselves are the shape: their boundary edges make the outlines.
    """

    type: Literal["mesh"] = "mesh"
    path: Path

    @model_validator(mode="after")
    def _makes_one_region(self) -> Self:
        try:
            area = float(self.region.area)
            if not self.loops or abs(area - self.exact_volume) > 1e-6 * self.exact_volume:
                raise ValueError(
                    f"elements overlap: they cover {area} m^2 and have {self.exact_volume} m^2 in all"
                )
        except ValueError as error:
            raise ValueError(
                str(error) if str(self.path) in str(error) else f"{self.path}: {error}"
            ) from error
        return self

    @cached_property
    def elements(self) -> Elements:
        """The elements, read once."""
        return read_elements(self.path)

    @cached_property
    def loops(self) -> tuple[FloatArray, ...]:
        """The boundary edges chained into closed loops (m, 2) [m], the material on their left."""
        return boundary_loops(self.elements)

    @cached_property
    def region(self) -> Any:
        """The union of the elements."""
        nodes = self.elements.nodes
        blocks = (self.elements.triangles, self.elements.quadrilaterals)
        return shapely.union_all(
            [p for block in blocks if len(block) for p in shapely.polygons(nodes[block])]
        )

    @property
    def exact_volume(self) -> float:
        """Area of the elements [m^2]."""
        return self.elements.area

    @property
    def centroid(self) -> FloatArray:
        """Centroid (2,) [m] of the elements."""
        return self.elements.centroid

    @property
    def is_connected(self) -> bool:
        """Whether all elements hang together by edges."""
        return is_connected(self.elements)

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """The boundary loops, with the mesh's nodes among theirs."""
        return tuple(subdivided(loop, segment) for loop in self.loops)

    def fitted(self, size: float) -> Layout:  # noqa: ARG002
        """The elements as they are, whatever ``size``: quads, and three quadrilaterals a triangle."""
        return layout_of_quadrilaterals(self.elements.pieces)


def boundary_loops(elements: Elements) -> tuple[FloatArray, ...]:
    """Boundary edges chained into closed loops (m, 2) [m], the material on their left.

    Raises
    ------
    ValueError
        Elements overlap: two of them run along one edge in the same direction.
    """
    edges, _ = _directed_edges(elements)
    n = len(elements.nodes)
    key, reverse = edges @ [n, 1], edges @ [1, n]
    _, first, count = np.unique(key, return_index=True, return_counts=True)
    if (count > 1).any():
        x, y = elements.nodes[edges[first[count > 1][0]]].mean(axis=0)
        raise ValueError(f"elements overlap: an edge has two elements on one side, at ({x:.4g}, {y:.4g}) m")
    onward: dict[int, list[int]] = defaultdict(list)
    for start, end in edges[~np.isin(key, reverse)]:
        onward[int(start)].append(int(end))
    loops = []
    while onward:
        loops.append(elements.nodes[_take_loop(onward, elements.nodes)])
    return tuple(loops)


def is_connected(elements: Elements) -> bool:
    """Whether all elements hang together by edges."""
    from scipy.sparse import coo_array  # half a second, which only meshes need
    from scipy.sparse.csgraph import connected_components

    edges, owner = _directed_edges(elements)
    n = len(elements.nodes)
    undirected = np.sort(edges, axis=1) @ [n, 1]
    order = np.argsort(undirected, kind="stable")
    same = np.flatnonzero(np.diff(undirected[order]) == 0)
    count = int(owner[-1]) + 1
    pairs = (owner[order[same]], owner[order[same + 1]])
    parts, _ = connected_components(
        coo_array((np.ones(len(same)), pairs), shape=(count, count)), directed=False
    )
    return int(parts) == 1


def _directed_edges(elements: Elements) -> tuple[IntArray, IntArray]:
    """Edges (k, 2) as (start, end), counter-clockwise around each element, and the element (k,) of each."""
    blocks = [b for b in (elements.triangles, elements.quadrilaterals) if len(b)]
    edges = [np.stack([b, np.roll(b, -1, axis=1)], axis=2).reshape(-1, 2) for b in blocks]
    sides = np.concatenate([np.full(len(b), b.shape[1]) for b in blocks])
    return np.concatenate(edges), np.repeat(np.arange(len(sides)), sides)


def _take_loop(onward: dict[int, list[int]], nodes: FloatArray) -> list[int]:
    """Take one closed loop of node numbers out of ``onward`` (start of a boundary edge: its ends)."""
    first = next(iter(onward))
    loop = [first, _take_edge(onward, first, onward[first][0])]
    start = loop[1]
    while True:
        # Where parts touch at a node, the loop goes on around the same material: along the first edge met
        # when turning clockwise from the way back
        here = loop[-1]
        back = nodes[loop[-2]] - nodes[here]
        ends = onward.get(here, [])
        if here == first and (not ends or _next_end(nodes, here, back, [*ends, start]) == start):
            return loop[:-1]
        loop.append(_take_edge(onward, here, _next_end(nodes, here, back, ends)))


def _next_end(nodes: FloatArray, here: int, back: FloatArray, ends: list[int]) -> int:
    """The end whose edge from ``here`` is met first when turning clockwise from the direction ``back``."""
    away = nodes[ends] - nodes[here]
    turn = np.arctan2(back[1], back[0]) - np.arctan2(away[:, 1], away[:, 0])
    return ends[int(np.argmin(np.mod(turn, 2 * np.pi)))]


def _take_edge(onward: dict[int, list[int]], start: int, end: int) -> int:
    """Remove the edge from ``start`` to ``end``, and return ``end``."""
    onward[start].remove(end)
    if not onward[start]:
        del onward[start]
    return end
