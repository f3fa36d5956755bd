"""One output as meshes of material points and of surfaces."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import shapely
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.results.domains import Corners, facets_of, loops, surfaces_of
from mpmfw.results.fields import carried_areas
from mpmfw.results.selection import frame_of
from mpmfw.state.fields import AnyArray, FloatArray, IntArray

#: Stored arrays that are the geometry of the mesh, not fields on it.
_GEOMETRY = ("position", "corners", "next", "triangles")

#: Out-of-plane component of tensors in plane strain, where it is known.
_ACROSS = {"deformation_gradient": 1.0, "velocity_gradient": 0.0, "affine": 0.0}


def mesh_library() -> Any:
    """Import pyvista; a SceneError says how to install it."""
    try:
        import pyvista
    except ImportError as error:
        raise SceneError("this needs pyvista: pip install 'mpmfw[render]'") from error
    return pyvista


def points_mesh(
    tree: xr.DataTree, bodies: Mapping[str, int], corners: Mapping[str, Corners | None], frame: int
) -> Any:
    """Return points of the ``bodies`` at one output, quadrilaterals if ``corners`` are known.

    As of surfaces, it is a pyvista.UnstructuredGrid that has the units of its fields in ``field_data``."""
    frames = {body: frame_of(tree, f"particles/{body}", frame) for body in bodies}
    points = _joined(frames, bodies, "particle")
    fields = _fields(points)
    kinds = mesh_library().CellType
    drawn = [of(frames[body]) for body in bodies if (of := corners[body]) is not None]
    if len(drawn) == len(bodies):
        nodes = np.concatenate(drawn)
        quads = np.arange(4 * len(nodes)).reshape(-1, 4)
        grid = _grid(nodes.reshape(-1, 2), kinds.QUAD, quads, points)
        grid.cell_data.update(fields)
    else:
        position = fields.pop("position")
        grid = _grid(position, kinds.VERTEX, np.arange(len(position))[:, np.newaxis], points)
        grid.point_data.update(fields)
        grid.cell_data["body"] = fields["body"]
    return grid


def surface_mesh(tree: xr.DataTree, bodies: Mapping[str, int], frame: int) -> Any:
    """Return surfaces of bodies at one output, with gap and contact fields."""
    everywhere = {body: frame_of(tree, f"surface/{body}", frame) for body in surfaces_of(tree)}
    shapes = {
        body: (np.asarray(data["position"].values, dtype=float), facets_of(tree, body))
        for body, data in everywhere.items()
    }
    frames = {}
    for body in everywhere:
        if body in bodies:
            gap, outward = _nearest(body, shapes)
            contact = contact_fields(everywhere[body], *shapes[body], gap, outward)
            gaps = xr.DataArray(gap, dims="surface_node", attrs={"units": "m"})
            frames[body] = everywhere[body].assign({"gap": gaps, **contact})
    nodes = _joined(frames, bodies, "surface_node")
    fields = _fields(nodes)
    start = np.cumsum([0, *(frame.sizes["surface_node"] for frame in frames.values())])
    facets = np.concatenate([shapes[body][1] + first for body, first in zip(frames, start, strict=False)])
    kinds = mesh_library().CellType
    kind = kinds.LINE if facets.shape[1] == 2 else kinds.TRIANGLE
    grid = _grid(fields.pop("position"), kind, facets, nodes)
    grid.point_data.update(fields)
    grid.cell_data["body"] = fields["body"][facets[:, 0]]
    return grid


def _nearest(
    body: str, shapes: Mapping[str, tuple[FloatArray, IntArray]]
) -> tuple[FloatArray, FloatArray | None]:
    """Return distances (s,) [m] of a body's nodes from the nearest other surface, and in space directions."""
    position = shapes[body][0]
    others = [shape for other, shape in shapes.items() if other != body]
    if not others:
        return np.full(len(position), np.nan), None
    if position.shape[1] == 2:
        return np.min([distances_in_plane(position, *other) for other in others], axis=0), None
    gaps, outward = map(
        np.array, zip(*(distances_in_space(position, *other) for other in others), strict=True)
    )
    nearest, rows = gaps.argmin(axis=0), np.arange(len(position))
    return gaps[nearest, rows], outward[nearest, rows]


def distances_in_plane(points: FloatArray, nodes: FloatArray, segments: IntArray) -> FloatArray:
    """Return distances (n,) [m] of points (n, 2) from closed polylines of ``segments``, negative inside."""
    rings = [shapely.Polygon(nodes[loop]) for loop in loops(segments[:, 1])]
    outlines = shapely.MultiLineString([ring.exterior for ring in rings])
    shapely.prepare(rings)
    inside = np.logical_xor.reduce([shapely.contains_xy(ring, points) for ring in rings])
    distance = shapely.distance(outlines, shapely.points(points))
    return np.asarray(np.where(inside, -distance, distance))


