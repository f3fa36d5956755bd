"""Body given by a file of the triangles of its surface."""

from __future__ import annotations

import io
import logging
from collections.abc import Iterable
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Literal, Self

import numpy as np
from pydantic import model_validator

from mpmfw.geometry.base import Point3D
from mpmfw.geometry.cut_cells import volume_of
from mpmfw.geometry.gmsh_file import read_blocks, refuse_not_finite
from mpmfw.geometry.layout import FloatArray, IntArray, Layout
from mpmfw.geometry.solid import Surfaces, TurnedSolid, solid_lattice, turning
from mpmfw.geometry.surface_checks import check_surface, shells_of
from mpmfw.units import to_si


class SurfaceMesh(TurnedSolid):
    """A closed surface of triangles in a file (.stl, .obj, .ply, .off, .msh), in ``unit``.

    The body is turned about the file's origin by ``angles`` [rad] about x, then y, then z, and moved by
    ``shift`` [m]. Triangles larger than asked for are divided; smaller ones stay as they are.
    """

    has_plane_faces: ClassVar[bool] = True

    type: Literal["surface_mesh"] = "surface_mesh"
    path: Path
    unit: str = "m"
    shift: Point3D = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _is_a_closed_surface(self) -> Self:
        try:
            scale = to_si(f"1 {self.unit}", "m")
        except ValueError as error:
            raise ValueError(f"unit '{self.unit}': {error}") from error
        if not isinstance(scale, float | int) or scale <= 0:
            raise ValueError(f"unit '{self.unit}' is not a unit of length")
        try:
            merging = f"; nodes within {SINGLE:.2g} of the largest coordinate are one"
            check_surface(*self.fine_surface, merging if self.path.suffix.lower() == ".stl" else "")
        except ValueError as error:
            text = str(error)
            raise ValueError(text if str(self.path) in text else f"{self.path}: {text}") from error
        return self

    @cached_property
    def fine_surface(self) -> tuple[FloatArray, IntArray]:
        """Nodes [m] and triangles of the file, in their place."""
        nodes, facets = read_surface(self.path)
        scale: Any = to_si(f"1 {self.unit}", "m")
        return scale * nodes @ turning(self.angles).T + np.array(self.shift), facets

    @cached_property
    def shells(self) -> tuple[IntArray, ...]:
        """Numbers of the triangles of every closed part."""
        nodes, facets = self.fine_surface
        return tuple(shells_of(facets, len(nodes)))

    @property
    def is_connected(self) -> bool:
        """Return True if the body is one piece: one surface is not that of a cavity."""
        nodes, facets = self.fine_surface
        return sum(volume_of(nodes, facets[shell]) > 0.0 for shell in self.shells) == 1

    @property
    def bounds(self) -> FloatArray:
        nodes, _ = self.fine_surface
        return np.array([nodes.min(axis=0), nodes.max(axis=0)])

    @property
    def mean_edge(self) -> float:
        """Mean length of the triangles' sides [m]."""
        nodes, facets = self.fine_surface
        corners = nodes[facets]
        return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())

    def surface_nodes(self, edge: float) -> float:
        """Most nodes with sides up to ``edge`` [m], those of the file among them."""
        return super().surface_nodes(edge) + len(self.fine_surface[0])

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] and triangles (k, 3) of every closed part, sides up to ``edge`` [m]."""
        return divided_shells(*self.fine_surface, self.shells, edge)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """Cubic cells cut by the file's triangles as they are."""
        return solid_lattice(*self.fine_surface, size, offset)


def divided_shells(nodes: FloatArray, facets: IntArray, shells: Iterable[IntArray], edge: float) -> Surfaces:
    """Return the closed surfaces that ``shells`` number, with sides up to ``edge`` [m]."""
    used = (np.unique(facets[shell], return_inverse=True) for shell in shells)
    return tuple(
        subdivided_triangles(nodes[numbers], own.reshape(-1, 3).astype(np.int64), edge)
        for numbers, own in used
    )


