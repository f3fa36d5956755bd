"""Facets near every surface node, or near every facet, listed once and used until bodies have moved far.

The lists are those of L. Verlet (1967), found by boxes of bodies and of blocks of facets.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np

from mpmfw.kernels import Struct, device, kernel, scratch
from mpmfw.kernels.contact import pair_table
from mpmfw.kernels.facets import (
    Boxes,
    bounding_boxes,
    boxes_apart,
    read_box,
    square_between,
)
from mpmfw.kernels.surfaces import BLOCK
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, IntArray
from mpmfw.state.structs import State, Surface


class Partners(Struct):
    """Bodies that each body is searched against, in ascending order."""

    first: Ints  #: (n_bodies + 1,) partners of body a are ``body[first[a]:first[a + 1]]``
    body: Ints  #: (n,)
    last: Ints  #: (n,) scratch: end of the chosen blocks of each


def partners_of(first: IntArray, second: IntArray, rank: IntArray) -> Partners:
    """Return each body's partners of no lower ``rank`` (body,), of the pairs ``first``, ``second``."""
    body, other = np.concatenate([first, second]), np.concatenate([second, first])
    searched = rank[body] <= rank[other]
    body, other = body[searched], other[searched]
    body, other = np.divmod(np.unique(body * len(rank) + other), len(rank))
    first = np.searchsorted(body, np.arange(len(rank) + 1))
    return Partners(first=first, body=other, last=np.zeros_like(first, shape=len(other)))


@kernel
def near_boxes(first: Ints, second: Ints, reach: float, outline: Surface, boxes: Boxes) -> bool:
    """Fill the boxes of all bodies; return true if those of any pair are within ``reach`` [m]."""
    bounding_boxes(outline.body_first, outline.position, boxes.lower, boxes.upper)
    near = False
    for c in range(len(first)):
        near = near or not boxes_apart(first[c], second[c], boxes.lower, boxes.upper, reach)
    return near


#: How far beyond the search radius facets are listed, in cells.
SKIN = 0.2


class NearFacets(Struct):
    """Facets near n items, which are nodes or facets, one item after the other."""

    first: Ints  #: (n + 1,) entries of item i are ``first[i]:first[i + 1]``
    facet: Indices  #: (m,) facet of another body, body by body; in the plane they ascend
    away: Floats  #: (m,) distance of its box from that of the item when it was listed [m]
    moved: Floats  #: (n_bodies,) how far any node of the body has moved since [m]


class FacetBoxes(Struct):
    """Boxes of facets, and of blocks of them in an order of which neighbours lie near each other."""

    order: Ints  #: (n_f,) facets, body by body; in the plane they ascend
    begin: Ints  #: (n + 1,) block k has the facets ``order[begin[k]:begin[k + 1]]``
    first: Ints  #: (n_bodies + 1,) blocks of body b are ``first[b]:first[b + 1]``
    facet: Floats  #: (n_f, 2, dim) lower and upper corner, in that order [m]
    block: Floats  #: (n, 2, dim) lower and upper corner [m]
    chosen: Ints  #: (n,) scratch: blocks near a body


def boxes_of(outline: Surface, facets: IntArray, cell_size: float) -> FacetBoxes:
    """Return boxes to be filled, of ``BLOCK`` of the ``facets`` that lie in one cell or in cells side by
    side."""
    (n_facets,), dim, body = facets.shape, outline.facets.shape[1], outline.body[outline.facets[facets, 0]]
    order, first = facets, np.searchsorted(body, np.arange(len(outline.facet_first)))
    if dim == 3:
        cells = np.floor(outline.position[outline.facets[facets]].mean(axis=1) / cell_size)
        order = facets[np.lexsort((*cells.T, body))]
    begin = np.concatenate([*(np.arange(*ends, BLOCK) for ends in pairwise(first)), [n_facets]])
    return FacetBoxes(
        order=order, begin=begin, first=np.searchsorted(begin, first), facet=np.zeros((n_facets, 2, dim)),
        block=np.zeros((len(begin) - 1, 2, dim)), chosen=np.zeros(len(begin), dtype=np.int64),
    )  # fmt: skip


@device
def write_boxes(outline: Surface, boxes: FacetBoxes, spacing: tuple[float, ...]) -> None:
    """Write the boxes of all facets and blocks."""
    for block in range(len(boxes.block)):
        lower, upper, begin = boxes.block[block, 0], boxes.block[block, 1], boxes.begin[block]
        for k in range(begin, boxes.begin[block + 1]):
            low, high = boxes.facet[k, 0], boxes.facet[k, 1]
            read_box(boxes.order[k], outline.facets, outline.position, low, high, spacing)
            for d in range(len(spacing)):
                lower[d] = low[d] if k == begin else min(lower[d], low[d])
                upper[d] = high[d] if k == begin else max(upper[d], high[d])


