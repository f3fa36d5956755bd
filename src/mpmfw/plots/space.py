"""Runs as bodies that can be turned: views of 2D and 3D by pyvista (``pip install mpmfw[render]``)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from scipy.spatial import cKDTree

from mpmfw.paraview.meshes import mesh_library
from mpmfw.plots.field_panel import Box, Scales, set_title
from mpmfw.results.domains import corners_of, facets_of, surfaces_of
from mpmfw.results.point_fields import point_field
from mpmfw.results.selection import bodies_of, frame_of, rigid_bodies_of
from mpmfw.state.fields import FloatArray, IntArray

#: Pixels of a picture; length of the longest arrow over the diagonal of all bodies; of the longest rigid body
#: that the picture holds, over that of the others.
_SIZE, _ARROW, _LONG = (1000, 750), 0.15, 5.0


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
        self.space = len(tree["series"].coords["axis"]) == 3
        self.outlined = [body for body in self.names if body in surfaces]
        self._solid = {body for body in self.outlined if self.space or body in self.rigid}
        self._corners = {body: corners_of(tree, body) for body in self.bodies}
        self._nearest = {
            body: cKDTree(frame_of(tree, f"particles/{body}", 0)["position"].values).query(
                self.places(body, 0)[:, : 3 if self.space else 2]
            )[1]
            for body in self._solid - set(self.rigid)
        }

    def places(self, body: str, frame: int) -> FloatArray:
        """Return the points (n, 3) that are drawn of a body at one output [m]."""
        if body in self._solid:
            places = frame_of(self.tree, f"surface/{body}", frame)["position"].values
        else:
            data, corners = frame_of(self.tree, f"particles/{body}", frame), self._corners.get(body)
            places = data["position"].values if corners is None else corners(data)
        return _in_space(places.reshape(-1, places.shape[-1]))

    def facets(self, body: str) -> IntArray | None:
        """Return segments, triangles or quadrilaterals between the points; None of single points."""
        if body in self._solid:
            return facets_of(self.tree, body)
        if self._corners.get(body) is None:
            return None
        return np.arange(len(self.places(body, 0))).reshape(-1, 4)

    def values(self, body: str, field: str, frame: int) -> FloatArray:
        """Return a field of a body at one output, as it is drawn."""
        data = frame_of(self.tree, f"particles/{body}", frame)
        values = np.asarray(point_field(data, field).values, dtype=float)
        return values[self._nearest[body]] if body in self._nearest else values

    def extremes(self, field: str, frames: Iterable[int]) -> tuple[float, float]:
        """Return the least and the largest finite value of a field over some outputs."""
        values = np.concatenate([self.values(body, field, k) for body in self.bodies for k in frames])
        known = values[np.isfinite(values)]
        return (float(known.min()), float(known.max())) if len(known) else (np.nan, np.nan)

    def box(self, frames: Iterable[int]) -> FloatArray:
        """Return the lower and the upper corner (2, 3) of the bodies over some outputs [m].

        Rigid bodies count up to five times the length of the others: a half-space does not.
        """
        frames = list(frames)
        boxes = {}
        for body in self.names:
            places = [self.places(body, frame) for frame in frames]
            boxes[body] = np.array([np.min(places, axis=(0, 1)), np.max(places, axis=(0, 1))])
        own = _around([boxes[body] for body in self.bodies])
        longest = _LONG * np.ptp(own, axis=0).max()
        near = [box for box in boxes.values() if np.ptp(box, axis=0).max() <= longest]
        return _around([own, *near])


class View(Bodies):
    """A plotter with the bodies of one run at one output."""

    def __init__(self, tree: xr.DataTree, bodies: Sequence[str] | None = None) -> None:
        library = mesh_library()
        super().__init__(tree, bodies)
        self.plotter = library.Plotter(off_screen=True, window_size=_SIZE)
        self._start = {body: self.places(body, 0) for body in self.names}
        self.meshes = {body: self._mesh(library, body) for body in self.names}
        for body, mesh in self.meshes.items():
            self.plotter.add_mesh(mesh, color="lightgrey", line_width=3, name=body)
        if self.space:
            self.plotter.view_vector((1.0, 0.7, 1.6), viewup=(0.0, 1.0, 0.0))
        else:
            self.plotter.view_xy()
        self.show_all([0])

    def show_all(self, frames: Iterable[int]) -> None:
        """Move the camera so that the picture holds the bodies at all these outputs."""
        self.plotter.reset_camera(bounds=self.box(frames).T.ravel().tolist())
        self.plotter.camera.zoom(1.2)

    def _mesh(self, library: Any, body: str) -> Any:
        places, facets = self._start[body].copy(), self.facets(body)
        if facets is None:
            return library.PolyData(places)
        if facets.shape[1] == 2:
            return library.PolyData(places, lines=np.insert(facets, 0, 2, axis=1).ravel())
        return library.PolyData.from_regular_faces(places, facets)

    def show(
        self,
        field: str,
        frame: int,
        limits: tuple[float, float],
        *,
        colours: str = "viridis",
        deformation: float = 1.0,
        largest_force: float = 0.0,
    ) -> None:
        """Show an output; displacements times ``deformation``, arrows if ``largest_force`` is positive."""
        for body, mesh in self.meshes.items():
            start = self._start[body]
            mesh.points = start + deformation * (self.places(body, frame) - start)
            if body in self.rigid:
                continue
            mesh[field] = self.values(body, field, frame)
            self.plotter.add_mesh(
                mesh, scalars=field, clim=limits, cmap=colours, name=body, show_scalar_bar=False,
                render_points_as_spheres=True, point_size=8, ambient=0.3, reset_camera=False,
            )  # fmt: skip
        self.plotter.remove_actor("forces")
        if largest_force > 0.0:
            self._add_arrows(frame, deformation, largest_force)

    def largest_force(self, frames: Iterable[int]) -> float:
        """Return the largest contact force on a surface node [N, in 2D N/m]; 0 where none is stored."""
        sizes = [
            np.linalg.norm(self._forces(body, frame), axis=1) for body in self.outlined for frame in frames
        ]
        return float(np.nanmax(np.concatenate(sizes), initial=0.0)) if sizes else 0.0

    def _forces(self, body: str, frame: int) -> FloatArray:
        data = frame_of(self.tree, f"surface/{body}", frame)
        return _in_space(data["force"].values if "force" in data else 0.0 * data["position"].values)

    def _add_arrows(self, frame: int, deformation: float, largest: float) -> None:
        position, force = [], []
        for body in self.outlined:
            first, now = (
                _in_space(frame_of(self.tree, f"surface/{body}", k)["position"].values) for k in (0, frame)
            )
            position.append(first + deformation * (now - first))
            force.append(np.nan_to_num(self._forces(body, frame)))
        vectors = np.concatenate(force)
        acting = np.linalg.norm(vectors, axis=1) > 1e-3 * largest
        if acting.any():
            low, high = self.box([frame])
            longest = _ARROW * float(np.linalg.norm(high - low)) / largest
            centres = np.concatenate(position)[acting]
            self.plotter.add_arrows(centres, longest * vectors[acting], color="#D55E00", name="forces")


def _around(boxes: Sequence[FloatArray]) -> FloatArray:
    return np.array([np.min(boxes, axis=(0, 1)), np.max(boxes, axis=(0, 1))])


def _in_space(places: FloatArray) -> FloatArray:
    return np.pad(np.asarray(places, dtype=float), ((0, 0), (0, 3 - places.shape[1])))


class SpacePanel(View):
    """A field of one run in space, as a picture; used as :class:`mpmfw.plots.field_panel.FieldPanel`."""

    def __init__(self, tree: xr.DataTree, name: str, bodies: Sequence[str] | None = None) -> None:
        super().__init__(tree, bodies)
        self.name = name
        self._drawn: list[Any] = []
        points = tree[f"particles/{self.bodies[0]}"].to_dataset()
        self.about = point_field(points.isel(time=slice(0), missing_dims="ignore"), name).attrs

    def survey(self, frames: Iterable[int]) -> tuple[tuple[float, float], Box]:
        """Return the range of finite values, and the extent of the picture, which shows all the outputs."""
        self.show_all(frames)
        return self.extremes(self.name, frames), (0.0, 1.0, 0.0, _SIZE[1] / _SIZE[0])

    def draw(self, axes: Any, frame: int, scales: Scales, title: str) -> None:
        """Draw another output."""
        low, high = (scales.unit_size * float(end or 0.0) for end in (scales.norm.vmin, scales.norm.vmax))
        self.show(self.name, frame, (low, high), colours=scales.colours, largest_force=scales.largest_force)
        while self._drawn:
            self._drawn.pop().remove()
        extent = [scales.length * value for value in (0.0, 1.0, 0.0, _SIZE[1] / _SIZE[0])]
        self._drawn.append(axes.imshow(self.plotter.screenshot(return_img=True), extent=extent))
        axes.set_axis_off()
        set_title(axes, self.tree, frame, title)
