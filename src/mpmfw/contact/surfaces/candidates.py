"""Candidates of the surface nodes, as one argument of kernels."""

from __future__ import annotations

import numpy as np

from mpmfw.kernels import Struct, device
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import Field


class Candidates(Struct):
    """Up to ``slots`` candidate facets for every surface node, each of another body, and where it was inside
    a step ago."""

    master: Ints  #: (n_s, slots) index of the candidate's body
    facet: Ints  #: (n_s, slots) facet; −1 if none is near
    share: Floats  #: (n_s, slots, dim) barycentric coordinates on it
    gap: Floats  #: (n_s, slots) g_n [m]
    normal: Floats  #: (n_s, slots, dim) e_n
    inside: Ints  #: (n_s, slots) body that the node was inside of in the last step; −1 for none
    inside_facet: Ints  #: (n_s, slots) the facet that it was behind; without nodes where nothing is tracked


def no_candidates(setup: Setup, owner: str, slots: int, *, tracked: bool) -> Candidates:
    """Allocate and list the arrays, without a candidate."""
    arrays = {}
    for name in Candidates.member_names:
        axes = ("axis",) if name in ("share", "normal") else ()
        kind, unit = ("f8", "m" if name == "gap" else "1") if axes or name == "gap" else ("i8", "1")
        field = Field(
            name, ("surface_node", "slot", *axes), unit, "candidates of surface nodes", "surface", kind
        )
        if tracked or not name.startswith("inside"):
            arrays[name] = setup.allocate(owner, field, slot=slots)
        else:
            arrays[name] = np.zeros((0, slots), dtype=kind)
    candidates = Candidates(**arrays)
    for each in (candidates.facet, candidates.master, candidates.inside):
        each.fill(-1)
    return candidates


@device
def put(
    s: int,
    j: int,
    master: int,
    m: int,
    gap: Float,
    share: Floats,
    normal: Floats,
    candidates: Candidates,
    spacing: tuple[float, ...],
) -> None:
    """Write the candidate in slot j of node s: facet m of body ``master``."""
    candidates.master[s, j], candidates.facet[s, j], candidates.gap[s, j] = master, m, gap
    for d in range(len(spacing)):
        candidates.share[s, j, d], candidates.normal[s, j, d] = share[d], normal[d]