@device
def list_block(
    block: int, lower: Floats, upper: Floats, limit: Float, count: int, boxes: FacetBoxes, near: NearFacets,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Add facets of a block whose squared distance from a box is at most ``limit`` [m²]; return the number,
    stored or not."""
    if square_between(lower, upper, boxes.block[block, 0], boxes.block[block, 1], spacing) > limit:
        return count
    for k in range(boxes.begin[block], boxes.begin[block + 1]):
        square = square_between(lower, upper, boxes.facet[k, 0], boxes.facet[k, 1], spacing)
        if square <= limit:
            if count < len(near.facet):
                near.facet[count], near.away[count] = boxes.order[k], math.sqrt(square)
            count += 1
    return count


@kernel
def list_near(
    items: Ints, item_first: Ints, cutoff: float, outline: Surface, bodies: Boxes, partners: Partners,
    boxes: FacetBoxes, near: NearFacets, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """List for every item the facets of its body's partners within ``cutoff`` [m]; return the number of
    entries, stored or not."""
    count, limit, chosen, last = 0, cutoff * cutoff, boxes.chosen, partners.last
    lower, upper = scratch.vector(spacing), scratch.vector(spacing)
    write_boxes(outline, boxes, spacing)
    for a in range(len(item_first) - 1):
        top, low, high = 0, bodies.lower[a], bodies.upper[a]
        for k in range(partners.first[a], partners.first[a + 1]):
            for block in range(boxes.first[partners.body[k]], boxes.first[partners.body[k] + 1]):
                if square_between(low, high, boxes.block[block, 0], boxes.block[block, 1], spacing) <= limit:
                    chosen[top] = block
                    top += 1
            last[k] = top
        for i in range(item_first[a], item_first[a + 1]):
            near.first[i], c = count, 0
            read_box(i, items, outline.position, lower, upper, spacing)
            for k in range(partners.first[a], partners.first[a + 1]):
                b = partners.body[k]
                if square_between(lower, upper, bodies.lower[b], bodies.upper[b], spacing) > limit:
                    c = last[k]
                while c < last[k]:
                    count = list_block(chosen[c], lower, upper, limit, count, boxes, near, spacing)
                    c += 1
    near.first[len(items)] = count
    return count


@kernel
def measure_motion(outline: Surface, position: Floats, moved: Floats) -> float:
    """Write how far bodies ``moved`` from ``position``; return the two largest's sum [m]."""
    most, second = 0.0, 0.0
    for b in range(len(moved)):
        square = 0.0
        for s in range(outline.body_first[b], outline.body_first[b + 1]):
            way = 0.0
            for d in range(position.shape[1]):
                way += (outline.position[s, d] - position[s, d]) ** 2
            square = max(square, way)
        moved[b] = math.sqrt(square)
        second = max(second, min(most, moved[b]))
        most = max(most, moved[b])
    return most + second


class VerletList:
    """The lists, the boxes of the bodies, and which facets a third body covers.

    Parameters
    ----------
    items, item_first
        Surface nodes of every item (n, k), and the first item of every body (n_bodies + 1,).
    outline
        The surfaces.
    radius, spacing
        Of the search [m], and the cell size once for each dimension.
    facets
        Those that others may touch (m,), in ascending order; all by default.
    """

    def __init__(
        self, items: IntArray, item_first: IntArray, outline: Surface, radius: float,
        spacing: tuple[float, ...], facets: IntArray | None = None,
    ) -> None:  # fmt: skip
        self.items, self.item_first, self.outline = items, item_first, outline
        self.radius, self.spacing, self.skin = radius, spacing, SKIN * spacing[0]
        n_bodies, dim = len(outline.body_first) - 1, len(spacing)
        self.boxes = Boxes(lower=np.zeros((n_bodies, dim)), upper=np.zeros((n_bodies, dim)))
        facets = np.arange(len(outline.facets)) if facets is None else facets
        self.blocks = boxes_of(outline, facets, spacing[0])
        self.near = NearFacets(
            first=np.zeros(len(items) + 1, dtype=np.int64),
            facet=np.zeros(len(items), dtype=np.int32),
            away=np.zeros(len(items)),
            moved=np.zeros(n_bodies),
        )
        self.listed = False
        self.listed_at = np.zeros_like(outline.position)  #: positions when the lists were made
        #: Kernel that finds which facets a third body covers, and its scratch; None of two bodies.
        self.find_covered: Any = None
        #: Removes facets of one part with a node; None where no body may touch itself.
        self.remove_joined: Any = None
        self.scratch = np.zeros(len(outline.covered), dtype=np.int32)

    def list_pairs(self, bodies: IntArray, rank: IntArray, acting: AnyArray | slice = slice(None)) -> None:
        """Search the ``acting`` (pair,) ones of the pairs of ``bodies`` (pair, 2), against those of no lower
        ``rank`` (body,)."""
        first, second = np.ascontiguousarray(bodies.T)
        self.first, self.second, self.pair_of = first, second, pair_table(first, second)
        self.listed = False
        self.partners = partners_of(first[acting], second[acting], rank)
        self.neighbours = partners_of(first, second, np.zeros_like(rank))

    def update(self) -> bool:
        """Return true if two bodies are near; list anew if they have moved far."""
        near = near_boxes(self.first, self.second, self.radius, self.outline, self.boxes)
        if not near and self.listed:
            self.near.first.fill(0)
            self.listed = False
        most = self.skin if self.remove_joined is None else 0.5 * self.skin  # two parts of a body may move
        if near and not (
            self.listed and measure_motion(self.outline, self.listed_at, self.near.moved) <= most
        ):
            given = (
                self.items, self.item_first, self.radius + self.skin, self.outline, self.boxes, self.partners,
                self.blocks, self.near, self.spacing,
            )  # fmt: skip
            while (entries := list_near(*given)) > len(self.near.facet):
                self.near.set(facet=np.zeros(2 * entries, dtype=np.int32), away=np.zeros(2 * entries))
            if self.remove_joined is not None:
                self.remove_joined(self.near)
            self.near.moved.fill(0.0)
            self.listed_at[:] = self.outline.position
            self.listed = True
        if self.find_covered is not None:
            self.find_covered(
                self.first, self.second, self.radius, self.outline, self.boxes, self.neighbours, self.blocks,
                self.near, self.scratch, self.spacing,
            )  # fmt: skip
        return near


#: Share of the search radius that near bodies may travel in a step.
SHARE = 0.5


@kernel
def fewest_steps(
    first: Ints, second: Ints, outline: Surface, begins: bool, boxes: Boxes, motions: Boxes, band: float
) -> float:
    """Least (distance of the boxes + ``band``) / relative motion of all pairs: steps that are left to them.
    ``motions``, bounds of the last displacements [m], are filled unless the run ``begins``."""
    lower, upper, slowest, fastest = boxes.lower, boxes.upper, motions.lower, motions.upper
    bounding_boxes(outline.body_first, outline.position, lower, upper)
    if not begins:
        bounding_boxes(outline.body_first, outline.displacement, slowest, fastest)
    steps = math.inf
    for c in range(len(first)):
        a, b = first[c], second[c]
        distance, motion = 0.0, 0.0
        for d in range(lower.shape[1]):
            distance = max(distance, lower[a, d] - upper[b, d], lower[b, d] - upper[a, d])
            most = max(abs(fastest[a, d] - slowest[b, d]), abs(fastest[b, d] - slowest[a, d]))
            motion += most * most
        if motion > 0.0:
            steps = min(steps, (distance + band) / math.sqrt(motion))
    return steps


class TravelLimit:
    """Limit of the step by speed alone: no node passes the band of the search."""

    name = "surface_travel"
    stage = "contact"

    def __init__(self, detection: Any) -> None:
        self.detection, self.share = detection, SHARE * detection.options.search_radius

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Allocate the bounds of the motions."""
        self.band = self.share * setup.cell_size
        shape = (len(setup.bodies), setup.dim)
        self.motions = Boxes(lower=np.zeros(shape), upper=np.zeros(shape))

    @hookimpl
    def stable_timestep(self, state: State) -> tuple[float, str]:
        """Return the time in which two bodies come nearer by their distance and half of the search radius, as
        they moved last, at first by their points."""
        near, unit, begins = self.detection.near, state.dt, state.steps == 0
        if begins:
            unit = 1.0
            for body in state.bodies:
                velocity = state.particles.velocity[body.particles]
                if body.rigid:
                    velocity = state.rigid.surface_velocity(body)
                self.motions.lower[body.index] = velocity.min(axis=0)
                self.motions.upper[body.index] = velocity.max(axis=0)
        steps = fewest_steps(
            near.first, near.second, near.outline, begins, near.boxes, self.motions, self.band
        )
        return steps * unit, f"travel of {self.share:g} cells towards each other"
