"""A picture of a run in space, rendered by pyvista (the extra ``mpmfw[render]``)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from scipy.spatial import cKDTree

from mpmfw.errors import SceneError
from mpmfw.paraview.meshes import mesh_library
from mpmfw.plots.style import PANEL, journal_style
from mpmfw.plots.units import in_brackets, with_prefix
from mpmfw.results.domains import surface_in_space
from mpmfw.results.point_fields import point_field
from mpmfw.results.selection import Results, bodies_of, frame_at, frame_of, opened_run, times_of
from mpmfw.state.fields import AnyArray, FloatArray, IntArray

#: Width and height of the picture in pixels: a journal's column at 300 dpi, drawn twice as large as it is
#: shown.
PIXELS = (2000, 1500)


@journal_style()
def rendered(
    results: Results,
    name: str = "von_mises",
    time: float | None = None,
    *,
    bodies: Sequence[str] | None = None,
    towards: tuple[float, float, float] = (-1.0, 1.5, -0.8),
) -> Figure:
    """Render the bodies of a run in space, their surfaces in the colours of a field.

    A surface node has the value of the nearest point; other bodies are spheres.
    ``towards`` is the direction of the view, with the z axis up; the rest is as of :func:`field`. A
    SceneError says that pyvista is missing, or what the run lacks.
    """
    vista = mesh_library("rendered", "; plane_cut draws without it")
    with opened_run(results) as tree:
        if len(tree.coords["axis"]) != 3:
            raise SceneError("rendered draws runs in three dimensions; field draws those in two")
        frame = frame_at(tree, time)
        own = bodies_of(tree, bodies)
        points = {body: frame_of(tree, f"particles/{body}", frame) for body in own}
        fields = {body: point_field(points[body], name) for body in own}
        surfaces = {body: surface_in_space(tree, body, frame) for body in own}
        moment = f"t = {times_of(tree)[frame]:.4g} s"
    every = np.concatenate([field.values for field in fields.values()])
    about = fields[own[0]].attrs
    divisor, unit = with_prefix(about["units"], float(np.abs(every).max()))
    scale = Normalize(every.min() / divisor, every.max() / divisor)
    plotter = vista.Plotter(off_screen=True, window_size=PIXELS)
    plotter.set_background("white")
    for body in own:
        mesh, colours = _mesh(vista, points[body], fields[body].values / divisor, surfaces[body])
        look = {"clim": (scale.vmin, scale.vmax), "cmap": "viridis", "ambient": 0.4}
        plotter.add_mesh(mesh, scalars=colours, show_scalar_bar=False, **look)
    plotter.view_vector([-x for x in towards], viewup=(0.0, 0.0, 1.0))
    picture = plotter.screenshot(None, return_img=True)
    plotter.close()
    return _framed(picture, scale, in_brackets(about["long_name"], unit), moment)


def _mesh(
    vista: Any, points: xr.Dataset, values: FloatArray, surface: tuple[FloatArray, IntArray] | None
) -> tuple[Any, AnyArray]:
    """Return a body's mesh, and the value at each vertex."""
    position = np.asarray(points["position"].values, dtype=float)
    if surface is None:
        radius = np.cbrt(0.75 / np.pi * np.asarray(points["volume"].values, dtype=float))
        cloud = vista.PolyData(position)
        cloud["radius"], cloud["value"] = radius, values
        ball = vista.Sphere(radius=1.0, theta_resolution=12, phi_resolution=12)
        balls = cloud.glyph(scale="radius", geom=ball)
        return balls, np.asarray(balls["value"])
    nodes, facets = surface
    triangles = np.column_stack([np.full(len(facets), 3), facets]).ravel()
    return vista.PolyData(nodes, triangles), values[cKDTree(position).query(nodes)[1]]


def _framed(picture: Any, scale: Normalize, label: str, title: str) -> Figure:
    """Return the picture without its white rim, with a scale beside it."""
    drawn = (picture < 250).any(axis=2)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    if len(rows):
        picture = picture[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    height = PANEL * picture.shape[0] / picture.shape[1] * 0.85 + 0.2
    figure = Figure(figsize=(PANEL, height), layout="constrained")
    panel = figure.add_subplot()
    panel.imshow(picture)
    panel.set_axis_off()
    panel.set_title(title)
    figure.colorbar(ScalarMappable(scale, "viridis"), ax=panel, label=label, fraction=0.05)
    return figure
