"""Pressure, traction and total force on the sides of a body, constant or changing in time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mpmfw.errors import SceneError
from mpmfw.plugin.load import LoadedFacets, SurfaceLoad
from mpmfw.plugin.setup import FLAT, Acts, Setup
from mpmfw.scene.bodies import AXIS
from mpmfw.state.fields import FloatArray, IntArray
from mpmfw.state.structs import Body
from mpmfw.units import TimeTable

if TYPE_CHECKING:
    from mpmfw.scene.bodies import Side


class SideLoad(SurfaceLoad):
    """Traction on the facets that lie on a side of the body at the start, or bound it outside or inside."""

    def __init__(self, body: Body, side: Side, facets: IntArray) -> None:
        super().__init__()
        self.key = next(key for key in ("pressure", "traction", "force") if getattr(side, key) is not None)
        self.name = self.title = f"{self.key} on {body.name} {_part(side)}"  # type: ignore[misc]
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
        over = 1.0 if self.key == "traction" else facets.area.sum() or np.inf  # no part of the side is left
        return np.tile(value / over, (len(facets.area), 1))


def from_setup(setup: Setup) -> Acts:
    """Return the loaded sides; refuse one without a facet."""
    surface, loads = setup.state.tracked_surface, []
    for body, side in setup.loaded_sides:
        own = surface.facets_of(body.index)
        if side.side in AXIS:
            normal, place = setup.face_of(body, side)
            at_side = np.abs(surface.position @ normal - place) <= FLAT * setup.cell_size
            on_side = np.flatnonzero(at_side[surface.facets[own]].all(axis=1))
        else:
            on_side = _facets_of_part(setup, surface.facets[own], inner=side.side == "inner")
        loaded = np.asarray(own.start + on_side, dtype=np.int64)
        if side.within is not None:
            centre = surface.position[surface.facets[loaded]].mean(axis=1)
            loaded = loaded[((centre >= side.within[0]) & (centre <= side.within[1])).all(axis=1)]
        if len(loaded) == 0:
            raise SceneError(
                f"no surface facet lies on the side {_part(side)}", key=f"bodies.{body.name}.sides"
            )
        loads.append(SideLoad(body, side, loaded))
    sides = ", ".join(f"{body.name} {_part(side)}" for body, side in setup.loaded_sides)
    return Acts(sides, loads)


def _part(side: Side) -> str:
    """Return the name of a side, with the box within which it is loaded."""
    return side.side if side.within is None else f"{side.side} within {side.within}"


def _facets_of_part(setup: Setup, facets: IntArray, *, inner: bool) -> IntArray:
    """Return the facets of the closed parts of a surface (k, dim) that bound the body outside, or its holes.

    ∮ x·n dS of a part is positive or negative. The axis of revolution is not a part, and ends none: x·n is 0.
    """
    surface = setup.state.tracked_surface
    corners = surface.position[facets]
    kept = np.ones(len(facets), dtype=bool)
    if setup.state.grid.axisymmetric:
        kept[:] = (corners[:, :, 0] > FLAT * setup.cell_size).any(axis=1)
    first, then = facets[kept, :-1].ravel(), facets[kept, 1:].ravel()
    shape = (len(surface.position),) * 2
    _, part = connected_components(coo_array((np.ones(len(first)), (first, then)), shape), directed=False)
    part = part[facets[:, 0]]
    content = np.bincount(part, np.where(kept, np.linalg.det(corners), 0.0))[part]
    return np.flatnonzero(kept & ((content < 0.0) if inner else (content > 0.0)))
