"""A run in space on a plane across it: the material points and the outlines that it meets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.figure import Figure

from mpmfw.errors import SceneError
from mpmfw.plots.style import in_brackets, journal_style, with_prefix
from mpmfw.results.domains import facets_of, surfaces_of
from mpmfw.results.point_fields import point_field
from mpmfw.results.selection import (
    Results,
    bodies_of,
    frame_at,
    frame_of,
    opened_run,
    rigid_bodies_of,
    times_of,
)
from mpmfw.state.fields import FloatArray, IntArray

#: Rounding of positions, which files have in single precision, over the bodies' extent.
SINGLE_PRECISION = 1e-6


@journal_style()
def plane_cut(
    results: Results,
    name: str = "von_mises",
    time: float | None = None,
    *,
    normal: str = "z",
    at: float | None = None,
    bodies: Sequence[str] | None = None,
    limits: tuple[float, float] | None = None,
) -> Figure:
    """Draw a field of a run in space on a plane across ``normal``, at a place [m], by default the middle.

    Points within half their size are discs, stored surfaces lines; the rest is as of :func:`field`.
    """
    with opened_run(results) as tree:
        own, frame = bodies_of(tree, bodies), frame_at(tree, time)
        axes = [str(axis) for axis in tree.coords["axis"].values]
        if len(axes) != 3:
            raise SceneError("plane_cut draws runs in three dimensions; field draws those in two")
        if normal not in axes:
            raise SceneError(f"plane {normal}: expected one of {', '.join(axes)}")
        across = axes.index(normal)
        shown = [k for k in range(3) if k != across]
        frames = {body: frame_of(tree, f"particles/{body}", frame) for body in own}
        drawn = xr.concat([point_field(data, name) for data in frames.values()], "particle")
        values, unit = drawn.values, drawn.attrs["units"]
        position = np.concatenate([data["position"].values for data in frames.values()]).astype(float)
        size = np.cbrt(np.concatenate([data["volume"].values for data in frames.values()]).astype(float))
        place = float(np.median(position[:, across])) if at is None else at
        met = np.abs(position[:, across] - place) <= 0.5 * size
        if not met.any():
            low, high = position[:, across].min(), position[:, across].max()
            text = f"no material point is on the plane {normal} = {place:g} m"
            raise SceneError(f"{text}; expected {low:.4g} to {high:.4g} m")
        outlined = [*own, *rigid_bodies_of(tree, bodies)]
        lines = []
        for body in (one for one in surfaces_of(tree) if one in outlined):
            nodes = frame_of(tree, f"surface/{body}", frame)["position"].values.astype(float)
            lines.append(cut_lines(nodes, facets_of(tree, body), across, place)[:, :, shown])
        colour = with_prefix(unit, float(np.abs(values[met]).max()))
        label = in_brackets(drawn.attrs["long_name"], colour[1])
        figure, panel = _drawn(position[met][:, shown], size[met], values[met] / colour[0], lines, label)
        if limits is not None:
            panel.collections[0].set_clim(*(end / colour[0] for end in limits))
        panel.set_xlabel(f"{axes[shown[0]]} [m]")
        panel.set_ylabel(f"{axes[shown[1]]} [m]")
        extent = float(np.ptp(position, axis=0).max())
        shown_place = 0.0 if abs(place) < SINGLE_PRECISION * extent else place
        panel.set_title(f"{normal} = {shown_place:.4g} m, t = {times_of(tree)[frame]:.4g} s")
    return figure


def _drawn(
    place: FloatArray, size: FloatArray, values: FloatArray, lines: Sequence[FloatArray], label: str
) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(7.0, 5.0), layout="constrained")
    panel = figure.add_subplot()
    discs = EllipseCollection(
        size, size, np.zeros(len(size)), units="x", offsets=place, offset_transform=panel.transData,
        array=values
    )  # fmt: skip
    panel.add_collection(discs)
    for each in lines:
        panel.add_collection(LineCollection(list(each), colors="black", linewidths=0.8))
    panel.set_aspect("equal")
    margin = float(size.max())
    panel.set_xlim(place[:, 0].min() - margin, place[:, 0].max() + margin)
    panel.set_ylim(place[:, 1].min() - margin, place[:, 1].max() + margin)
    figure.colorbar(discs, label=label)
    return figure, panel


def cut_lines(nodes: FloatArray, facets: IntArray, across: int, place: float) -> FloatArray:
    """Return segments (n, 2, 3) [m] in which triangles (k, 3) meet a plane."""
    corners = nodes[facets]
    above = corners[:, :, across] >= place
    cut = above.any(axis=1) & ~above.all(axis=1)
    corners, above = corners[cut], above[cut]
    lone = np.argmax(above == (above.sum(axis=1) == 1)[:, np.newaxis], axis=1)
    rows = np.arange(len(corners))
    start = corners[rows, lone]
    ends = []
    for k in (1, 2):
        end = corners[rows, (lone + k) % 3]
        share = (place - start[:, across]) / (end[:, across] - start[:, across])
        ends.append(start + share[:, np.newaxis] * (end - start))
    return np.stack(ends, axis=1)
