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

from mpmfw.plots.bodies import Bodies
from mpmfw.plots.style import on_lines, time_scale
from mpmfw.results.domains import loops, surfaces_of
from mpmfw.results.point_fields import point_field
from mpmfw.results.selection import frame_of, times_of

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
