"""Markers that would cover each other, moved apart, with a dot where they belong."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.transforms import offset_copy

from mpmfw.state.fields import FloatArray

#: Distance of two markers, as a share of the sum of their half sizes: at 1 circles touch.
_SHARE = 0.6
#: Shifts are multiples of this [pt].
_STEP = 0.5
#: The dot where a marker belongs, above all markers.
_PLACE: dict[str, Any] = {
    "marker": "o",
    "markersize": 2.0,
    "color": "black",
    "markeredgecolor": "white",
    "markeredgewidth": 0.3,
    "zorder": 8,
}


class Marker(NamedTuple):
    """A marker of a panel."""

    x: float  #: in data's units
    y: float  #: in data's units
    size: float  #: [pt]
    style: dict[str, Any]  #: keywords of ``Axes.plot``


def draw_side_by_side(axes: Any, markers: Sequence[Marker]) -> None:
    """Draw markers beside each other; thin lines lead to the places of those shifted."""
    if not markers:
        return
    points = 72.0 / axes.figure.dpi
    places = points * axes.transData.transform([(one.x, one.y) for one in markers])
    box = points * axes.bbox.extents
    shifts = vertical_shifts(places, np.array([one.size for one in markers]), box[1], box[3])
    for one, shift in zip(markers, shifts, strict=True):
        if shift != 0.0:
            axes.plot(one.x, one.y, **_PLACE)
            axes.annotate(
                "",
                (one.x, one.y),
                (0.0, shift),
                textcoords="offset points",
                arrowprops={"arrowstyle": "-", "linewidth": 0.5, "shrinkA": 0, "shrinkB": 0},
                zorder=7,
            )
        moved = offset_copy(axes.transData, axes.figure, y=float(shift), units="points")
        axes.plot(one.x, one.y, markersize=one.size, linestyle="", transform=moved, **one.style)


def vertical_shifts(places: FloatArray, sizes: FloatArray, low: float, high: float) -> FloatArray:
    """Return shifts (n,) that part markers at ``places`` (n, 2), of diameters (n,) [pt]."""
    shifts = np.zeros(len(places))
    for k in range(len(places)):
        taken = places[:k] + np.stack([np.zeros(k), shifts[:k]], axis=1)
        room = 0.5 * _SHARE * (sizes[:k] + sizes[k])
        for count in range(1 + int((high - low) / _STEP)):
            free = [
                shift
                for shift in (count * _STEP, -count * _STEP)
                if np.all(np.hypot(*(taken - places[k] - (0.0, shift)).T) >= room)
                and (count == 0 or low < places[k, 1] + shift - 0.5 * sizes[k])
                and (count == 0 or places[k, 1] + shift + 0.5 * sizes[k] < high)
            ]
            if free:
                shifts[k] = free[0]
                break
    return shifts
