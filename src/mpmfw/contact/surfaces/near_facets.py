"""Facets near every node, listed once and looked through as long as no body has moved far since (L. Verlet,
1967)."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.contact.surfaces.candidates import Candidates, SearchGrid
from mpmfw.contact.surfaces.cells import cell_beside, cell_of, flat_index, outside_near, tagged
from mpmfw.contact.surfaces.facing import turn_to_facing
from mpmfw.contact.surfaces.outline import Outline, square_of
from mpmfw.contact.surfaces.search import (
    begin_with_last,
    outside_box,
    reach_of,
    reach_towards,
    search_facet,
)
from mpmfw.kernels import Struct, device, kernel, scratch
from mpmfw.kernels.facets import read_point
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw.state.fields import IntArray

#: How far beyond what a node's search needs facets are listed, in cells: the motion that a list outlasts.
SKIN = 0.1

#: Steps like the last that a list must outlast to be worth its making.
WORTH = 6

#: What the lists answer where bodies have moved too far since they were made.
STALE = -(2**62)


class Listed(Struct):
    """The lists of all nodes, one after the other, and where the nodes were."""

    first: Ints  #: (n_s + 1,) entries of node s are ``first[s]:first[s + 1]``
    facet: Indices  #: (n,) facet
    away: Floats  #: (n,) its distance from the node [m]
    cutoff: Floats  #: (n_s,) distance within which all facets are listed [m]
    position: Floats  #: (n_s, dim) [m]
    moved: Floats  #: (n_bodies,) how far any node of the body has moved since [m]


@device
def list_cell(
    s: int, cell: int, count: int, outline: Outline, rank: Ints, grid: SearchGrid, near: Listed,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Add the facets of a cell that are within the cutoff of node s, each once; the number of entries, stored
    or not."""
    x, mine, cutoff = scratch.vector(spacing), outline.body[s], near.cutoff[s]
    read_point(s, outline.position, x, spacing)
    entry = grid.head[cell]
    while entry >= 0:
        m, other = grid.link_facet[entry], grid.link_body[entry]
        entry = grid.link[entry]
        if other == mine or rank[mine] > rank[other]:
            continue
        if outside_box(x, grid.facet_lower[m], grid.facet_upper[m], cutoff, spacing):
            continue
        known = False
        for k in range(near.first[s], min(count, len(near.facet))):
            known = known or near.facet[k] == m
        if known:
            continue
        square = square_of(s, m, outline, spacing)
        if square <= cutoff * cutoff:
            if count < len(near.facet):
                near.facet[count], near.away[count] = m, math.sqrt(square)
            count += 1
    return count


