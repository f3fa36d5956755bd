"""The bodies of one run at every output, for drawings in the plane and in space."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from scipy.spatial import cKDTree

from mpmfw.results.domains import corners_of, facets_of, surfaces_of
from mpmfw.results.point_fields import point_field
from mpmfw.results.selection import bodies_of, frame_of, rigid_bodies_of
from mpmfw.state.fields import FloatArray, IntArray

#: Length of the longest rigid body that a picture holds, over that of the others.
_LONG = 5.0


class Bodies:
    """The bodies of one run in space: their points, facets and values at every output.

    Solids with a stored surface are drawn as this surface, coloured by the nearest material point. Other
    bodies are drawn as the domains of their points, or as spheres. Rigid bodies have no values.
    """

    def __init__(self, tree: xr.DataTree, bodies: Sequence[str] | None = None) -> None:
        self.tree = tree
        self.bodies, self.rigid = bodies_of(tree, bodies), rigid_bodies_of(tree, bodies)
        self.names = [*self.bodies, *self.rigid]
        surfaces = set(surfaces_of(tree))
        self.space = tree.sizes.get("axis") == 3
        self.outlined = [body for body in self.names if body in surfaces]
        self._solid = {body for body in self.outlined if self.space or body in self.rigid}
        self.corners = {body: corners_of(tree, body) for body in self.bodies}
        self._nearest = {
            body: cKDTree(frame_of(tree, f"particles/{body}", 0)["position"].values).query(
                self.places(body, 0)[:, : 3 if self.space else 2]
            )[1]
            for body in self._solid - set(self.rigid)
        }

    def places(self, body: str, frame: int) -> FloatArray:
        """Return the drawn points (n, 3) of a body at one output [m]."""
        if body in self._solid:
            places = frame_of(self.tree, f"surface/{body}", frame)["position"].values
        else:
            data, corners = frame_of(self.tree, f"particles/{body}", frame), self.corners.get(body)
            places = data["position"].values if corners is None else corners(data)
        return in_space(places.reshape(-1, places.shape[-1]))

    def facets(self, body: str) -> IntArray | None:
        """Return segments, triangles or quadrilaterals between the points; None for single points."""
        if body in self._solid:
            return facets_of(self.tree, body)
        if self.corners.get(body) is None:
            return None
        return np.arange(len(self.places(body, 0))).reshape(-1, 4)

    def attributes(self, field: str) -> dict[Any, Any]:
        """Return ``long_name`` and ``units`` of a field."""
        points = self.tree[f"particles/{self.bodies[0]}"].to_dataset()
        return point_field(points.isel(time=slice(0), missing_dims="ignore"), field).attrs

    def values(self, body: str, field: str, frame: int) -> FloatArray:
        """Return a field of a body at one output, as it is drawn."""
        data = frame_of(self.tree, f"particles/{body}", frame)
        values = np.asarray(point_field(data, field).values, dtype=float)
        return values[self._nearest[body]] if body in self._nearest else values

    def extremes(self, field: str, frames: Iterable[int]) -> tuple[float, float]:
        """Return the least and the largest finite value of a field over some outputs."""
        every = (self.values(body, field, frame) for frame in frames for body in self.bodies)
        known = (values[np.isfinite(values)] for values in every)
        ends = np.array([[values.min(), values.max()] for values in known if len(values)])
        return (float(ends.min()), float(ends.max())) if len(ends) else (np.nan, np.nan)

    def box(self, frames: Iterable[int]) -> FloatArray:
        """Return the lower and the upper corner (2, 3) of the bodies over some outputs [m].

        Rigid bodies count up to five times the length of the others: a half-space does not.
        """
        frames = list(frames)
        boxes = {}
        for body in self.names:
            places = (self.places(body, frame) for frame in frames)
            boxes[body] = _around([np.array([each.min(axis=0), each.max(axis=0)]) for each in places])
        own = _around([boxes[body] for body in self.bodies])
        longest = _LONG * np.ptp(own, axis=0).max()
        near = [box for box in boxes.values() if np.ptp(box, axis=0).max() <= longest]
        return _around([own, *near])

    @property
    def stores_force(self) -> bool:
        """Return True if contact forces on surface nodes are stored."""
        return any("force" in self.tree[f"surface/{body}"].data_vars for body in self.outlined)

    def largest_force(self, frames: Iterable[int]) -> float:
        """Return the largest contact force on a surface node [N, in 2D N/m]; 0 where none is stored."""
        sizes = [
            np.linalg.norm(self.forces(body, frame), axis=1) for body in self.outlined for frame in frames
        ]
        return float(np.nanmax(np.concatenate(sizes), initial=0.0)) if sizes else 0.0

    def forces(self, body: str, frame: int) -> FloatArray:
        """Return contact forces on the surface nodes of a body (n, 3); 0 where none is stored."""
        data = frame_of(self.tree, f"surface/{body}", frame)
        return in_space(data["force"].values if "force" in data else 0.0 * data["position"].values)


def _around(boxes: Sequence[FloatArray]) -> FloatArray:
    return np.array([np.min(boxes, axis=(0, 1)), np.max(boxes, axis=(0, 1))])


def in_space(places: FloatArray) -> FloatArray:
    """Return points (n, dim) with zeros to (n, 3)."""
    return np.pad(np.asarray(places, dtype=float), ((0, 0), (0, 3 - places.shape[1])))
