"""A plane body: replace region and outlines by those of your own; bodies in space derive from
SolidGeometry."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
import shapely
from pydantic import Field

from mpmfw.api.geometry import PlaneGeometry
from mpmfw.api.types import FloatArray
from mpmfw.api.units import Length

#: Corners of the polygon that stands for the true shape.
FINE = 720


class Template(PlaneGeometry):
    """An ellipse [m] with its axes along x and y."""

    type: Literal["template"] = "template"
    centre: tuple[Length, Length] = (0.0, 0.0)
    semi_axes: Annotated[tuple[Length, Length], Field(examples=[(0.4, 0.2)])] = (0.5, 0.25)

    @property
    def exact_volume(self) -> float:
        """π a b [m^2]."""
        a, b = self.semi_axes
        return float(np.pi * a * b)

    @property
    def centroid(self) -> FloatArray:
        """The centre (2,) [m]."""
        return np.array(self.centre)

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 2) [m]."""
        half = np.array(self.semi_axes)
        return np.asarray(self.centroid + np.array([-half, half]))

    @property
    def region(self) -> Any:
        """A fine polygon of the exact area."""
        larger = np.sqrt(2.0 * np.pi / FINE / np.sin(2.0 * np.pi / FINE))
        return shapely.Polygon(self.centroid + larger * (self._nodes(FINE) - self.centroid))

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """One polyline (m, 2) [m], counter-clockwise, with segments up to ``segment`` [m]; holes would run
        clockwise."""
        return (self._nodes(max(8, int(np.ceil(2.0 * np.pi * max(self.semi_axes) / segment)))),)

    def _nodes(self, number: int) -> FloatArray:
        angle = 2.0 * np.pi * np.arange(number) / number
        around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return np.asarray(self.centroid + np.array(self.semi_axes) * around)