@kernel
def list_near(
    stamp: int, radius: float, skin: float, outline: Outline, rank: Ints, grid: SearchGrid,
    candidates: Candidates,
    near: Listed, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """List for every node the facets of other bodies within the distance of its candidate, or the ``radius``,
    and a ``skin``.

    The cells' lists are those of boxes widened by the skin (:func:`.search.list_facets`).

    Returns
    -------
    Number of entries, stored or not.
    """
    count = 0
    x, lower, upper = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    own, index = scratch.integers(spacing), scratch.integers(spacing)
    for s in range(len(outline.body)):
        near.first[s] = count
        read_point(s, outline.position, x, spacing)
        if outside_near(outline.body[s], x, x, grid, spacing):
            continue
        for d in range(len(spacing)):
            own[d] = cell_of(x[d], d, grid, spacing)
        if not tagged(flat_index(own, grid, spacing), stamp, grid, spacing):
            continue
        near.cutoff[s] = reach_of(s, radius, candidates) + skin
        for code in range(3 ** len(spacing)):
            cell = cell_beside(own, code, index, grid, spacing)
            if cell < 0 or grid.head_stamp[cell] != stamp or grid.head_body[cell] == outline.body[s]:
                continue
            for d in range(len(spacing)):
                lower[d] = grid.lower[d] + index[d] * spacing[0]
                upper[d] = lower[d] + spacing[0]
            if not outside_box(x, lower, upper, near.cutoff[s] * (1.0 + 1e-9), spacing):
                count = list_cell(s, cell, count, outline, rank, grid, near, spacing)
    near.first[len(outline.body)] = count
    return count


@kernel
def measure_motion(outline: Outline, near: Listed) -> float:
    """How far any node of each body has moved since the lists were made, into ``near.moved``; the sum of the
    two largest [m]."""
    most, second = 0.0, 0.0
    for b in range(len(near.moved)):
        square = 0.0
        for s in range(outline.body_first[b], outline.body_first[b + 1]):
            way = 0.0
            for d in range(outline.position.shape[1]):
                way += (outline.position[s, d] - near.position[s, d]) ** 2
            square = max(square, way)
        near.moved[b] = math.sqrt(square)
        second = max(second, min(most, near.moved[b]))
        most = max(most, near.moved[b])
    return most + second


@device
def search_list(
    s: int, radius: Float, outline: Outline, near: Listed, candidates: Candidates, spacing: tuple[float, ...]
) -> None:
    """Compare node s with the facets of its list that may have come within what is found."""
    mine = outline.body[s]
    for k in range(near.first[s], near.first[s + 1]):
        m = near.facet[k]
        other = outline.body[outline.facets[m, 0]]
        least = near.away[k] - near.moved[mine] - near.moved[other]
        if least <= reach_towards(s, other, radius, candidates):
            search_facet(s, m, other, radius, outline, candidates, spacing)


@kernel
def find_listed(
    radius: float, motion: float, outline: Outline, rank: Ints, near: Listed, candidates: Candidates,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """The candidates that :func:`.search.find_pairs` finds, from the lists.

    ``motion`` is the farthest that two bodies have moved against each other since the lists were made [m].

    Returns
    -------
    What :func:`.search.find_pairs` does; :data:`STALE` where a facet that is not listed may be closer than
    what was found.
    """
    count = 0
    for s in range(len(outline.body)):
        if near.first[s] == near.first[s + 1]:
            for j in range(candidates.facet.shape[1]):
                candidates.facet[s, j] = -1
            continue
        begin_with_last(s, radius, outline, rank, candidates, spacing)
        search_list(s, radius, outline, near, candidates, spacing)
        if reach_of(s, radius, candidates) > near.cutoff[s] - motion:
            return STALE
        if not turn_to_facing(s, radius, outline, candidates, spacing):
            return -1 - s
        for j in range(candidates.facet.shape[1]):
            if candidates.facet[s, j] >= 0:
                count += 1
    return count


class NearFacets:
    """The lists, and whether they hold.

    Parameters
    ----------
    outline, rank
        The surfaces, and the bodies' ranks as slaves and masters.
    radius, spacing
        Of the search [m], and the cell size once for each dimension.
    """

    def __init__(self, outline: Outline, rank: IntArray, radius: float, spacing: tuple[float, ...]) -> None:
        self.outline, self.rank, self.radius, self.spacing = outline, rank, radius, spacing
        self.skin, self.made = SKIN * spacing[0], False
        n = len(outline.body)
        self.near = Listed(
            first=np.zeros(n + 1, dtype=np.int64),
            facet=np.zeros(n, dtype=np.int32),
            away=np.zeros(n),
            cutoff=np.zeros(n),
            position=np.zeros_like(outline.position),
            moved=np.zeros(len(outline.body_first) - 1),
        )

    def forget(self) -> None:
        """Other bodies are near: the lists hold no more."""
        self.made = False

    def find(self, candidates: Candidates) -> int:
        """Number of candidates, −1 − s where a corner near node s has too many facets, or :data:`STALE`."""
        if not self.made:
            return STALE
        motion = measure_motion(self.outline, self.near)
        count = STALE
        if motion <= self.skin:
            count = find_listed(
                self.radius, motion, self.outline, self.rank, self.near, candidates, self.spacing
            )
        self.made = count != STALE
        return count

    def margin(self) -> float:
        """The skin [m], or 0 where bodies move so fast that lists are not worth their making."""
        return self.skin if 2.0 * WORTH * np.abs(self.outline.displacement).max() <= self.skin else 0.0

    def make(self, stamp: int, lists: SearchGrid, candidates: Candidates) -> None:
        """List the facets near the nodes, after the search has found the candidates with boxes widened by the
        skin."""
        while True:
            entries = list_near(
                stamp, self.radius, self.skin, self.outline, self.rank, lists, candidates, self.near,
                self.spacing
            )  # fmt: skip
            if entries <= len(self.near.facet):
                break
            self.near.set(facet=np.zeros(2 * entries, dtype=np.int32), away=np.zeros(2 * entries))
        self.near.position[:] = self.outline.position
        self.made = True
