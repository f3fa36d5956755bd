"""Runs as bodies that can be turned: pictures by pyvista (``mpmfw[render]``), a page (``mpmfw[view]``)."""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.paraview.exporting import mesh_library
from mpmfw.plots.bodies import Bodies, Box, Scales, colour_range, in_space, set_title
from mpmfw.plots.style import in_brackets
from mpmfw.results.point_fields import point_field, point_fields
from mpmfw.results.selection import Results, chosen_frames, frame_of, opened_run, times_of

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
    """A field of one run in space, as a picture; used as :class:`mpmfw.plots.bodies.FieldPanel`."""

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


class Viewer:
    """A page on which a run can be turned; ``server`` is trame's."""

    def __init__(self, tree: Any, field: str = "von_mises", every: int = 1) -> None:
        app, widgets, vtk, page = _libraries()
        self.view = View(tree)
        self._frames = list(chosen_frames(tree, every))
        self._times = times_of(tree)[self._frames]
        points = frame_of(tree, f"particles/{self.view.bodies[0]}", 0)
        self._labels = {name: point_field(points, name).attrs for name in point_fields(points)}
        point_field(points, field)  # a wrong name lists all
        self._ends: dict[str, tuple[float, float, str]] = {}
        self._force = self.view.largest_force(self._frames)
        self.server = app.get_server("mpmfw", client_type="vue3")
        state = self.server.state
        state.update({"frame": len(self._frames) - 1, "field": field, "deformation": 1.0, "arrows": False})
        state.title = str(tree.attrs.get("title") or "mpmfw")  # as text: a template would run what is in it
        state.fields, state.caption = list(self._labels), ""
        with page(self.server) as layout:
            layout.title.set_text("{{ title }}")
            with layout.toolbar:
                plain = {"hide_details": True, "density": "compact", "style": "max-width: 14em"}
                widgets.VSelect(v_model=("field",), items=("fields",), **plain)
                most = len(self._frames) - 1
                widgets.VSlider(v_model=("frame",), min=0, max=most, step=1, label="time", hide_details=True)
                widgets.VSlider(
                    v_model=("deformation",), min=0, max=20, step=1, label="deformation ×", hide_details=True
                )
                widgets.VCheckbox(v_model=("arrows",), label="forces", disabled=self._force == 0.0, **plain)
            with layout.content, widgets.VContainer(fluid=True, classes="pa-0 fill-height"):
                widgets.VLabel("{{ caption }}", classes="pl-4")
                shown = vtk.VtkLocalView(self.view.plotter.render_window)
        self._update = shown.update
        state.change("frame", "field", "deformation", "arrows")(self._show)
        self._show()

    def _show(self, **_: Any) -> None:
        """Draw what the page's state names."""
        state = self.server.state
        if state.field not in self._ends:
            self._ends[state.field] = colour_range([self.view.extremes(state.field, self._frames)], None)
        low, high, colours = self._ends[state.field]
        self.view.show(
            state.field,
            self._frames[int(state.frame)],
            (low, high),
            colours=colours,
            deformation=float(state.deformation),
            largest_force=self._force if state.arrows else 0.0,
        )
        about = self._labels[state.field]
        time = f"t = {self._times[int(state.frame)]:.4g} s"
        state.caption = f"{time}, {in_brackets(about['long_name'], about['units'])}: {low:.3g} to {high:.3g}"
        self._update()


def view(
    results: Results, field: str = "von_mises", *, every: int = 1, port: int = 0, open_browser: bool = True
) -> None:
    """Serve a page with a run at the loopback address until it is interrupted; print the address.

    It begins with ``field`` and has each ``every``-th output; port 0 takes a free one. A SceneError names a
    missing library, or the fields if ``field`` is unknown.
    """
    with opened_run(results) as tree:
        server = Viewer(tree, field, every).server
        server.controller.on_server_ready.once(
            lambda **_: print(f"http://127.0.0.1:{server.port}/ shows the run until Ctrl-C", flush=True)
        )
        options = {"timeout": 0, "show_connection_info": False}
        server.start(host="127.0.0.1", port=port, open_browser=open_browser, **options)


def _libraries() -> tuple[Any, ...]:
    names = ("pyvista", "trame.app", "trame.widgets.vuetify3", "trame.widgets.vtk", "trame.ui.vuetify3")
    try:
        _, app, widgets, vtk, page = map(importlib.import_module, names)
    except ImportError as error:
        raise SceneError(f"view: {error.name} is missing: pip install 'mpmfw[view]'") from error
    return app, widgets, vtk, page.SinglePageLayout
