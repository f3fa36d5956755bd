"""One output as meshes: material points as vertices or domains, surfaces as closed lines or triangles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
import xarray as xr

from mpmfw.errors import MpmfwError, SceneError
from mpmfw.results.domains import Corners, loops, triangles_of
from mpmfw.results.selection import frame_of
from mpmfw.state.fields import AnyArray, FloatArray, IntArray

#: Stored arrays that are the geometry of the mesh, not fields on it.
_GEOMETRY = ("position", "corners", "next")

#: Out-of-plane component of tensors in 2D, plane strain, where it is known; it is NaN for the others.
_ACROSS = {"deformation_gradient": 1.0, "velocity_gradient": 0.0, "affine": 0.0}


@dataclass(frozen=True)
class Mesh:
    """A grid of VTK, and the units of its fields by name."""

    grid: Any  #: pyvista.UnstructuredGrid
    units: Mapping[str, str]


def mesh_library(user: str = "export", instead: str = "") -> Any:
    """Import pyvista; where it is not installed, a SceneError says what needs it and what works instead."""
    try:
        import pyvista
    except ImportError as error:
        raise SceneError(f"{user} needs pyvista: pip install 'mpmfw[render]'{instead}") from error
    return pyvista


def points_mesh(
    tree: xr.DataTree, bodies: Mapping[str, int], corners: Mapping[str, Corners | None], frame: int
) -> Mesh:
    """Return material points of the ``bodies``, whose indices become the array ``body``, at one output.

    With ``corners`` of domains a material point is a quadrilateral and its fields are cell data; without them
    it is a vertex and they are point data.
    """
    frames = {body: frame_of(tree, f"particles/{body}", frame) for body in bodies}
    points = _joined(frames, bodies, "particle")
    fields = _fields(points)
    kinds = mesh_library().CellType
    drawn = [of(frames[body]) for body in bodies if (of := corners[body]) is not None]
    if len(drawn) == len(bodies):
        nodes = np.concatenate(drawn)
        quads = np.arange(4 * len(nodes)).reshape(-1, 4)
        grid = _grid(nodes.reshape(-1, 2), kinds.QUAD, quads)
        grid.cell_data.update(fields)
    else:
        position = fields.pop("position")
        grid = _grid(position, kinds.VERTEX, np.arange(len(position))[:, np.newaxis])
        grid.point_data.update(fields)
        grid.cell_data["body"] = fields["body"]
    return Mesh(grid, _units(points, fields))


def surface_mesh(tree: xr.DataTree, bodies: Mapping[str, int], frame: int) -> Mesh:
    """Surfaces of the bodies at one output as segments or triangles, with the gap at every surface node.

    In space with the pressure and the share of friction as well, where the contact force is stored.
    """
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
    grid = _grid(fields.pop("position"), kinds.LINE if facets.shape[1] == 2 else kinds.TRIANGLE, facets)
    grid.point_data.update(fields)
    grid.cell_data["body"] = fields["body"][facets[:, 0]]
    return Mesh(grid, _units(nodes, fields))


def _nearest(
    body: str, shapes: Mapping[str, tuple[FloatArray, IntArray]]
) -> tuple[FloatArray, FloatArray | None]:
    """Distance of a body's surface nodes (s,) [m] from the nearest other surface, negative inside, measured
    as ``min_gap``, NaN without another; and the outward direction (s, 3) there, None in the plane.
    """
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
    """Signed distance (n,) [m] of points (n, 2) from closed polylines, negative inside the material, which
    lies inside an odd number of them.

    The first node of segment s of ``segments`` (s, 2) is node s of ``nodes`` (s, 2) [m].
    """
    rings = [shapely.Polygon(nodes[loop]) for loop in loops(segments[:, 1])]
    outlines = shapely.MultiLineString([ring.exterior for ring in rings])
    shapely.prepare(rings)
    inside = np.logical_xor.reduce([shapely.contains_xy(ring, points) for ring in rings])
    distance = shapely.distance(outlines, shapely.points(points))
    return np.asarray(np.where(inside, -distance, distance))


def distances_in_space(
    points: FloatArray, nodes: FloatArray, facets: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Signed distance (n,) [m] of points (n, 3) from a closed surface of triangles, negative inside, and the
    unit vectors (n, 3) along it, zero where it is zero.

    Triangles ``facets`` (k, 3) of ``nodes`` (s, 3) [m] are counter-clockwise as seen from outside. Where the
    nearest point lies on an edge or a node the angle-weighted normal decides (J. A. Bærentzen, H. Aanæs,
    2005), as for ``min_gap``.
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

    A node inside another body, its ``gap`` (s,) [m] negative, presses along the normal of that body's
    surface, ``other`` (s, 3). Nodes of the other body press on this surface along its own normal. So friction
    is measured against the mean of both normals there, and against the node's own normal elsewhere: a node
    beside the lowest one of a sphere would otherwise seem to slip, or to stick.

    Returns
    -------
    dict
        ``pressure`` −f·n/A (s,) [Pa], with n and A the sum of the area vectors of a node's triangles, a third
        each; and ``friction_share`` |f − (f·m) m|/(−f·m), m the mean normal, NaN where nothing presses. A
        node sticks below the coefficient of friction and slips where it is reached. Empty in the plane,
        without forces or without another surface.
    """
    if facets.shape[1] != 3 or "force" not in frame or other is None:
        return {}
    force = np.asarray(frame["force"].values, dtype=float)
    corners = position[facets]
    third = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 6.0
    area = np.zeros_like(position)
    for corner in facets.T:
        np.add.at(area, corner, third)
    size = np.linalg.norm(area, axis=1)
    normal = area / size[:, np.newaxis]
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


