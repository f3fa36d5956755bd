"""Geometries that are wrong in one place: ellipses with a round hole, and tetrahedra."""

from dataclasses import replace
from typing import Literal

import numpy as np
import shapely

from mpmfw.api import FloatArray, Length, PlaneGeometry

FINE = 1440


class Sound(PlaneGeometry):
    """An ellipse of twice the height of its hole [m]."""

    type: Literal["sound"] = "sound"
    centre: tuple[Length, Length] = (0.2, -0.1)
    semi_axes: tuple[Length, Length] = (1.0, 0.6)
    hole: Length = 0.3

    @property
    def exact_volume(self):
        """π (a b − r²) [m^2]."""
        return float(np.pi * (self.semi_axes[0] * self.semi_axes[1] - self.hole**2))

    @property
    def centroid(self):
        return np.array(self.centre)

    @property
    def bounds(self):
        half = np.array(self.semi_axes)
        return np.array(self.centre) + np.array([-half, half])

    @property
    def region(self):
        larger = np.sqrt(2.0 * np.pi / FINE / np.sin(2.0 * np.pi / FINE))
        outer, inner = (self.loop(half, FINE, larger) for half in self.halves())
        return shapely.Polygon(outer, [inner])

    def outlines(self, segment):
        outer, inner = (
            self.loop(half, int(np.ceil(2.0 * np.pi * max(half) / segment))) for half in self.halves()
        )
        return outer, inner[::-1].copy()

    def halves(self):
        """Semi-axes of both outlines [m]."""
        return self.semi_axes, (self.hole, self.hole)

    def loop(self, half, number, larger=1.0):
        """An ellipse (number, 2) [m], counter-clockwise."""
        angle = 2.0 * np.pi * np.arange(number) / number
        found: FloatArray = np.array(self.centre) + larger * np.array(half) * np.stack(
            [np.cos(angle), np.sin(angle)], axis=1
        )
        return found


class SmallDomains(Sound):
    """Domains have not the volume of their points."""

    type: Literal["small-domains"] = "small-domains"

    def lattice(self, size, offset):
        layout = super().lattice(size, offset)
        return replace(layout, half_edges=0.5 * layout.half_edges)


class Shared(Sound):
    """Gives the array that it keeps away."""

    type: Literal["shared"] = "shared"

    def outlines(self, segment):
        key = f"_kept_{segment}"
        if key not in self.__dict__:
            self.__dict__[key] = super().outlines(segment)
        kept: tuple[FloatArray, ...] = self.__dict__[key]
        return kept


class Hidden(Sound):
    """A part of what it is made of is no key."""

    type: Literal["hidden"] = "hidden"

    def __init__(self, **keys):
        super().__init__(**{"hole": 0.29, **keys})
        self.__dict__["more"] = 0.01 if "hole" not in keys else 0.0

    def halves(self):
        hole = self.hole + self.__dict__["more"]
        return self.semi_axes, (hole, hole)

    @property
    def exact_volume(self):
        return float(np.pi * (self.semi_axes[0] * self.semi_axes[1] - self.halves()[1][0] ** 2))


class LeftHanded(Sound):
    """The second axis points down."""

    type: Literal["left-handed"] = "left-handed"

    @property
    def axes(self):
        return np.diag([1.0, -1.0])
