"""Facets that another body lies flush on, in scenes of more than two bodies: no third body can touch the
inside of a seam."""

from __future__ import annotations

from mpmfw.contact.surfaces.near_facets import FacetBoxes, NearFacets, Partners
from mpmfw.contact.surfaces.outline import ROUNDING
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.facets import (
    Boxes,
    boxes_apart,
    closest_point,
    dot,
    length_of,
    read_box,
    read_corners,
    read_point,
    square_between,
)
from mpmfw.kernels.surfaces import area_of
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw.state.structs import Surface

#: Distance from another body up to which a facet's corner is covered, in cells.
FLUSH = 0.05

#: Least cosine between a facet's normal and the reversed one of a facet that covers it.
OPPOSITE = 0.9

#: Cosine between the normals of facets that meet in an edge, at most.
EDGE = 0.7

#: Part of a corner's distance that may lie along its covering facet: elastic faces lean.
ASIDE = 0.3


@device
def remove(vector: Floats, unit: Floats, spacing: tuple[float, ...]) -> None:
    """Take the component along a ``unit`` vector away from ``vector``."""
    along = dot(vector, unit, spacing)
    for d in range(len(spacing)):
        vector[d] -= along * unit[d]


@device
def seam_box(
    a: int, b: int, partners: Partners, reach: Float, boxes: Boxes, lower: Floats, upper: Floats,
    spacing: tuple[float, ...],
) -> bool:  # fmt: skip
    """Box that two bodies' boxes share within ``reach`` [m] of a third body; False without."""
    flush, found = FLUSH * spacing[0], False
    low, high = scratch.vector(spacing), scratch.vector(spacing)
    for k in range(partners.first[a], partners.first[a + 1]):
        c = partners.body[k]
        common = c != b and not boxes_apart(a, c, boxes.lower, boxes.upper, reach)
        for d in range(len(spacing)):
            low[d] = max(boxes.lower[a, d], boxes.lower[b, d]) - flush
            high[d] = min(boxes.upper[a, d], boxes.upper[b, d]) + flush
            low[d] = max(low[d], boxes.lower[c, d] - reach)
            high[d] = min(high[d], boxes.upper[c, d] + reach)
            common = common and low[d] <= high[d]
        if not common:
            continue
        for d in range(len(spacing)):
            lower[d] = min(low[d], lower[d]) if found else low[d]
            upper[d] = max(high[d], upper[d]) if found else high[d]
        found = True
    return found


@device
def list_within(
    body: int, lower: Floats, upper: Floats, begin: int, outline: Surface, blocks: FacetBoxes,
    near: NearFacets, out: Indices, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """List the facets of a body that touch the box in ``out[begin:]``; return where they end. ``blocks`` are
    those of before the body ``moved``."""
    low, high, count = scratch.vector(spacing), scratch.vector(spacing), begin
    moved = near.moved[body] + ROUNDING * spacing[0]
    for block in range(blocks.first[body], blocks.first[body + 1]):
        box = blocks.block[block]
        if square_between(box[0], box[1], lower, upper, spacing) > moved * moved:
            continue
        for k in range(blocks.begin[block], blocks.begin[block + 1]):
            m = blocks.order[k]
            read_box(m, outline.facets, outline.position, low, high, spacing)
            if square_between(low, high, lower, upper, spacing) == 0.0:
                out[count] = m
                count += 1
    return count


@device
def is_flush(p: int, m: int, normal: Floats, outline: Surface, spacing: tuple[float, ...]) -> bool:
    """Return True if surface node p, on a facet with the unit ``normal``, lies on facet m of another body.

    It may be away along the normal, and beyond the rim along the normals of facets round an edge: seams are
    never level.
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
    m: int, listed: Indices, begin: int, end: int, outline: Surface, spacing: tuple[float, ...]
) -> bool:
    """Return True if opposite facets ``listed[begin:end]`` are flush with every corner of facet m."""
    normal, other = scratch.vector(spacing), scratch.vector(spacing)
    area_of(m, outline, normal, spacing)
    size, covered = length_of(normal, spacing), True
    for d in range(len(spacing)):
        normal[d] /= size
    for a in range(len(spacing)):
        k, found = begin, False
        while covered and k < end and not found:
            area_of(listed[k], outline, other, spacing)
            opposite = dot(normal, other, spacing) < -OPPOSITE * length_of(other, spacing)
            found = opposite and is_flush(outline.facets[m, a], listed[k], normal, outline, spacing)
            k += 1
        covered = covered and found
    return covered


@kernel
def find_covered(
    first: Ints, second: Ints, reach: float, outline: Surface, boxes: Boxes, partners: Partners,
    blocks: FacetBoxes, near: NearFacets, listed: Indices, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Write the body that covers each facet within ``reach`` [m] of a third one, of the pairs of bodies, else
    −1; ``listed`` (n_f,) is scratch."""
    lower, upper = scratch.vector(spacing), scratch.vector(spacing)
    outline.covered[:] = -1
    for c in range(len(first)):
        a, b = first[c], second[c]
        if a == b or boxes_apart(a, b, boxes.lower, boxes.upper, FLUSH * spacing[0]):
            continue
        if not seam_box(a, b, partners, reach, boxes, lower, upper, spacing):
            continue
        middle = list_within(a, lower, upper, 0, outline, blocks, near, listed, spacing)
        end = list_within(b, lower, upper, middle, outline, blocks, near, listed, spacing)
        for k in range(end):
            begin, stop = (middle, end) if k < middle else (0, middle)
            if is_covered(listed[k], listed, begin, stop, outline, spacing):
                outline.covered[listed[k]] = b if k < middle else a
