"""Runs as bodies that can be turned: views in 2D and 3D by pyvista (``pip install mpmfw[render]``)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.paraview.meshes import mesh_library
from mpmfw.plots.bodies import Bodies, in_space
from mpmfw.plots.field_panel import Box, Scales, set_title
from mpmfw.results.selection import frame_of

#: Pixels of a picture; length of the longest arrow over the diagonal of all bodies.
_SIZE, _ARROW = (1000, 750), 0.15


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

    def _add_arrows(self, frame: int, deformation: float, largest: float) -> None:
        position, force = [], []
        for body in self.outlined:
            first, now = (
                in_space(frame_of(self.tree, f"surface/{body}", k)["position"].values) for k in (0, frame)
            )
            position.append(first + deformation * (now - first))
            force.append(np.nan_to_num(self.forces(body, frame)))
        vectors = np.concatenate(force)
        acting = np.linalg.norm(vectors, axis=1) > 1e-3 * largest
        if acting.any():
            low, high = self.box([frame])
            longest = _ARROW * float(np.linalg.norm(high - low)) / largest
            centres = np.concatenate(position)[acting]
            self.plotter.add_arrows(centres, longest * vectors[acting], color="#D55E00", name="forces")


class SpacePanel(View):
    """A field of one run in space, as a picture; used as :class:`mpmfw.plots.field_panel.FieldPanel`."""

    def __init__(self, tree: xr.DataTree, name: str, bodies: Sequence[str] | None = None) -> None:
        super().__init__(tree, bodies)
        self.name = name
        self._drawn: list[Any] = []
        self.about = self.attributes(name)

    def survey(self, frames: Iterable[int]) -> tuple[tuple[float, float], Box]:
        """Return the range of finite values, and the extent of the picture, which shows all the outputs."""
        self.show_all(frames)
        return self.extremes(self.name, frames), (0.0, 1.0, 0.0, _SIZE[1] / _SIZE[0])

    def draw(self, axes: Any, frame: int, scales: Scales, title: str) -> None:
        low, high = (scales.unit_size * float(end or 0.0) for end in (scales.norm.vmin, scales.norm.vmax))
        self.show(self.name, frame, (low, high), colours=scales.colours, largest_force=scales.largest_force)
        while self._drawn:
            self._drawn.pop().remove()
        extent = [scales.length * value for value in (0.0, 1.0, 0.0, _SIZE[1] / _SIZE[0])]
        self._drawn.append(axes.imshow(self.plotter.screenshot(return_img=True), extent=extent))
        axes.set_axis_off()
        set_title(axes, self.tree, frame, title)
