"""Half-space of a rigid wall or floor."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from mpmfw.geometry.base import BodyGeometry, LengthInCells
from mpmfw.geometry.layout import FloatArray, IntArray, Layout
from mpmfw.geometry.plane import Rectangle
from mpmfw.geometry.solid import box_surface
from mpmfw.units import Length, Number

_VECTOR = Field(min_length=2, max_length=3)


class HalfSpace(BodyGeometry):
    """All that lies behind a plane through ``point`` (dim,) [m] with an outward ``normal`` (dim,).

    A square or cube of edge ``extent`` [m] stands for it, with the point in the middle of one face, which is
    one facet in the plane and four in space. A run takes a block that covers the grid: :meth:`facing`."""

    type: Literal["half_space"] = "half_space"
    point: Annotated[tuple[Length, ...], _VECTOR]
    normal: Annotated[tuple[Number, ...], _VECTOR]
    extent: LengthInCells = Field("10000 cells", validate_default=True)

    @model_validator(mode="after")
    def _has_a_direction(self) -> Self:
        """Refuse a normal of another dimension, or of no length."""
        if len(self.normal) != len(self.point):
            raise ValueError(f"point has {len(self.point)} entries, and normal {len(self.normal)}")
        if not any(self.normal):
            raise ValueError("normal has no length; expected a direction out of the body")
        return self

    @property
    def dim(self) -> int:  # type: ignore[override]
        return len(self.point)

    @property
    def axes(self) -> FloatArray:
        """Unit vectors along the plane, and out of it, one a row (dim, dim)."""
        normal = np.array(self.normal) / np.linalg.norm(self.normal)
        if self.dim == 2:
            return np.array([[normal[1], -normal[0]], normal])
        along = np.cross(np.eye(3)[np.abs(normal).argmin()], normal)
        along /= np.linalg.norm(along)
        return np.array([along, np.cross(normal, along), normal])

    @property
    def exact_volume(self) -> float:
        return float(self.extent**self.dim)

    @property
    def centroid(self) -> FloatArray:
        return np.array(self.point)

    @property
    def bounds(self) -> FloatArray:
        nodes = self.surfaces(self.extent)[0][0]
        return np.array([nodes.min(axis=0), nodes.max(axis=0)])

    def facing(self, lower: Any, upper: Any, moves: float) -> HalfSpace:
        """Return it with its face before the middle of the box from ``lower`` to ``upper`` (dim,) [m].

        Of all points in the box the face is nearest, also when the block has moved by ``moves`` [m]; if need
        be with a larger extent."""
        middle, reach = np.add(lower, upper) / 2.0, np.linalg.norm(np.subtract(upper, lower)) / 2.0 + moves
        away, axes = middle - self.point, self.axes
        point = self.point + (axes[:-1] @ away) @ axes[:-1]
        behind = max(reach - axes[-1] @ away, 0.0)
        extent = max(self.extent, float(2.0 * (reach + behind)))
        return self.model_copy(update={"point": tuple(point.tolist()), "extent": extent})

    def surface_nodes(self, edge: float) -> float:  # noqa: ARG002
        """Return the number of nodes, whatever the ``edge`` [m]."""
        return float(len(self.surfaces(self.extent)[0][0]))

    def surfaces(self, edge: float) -> tuple[tuple[FloatArray, IntArray], ...]:  # noqa: ARG002
        """Nodes and facets of the block, as large as they are whatever the ``edge`` [m]."""
        half, dim = 0.5 * self.extent, self.dim
        lower, upper = np.full(dim, -half), np.full(dim, half)
        lower[-1], upper[-1] = -self.extent, 0.0
        if dim == 2:
            nodes = Rectangle(lower=tuple(lower), upper=tuple(upper)).corners
            facets = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
        else:
            nodes, facets = box_surface(lower, upper, self.extent)
        return ((np.array(self.point) + nodes @ self.axes, facets),)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:  # noqa: ARG002
        raise ValueError("a half_space has no material points; expected rigid = true")
