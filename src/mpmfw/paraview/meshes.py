"""One output as meshes: material points as vertices or domains, surfaces as closed lines or triangles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from mpmfw.errors import MpmfwError
from mpmfw.paraview.arrays import arrays_of, stacked, vectors
from mpmfw.paraview.files import Mesh
from mpmfw.paraview.gaps import surface_gaps
from mpmfw.results.domains import Domains, triangles_of
from mpmfw.results.outputs import frame_of
from mpmfw.state.fields import AnyArray, FloatArray, IntArray

#: What the results call the geometry, which is that of the mesh and no field beside it.
_GEOMETRY = ("position", "corners", "next")


def points_mesh(
    tree: xr.DataTree, bodies: Mapping[str, int], domains: Mapping[str, Domains | None], frame: int
) -> Mesh:
    """Material points of the bodies at one output.

    Parameters
    ----------
    bodies
        Index in the scene by name; the index becomes the array ``body``.
    domains
        By body; with domains a material point is a quadrilateral and its fields are cell data, without them it
        is a vertex and they are point data.
    """
    frames = {body: frame_of(tree, f"particles/{body}", frame) for body in bodies}
    counts = [data.sizes["particle"] for data in frames.values()]
    fields = stacked([arrays_of(data, "particle")[0] for data in frames.values()], counts)
    owner = np.repeat(np.array(list(bodies.values())), counts)
    drawn = [domains[body] for body in bodies]
    if all(one is not None for one in drawn):
        corners = np.concatenate(
            [one.corners(data) for one, data in zip(drawn, frames.values(), strict=True) if one is not None]
        )
        quads = np.arange(4 * len(corners)).reshape(-1, 4)
        return Mesh(vectors(corners.reshape(-1, 2)), quads, cell_data={"body": owner, **fields})
    position = fields.pop("position")
    vertices = np.arange(len(position))[:, None]
    return Mesh(position, vertices, point_data={"body": owner, **fields}, cell_data={"body": owner})


def surface_mesh(tree: xr.DataTree, bodies: Mapping[str, int], frame: int) -> Mesh:
    """Surfaces of the bodies at one output as segments or triangles, with the gap at every surface node.

    In space with the pressure and the share of friction as well, where the contact force is stored.
    """
    everywhere = {body: frame_of(tree, f"surface/{body}", frame) for body in surfaces_of(tree)}
    shapes = {
        body: (np.asarray(data["position"].values, dtype=float), facets_of(tree, body))
        for body, data in everywhere.items()
    }
    gaps = surface_gaps(shapes)
    own = [body for body in everywhere if body in bodies]
    counts = [len(gaps[body][0]) for body in own]
    parts = [
        {
            **_without_geometry(everywhere[body]),
            "gap": gaps[body][0],
            **contact_fields(everywhere[body], *shapes[body], *gaps[body]),
        }
        for body in own
    ]
    fields = stacked(parts, counts)
    start = np.cumsum([0, *counts])
    return Mesh(
        vectors(np.concatenate([shapes[body][0] for body in own])),
        np.concatenate([shapes[body][1] + first for body, first in zip(own, start, strict=False)]),
        point_data={"body": np.repeat(np.array([bodies[body] for body in own]), counts), **fields},
        cell_data={"body": np.repeat([bodies[body] for body in own], [len(shapes[body][1]) for body in own])},
    )


def contact_fields(
    frame: xr.Dataset, position: FloatArray, facets: IntArray, gap: FloatArray, other: FloatArray | None
) -> dict[str, AnyArray]:
    """What the contact forces of the nodes of a surface in space are by area and direction.

    A node that is inside of another body, its ``gap`` (s,) [m] negative, presses along the normal of that body's surface, whose
    outward directions ``other`` (s, 3) are given; and nodes of the other press on its own triangles along theirs. Friction is
    told from pressing by the mean of both there, and by its own normal elsewhere: a node beside the lowest one of a sphere would
    else seem to slip, or to stick.

    Returns
    -------
    dict
        ``pressure`` −f·n/A (s,) [Pa], with n and A the sum of the area vectors of a node's triangles, a third each; and
        ``friction_share`` |f − (f·m) m|/(−f·m), m the mean normal, NaN where nothing presses: a node sticks below the
        coefficient of friction and slips where it is reached. Nothing in the plane, without forces or another surface.
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
    return {"pressure": pressing / size, "friction_share": share}


def surfaces_of(tree: xr.DataTree) -> list[str]:
    """Bodies whose surfaces are stored."""
    if "surface" not in tree.children:
        return []
    groups = tree["surface"].children
    return [str(body) for body, group in groups.items() if {"position"} <= set(group.data_vars)]


def facets_of(tree: xr.DataTree, body: str) -> IntArray:
    """Segments (k, 2) of a stored surface; of one in space the triangles (k, 3), made again from the scene as the run made them.

    Raises
    ------
    MpmfwError
        The scene in the file does not give the stored surface back.
    """
    surface = tree[f"surface/{body}"].to_dataset()
    if "next" in surface:
        following = np.asarray(surface["next"].values)
        return np.stack([np.arange(len(following)), following], axis=1)
    made = triangles_of(tree, body)
    if made is None or made.max(initial=-1) + 1 != surface.sizes["surface_node"]:
        raise MpmfwError(
            f"surface of '{body}': its triangles are not in the file, and those of the file's scene do not fit the stored nodes; "
            "is a mesh file that it names another one?"
        )
    return made


def left_out(tree: xr.DataTree, bodies: Sequence[str]) -> list[str]:
    """Names of stored fields that have another form than scalar, vector or tensor of a point."""
    groups = [(f"particles/{body}", "particle") for body in bodies]
    groups += [(f"surface/{body}", "surface_node") for body in surfaces_of(tree)]
    names = [name for place, dim in groups for name in arrays_of(frame_of(tree, place, 0), dim)[1]]
    return [name for name in dict.fromkeys(names) if name not in _GEOMETRY]


def _without_geometry(frame: xr.Dataset) -> dict[str, AnyArray]:
    fields, _ = arrays_of(frame, "surface_node")
    return {name: values for name, values in fields.items() if name not in _GEOMETRY}


def unit_of(tree: xr.DataTree, names: Sequence[str], place: str) -> dict[str, str]:
    """Units of fields by name, those of the declarations; the gap's is m."""
    data = tree[place].to_dataset()
    known = {name: str(data[name].attrs.get("units", "1")) for name in names if name in data.data_vars}
    derived = {"gap": "m", "pressure": "Pa", "friction_share": "1"}
    return {**known, **{name: unit for name, unit in derived.items() if name in names}}
