"""Contact pressure or traction on surfaces: curves beside the outlines, in space a map of each body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.errors import SceneError
from mpmfw.plots import style
from mpmfw.results.domains import facets_of, surfaces_of
from mpmfw.results.fields import field, pressed_bodies
from mpmfw.results.selection import frame_at, frame_of
from mpmfw.state.fields import FloatArray, IntArray


@style.journal_style()
def contact_figure(
    trees: Mapping[str, xr.DataTree],
    name: str,
    time: float | None,
    bodies: Sequence[str] | None,
    limits: tuple[float, float] | None,
) -> Figure:
    """Draw a field of surface nodes where forces act, over the coordinates along which it extends most.

    In the plane the outlines are those of the first run. Other parameters are those of :func:`field`.
    """
    drawn = dict(_loaded(trees, name, time, bodies))
    if not drawn:
        raise SceneError("no contact force acts at this output; expected another time")
    first, every = next(iter(drawn.values()))[0], np.concatenate([one.values for one, _ in drawn.values()])
    axes = [axis for axis in "xyz" if axis in first.coords]
    extent = {axis: max(np.ptp(one[axis].values[facets]) for one, facets in drawn.values()) for axis in axes}
    along = sorted(sorted(axes, key=lambda axis: extent[axis])[1:])
    low, high = limits or (min(float(every.min()), 0.0), 1.05 * float(every.max()))
    size, unit = style.with_prefix("Pa", max(abs(low), abs(high)))
    text, plane = style.in_brackets(first.attrs["long_name"], unit), len(axes) == 2
    figure, panels = style.new_panels(2 if plane else len(drawn), 58.0 if plane else 70.0)
    for k, (label, (one, facets)) in enumerate(drawn.items()):
        x, y, value = (array.values for array in (one[along[0]], one[along[-1]], one / size))
        if plane:
            panels[1].plot(_lines(x, facets), _lines(value, facets), color=f"C{k}", marker=".", label=label)
            panels[0].plot(*(_lines(one[axis].values, facets) for axis in axes), color=f"C{k}", linewidth=2.0)
        else:
            scale = {"shading": "gouraud", "vmin": low / size, "vmax": high / size}
            colours = panels[k].tripcolor(x, y, facets, value, **scale)
            panels[k].set(xlim=(x[facets].min(), x[facets].max()), ylim=(y[facets].min(), y[facets].max()))
            panels[k].set_aspect("equal")
            style.dress(panels[k], f"{along[0]} [m]", f"{along[1]} [m]", label)
    figure.suptitle(f"t = {float(first['time']):.4g} s")
    if not plane:
        figure.colorbar(colours, ax=panels, label=text)
        return figure
    tree = next(iter(trees.values()))
    for body in surfaces_of(tree):
        nodes = frame_of(tree, f"surface/{body}", frame_at(tree, time))["position"].values
        panels[0].plot(*(_lines(x, facets_of(tree, body)) for x in nodes.T), color="0.6", linewidth=0.6)
    panels[0].set_aspect("equal")
    style.dress(panels[0], "x [m]", "y [m]")
    style.dress(panels[1], f"{along[0]} [m]", text)
    panels[1].set_ylim(low / size, high / size)
    panels[1].legend()
    return figure


def _loaded(
    trees: Mapping[str, xr.DataTree], name: str, time: float | None, bodies: Sequence[str] | None
) -> Iterator[tuple[str, tuple[xr.DataArray, IntArray]]]:
    """Yield label and body, the field of its nodes and the facets at which it is not zero."""
    for label, tree in trees.items():
        for body in pressed_bodies(tree, bodies):
            values, facets = field(tree, name, time=time, body=body).fillna(0.0), facets_of(tree, body)
            if len(facets := facets[(values.values[facets] != 0.0).any(axis=1)]):
                yield f"{label}, {body}" if label else body, (values, facets)


def _lines(values: FloatArray, segments: IntArray) -> FloatArray:
    """Return the values at the ends of segments, with NaN between them."""
    return np.insert(values[segments], 2, np.nan, axis=1).ravel()
