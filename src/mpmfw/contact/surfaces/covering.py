"""Facets that another body lies flush on: inside of a seam there is nothing that a third body could touch."""

from __future__ import annotations

import numpy as np

from mpmfw.contact.surfaces.candidates import SearchGrid
from mpmfw.contact.surfaces.cells import boxes_apart, reach_of_facet
from mpmfw.contact.surfaces.outline import Outline, area_of, hidden
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.facets import at_rim, closest_point, length_of, read_corners, read_point
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw.state.fields import IntArray

#: Distance from another body up to which a facet's corner is covered, in cells.
FLUSH = 0.05

#: Least cosine between a facet's normal and the reversed one of a facet that covers it.
OPPOSITE = 0.9

#: Cosine between the normals of facets that meet in an edge, at most.
EDGE = 0.7

#: Part of a corner's distance that may lie along the facet that covers it: elastic faces are not quite
#: parallel.
ASIDE = 0.3

#: What rounding leaves of lengths in cells and of cosines.
ROUNDING = 1e-9


@device
def dot(a: Floats, b: Floats, spacing: tuple[float, ...]) -> Float:
    """Σ a_d b_d."""
    total = 0.0
    for d in range(len(spacing)):
        total += a[d] * b[d]
    return total


@device
def remove(vector: Floats, unit: Floats, spacing: tuple[float, ...]) -> None:
    """Take the component along a ``unit`` vector away from ``vector``."""
    along = dot(vector, unit, spacing)
    for d in range(len(spacing)):
        vector[d] -= along * unit[d]


@device
def seam_box(
    a: int, b: int, near_first: Ints, near: Ints, reach: Float, grid: SearchGrid, lower: Floats,
    upper: Floats,
    spacing: tuple[float, ...],
) -> bool:  # fmt: skip
    """Box of what two bodies' boxes have in common within ``reach`` [m] of a third body; whether there is
    any.

    ``near[near_first[a]:near_first[a + 1]]`` are the bodies near body a.
    """
    flush, found = FLUSH * spacing[0], False
    for k in range(near_first[a], near_first[a + 1]):
        c = near[k]
        if c == b:
            continue
        common = True
        for d in range(len(spacing)):
            low = max(grid.box_lower[a, d], grid.box_lower[b, d]) - flush
            high = min(grid.box_upper[a, d], grid.box_upper[b, d]) + flush
            common = common and max(low, grid.box_lower[c, d] - reach) <= min(
                high, grid.box_upper[c, d] + reach
            )
        if not common:
            continue
        for d in range(len(spacing)):
            low = max(grid.box_lower[a, d], grid.box_lower[b, d]) - flush
            high = min(grid.box_upper[a, d], grid.box_upper[b, d]) + flush
            low, high = max(low, grid.box_lower[c, d] - reach), min(high, grid.box_upper[c, d] + reach)
            lower[d] = min(low, lower[d]) if found else low
            upper[d] = max(high, upper[d]) if found else high
        found = True
    return found


@device
def list_within(
    body: int, lower: Floats, upper: Floats, begin: int, outline: Outline, out: Indices, spacing: tuple[float,
    ...]
) -> int:  # fmt: skip
    """List the facets of a body whose boxes touch that from ``lower`` to ``upper``, into ``out[begin:]``;
    where they end."""
    low, high, count = scratch.vector(spacing), scratch.vector(spacing), begin
    for m in range(outline.facet_first[body], outline.facet_first[body + 1]):
        reach_of_facet(m, outline.position, outline.facets, low, high, spacing)
        outside = False
        for d in range(len(spacing)):
            outside = outside or low[d] > upper[d] or high[d] < lower[d]
        if not outside:
            out[count] = m
            count += 1
    return count


