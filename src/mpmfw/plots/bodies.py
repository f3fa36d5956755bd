"""The bodies of one run at every output, and their drawing in the plane with a field at the points."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.collections import EllipseCollection, PolyCollection
from matplotlib.colors import Normalize
from scipy.spatial import cKDTree

from mpmfw.errors import SceneError
from mpmfw.plots.style import on_lines, time_scale
from mpmfw.results.domains import corners_of, facets_of, loops, surfaces_of
from mpmfw.results.point_fields import point_field
from mpmfw.results.selection import bodies_of, frame_of, rigid_bodies_of, times_of
from mpmfw.state.fields import FloatArray, IntArray

#: Length of the longest rigid body that a picture holds, over that of the others.
_LONG = 5.0


class Bodies:
    """The bodies of one run in space: their points, facets and values at every output.

    Solids with a stored surface are drawn as this surface, coloured by the nearest material point. Other
    bodies are drawn as the domains of their points, or as spheres. Rigid bodies have no values.
    """

    def __init__(self, tree: xr.DataTree, bodies: Sequence[str] | None = None) -> None:
        self.tree = tree
        self.bodies, self.rigid = bodies_of(tree, bodies), rigid_bodies_of(tree, bodies)
        self.names = [*self.bodies, *self.rigid]
        surfaces = set(surfaces_of(tree))
        self.space = tree.sizes.get("axis") == 3
        self.outlined = [body for body in self.names if body in surfaces]
        self._solid = {body for body in self.outlined if self.space or body in self.rigid}
        self.corners = {body: corners_of(tree, body) for body in self.bodies}
        self._nearest = {
            body: cKDTree(frame_of(tree, f"particles/{body}", 0)["position"].values).query(
                self.places(body, 0)[:, : 3 if self.space else 2]
            )[1]
            for body in self._solid - set(self.rigid)
        }

    def places(self, body: str, frame: int) -> FloatArray:
        """Return the drawn points (n, 3) of a body at one output [m]."""
        if body in self._solid:
            places = frame_of(self.tree, f"surface/{body}", frame)["position"].values
        else:
            data, corners = frame_of(self.tree, f"particles/{body}", frame), self.corners.get(body)
            places = data["position"].values if corners is None else corners(data)
        return in_space(places.reshape(-1, places.shape[-1]))

    def facets(self, body: str) -> IntArray | None:
        """Return segments, triangles or quadrilaterals between the points; None for single points."""
        if body in self._solid:
            return facets_of(self.tree, body)
        if self.corners.get(body) is None:
            return None
        return np.arange(len(self.places(body, 0))).reshape(-1, 4)

    def attributes(self, field: str) -> dict[Any, Any]:
        """Return ``long_name`` and ``units`` of a field."""
        points = self.tree[f"particles/{self.bodies[0]}"].to_dataset()
        return point_field(points.isel(time=slice(0), missing_dims="ignore"), field).attrs

    def values(self, body: str, field: str, frame: int) -> FloatArray:
        """Return a field of a body at one output, as it is drawn."""
        data = frame_of(self.tree, f"particles/{body}", frame)
        values = np.asarray(point_field(data, field).values, dtype=float)
        return values[self._nearest[body]] if body in self._nearest else values

    def extremes(self, field: str, frames: Iterable[int]) -> tuple[float, float]:
        """Return the least and the largest finite value of a field over some outputs."""
        every = (self.values(body, field, frame) for frame in frames for body in self.bodies)
        known = (values[np.isfinite(values)] for values in every)
        ends = np.array([[values.min(), values.max()] for values in known if len(values)])
        return (float(ends.min()), float(ends.max())) if len(ends) else (np.nan, np.nan)

    def box(self, frames: Iterable[int]) -> FloatArray:
        """Return the lower and the upper corner (2, 3) of the bodies over some outputs [m].

        Rigid bodies count up to five times the length of the others: a half-space does not.
        """
        frames = list(frames)
        boxes = {}
        for body in self.names:
            places = (self.places(body, frame) for frame in frames)
            boxes[body] = _around([np.array([each.min(axis=0), each.max(axis=0)]) for each in places])
        own = _around([boxes[body] for body in self.bodies])
        longest = _LONG * np.ptp(own, axis=0).max()
        near = [box for box in boxes.values() if np.ptp(box, axis=0).max() <= longest]
        return _around([own, *near])

    @property
    def stores_force(self) -> bool:
        """Return True if contact forces on surface nodes are stored."""
        return any("force" in self.tree[f"surface/{body}"].data_vars for body in self.outlined)

    def largest_force(self, frames: Iterable[int]) -> float:
        """Return the largest contact force on a surface node [N, in 2D N/m]; 0 where none is stored."""
        sizes = [
            np.linalg.norm(self.forces(body, frame), axis=1) for body in self.outlined for frame in frames
        ]
        return float(np.nanmax(np.concatenate(sizes), initial=0.0)) if sizes else 0.0

    def forces(self, body: str, frame: int) -> FloatArray:
        """Return contact forces on the surface nodes of a body (n, 3); 0 where none is stored."""
        data = frame_of(self.tree, f"surface/{body}", frame)
        return in_space(data["force"].values if "force" in data else 0.0 * data["position"].values)


def _around(boxes: Sequence[FloatArray]) -> FloatArray:
    return np.array([np.min(boxes, axis=(0, 1)), np.max(boxes, axis=(0, 1))])


def in_space(places: FloatArray) -> FloatArray:
    """Return points (n, dim) with zeros to (n, 3)."""
    return np.pad(np.asarray(places, dtype=float), ((0, 0), (0, 3 - places.shape[1])))


#: Width of a title above a panel of a journal's column, in letters.
TITLE_WIDTH = 44
#: Length of the longest arrow, as shares of the drawing's width and height: the lesser counts.
_ARROW = (0.12, 0.25)


#: x from, to, y from, to [m].
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Scales:
    """Colours, lengths and arrows that panels share."""

    norm: Normalize  #: of values divided by ``unit_size``
    colours: str  #: name of the colour map
    unit_size: float  #: of the shown unit in SI units
    length: float  #: shown length of a metre
    box: Box  #: that is seen
    largest_force: float  #: drawn as the longest arrow; 0 without arrows
    extend: str  #: ends of the colours that values lie beyond, as matplotlib names them


class FieldPanel(Bodies):
    """A field of one run in 2D on the material points of ``bodies``."""

    def __init__(self, tree: xr.DataTree, name: str, bodies: Sequence[str] | None = None) -> None:
        super().__init__(tree, bodies)
        self.name, self.about = name, self.attributes(name)
        self._drawn: list[Any] = []

    def survey(self, frames: Iterable[int]) -> tuple[tuple[float, float], Box]:
        """Return the range of finite values, and the extent of the bodies."""
        frames = list(frames)
        discs = (body for body in self.bodies if self.corners[body] is None)
        volumes = (frame_of(self.tree, f"particles/{body}", frames[0])["volume"].max() for body in discs)
        radius = max((0.5 * float(np.sqrt(volume)) for volume in volumes), default=0.0)
        (x0, y0, _), (x1, y1, _) = self.box(frames).tolist()
        return self.extremes(self.name, frames), (x0 - radius, x1 + radius, y0 - radius, y1 + radius)

    def draw(self, axes: Any, frame: int, scales: Scales, title: str) -> None:
        """Draw another output."""
        while self._drawn:
            self._drawn.pop().remove()
        for body in self.bodies:
            data = frame_of(self.tree, f"particles/{body}", frame)
            shapes, values = self._shapes(axes, body, data, scales), point_field(data, self.name).values
            shapes.set(norm=scales.norm, cmap=scales.colours, array=values / scales.unit_size)
            self._drawn.append(axes.add_collection(shapes, autolim=False))
        for body in surfaces_of(self.tree):  # those that are not chosen show what the others touch
            data, chosen = frame_of(self.tree, f"surface/{body}", frame), body in self.outlined
            self._drawn += self._draw_surface(axes, data, scales, chosen=chosen)
        set_title(axes, self.tree, frame, title)

    def _shapes(
        self, axes: Any, body: str, data: xr.Dataset, scales: Scales
    ) -> PolyCollection | EllipseCollection:
        """Return domains as polygons, or points as discs of their area."""
        if (corners := self.corners[body]) is not None:
            polygons = list(scales.length * corners(data))
            return PolyCollection(polygons, edgecolors="face", linewidths=0.25)
        places = data["position"].values
        diameter = scales.length * 2.0 * np.sqrt(data["volume"].values / np.pi)
        centres: dict[str, Any] = {"offsets": scales.length * places, "offset_transform": axes.transData}
        flat = np.zeros_like(diameter)
        return EllipseCollection(diameter, diameter, flat, units="xy", linewidths=0.0, **centres)

    def _draw_surface(self, axes: Any, data: xr.Dataset, scales: Scales, *, chosen: bool) -> list[Any]:
        position = scales.length * data["position"].values
        parts = [np.insert(position[loop], len(loop), np.nan, axis=0) for loop in loops(data["next"].values)]
        look = {"color": "black" if chosen else "0.4", "linewidth": 0.5 if chosen else 0.8}
        drawn: list[Any] = axes.plot(*np.concatenate(parts or [position]).T, **look)
        if chosen and scales.largest_force > 0.0 and "force" in data:
            force = data["force"].values
            acting = np.linalg.norm(force, axis=1) > 1e-3 * scales.largest_force
            x0, x1, y0, y1 = scales.box
            longest = scales.length * min(_ARROW[0] * (x1 - x0), _ARROW[1] * (y1 - y0))
            arrows = force[acting] * longest / scales.largest_force
            plain = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 0.004, "zorder": 4}
            drawn.append(axes.quiver(*position[acting].T, *arrows.T, color="#D55E00", **plain))
        return drawn


def set_title(axes: Any, tree: xr.DataTree, frame: int, title: str) -> None:
    """Write a title and the time of an output above axes."""
    times = times_of(tree)
    scale, unit = time_scale(float(times[-1]))
    time = f"t = {scale * float(times[frame]):.4g} {unit}"
    text = f"{title}, {time}" if title else time
    lines = [textwrap.fill(line, TITLE_WIDTH) for line in on_lines(text).splitlines()]
    axes.set_title("\n".join(lines), loc="left")


def colour_range(
    found: Sequence[tuple[float, float]], limits: tuple[float, float] | None
) -> tuple[float, float, str]:
    """Return the ends of the scale and the colour map, with zero in its middle."""
    if limits is not None:
        low, high = limits
        if not low < high:
            raise SceneError(f"limits {low:g}, {high:g}: expected the lower one first")
        return low, high, "RdBu_r" if low == -high else "viridis"
    ends = np.array(found)
    if not np.isfinite(ends).any():
        raise SceneError("the field has no finite value to draw")
    low, high = float(np.nanmin(ends[:, 0])), float(np.nanmax(ends[:, 1]))
    if low < 0.0 < high:
        return -max(-low, high), max(-low, high), "RdBu_r"
    half = 0.5 * (abs(low) or 1.0) if low == high else 0.0
    return low - half, high + half, "viridis"
