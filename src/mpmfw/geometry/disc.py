"""Disc."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
import shapely

from mpmfw.geometry.base import Point2D, Round
from mpmfw.geometry.layout import FloatArray, Layout, layout_of_quadrilaterals
from mpmfw.geometry.plane import PlaneGeometry
from mpmfw.geometry.polylines import circle_outline, clipping_circle, equal_area_factor

# Radius of the central block's corners, and how far its sides bulge from straight (0) to circular (1). Chosen
# over sizes from 0.05 to 2 radii: smallest angle 45 degrees, smallest area 0.4 of the largest
CORE_RADIUS = 0.75
CORE_BULGE = 0.35


class Disc(Round, PlaneGeometry):
    """A full circle [m]."""

    type: Literal["disc"] = "disc"
    centre: Point2D

    @property
    def exact_volume(self) -> float:
        """π R² [m^2]."""
        return float(np.pi * self.radius**2)

    @property
    def outline_length(self) -> float:
        """2 π R [m]."""
        return float(2.0 * np.pi * self.radius)

    @property
    def region(self) -> Any:
        """A fine polygon of the disc's area."""
        return shapely.Polygon(clipping_circle(self.centre, self.radius))

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """One polyline with its nodes on the circle, the first at angle 0.

        Their number is a multiple of four, so that the outline is symmetric about axes and diagonals.
        """
        return (circle_outline(self.centre, self.radius, segment),)

    def fitted(self, size: float) -> Layout:
        """A central block and four blocks around it, of the exact area."""
        return layout_of_quadrilaterals(np.array(self.centre) + self.radius * disc_mesh(size / self.radius))


def disc_mesh(size: float) -> FloatArray:
    """Quadrilaterals (n, 4, 2) with edges of at most ``size`` (in radii), counter-clockwise.

    The mesh has the symmetries of the square, and the area π: its outermost nodes stand on the circle times
    sqrt(x/sin x), x the angle between them.
    """
    n = max(1, math.ceil(0.5 * math.pi / size - 1e-9))
    while _largest_edge(corners := _blocks(n, size)) > size * (1 + 1e-9):
        n += 1
    return corners


def _blocks(n: int, size: float) -> FloatArray:
    """The five blocks (k, 4, 2): n by n cells in the middle, n along each quarter of the rim."""
    rim_radius = equal_area_factor(4 * n)
    side = np.linspace(-1.0, 1.0, n + 1)
    core = _core(side)
    rim = rim_radius * np.column_stack([np.cos(0.25 * np.pi * side), np.sin(0.25 * np.pi * side)])
    gap = np.linalg.norm(rim - core[-1], axis=1).max()
    across = np.linspace(0.0, 1.0, max(1, math.ceil(gap / size - 1e-9)) + 1)[:, np.newaxis, np.newaxis]
    outer = _cells((1 - across) * core[-1] + across * rim)
    blocks = [_cells(core)]
    for _ in range(4):
        blocks.append(outer)
        outer = np.stack([-outer[..., 1], outer[..., 0]], axis=-1)
    return np.concatenate(blocks)


def _core(side: FloatArray) -> FloatArray:
    """Nodes (n + 1, n + 1, 2) of the central block: a blend of a square and of its image on a disc."""
    xi, eta = np.meshgrid(side, side, indexing="ij")
    square = np.stack([xi, eta], axis=-1) / np.sqrt(2)
    disc = np.stack([xi * np.sqrt(1 - 0.5 * eta**2), eta * np.sqrt(1 - 0.5 * xi**2)], axis=-1)
    core: FloatArray = CORE_RADIUS * ((1 - CORE_BULGE) * square + CORE_BULGE * disc)
    return core


def _cells(nodes: FloatArray) -> FloatArray:
    """Corners (k, 4, 2) of the cells of a block of nodes (i, j, 2)."""
    return np.stack([nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]], axis=2).reshape(
        -1, 4, 2
    )


def _largest_edge(corners: FloatArray) -> float:
    """Longest edge of quadrilaterals (k, 4, 2)."""
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())
