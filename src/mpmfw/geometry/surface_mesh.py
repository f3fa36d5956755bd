"""Body given by a file of the triangles of its surface."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Literal, Self

import numpy as np
from pydantic import model_validator

from mpmfw.geometry.cut_cells import volume_of
from mpmfw.geometry.layout import FloatArray, IntArray, Layout
from mpmfw.geometry.plane import Point3D
from mpmfw.geometry.solid import SolidGeometry, Surfaces, Turns, solid_lattice, turning
from mpmfw.geometry.subdivision import subdivided_triangles
from mpmfw.geometry.surface_checks import check_surface, shells_of
from mpmfw.geometry.surface_file import SINGLE, read_surface
from mpmfw.units import to_si


class SurfaceMesh(SolidGeometry):
    """A closed surface of triangles in a file (.stl, .obj, .ply, .off, .msh), whose coordinates are in ``unit``.

    The body is turned about the file's origin by ``angles`` [rad] about x, then y, then z, and moved by ``shift`` [m].
    Triangles larger than asked for are divided; smaller ones stay as they are.
    """

    has_plane_faces: ClassVar[bool] = True

    type: Literal["surface_mesh"] = "surface_mesh"
    path: Path
    unit: str = "m"
    angles: Turns = (0.0, 0.0, 0.0)
    shift: Point3D = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _is_a_closed_surface(self) -> Self:
        try:
            scale = to_si(f"1 {self.unit}", "m")
        except ValueError as error:
            raise ValueError(f"unit '{self.unit}': {error}") from error
        if not isinstance(scale, float | int) or scale <= 0:
            raise ValueError(f"unit '{self.unit}' is no unit of length")
        try:
            single = self.path.suffix.lower() == ".stl"
            check_surface(
                *self.fine_surface, f"; nodes within {SINGLE:.2g} of the largest coordinate are one" * single
            )
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
    def is_connected(self) -> bool:  # type: ignore[override]
        """Whether the body is of one piece: it has one surface that is no cavity's."""
        nodes, facets = self.fine_surface
        return sum(volume_of(nodes, facets[shell]) > 0.0 for shell in self.shells) == 1

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 3) [m]."""
        nodes, _ = self.fine_surface
        return np.array([nodes.min(axis=0), nodes.max(axis=0)])

    @property
    def axes(self) -> FloatArray:
        """The file's axes, one a row (3, 3): sides turn with the body."""
        return turning(self.angles).T

    @cached_property
    def edges(self) -> FloatArray:
        """Lengths (k, 3) of the triangles' sides [m]."""
        nodes, facets = self.fine_surface
        corners = nodes[facets]
        lengths: FloatArray = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        return lengths

    @property
    def mean_edge(self) -> float:
        """Mean length of the triangles' sides [m]."""
        return float(self.edges.mean())

    def surface_nodes(self, edge: float) -> float:
        """Most nodes with sides up to ``edge`` [m], those of the file among them."""
        return super().surface_nodes(edge) + len(self.fine_surface[0])

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] and triangles (k, 3) of every closed part, sides up to ``edge`` [m]."""
        nodes, facets = self.fine_surface
        found = []
        for shell in self.shells:
            used, own = np.unique(facets[shell], return_inverse=True)
            found.append(subdivided_triangles(nodes[used], own.reshape(-1, 3).astype(np.int64), edge))
        return tuple(found)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """Cubic cells cut by the file's triangles as they are."""
        return solid_lattice(*self.fine_surface, size, offset)
