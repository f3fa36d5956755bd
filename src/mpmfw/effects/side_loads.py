"""Pressure, traction and total force on the sides of a body, constant or changing in time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.plugin.load import LoadedFacets, SurfaceLoad
from mpmfw.plugin.setup import FLAT, Acts, Setup
from mpmfw.state.fields import FloatArray, IntArray
from mpmfw.state.structs import Body
from mpmfw.units import TimeTable

if TYPE_CHECKING:
    from mpmfw.scene.tables import Side


class SideLoad(SurfaceLoad):
    """Traction on the facets that lie on a side of the body at the start."""

    def __init__(self, body: Body, side: Side, facets: IntArray) -> None:
        super().__init__()
        self.key = next(key for key in ("pressure", "traction", "force") if getattr(side, key) is not None)
        self.name = self.title = f"{self.key} on {body.name} {side.side}"  # type: ignore[misc]
        self.bodies, self.facets = (body,), facets
        self.table = TimeTable.of(getattr(side, self.key))

    @property
    def ledger_term(self) -> tuple[str, str]:
        """Term of the energy ledger, and what does the work."""
        return "external", "loads on sides"

    def traction(self, facets: LoadedFacets, time: float) -> FloatArray:
        """−p n, t, or F / Σ A: a force keeps its sum whatever becomes of the side."""
        value = self.table.at(time)
        if self.key == "pressure":
            return -value * facets.normal
        return np.tile(value if self.key == "traction" else value / facets.area.sum(), (len(facets.area), 1))


def from_setup(setup: Setup) -> Acts:
    """Return the loaded sides; refuse one without a facet."""
    surface, loads = setup.state.tracked_surface, []
    for body, side in setup.loaded_sides:
        normal, place = setup.face_of(body, side)
        own = surface.facets_of(body.index)
        at_side = np.abs(surface.position @ normal - place) <= FLAT * setup.cell_size
        on_side = np.flatnonzero(at_side[surface.facets[own]].all(axis=1))
        loaded = np.asarray(own.start + on_side, dtype=np.int64)
        if len(loaded) == 0:
            raise SceneError(
                f"no surface facet lies on the side '{side.side}'", key=f"bodies.{body.name}.sides"
            )
        loads.append(SideLoad(body, side, loaded))
    sides = ", ".join(f"{body.name} {side.side}" for body, side in setup.loaded_sides)
    return Acts(sides, loads)
