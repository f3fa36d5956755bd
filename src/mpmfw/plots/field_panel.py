"""One panel with a field on the material points of a run."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.collections import EllipseCollection, PolyCollection
from matplotlib.colors import Normalize

from mpmfw.errors import SceneError
from mpmfw.plots.style import on_lines, time_scale
from mpmfw.results.domains import Corners, corners_of, loops
from mpmfw.results.point_fields import point_field
from mpmfw.results.selection import bodies_of, frame_of, rigid_bodies_of, times_of
from mpmfw.state.fields import FloatArray

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


class FieldPanel:
    """A field of one run in 2D on the material points of ``bodies``."""

    def __init__(self, tree: xr.DataTree, name: str, bodies: Sequence[str] | None = None) -> None:
        self.tree = tree
        self.bodies = bodies_of(tree, bodies)
        self.name = name
        points = tree[f"particles/{self.bodies[0]}"].to_dataset()
        #: ``long_name`` and ``units`` of the field.
        self.about = point_field(points.isel(time=slice(0), missing_dims="ignore"), name).attrs
        self.corners: dict[str, Corners | None] = {body: corners_of(tree, body) for body in self.bodies}
        outlined = tree["surface"].children if "surface" in tree.children else {}
        rigid = rigid_bodies_of(tree, bodies)
        self.outlined = [*(body for body in self.bodies if body in outlined), *rigid]
        self._drawn: list[Any] = []

    def survey(self, frames: Iterable[int]) -> tuple[tuple[float, float], Box]:
        """Return the range of finite values, and the extent of the points."""
        ends, corners = [], []
        for frame in frames:
            for body in self.bodies:
                data = frame_of(self.tree, f"particles/{body}", frame)
                values = point_field(data, self.name).values
                known = values[np.isfinite(values)]
                if len(known):
                    ends += [known.min(), known.max()]
                points, size = self._places(body, data)
                flat = points.reshape(-1, 2)
                corners += [np.nanmin(flat, axis=0) - size, np.nanmax(flat, axis=0) + size]
        limits = (float(min(ends)), float(max(ends))) if ends else (float("nan"), float("nan"))
        (x0, y0), (x1, y1) = np.min(corners, axis=0), np.max(corners, axis=0)
        return limits, (float(x0), float(x1), float(y0), float(y1))

    def largest_force(self, frames: Iterable[int]) -> float:
        """Return the largest contact force on a surface node [N/m]."""
        if not any("force" in self.tree[f"surface/{body}"].data_vars for body in self.outlined):
            raise SceneError("the run stored no contact force of surface nodes; leave the arrows out")
        sizes = [
            np.linalg.norm(frame_of(self.tree, f"surface/{body}", frame)["force"].values, axis=1).max()
            for frame in frames
            for body in self.outlined
        ]
        return float(np.nanmax(sizes))

    def draw(self, axes: Any, frame: int, scales: Scales, title: str) -> None:
        """Draw another output."""
        while self._drawn:
            self._drawn.pop().remove()
        for body in self.bodies:
            data = frame_of(self.tree, f"particles/{body}", frame)
            shapes, values = self._shapes(axes, body, data, scales), point_field(data, self.name).values
            shapes.set(norm=scales.norm, cmap=scales.colours, array=values / scales.unit_size)
            self._drawn.append(axes.add_collection(shapes, autolim=False))
        for body in self.outlined:
            self._drawn += self._draw_surface(axes, frame_of(self.tree, f"surface/{body}", frame), scales)
        set_title(axes, self.tree, frame, title)

    def _places(self, body: str, data: xr.Dataset) -> tuple[FloatArray, float]:
        """Return corners of domains, or centres and the largest point's radius [m]."""
        corners = self.corners[body]
        if corners is not None:
            return corners(data), 0.0
        return data["position"].values, 0.5 * float(np.sqrt(data["volume"].max()))

    def _shapes(
        self, axes: Any, body: str, data: xr.Dataset, scales: Scales
    ) -> PolyCollection | EllipseCollection:
        """Return domains as polygons, or points as discs of their area."""
        places, _ = self._places(body, data)
        if places.ndim == 3:
            return PolyCollection(list(scales.length * places), edgecolors="face", linewidths=0.25)
        diameter = scales.length * 2.0 * np.sqrt(data["volume"].values / np.pi)
        centres: dict[str, Any] = {"offsets": scales.length * places, "offset_transform": axes.transData}
        flat = np.zeros_like(diameter)
        return EllipseCollection(diameter, diameter, flat, units="xy", linewidths=0.0, **centres)

    def _draw_surface(self, axes: Any, data: xr.Dataset, scales: Scales) -> list[Any]:
        position = scales.length * data["position"].values
        parts = [np.insert(position[loop], len(loop), np.nan, axis=0) for loop in loops(data["next"].values)]
        drawn: list[Any] = axes.plot(*np.concatenate(parts or [position]).T, color="black", linewidth=0.5)
        if scales.largest_force > 0.0 and "force" in data:
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
