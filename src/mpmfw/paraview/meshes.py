"""One output as meshes: material points as vertices or domains, surfaces as closed lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import meshio
import numpy as np
import xarray as xr

from mpmfw.domains import Domains
from mpmfw.fields import AnyArray, IntArray
from mpmfw.outputs import frame_of
from mpmfw.paraview.arrays import arrays_of, stacked, vectors
from mpmfw.paraview.gaps import surface_gaps

#: What the results call the geometry, which is that of the mesh and no field beside it.
_GEOMETRY = ("position", "corners", "next")


def points_mesh(
    tree: xr.DataTree, bodies: Mapping[str, int], domains: Mapping[str, Domains | None], frame: int
) -> meshio.Mesh:
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
        cell_data = {name: [values] for name, values in {"body": owner, **fields}.items()}
        return meshio.Mesh(vectors(corners.reshape(-1, 2)), [("quad", quads)], cell_data=cell_data)
    position = fields.pop("position")
    vertices = np.arange(len(position))[:, None]
    return meshio.Mesh(
        position, [("vertex", vertices)], point_data={"body": owner, **fields}, cell_data={"body": [owner]}
    )


def surface_mesh(tree: xr.DataTree, bodies: Mapping[str, int], frame: int) -> meshio.Mesh:
    """Surfaces of the bodies at one output as segments, with the gap at every surface node."""
    everywhere = {body: frame_of(tree, f"surface/{body}", frame) for body in surfaces_of(tree)}
    lines = {
        body: (np.asarray(data["position"].values, dtype=float), data["next"].values)
        for body, data in everywhere.items()
    }
    gaps = surface_gaps(lines)
    own = [body for body in everywhere if body in bodies]
    counts = [len(gaps[body]) for body in own]
    fields = stacked([{**_without_geometry(everywhere[body]), "gap": gaps[body]} for body in own], counts)
    owner = np.repeat(np.array([bodies[body] for body in own]), counts)
    return meshio.Mesh(
        vectors(np.concatenate([lines[body][0] for body in own])),
        [("line", _segments([lines[body][1] for body in own]))],
        point_data={"body": owner, **fields},
        cell_data={"body": [owner]},
    )


def surfaces_of(tree: xr.DataTree) -> list[str]:
    """Bodies whose surfaces are stored."""
    if "surface" not in tree.children:
        return []
    groups = tree["surface"].children
    return [str(body) for body, group in groups.items() if {"position", "next"} <= set(group.data_vars)]


def left_out(tree: xr.DataTree, bodies: Sequence[str]) -> list[str]:
    """Names of stored fields that have another form than scalar, vector or tensor of a point."""
    groups = [(f"particles/{body}", "particle") for body in bodies]
    groups += [(f"surface/{body}", "surface_node") for body in surfaces_of(tree)]
    names = [name for place, dim in groups for name in arrays_of(frame_of(tree, place, 0), dim)[1]]
    return [name for name in dict.fromkeys(names) if name not in _GEOMETRY]


def _without_geometry(frame: xr.Dataset) -> dict[str, AnyArray]:
    fields, _ = arrays_of(frame, "surface_node")
    return {name: values for name, values in fields.items() if name not in _GEOMETRY}


def _segments(following: list[IntArray]) -> IntArray:
    """Segments (s, 2) as start and end, over the nodes of all bodies."""
    start = np.cumsum([0, *(len(one) for one in following)])
    ends: IntArray = np.concatenate([one + begin for one, begin in zip(following, start, strict=False)])
    return np.stack([np.arange(len(ends)), ends], axis=1)


def unit_of(tree: xr.DataTree, names: Sequence[str], place: str) -> dict[str, str]:
    """Units of fields by name, those of the declarations; the gap's is m."""
    data = tree[place].to_dataset()
    known = {name: str(data[name].attrs.get("units", "1")) for name in names if name in data.data_vars}
    return {**known, **({"gap": "m"} if "gap" in names else {})}
