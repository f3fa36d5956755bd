"""Arrays of the search as arguments of kernels: candidates of the surface nodes, and linked lists on the background grid."""

from __future__ import annotations

import numpy as np

from mpmfw.kernels import Struct, device
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import Field


class Candidates(Struct):
    """Up to ``slots`` candidate facets for every surface node, each of another body, and where it was inside a step ago."""

    master: Ints  #: (n_s, slots) index of the candidate's body
    facet: Ints  #: (n_s, slots) facet; −1 if none is near
    share: Floats  #: (n_s, slots, dim) barycentric coordinates on it
    gap: Floats  #: (n_s, slots) g_n [m]
    normal: Floats  #: (n_s, slots, dim) e_n
    inside: Ints  #: (n_s, slots) body that the node was inside of in the last step; −1 for none
    inside_facet: Ints  #: (n_s, slots) the facet that it was behind; without nodes where nothing is tracked


def no_candidates(setup: Setup, owner: str, slots: int, *, tracked: bool) -> Candidates:
    """Allocate and list the arrays, without a candidate."""

    def array(
        name: str, unit: str, meaning: str, dtype: str = "i8", dims: tuple[str, ...] = ()
    ) -> np.ndarray:
        field = Field(name, ("surface_node", "slot", *dims), unit, meaning, "surface", dtype)
        return setup.allocate(owner, field, slot=slots)

    def none() -> np.ndarray:
        return np.full((0, slots), -1)

    candidates = Candidates(
        master=array("master", "1", "body of the candidate"),
        facet=array("facet", "1", "closest facet"),
        share=array("share", "1", "barycentric coordinates on the facet", "f8", ("axis",)),
        gap=array("gap", "m", "normal gap", "f8"),
        normal=array("normal", "1", "direction of the normal force", "f8", ("axis",)),
        inside=array("inside", "1", "body that the node was inside of") if tracked else none(),
        inside_facet=array("inside_facet", "1", "facet that it was behind") if tracked else none(),
    )
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


def no_lists(setup: Setup, owner: str) -> SearchGrid:
    """Allocate and list the arrays of the search, without marks."""
    grid, surface = setup.state.grid, setup.state.surface
    facets = 0 if surface is None else len(surface.facets)
    sizes = {"grid_node": int(np.prod(grid.nodes)), "facet": facets, "entry": 4 * facets, "one": 1}

    def array(name: str, dims: tuple[str, ...], meaning: str, dtype: str, unit: str = "1") -> np.ndarray:
        return setup.allocate(owner, Field(name, dims, unit, meaning, "contact", dtype), **sizes)

    node, entry, body, facet = ("grid_node",), ("entry",), ("body", "axis"), ("facet", "axis")
    return SearchGrid(
        lower=grid.lower,
        nodes=grid.nodes,
        owner=array("owner", node, "first body whose surface reached the node", "i8"),
        shared=array("shared", node, "stamp of nodes reached by two surfaces", "i8"),
        head=array("head", node, "first entry of the cell's list of facets", "i8"),
        head_stamp=array("head_stamp", node, "stamp of the list", "i8"),
        head_body=array("head_body", node, "body of all facets of the list, or -1", "i8"),
        link=array("link", entry, "next entry of the list", "i4"),
        link_facet=array("link_facet", entry, "facet of the entry", "i4"),
        link_body=array("link_body", entry, "its body", "i4"),
        near=array("near", ("facet",), "facets in their bodies' near boxes", "i4"),
        near_count=array("near_count", ("one",), "number of those facets", "i8"),
        facet_lower=array("facet_lower", facet, "lower corner of such a facet's bounding box", "f8", "m"),
        facet_upper=array("facet_upper", facet, "upper corner of such a facet's bounding box", "f8", "m"),
        box_lower=array("box_lower", body, "lower corner of the body's bounding box", "f8", "m"),
        box_upper=array("box_upper", body, "upper corner of the body's bounding box", "f8", "m"),
        near_lower=array("near_lower", body, "lower corner of what may be near another body", "f8", "m"),
        near_upper=array("near_upper", body, "upper corner of what may be near another body", "f8", "m"),
    )