def subdivided_triangles(nodes: FloatArray, facets: IntArray, edge: float) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 3) [m] and triangles (k, 3) of a closed surface, sides halved until up to ``edge`` [m]."""
    while True:
        sides = np.stack([facets[:, [1, 2]], facets[:, [2, 0]], facets[:, [0, 1]]], axis=1).reshape(-1, 2)
        pairs, which = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
        length = np.linalg.norm(nodes[pairs[:, 1]] - nodes[pairs[:, 0]], axis=1)
        long = length > edge * (1.0 + 1e-12)
        if not long.any():
            return nodes, facets
        middle = np.full(len(pairs), -1)
        middle[long] = len(nodes) + np.arange(np.count_nonzero(long))
        nodes = np.concatenate([nodes, nodes[pairs[long]].mean(axis=1)])
        facets = _divided(nodes, facets, middle[which.ravel()].reshape(-1, 3))


def _divided(nodes: FloatArray, facets: IntArray, middle: IntArray) -> IntArray:
    """Divide triangles at the nodes in the middle of their sides (k, 3), −1 where there is none."""
    count = (middle >= 0).sum(axis=1)
    parts = [facets[count == 0]]
    rows = np.arange(len(facets))
    # turned so that the one side that differs from the others is opposite the first corner
    odd = np.argmax((middle >= 0) == (count == 1)[:, np.newaxis], axis=1)
    order = (odd[:, np.newaxis] + np.arange(3)) % 3
    (a, b, c), (ma, mb, mc) = (one[rows[:, np.newaxis], order].T for one in (facets, middle))
    one, two, all_three = count == 1, count == 2, count == 3
    parts += [_stacked(one, (a, b, ma)), _stacked(one, (a, ma, c))]
    # of the two diagonals the shorter
    across = np.linalg.norm(nodes[b] - nodes[mb], axis=1) <= np.linalg.norm(nodes[c] - nodes[mc], axis=1)
    parts += [_stacked(two, (a, mc, mb))]
    parts += [_stacked(two & across, (mc, b, mb)), _stacked(two & across, (b, c, mb))]
    parts += [_stacked(two & ~across, (mc, b, c)), _stacked(two & ~across, (mc, c, mb))]
    parts += [_stacked(all_three, each) for each in ((a, mc, mb), (mc, b, ma), (mb, ma, c), (ma, mb, mc))]
    return np.concatenate(parts)


def _stacked(where: IntArray, corners: tuple[IntArray, ...]) -> IntArray:
    return np.asarray(np.stack(corners, axis=1)[where])


#: Endings of files that trimesh reads, and that of gmsh's own.
BY_TRIMESH = (".stl", ".obj", ".ply", ".off")
BY_GMSH = ".msh"

#: Distance up to which two nodes of an STL are one, over its largest coordinate: 4 units of single precision.
SINGLE = float(4.0 * np.finfo(np.float32).eps)


def read_surface(path: Path) -> tuple[FloatArray, IntArray]:
    """Read nodes (n, 3) in the file's unit and triangles (k, 3); nodes at one place are one.

    Nodes of an STL are one where they are equal in single precision. A ValueError refuses damaged files.
    """
    if not path.is_file():
        raise ValueError(f"mesh file not found: {path}")
    kind = path.suffix.lower()
    if kind == BY_GMSH:
        corners, blocks = read_blocks(path, {2: 3})
        facets = blocks[2]
    elif kind in BY_TRIMESH:
        corners, facets = _by_trimesh(path)
    else:
        kinds = ", ".join((*BY_TRIMESH, BY_GMSH))
        raise ValueError(f"{path} has the ending '{kind}'; expected one of {kinds}")
    if not len(facets):
        raise ValueError(f"{path} has no triangles")
    refuse_not_finite(path, corners)
    if facets.min() < 0 or facets.max() >= len(corners):
        wrong = np.flatnonzero(((facets < 0) | (facets >= len(corners))).any(axis=1))
        raise ValueError(
            f"{path} has {len(wrong)} triangles with nodes that are not among its {len(corners)}, the first "
            f"is triangle {wrong[0]}, counted from 0"
        )
    used, facets = np.unique(facets, return_inverse=True)
    # + 0.0: of −0.0 and 0.0 the same
    nodes, joint = np.unique(corners[used] + 0.0, axis=0, return_inverse=True)
    facets = joint.ravel()[facets].reshape(-1, 3)
    if kind == ".stl":
        nodes, facets = _merged(nodes, facets)
    return nodes, facets.astype(np.int64)


def _merged(nodes: FloatArray, facets: IntArray) -> tuple[FloatArray, IntArray]:
    """Take the first of nodes that differ by rounding to single precision."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(nodes).query_pairs(SINGLE * np.abs(nodes).max(), output_type="ndarray")
    near = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(nodes), len(nodes)))
    _, group = connected_components(near, directed=False)
    _, first = np.unique(group, return_index=True)
    return nodes[first], group[facets]


def _by_trimesh(path: Path) -> tuple[FloatArray, IntArray]:
    try:
        import trimesh
    except ImportError as error:
        raise ValueError(f"reading {path.name} needs trimesh: pip install 'mpmfw[mesh]'") from error
    kind = path.suffix[1:].lower()
    # It prints tracebacks of what it can do without
    logging.getLogger("trimesh").addHandler(logging.NullHandler())
    try:
        # of the bytes alone: trimesh then opens no file that they name, such as a library of materials
        content = io.BytesIO(path.read_bytes())
        mesh: Any = trimesh.load(content, file_type=kind, force="mesh", process=False)
        nodes = np.asarray(mesh.vertices, dtype=np.float64).reshape(-1, 3)
        return nodes, np.asarray(mesh.faces, dtype=np.int64)
    except Exception as error:  # readers of strangers' files fail in all ways
        raise ValueError(f"{path} is not a {kind.upper()} file that can be read: {error}") from error
