"""Ring."""

from __future__ import annotations

from typing import Any, Literal, Self

import numpy as np
import shapely
from pydantic import model_validator

from mpmfw.geometry.base import Point2D, PositiveLength
from mpmfw.geometry.layout import FloatArray, Layout, layout_of_quadrilaterals
from mpmfw.geometry.plane import PlaneGeometry
from mpmfw.geometry.polylines import (
    circle_nodes,
    circle_outline,
    clipping_circle,
    equal_area_factor,
    number_of_segments,
)


class Ring(PlaneGeometry):
    """The region between two concentric circles [m]."""

    type: Literal["ring"] = "ring"
    centre: Point2D
    inner_radius: PositiveLength
    outer_radius: PositiveLength

    @model_validator(mode="after")
    def _inner_below_outer(self) -> Self:
        if self.inner_radius >= self.outer_radius:
            raise ValueError(
                f"inner_radius {self.inner_radius} m must be smaller than outer_radius {self.outer_radius} m"
            )
        return self

    @property
    def exact_volume(self) -> float:
        """π (R_o² - R_i²) [m^2]."""
        return float(np.pi * (self.outer_radius**2 - self.inner_radius**2))

    @property
    def outline_length(self) -> float:
        """2 π (R_o + R_i) [m]."""
        return float(2.0 * np.pi * (self.outer_radius + self.inner_radius))

    @property
    def centroid(self) -> FloatArray:
        """The centre (2,) [m]."""
        return np.array(self.centre)

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 2) [m]."""
        return np.add(self.centre, [[-self.outer_radius], [self.outer_radius]])

    @property
    def width(self) -> float:
        """R_o − R_i, the thickness of the wall [m]."""
        return float(self.outer_radius - self.inner_radius)

    @property
    def region(self) -> Any:
        """A fine polygon of the ring's area."""
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
