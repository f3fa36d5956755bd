"""Ball."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from mpmfw.geometry.clipped_lattice import SMALLEST_PIECE
from mpmfw.geometry.layout import FloatArray, IntArray, Layout, layout_of_boxes
from mpmfw.geometry.plane import Point3D, PositiveLength
from mpmfw.geometry.triangles import sphere_surface

# Sub-cells along each edge of a cell that the sphere cuts: the fraction inside is counted on them
SUBCELLS = 8


class Ball(BaseModel):
    """A full sphere [m]."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    dim: ClassVar[int] = 3
    is_connected: ClassVar[bool] = True

    type: Literal["ball"] = "ball"
    centre: Point3D
    radius: PositiveLength

    @property
    def exact_volume(self) -> float:
        """4 π R³/3 [m^3]."""
        return float(4 / 3 * np.pi * self.radius**3)

    @property
    def centroid(self) -> FloatArray:
        """The centre (3,) [m]."""
        return np.array(self.centre)

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 3) [m]."""
        return np.add(self.centre, [[-self.radius], [self.radius]])

    @property
    def axes(self) -> FloatArray:
        """Those of the grid, one a row (3, 3)."""
        return np.eye(3)

    def surfaces(self, edge: float) -> tuple[tuple[FloatArray, IntArray], ...]:
        """Nodes (n, 3) [m] on the sphere and triangles (k, 3) of edges up to ``edge`` [m]."""
        return (sphere_surface(self.centroid, self.radius, edge),)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """Cubic cells clipped by the sphere; those below a quarter are left out, all volumes scaled alike.

        The volume is exact. With an ``offset`` the pieces left out are not mirror images, which moves the
        centroid: by less than 1 % of the radius for cells up to a quarter of it.

        Raises
        ------
        ValueError
            The cells are so large that none is filled to a quarter.
        """
        lower = _lower_corners(self.radius, size, offset)
        fraction, centroid = _clip(lower, size, self.radius)
        kept = fraction >= SMALLEST_PIECE
        if not kept.any():
            raise ValueError(
                f"no cell of {size} m is filled to a quarter by a ball of radius {self.radius} m"
            )
        volume = fraction[kept] * self.exact_volume / fraction[kept].sum()
        edges = np.repeat(np.cbrt(volume)[:, np.newaxis], 3, axis=1)
        return layout_of_boxes(np.array(self.centre) + centroid[kept], edges)

    def fitted(self, size: float) -> Layout:
        """Refused: there is no layout of hexahedra that follows a sphere here."""
        raise ValueError(f"a ball has no fitted layout (size {size} m): choose layout = 'lattice'")


def _lower_corners(radius: float, size: float, offset: tuple[float, ...]) -> FloatArray:
    """Lower corners (n, 3) [m] of cells that cover the ball, symmetric where ``offset`` is zero."""
    n = int(np.ceil(2 * radius / size - 1e-9))
    axes = [size * (np.arange(-(shift > 0), n) + shift - n / 2) for shift in offset]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def _clip(lower: FloatArray, size: float, radius: float) -> tuple[FloatArray, FloatArray]:
    """Fractions (n,) of cells (n, 3) inside the sphere about the origin, and their centroids (n, 3) [m]."""
    farthest = np.maximum(np.abs(lower), np.abs(lower + size))
    nearest = np.maximum(np.maximum(lower, -(lower + size)), 0.0)
    fraction = (np.linalg.norm(farthest, axis=1) <= radius).astype(float)
    centroid = lower + 0.5 * size
    cut = np.flatnonzero((fraction == 0) & (np.linalg.norm(nearest, axis=1) < radius))
    points = lower[cut][:, :, np.newaxis] + size * (np.arange(SUBCELLS) + 0.5) / SUBCELLS
    x, y, z = points[:, 0, :, None, None], points[:, 1, None, :, None], points[:, 2, None, None, :]
    inside = (x**2 + y**2 + z**2 <= radius**2).astype(float)
    count = inside.sum(axis=(1, 2, 3))
    moment = np.stack([(inside * axis).sum(axis=(1, 2, 3)) for axis in (x, y, z)], axis=1)
    fraction[cut] = count / SUBCELLS**3
    centroid[cut[count > 0]] = moment[count > 0] / count[count > 0, np.newaxis]
    return fraction, centroid
