"""Figures of fields: one run, or several side by side under one colour scale."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from mpmfw.errors import SceneError
from mpmfw.plots import style
from mpmfw.plots.bodies import Box, FieldPanel, Scales, colour_range
from mpmfw.plots.contact_figure import contact_figure
from mpmfw.plots.plane_cut import plane_cut
from mpmfw.plots.space import SpacePanel
from mpmfw.results.point_fields import CONTACT_FIELDS
from mpmfw.results.selection import Results, frame_at, opened, opened_run, runs_of
from mpmfw.state.fields import FloatArray

#: Drawings wider than this, in heights, stand one above the other; narrower ones two in a row.
_WIDE = 2.5
#: Room for labels beside a drawing and above it, and for a colour bar [mm].
_BESIDE, _ABOVE, _BAR = 15.0, 18.0, 14.0


def field(
    results: Results,
    name: str = "von_mises",
    time: float | None = None,
    *,
    bodies: Sequence[str] | None = None,
    limits: tuple[float, float] | None = None,
    arrows: bool = False,
    plane: tuple[str, float | None] | None = None,
    against: str | None = None,
) -> Figure:
    """Draw a field at one output of a run or of a comparison's runs.

    Domains of CPDI are patches, other points discs; of a run in 3D those that meet a plane.

    Parameters
    ----------
    results
        A run or a comparison, or the name of its file.
    name
        ``von_mises``, ``velocity`` (its magnitude), ``velocity_x``, ``stress_xy``, ``volume_ratio`` …; or
        ``contact_pressure``, ``contact_traction`` …, along the surfaces that touch, in 3D on them
    time
        [s]; the nearest output is drawn, the last one by default.
    bodies
        Only these bodies.
    limits
        Ends of the scale [SI]; the least and the largest value by default.
    arrows
        Draw the contact force on every surface node (2D).
    plane
        Axis across the plane, and its place along the axis [m]; by default the middle along z (3D).
    against
        A contact of the comparison: draw the difference of every other run against it.

    Raises
    ------
    SceneError
        There is no such field, body or time, or the run keeps no material points.
    """
    with labelled(results, against=against, name=name) as trees:
        drawn = name if against is None else f"{name}_difference"
        tree = trees.get("")
        on_nodes = name.startswith(CONTACT_FIELDS)
        if on_nodes and plane is not None:
            raise SceneError(f"plane: has no effect on {name}")
        if on_nodes or tree is None or tree.sizes.get("axis") != 3:
            if plane is not None and tree is None:
                raise SceneError("plane: has no effect on a comparison; mpmfw.select gives one run of it")
            if plane is not None:
                raise SceneError("plane: has no effect on a run in 2D")
            return side_by_side(trees, drawn, time, bodies=bodies, limits=limits, arrows=arrows)
        if arrows:
            raise SceneError("arrows: drawn of runs in 2D alone; mpmfw export shows forces in 3D in ParaView")
        title, cut = plane_cut(tree, name, frame_at(tree, time), *(plane or ("z", None)), bodies)
        return side_by_side({title: cut}, drawn, limits=limits)


def side_by_side(
    results: Results | Mapping[str, Results] | Sequence[Results],
    name: str = "von_mises",
    time: float | None = None,
    *,
    bodies: Sequence[str] | None = None,
    limits: tuple[float, float] | None = None,
    arrows: bool = False,
) -> Figure:
    """Draw a field of several runs under one colour scale, with the parameters of :func:`field`."""
    with labelled(results) as trees:
        if name.startswith(CONTACT_FIELDS):
            if arrows:
                raise SceneError(f"arrows: have no effect on {name}")
            return contact_figure(trees, name, time, bodies, limits)
        frames = {label: [frame_at(tree, time)] for label, tree in trees.items()}
        drawing = Drawing(trees, name, frames, bodies, limits, arrows=arrows)
        drawing.show(0)
        return drawing.figure


@contextmanager
def labelled(
    results: Results | Mapping[str, Results] | Sequence[Results],
    *,
    against: str | None = None,
    name: str = "",
) -> Iterator[dict[str, xr.DataTree]]:
    """Context with runs by label: "" for a single run, else their methods or their files' names."""
    with ExitStack() as stack:
        if isinstance(results, xr.DataTree | xr.Dataset | str | os.PathLike):
            found = stack.enter_context(opened(results))
            if isinstance(found, xr.Dataset) and "status" in found:
                yield runs_of(found, against, name)
                return
            if against is not None:
                raise SceneError(f"against {against}: has no effect on a single run; give a comparison")
            yield {"": stack.enter_context(opened_run(found))}
            return
        runs = list(results.values() if isinstance(results, Mapping) else results)
        if not runs:
            raise SceneError("no results to draw")
        trees = [stack.enter_context(opened_run(run)) for run in runs]
        labels = list(map(str, results)) if isinstance(results, Mapping) else _labels(runs, trees)
        yield dict(zip(labels, trees, strict=True))


def _methods(tree: xr.DataTree) -> str:
    return ", ".join(str(tree.attrs[key]) for key in ("contact", "shape") if tree.attrs.get(key))


