"""Arrays of the search as arguments of kernels: candidates of the surface nodes, and linked lists on the
background grid."""

from __future__ import annotations

import numpy as np

from mpmfw.kernels import Struct, device
from mpmfw.kernels.types import Float, Floats, Indices, Ints
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


class SearchGrid(Struct):
    """Marks and linked lists on the background grid; stamps that grow spare clearing them."""

    lower: Floats  #: (dim,) position of the grid's first node [m]
    nodes: Ints  #: (dim,) number of nodes of the grid
    owner: Ints  #: (n_nodes,) stamp and body of the first surface that reached the node
    shared: Ints  #: (n_nodes,) stamp of the last step in which two surfaces reached it
    head: Ints  #: (n_nodes,) first entry of the cell's list
    head_stamp: Ints  #: (n_nodes,)
    head_body: Ints  #: (n_nodes,) body of all facets of the list, −1 where there are several
    link: Indices  #: (n_entries,) next entry
    link_facet: Indices  #: (n_entries,) facet
    link_body: Indices  #: (n_entries,) its body
    near: Indices  #: (n_f,) facets in their bodies' near boxes, the first ``near_count[0]`` of them
    near_count: Ints  #: (1,)
    facet_lower: Floats  #: (n_f, dim) bounding boxes of those facets [m]
    facet_upper: Floats  #: (n_f, dim) [m]
    box_lower: Floats  #: (n_bodies, dim) [m]
    box_upper: Floats  #: (n_bodies, dim) [m]
    near_lower: Floats  #: (n_bodies, dim) box of what of the body may be near another [m]
    near_upper: Floats  #: (n_bodies, dim) [m]


#: Dimensions, type and unit of the arrays of :class:`SearchGrid` that belong to the search.
ARRAYS = {
    **dict.fromkeys(("owner", "shared", "head", "head_stamp", "head_body"), (("grid_node",), "i8", "1")),
    **dict.fromkeys(("link", "link_facet", "link_body"), (("entry",), "i4", "1")),
    "near": (("facet",), "i4", "1"),
    "near_count": (("one",), "i8", "1"),
    **dict.fromkeys(("facet_lower", "facet_upper"), (("facet", "axis"), "f8", "m")),
    **dict.fromkeys(("box_lower", "box_upper", "near_lower", "near_upper"), (("body", "axis"), "f8", "m")),
}


def no_lists(setup: Setup, owner: str) -> SearchGrid:
    """Allocate and list the arrays of the search, without marks."""
    grid, surface = setup.state.grid, setup.state.surface
    facets = 0 if surface is None else len(surface.facets)
    sizes = {"grid_node": int(np.prod(grid.nodes)), "facet": facets, "entry": 4 * facets, "one": 1}
    arrays = {
        name: setup.allocate(
            owner, Field(name, dims, unit, "search for near facets", "contact", kind), **sizes
        )
        for name, (dims, kind, unit) in ARRAYS.items()
    }
    return SearchGrid(lower=grid.lower, nodes=grid.nodes, **arrays)
