"""Scalar fields of a run at one output, contact pressure and traction on surface nodes among them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.results.domains import facets_of, surfaces_of
from mpmfw.results.point_fields import CONTACT_FIELDS, point_field
from mpmfw.results.selection import Results, bodies_of, checked_name, frame_at, frame_of, opened_run
from mpmfw.results.stored_scene import scene_of
from mpmfw.state.fields import FloatArray, IntArray
from mpmfw.units import to_si

#: Least cosine between the facet that a node's force presses most and the others that carry this force: of an
#: edge of a block one side does.
LEVEL = 0.7


def field(
    results: Results, name: str = "von_mises", *, time: float | None = None, body: str | None = None
) -> xr.DataArray:
    """Return a scalar field on the material points, or the surface nodes, of a run at one output.

    Parameters
    ----------
    results
        A tree or a file.
    name
        ``von_mises``, ``velocity`` (its magnitude), ``velocity_x``, ``stress_xy`` …; on surface nodes
        ``contact_pressure``, ``contact_traction`` (its magnitude), ``contact_traction_x`` …
    time
        [s]; the nearest output, the last one by default.
    body
        All bodies by default; for fields on surface nodes all that deform.

    Returns
    -------
    xarray.DataArray
        Over ``particle`` or ``surface_node``, with the coordinates ``x``, ``y`` (and ``z``) [m], ``body`` and
        ``time``.

    Raises
    ------
    SceneError
        The field, body or time is missing, or the run keeps neither material points nor contact forces.
    """
    on_nodes = name.startswith(CONTACT_FIELDS)
    group, dim = ("surface", "surface_node") if on_nodes else ("particles", "particle")
    with opened_run(results) as tree:
        index, parts = frame_at(tree, time), []
        for one in (pressed_bodies if on_nodes else bodies_of)(tree, body):
            frame = frame_of(tree, f"{group}/{one}", index)
            fields = contact_fields(tree, one, frame).rename(surface_node="particle") if on_nodes else frame
            values = point_field(fields, name).rename(particle=dim)
            position = frame["position"].values.astype(float)
            coords: dict[str, Any] = {
                axis: (dim, x, {"units": "m"}) for axis, x in zip("xyz", position.T, strict=False)
            }
            names = (dim, [one] * len(position))
            parts.append(values.assign_coords(body=names, time=frame["time"], **coords))
    return xr.concat(parts, dim)


def pressed_bodies(tree: xr.DataTree, selection: str | Sequence[str] | None = None) -> list[str]:
    """Return the bodies with contact forces on surface nodes, by default without rigid ones.

    Raises a SceneError if there is no such body.
    """
    stored = [body for body in surfaces_of(tree) if "force" in tree[f"surface/{body}"].data_vars]
    if not stored:
        expected = "penalty, lcp or another contact on surface nodes, and output.surface = true"
        text = "contact at grid nodes and midplane act at other places"
        raise SceneError(f"the run stored no contact force of surface nodes: {text}; expected {expected}")
    if selection is not None:
        names = [selection] if isinstance(selection, str) else selection
        return [checked_name("body", name, stored) for name in names]
    bodies = scene_of(tree.attrs).get("bodies", {})
    return [body for body in stored if not bodies.get(body, {}).get("rigid")] or stored


def contact_fields(tree: xr.DataTree, body: str, surface: xr.Dataset) -> xr.Dataset:
    """Return contact pressure and traction (surface_node, …) [Pa] of a body at one output of its ``surface``.

    ``contact_pressure`` is −f·n/A, with the outward normal n and the node's tributary area A at this time;
    ``contact_traction`` is (f − (f·n) n)/A. They are summed over pairs, zero without a force, and NaN where A
    is zero. The thickness is the body's, or the largest of the other bodies if that is less.
    """
    scene = scene_of(tree.attrs)
    widths: dict[str, Any] = {
        one: to_si(table.get("thickness", 1.0), "m") for one, table in scene.get("bodies", {}).items()
    }
    own = widths.pop(body, 1.0)
    position, force = (surface[one].values.astype(float) for one in ("position", "force"))
    area, normal = carried_areas(force, position, facets_of(tree, body))
    area = np.where(area > 0.0, area * min(own, max(widths.values(), default=own)), np.nan)
    if scene.get("grid", {}).get("axisymmetric"):  # on the axis as the forces are
        area *= 2.0 * np.pi * np.maximum(position[:, 0], float(tree.attrs["cell_size"]) / 6.0)
    pressing = -(force * normal).sum(axis=1)
    traction = (force + pressing[:, np.newaxis] * normal) / area[:, np.newaxis]
    return xr.Dataset(
        {
            "contact_pressure": ("surface_node", pressing / area, {"units": "Pa"}),
            "contact_traction": (("surface_node", "axis"), traction, {"units": "Pa"}),
        }
    )


def carried_areas(force: FloatArray, position: FloatArray, facets: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return tributary areas (n,) [m^(dim−1)] of surface nodes with forces (n, dim), and outward normals.

    A facet, a segment (k, 2) or a triangle (k, 3), is divided equally among its nodes. A node counts the
    facets that are level with the one that its force presses most.
    """
    dim = position.shape[1]
    corners = position[facets]
    edges = corners[:, 1:] - corners[:, :1]
    if dim == 2:
        vector = np.stack([edges[:, 0, 1], -edges[:, 0, 0]], axis=1)
    else:
        vector = 0.5 * np.cross(edges[:, 0], edges[:, 1])
    unit = vector / np.maximum(np.linalg.norm(vector, axis=1, keepdims=True), np.finfo(float).tiny)
    node, facet = facets.ravel(), np.repeat(np.arange(len(facets)), dim)
    part = vector[facet] / dim
    order = np.argsort(-(force[node] * unit[facet]).sum(axis=1), kind="stable")
    most = np.zeros(len(position), dtype=np.int64)
    most[node[order]] = facet[order]  # the last one stays
    level = (unit[facet] * unit[most[node]]).sum(axis=1) > LEVEL
    area = np.zeros_like(position)
    np.add.at(area, node[level], part[level])
    size = np.linalg.norm(area, axis=1)
    return size, area / np.maximum(size, np.finfo(float).tiny)[:, np.newaxis]