def _labels(results: Sequence[Results], trees: Sequence[xr.DataTree]) -> list[str]:
    methods = [_methods(tree) for tree in trees]
    if len(set(methods)) == len(trees):
        return methods
    names = [
        f"run {k + 1}" if isinstance(one, xr.DataTree | xr.Dataset) else Path(one).stem
        for k, one in enumerate(results)
    ]
    return names if len(set(names)) == len(names) else [f"{k + 1}: {name}" for k, name in enumerate(names)]


class Drawing:
    """Panels of runs by label with common scales and a colour bar, which move through their ``frames``."""

    @style.journal_style()
    def __init__(
        self,
        trees: Mapping[str, xr.DataTree],
        name: str,
        frames: Mapping[str, Sequence[int]],
        bodies: Sequence[str] | None = None,
        limits: tuple[float, float] | None = None,
        *,
        arrows: bool = False,
    ) -> None:
        panels: dict[str, FieldPanel | SpacePanel] = {
            label: (SpacePanel if tree.sizes.get("axis") == 3 else FieldPanel)(tree, name, bodies)
            for label, tree in trees.items()
        }
        self.panels, self.frames = panels, frames
        self.scales, unit = _scales(panels, frames, limits, arrows=arrows)
        x0, x1, y0, y1 = self.scales.box
        ratio = (x1 - x0) / (y1 - y0)
        most = 1 if ratio > _WIDE else 2
        below = ratio > 1.0 or min(most, len(panels)) > 1
        width = 25.4 * style.PANEL - _BESIDE - (0.0 if below else _BAR)
        self.figure, grid = style.new_panels(len(panels), min(width / ratio, 110.0) + _ABOVE, most)
        self.figure.set_layout_engine("compressed")
        self.axes = dict(zip(self.panels, grid, strict=True))
        length = self.scales.length
        metres = "m" if length == 1.0 else "mm"
        along, up, *_ = next(iter(trees.values())).coords["axis"].values
        for axes in grid:
            axes.set_aspect("equal")
            axes.set_xlim(length * x0, length * x1)
            axes.set_ylim(length * y0, length * y1)
            style.dress(axes, f"{along} [{metres}]", f"{up} [{metres}]")
            axes.grid(False)
        self._bar(unit, below=below)

    @style.journal_style()
    def show(self, index: int) -> None:
        """Draw the output ``index`` of every panel's frames."""
        for label, panel in self.panels.items():
            title = label or _methods(panel.tree)
            panel.draw(self.axes[label], self.frames[label][index], self.scales, title)

    def _bar(self, unit: str, *, below: bool) -> None:
        about = next(iter(self.panels.values())).about
        colours, ends = ScalarMappable(self.scales.norm, self.scales.colours), self.scales.extend
        place: dict[str, Any] = {"location": "bottom" if below else "right", "aspect": 30, "pad": 0.02}
        bar = self.figure.colorbar(colours, ax=list(self.axes.values()), extend=ends, **place)
        bar.set_label(style.in_brackets(about["long_name"], unit))
        if self.scales.largest_force > 0.0:
            groups = next(iter(self.panels.values())).tree["surface"].children.values()
            stored = next(group["force"] for group in groups if "force" in group.data_vars)
            size, prefix = (1e3, "k") if self.scales.largest_force >= 1e3 else (1.0, "")
            force = f"{self.scales.largest_force / size:.3g} {prefix}{style.readable(stored.attrs['units'])}"
            text = f"contact force on surface nodes, longest arrow: {force}"
            self.figure.supxlabel(text, color="#D55E00")


def _scales(
    panels: Mapping[str, FieldPanel | SpacePanel],
    frames: Mapping[str, Sequence[int]],
    limits: tuple[float, float] | None,
    *,
    arrows: bool,
) -> tuple[Scales, str]:
    found, boxes = zip(*(panel.survey(frames[label]) for label, panel in panels.items()), strict=True)
    low, high, colours = colour_range(found, limits)
    units = next(iter(panels.values())).about["units"]
    size, unit = style.with_prefix(units, max(abs(low), abs(high)))
    box = _with_margin(np.array(boxes))
    forces = [panel.largest_force(frames[label]) for label, panel in panels.items()] if arrows else [0.0]
    if arrows and not any(panel.stores_force for panel in panels.values()):
        raise SceneError("the run stored no contact force of surface nodes; leave the arrows out")
    length, _ = style.length_scale(box[1] - box[0])
    norm = Normalize(low / size, high / size)
    below, above = min(least for least, _ in found) < low, max(largest for _, largest in found) > high
    extend = ("neither", "min", "max", "both")[below + 2 * above]
    return Scales(norm, colours, size, length, box, max(forces), extend), unit


def _with_margin(boxes: FloatArray) -> Box:
    x0, y0 = boxes[:, [0, 2]].min(axis=0)
    x1, y1 = boxes[:, [1, 3]].max(axis=0)
    margin = 0.03 * max(x1 - x0, y1 - y0)
    return float(x0 - margin), float(x1 + margin), float(y0 - margin), float(y1 + margin)