@device
def is_flush(p: int, m: int, normal: Floats, outline: Outline, spacing: tuple[float, ...]) -> bool:
    """Whether surface node p, at the corner of a facet with the unit ``normal``, lies on facet m of another
    body.

    The node may be away from it along the normal, and beyond its rim along the normals of other facets at the
    node, which turn away from this one: seams are never level.
    """
    dim, flush = len(spacing), FLUSH * spacing[0]
    away, share, side = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    corners = scratch.matrix(spacing, spacing)
    read_point(p, outline.position, away, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    closest_point(away, corners, share, spacing)
    for a in range(dim):
        for d in range(dim):
            away[d] -= share[a] * corners[a, d]
    distance = length_of(away, spacing)
    if distance > flush:
        return False
    remove(away, normal, spacing)
    for k in range(outline.star_first[p], outline.star_first[p + 1]):
        area_of(outline.star[k], outline, side, spacing)
        size = length_of(side, spacing)
        if dot(side, normal, spacing) < EDGE * size:
            remove(side, normal, spacing)
            size = length_of(side, spacing)
            for d in range(dim):
                side[d] /= size
            if dot(away, side, spacing) > 0.0:
                remove(away, side, spacing)
    level: bool = length_of(away, spacing) <= ASIDE * distance + ROUNDING * spacing[0]
    return level


@device
def is_covered(
    m: int, listed: Indices, begin: int, end: int, outline: Outline, spacing: tuple[float, ...]
) -> bool:
    """Whether every corner of facet m is flush with one of the facets ``listed[begin:end]`` that is opposite
    to it."""
    normal, other = scratch.vector(spacing), scratch.vector(spacing)
    area_of(m, outline, normal, spacing)
    size = length_of(normal, spacing)
    for d in range(len(spacing)):
        normal[d] /= size
    for a in range(len(spacing)):
        found = False
        for k in range(begin, end):
            area_of(listed[k], outline, other, spacing)
            opposite = dot(normal, other, spacing) < -OPPOSITE * length_of(other, spacing)
            if opposite and is_flush(outline.facets[m, a], listed[k], normal, outline, spacing):
                found = True
                break
        if not found:
            return False
    return True


@kernel
def find_covered(
    first: Ints, second: Ints, reach: float, outline: Outline, grid: SearchGrid, near_first: Ints, near: Ints,
    listed: Indices, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Write on every facet within ``reach`` [m] of a third body which body covers it, into
    ``outline.covered``; else −1.

    The bodies' boxes are those of the step. ``near_first`` (n_bodies + 1,), ``near`` (2 n_pairs,) and
    ``listed`` (n_f,) are scratch.
    """
    lower, upper = scratch.vector(spacing), scratch.vector(spacing)
    outline.covered[:] = -1
    near_first[:] = 0
    for c in range(len(first)):
        if not boxes_apart(first[c], second[c], grid.box_lower, grid.box_upper, reach):
            near_first[first[c]] += 1
            near_first[second[c]] += 1
    for b in range(1, len(near_first)):
        near_first[b] += near_first[b - 1]
    for c in range(len(first)):
        if not boxes_apart(first[c], second[c], grid.box_lower, grid.box_upper, reach):
            near_first[first[c]] -= 1
            near[near_first[first[c]]] = second[c]
            near_first[second[c]] -= 1
            near[near_first[second[c]]] = first[c]
    for c in range(len(first)):
        a, b = first[c], second[c]
        if boxes_apart(a, b, grid.box_lower, grid.box_upper, FLUSH * spacing[0]):
            continue
        if not seam_box(a, b, near_first, near, reach, grid, lower, upper, spacing):
            continue
        middle = list_within(a, lower, upper, 0, outline, listed, spacing)
        end = list_within(b, lower, upper, middle, outline, listed, spacing)
        for k in range(end):
            begin, stop = (middle, end) if k < middle else (0, middle)
            if is_covered(listed[k], listed, begin, stop, outline, spacing):
                outline.covered[listed[k]] = b if k < middle else a


@device
def past_a_seam(
    s: int, m: int, share: Floats, normal: Floats, outline: Outline, spacing: tuple[float, ...]
) -> bool:  # fmt: skip
    """Whether node s is past a rim of facet m beyond which the surface is another body's: that body has the
    node's foot.

    ``share`` and ``normal`` are those of :func:`.outline.distance_to`.
    """
    if len(outline.covered) == 0 or not at_rim(share, spacing):
        return False
    dim, area, ends, past = len(spacing), scratch.vector(spacing), 0, False
    area_of(m, outline, area, spacing)
    if abs(dot(area, normal, spacing)) >= (1.0 - ROUNDING) * length_of(area, spacing):
        return False
    mine, side, corner = outline.body[s], 0, 0
    for a in range(dim):
        if share[a] == 0.0:
            ends, side = ends + 1, a
        else:
            corner = a
    if ends < dim - 1:
        past = hidden(outline.neighbours[m, side], mine, outline)
    else:
        node = outline.facets[m, corner]
        for k in range(outline.star_first[node], outline.star_first[node + 1]):
            past = past or hidden(outline.star[k], mine, outline)
    return past


class Seams:
    """Scratch of the search for covered facets; nothing where two bodies are alone.

    Parameters
    ----------
    outline, reach, spacing
        The surfaces, how near a third body must be [m], and the cell size once for each dimension.
    """

    def __init__(self, outline: Outline, reach: float, spacing: tuple[float, ...]) -> None:
        self.outline, self.reach, self.spacing = outline, reach, spacing
        self.listed = np.zeros(len(outline.covered), dtype=np.int32)
        self.near_first = np.zeros(len(outline.body_first), dtype=np.int64)
        self.near = np.zeros(0, dtype=np.int64)

    def find(self, first: IntArray, second: IntArray, grid: SearchGrid) -> None:
        """Write which body covers every facet, of the pairs ``first`` and ``second``, (pair,) each."""
        if len(self.listed) == 0:
            return
        if len(self.near) < 2 * len(first):
            self.near = np.zeros(2 * len(first), dtype=np.int64)
        find_covered(
            first,
            second,
            self.reach,
            self.outline,
            grid,
            self.near_first,
            self.near,
            self.listed,
            self.spacing,
        )