def distances_in_space(
    points: FloatArray, nodes: FloatArray, facets: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return distances (n,) [m] of points (n, 3) from a closed surface, negative inside, with directions.

    On edges and nodes the angle-weighted normal decides (J. A. Bærentzen, H. Aanæs, 2005).
    """
    mesh: Any = mesh_library().PolyData  # its annotations know no fixed width of integers
    surface = mesh.from_regular_faces(nodes, facets)
    cloud = mesh(points).compute_implicit_distance(surface)
    gap = np.asarray(cloud["implicit_distance"])
    nearest = surface.find_closest_cell(points, return_closest_point=True)[1]
    away = points - nearest
    outward = np.zeros_like(points)
    np.divide(away, gap[:, np.newaxis], out=outward, where=gap[:, np.newaxis] != 0.0)
    return gap, outward


def contact_fields(
    frame: xr.Dataset, position: FloatArray, facets: IntArray, gap: FloatArray, other: FloatArray | None
) -> dict[str, xr.DataArray]:
    """Split the contact forces on the nodes of a surface in space into pressure and friction.

    ``pressure`` is −f·n/A (s,) [Pa], as :func:`.carried_areas` gives A and n.
    ``friction_share`` is |f − (f·m) m|/(−f·m), NaN where nothing presses; a node slips where it reaches μ.
    There m is n, and inside another body, at a negative ``gap`` (s,) [m], the mean of n and of that body's
    normal ``other`` (s, 3). Nothing in the plane, without forces or without another surface.
    """
    if facets.shape[1] != 3 or "force" not in frame or other is None:
        return {}
    force = np.asarray(frame["force"].values, dtype=float)
    size, normal = carried_areas(force, position, facets)
    pressing = -(force * normal).sum(axis=1)
    mean = normal - np.where(gap < 0.0, 1.0, 0.0)[:, np.newaxis] * other
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-12)
    against = -(force * mean).sum(axis=1)
    tangential = np.linalg.norm(force + against[:, np.newaxis] * mean, axis=1)
    share = np.full(len(size), np.nan)
    np.divide(tangential, against, out=share, where=(pressing > 0.0) & (against > 0.0))
    fields = {"pressure": (pressing / size, "Pa"), "friction_share": (share, "1")}
    return {
        name: xr.DataArray(values, dims="surface_node", attrs={"units": unit})
        for name, (values, unit) in fields.items()
    }


def skipped_fields(tree: xr.DataTree, bodies: Sequence[str]) -> list[str]:
    """Return stored fields that are not scalars, vectors or tensors."""
    groups = [(f"particles/{body}", "particle") for body in bodies]
    groups += [(f"surface/{body}", "surface_node") for body in surfaces_of(tree)]
    frames = [(frame_of(tree, place, 0), dim) for place, dim in groups]
    names = [
        str(name) for frame, dim in frames for name in frame.data_vars if not _is_field(frame[name], dim)
    ]
    return [name for name in dict.fromkeys(names) if name not in _GEOMETRY]


def _joined(frames: Mapping[str, xr.Dataset], bodies: Mapping[str, int], dim: str) -> xr.Dataset:
    parts = []
    for body, frame in frames.items():
        fields = frame[[name for name in frame if name != "next" and _is_field(frame[name], dim)]]
        own = (dim, np.full(frame.sizes[dim], bodies[body]))
        parts.append(fields.drop_vars("body", errors="ignore").assign(body=own))
    return xr.concat(
        parts, dim, data_vars="all", coords="minimal", compat="override", combine_attrs="override"
    )


def _is_field(array: xr.DataArray, dim: str) -> bool:
    return array.dims in ((dim,), (dim, "axis"), (dim, "axis", "axis2"))


def _fields(points: xr.Dataset) -> dict[str, AnyArray]:
    """Return fields for VTK, vectors of 3 components and tensors of 9."""
    fields: dict[str, AnyArray] = {}
    for name, array in points.data_vars.items():
        values = array.values
        missing = 3 - values.shape[-1]
        values = np.pad(values, [(0, 0)] + [(0, missing)] * (values.ndim - 1))
        if values.ndim == 3:
            if missing:
                values[:, 2, 2] = _ACROSS.get(str(name), np.nan)
            values = values.reshape(-1, 9)
        fields[str(name)] = values
    return fields


def _grid(points: FloatArray, kind: int, cells: IntArray, fields: xr.Dataset) -> Any:
    points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    grid = mesh_library().UnstructuredGrid({kind: cells}, points)
    names = {str(name) for name in fields.data_vars} - {"body"}
    units = {name: str(fields[name].attrs.get("units", "1")) for name in sorted(names)}
    grid.field_data["units"] = [json.dumps(units)]
    return grid
