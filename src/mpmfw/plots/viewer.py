"""A run in the browser: time, field, deformation and contact forces (``pip install mpmfw[view]``)."""

from __future__ import annotations

import importlib
from typing import Any

from mpmfw.errors import SceneError
from mpmfw.plots.field_figure import colour_range
from mpmfw.plots.space import View
from mpmfw.plots.style import in_brackets
from mpmfw.results.point_fields import point_field, point_fields
from mpmfw.results.selection import Results, chosen_frames, frame_of, opened_run, times_of


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

    It begins with ``field`` and has each ``every``-th output; port 0 takes a free one. A SceneError names the
    library that is missing, or the fields if there is no such field.
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
