"""Disc and ring."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal

import numpy as np
import shapely

from mpmfw.geometry.base import Centred, Point2D, PositiveLength, Round
from mpmfw.geometry.layout import FloatArray, Layout, layout_of_quadrilaterals
from mpmfw.geometry.plane import (
    PlaneGeometry,
    circle_nodes,
    circle_outline,
    clipping_circle,
    equal_area_factor,
    number_of_segments,
)

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
        return float(np.pi * self.radius**2)

    @property
    def outline_length(self) -> float:
        return float(2.0 * np.pi * self.radius)

    @property
    def region(self) -> Any:
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
    while True:
        corners = _blocks(n, size)
        if np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max() <= size * (1 + 1e-9):
            return corners
        n += 1


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
    return np.asarray(CORE_RADIUS * ((1 - CORE_BULGE) * square + CORE_BULGE * disc))


def _cells(nodes: FloatArray) -> FloatArray:
    return np.stack([nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]], axis=2).reshape(
        -1, 4, 2
    )


class Ring(Centred, PlaneGeometry):
    """The region between two concentric circles [m]."""

    type: Literal["ring"] = "ring"
    centre: Point2D
    inner_radius: PositiveLength
    outer_radius: PositiveLength
    rising: ClassVar[tuple[str, str]] = ("inner_radius", "outer_radius")

    @property
    def exact_volume(self) -> float:
        return float(np.pi * (self.outer_radius**2 - self.inner_radius**2))

    @property
    def outline_length(self) -> float:
        return float(2.0 * np.pi * (self.outer_radius + self.inner_radius))

    @property
    def bounds(self) -> FloatArray:
        return np.add(self.centre, [[-self.outer_radius], [self.outer_radius]])

    @property
    def width(self) -> float:
        return float(self.outer_radius - self.inner_radius)

    @property
    def region(self) -> Any:
        radii = (self.outer_radius, self.inner_radius)
        outer, inner = (clipping_circle(self.centre, radius) for radius in radii)
        return shapely.Polygon(outer, [inner])

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """The outer circle counter-clockwise and the inner one clockwise, first nodes at angle 0.

        Their numbers of nodes are multiples of four: two rings that meet are mirror images of each other.
        """
        outer, inner = (
            circle_outline(self.centre, radius, segment) for radius in (self.outer_radius, self.inner_radius)
        )
        return outer, np.roll(inner[::-1], 1, axis=0)

    def fitted(self, size: float) -> Layout:
        """A polar grid: ceil((R_o - R_i)/size) by about 2 π R_mean/size quadrilaterals, a multiple of four.

        The corners' radii are those of the circles times sqrt(x/sin x), x = 2 π/n_θ: the area is exact.
        """
        n_r = number_of_segments(self.outer_radius - self.inner_radius, size)
        n_theta = 4 * max(1, round(0.25 * np.pi * (self.outer_radius + self.inner_radius) / size))
        radii = np.linspace(self.inner_radius, self.outer_radius, n_r + 1) * equal_area_factor(n_theta)
        inner = np.stack([circle_nodes(self.centre, radius, n_theta) for radius in radii])
        nxt = np.roll(inner, -1, axis=1)
        corners = np.stack([inner[:-1], inner[1:], nxt[1:], nxt[:-1]], axis=2)
        return layout_of_quadrilaterals(corners.reshape(-1, 4, 2))