def surfaces_of(tree: xr.DataTree) -> list[str]:
    """Bodies whose surfaces are stored."""
    groups = tree["surface"].children if "surface" in tree.children else {}
    return [str(body) for body, group in groups.items() if "position" in group.data_vars]


def facets_of(tree: xr.DataTree, body: str) -> IntArray:
    """Segments (k, 2) of a stored surface, or triangles (k, 3), made again from the scene as the run made
    them.
    """
    surface = tree[f"surface/{body}"].to_dataset()
    if "next" in surface:
        following = np.asarray(surface["next"].values)
        return np.stack([np.arange(len(following)), following], axis=1)
    made = triangles_of(tree, body)
    if made is None or made.max(initial=-1) + 1 != surface.sizes["surface_node"]:
        raise MpmfwError(
            f"surface of '{body}': its triangles are not in the file, and those of the file's scene do not "
            "fit "
            "the stored nodes; is a mesh file that it names another one?"
        )
    return made


def skipped_fields(tree: xr.DataTree, bodies: Sequence[str]) -> list[str]:
    """Names of stored fields that have another form than scalar, vector or tensor of a point."""
    groups = [(f"particles/{body}", "particle") for body in bodies]
    groups += [(f"surface/{body}", "surface_node") for body in surfaces_of(tree)]
    frames = [(frame_of(tree, place, 0), dim) for place, dim in groups]
    names = [
        str(name) for frame, dim in frames for name in frame.data_vars if not _is_field(frame[name], dim)
    ]
    return [name for name in dict.fromkeys(names) if name not in _GEOMETRY]


def _joined(frames: Mapping[str, xr.Dataset], bodies: Mapping[str, int], dim: str) -> xr.Dataset:
    """Fields of several bodies' points, and the index of each point's ``body``; a field that a body lacks
    is NaN.
    """
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
    """Fields by name, as VTK takes them: vectors of 3 components, tensors of 9, row by row.

    In 2D the shear across the plane is zero. The zz component of the stress is not stored: it is NaN, so that
    no filter uses it.
    """
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


def _units(points: xr.Dataset, fields: Mapping[str, AnyArray]) -> dict[str, str]:
    return {name: str(points[name].attrs.get("units", "1")) for name in fields if name != "body"}


def _grid(points: FloatArray, kind: int, cells: IntArray) -> Any:
    points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    return mesh_library().UnstructuredGrid({kind: cells}, points)
