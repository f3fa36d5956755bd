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
from mpmfw.results.fields import contact_fields
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
    frames = {body: data for body, data in everywhere.items() if body in bodies}
    for body, data in frames.items():
        gap = xr.DataArray(_gaps(body, shapes), dims="surface_node", attrs={"units": "m"})
        pressed = contact_fields(tree, body, data) if "force" in data else {}
        frames[body] = data.assign({"gap": gap, **pressed})
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


def _gaps(body: str, shapes: Mapping[str, tuple[FloatArray, IntArray]]) -> FloatArray:
    """Return distances (s,) [m] of a body's nodes from the nearest other surface."""
    position = shapes[body][0]
    distances = distances_in_plane if position.shape[1] == 2 else distances_in_space
    gaps = [distances(position, *shape) for other, shape in shapes.items() if other != body]
    return np.min(gaps, axis=0) if gaps else np.full(len(position), np.nan)


def distances_in_plane(points: FloatArray, nodes: FloatArray, segments: IntArray) -> FloatArray:
    """Return distances (n,) [m] of points (n, 2) from closed polylines of ``segments``, negative inside."""
    rings = [shapely.Polygon(nodes[loop]) for loop in loops(segments[:, 1])]
    outlines = shapely.MultiLineString([ring.exterior for ring in rings])
    shapely.prepare(rings)
    inside = np.logical_xor.reduce([shapely.contains_xy(ring, points) for ring in rings])
    distance = shapely.distance(outlines, shapely.points(points))
    return np.asarray(np.where(inside, -distance, distance))


def distances_in_space(points: FloatArray, nodes: FloatArray, facets: IntArray) -> FloatArray:
    """Return distances (n,) [m] of points (n, 3) from a closed surface, negative inside.

    On edges and nodes the angle-weighted normal decides (J. A. Bærentzen, H. Aanæs, 2005).
    """
    mesh: Any = mesh_library().PolyData  # its annotations lack integers of fixed width
    cloud = mesh(points).compute_implicit_distance(mesh.from_regular_faces(nodes, facets))
    return np.asarray(cloud["implicit_distance"])


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
