"""Tracked surfaces, partners and candidates, as arguments of kernels; facets that another body lies flush on:
no third body can touch the inside of a seam."""

from __future__ import annotations

import numpy as np

from mpmfw.errors import SimulationError
from mpmfw.kernels import Struct, device, kernel, scratch
from mpmfw.kernels.boxes import Boxes, boxes_apart, read_box, square_between
from mpmfw.kernels.facets import (
    at_rim,
    closest_point,
    dot,
    length_of,
    read_corners,
    read_point,
    squared_distance,
)
from mpmfw.kernels.surfaces import add_normal, area_of, signed_distance
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw.state.fields import IntArray
from mpmfw.state.structs import State, Surface


def node_error(state: State, surface: Surface, node: int, text: str, *, advice: str) -> SimulationError:
    """Return the error of a surface ``node``: body, index, place and ``text``."""
    body = state.bodies[int(surface.body[node])]
    return SimulationError(
        text,
        body=body.name,
        index=node - int(surface.body_first[body.index]),
        position=surface.position[node].tolist(),
        time=state.time,
        advice=advice,
    )


@device
def distance_to(
    s: int, m: int, outline: Surface, share: Floats, normal: Floats, spacing: tuple[float, ...]
) -> Float:
    """Signed distance of node s from facet m [m]; coordinates into ``share``, e_n into ``normal``."""
    x = scratch.vector(spacing)
    read_point(s, outline.position, x, spacing)
    return signed_distance(x, m, outline, share, normal, spacing)


@device
def square_of(s: int, m: int, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Squared distance of node s from facet m [m²]."""
    x, corners = scratch.vector(spacing), scratch.matrix(spacing, spacing)
    read_point(s, outline.position, x, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    return squared_distance(x, corners, spacing)


@device
def body_of(m: int, outline: Surface) -> int:
    """Body of facet m."""
    body: int = outline.body[outline.facets[m, 0]]
    return body


@device
def hidden(m: int, body: int, outline: Surface) -> bool:
    """Return True if a third body covers facet m, so that ``body`` cannot touch it."""
    return len(outline.covered) > 0 and outline.covered[m] >= 0 and outline.covered[m] != body


#: Least cosine between a slave node's reversed normal and that of a facet that faces it: at the right angles
#: of blocks neither rounding nor elastic lean must decide. The sides of a wedge of 2.3° face nothing.
LEAST_COSINE = 0.02


@device
def opposition(outward: Floats, m: int, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Cosine between the reversed ``outward`` normal of a node or facet and that of facet m."""
    area = scratch.vector(spacing)
    area_of(m, outline, area, spacing)
    return -dot(outward, area, spacing) / (length_of(outward, spacing) * length_of(area, spacing))


@device
def opposes(outward: Floats, m: int, outline: Surface, spacing: tuple[float, ...]) -> bool:
    """Return true if facet m faces a node or facet with the normal ``outward``."""
    facing: bool = opposition(outward, m, outline, spacing) > LEAST_COSINE
    return facing


@device
def node_outward(s: int, other: int, outline: Surface, outward: Floats, spacing: tuple[float, ...]) -> None:
    """Normal of surface node s for body ``other``, without covered facets."""
    for d in range(len(spacing)):
        outward[d] = 0.0
    for k in range(outline.star_first[s], outline.star_first[s + 1]):
        if not hidden(outline.star[k], other, outline):
            add_normal(s, outline.star[k], outline, outward, spacing)


class Partners(Struct):
    """Bodies that each body is searched against, in ascending order."""

    first: Ints  #: (n_bodies + 1,) partners of body a are ``body[first[a]:first[a + 1]]``
    body: Ints  #: (n,)


def partners_of(first: IntArray, second: IntArray, rank: IntArray) -> Partners:
    """Return each body's partners of no lower ``rank`` (body,), of the pairs ``first``, ``second``."""
    body, other = np.concatenate([first, second]), np.concatenate([second, first])
    searched = rank[body] <= rank[other]
    body, other = body[searched], other[searched]
    order = np.lexsort((other, body))
    return Partners(first=np.searchsorted(body[order], np.arange(len(rank) + 1)), body=other[order])


class Candidates(Struct):
    """Facets that every surface node may touch; until the search those of the last step."""

    facet: Ints  #: (n_s, slots) −1 if none is near
    gap: Floats  #: (n_s, slots) g_n [m], infinite if none is near


@device
def clear(s: int, candidates: Candidates) -> None:
    """Empty the slots of node s."""
    for j in range(candidates.facet.shape[1]):
        candidates.facet[s, j], candidates.gap[s, j] = -1, np.inf


#: Distance from another body up to which a facet's corner is covered, in cells.
FLUSH = 0.05

#: Least cosine between a facet's normal and the reversed one of a facet that covers it.
OPPOSITE = 0.9

#: Cosine between the normals of facets that meet in an edge, at most.
EDGE = 0.7

#: Part of a corner's distance that may lie along its covering facet: elastic faces lean.
ASIDE = 0.3

#: What rounding leaves of lengths in cells and of cosines.
ROUNDING = 1e-9


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
    body: int, lower: Floats, upper: Floats, begin: int, outline: Surface, out: Indices,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """List the facets of a body that touch the box in ``out[begin:]``; return where they end."""
    low, high, count = scratch.vector(spacing), scratch.vector(spacing), begin
    for m in range(outline.facet_first[body], outline.facet_first[body + 1]):
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
    listed: Indices, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Write the body that covers each facet within ``reach`` [m] of a third one, of the pairs of bodies, else
    −1; ``listed`` (n_f,) is scratch."""
    lower, upper = scratch.vector(spacing), scratch.vector(spacing)
    outline.covered[:] = -1
    for c in range(len(first)):
        a, b = first[c], second[c]
        if boxes_apart(a, b, boxes.lower, boxes.upper, FLUSH * spacing[0]):
            continue
        if not seam_box(a, b, partners, reach, boxes, lower, upper, spacing):
            continue
        middle = list_within(a, lower, upper, 0, outline, listed, spacing)
        end = list_within(b, lower, upper, middle, outline, listed, spacing)
        for k in range(end):
            begin, stop = (middle, end) if k < middle else (0, middle)
            if is_covered(listed[k], listed, begin, stop, outline, spacing):
                outline.covered[listed[k]] = b if k < middle else a


@device
def past_a_seam(
    s: int, m: int, share: Floats, normal: Floats, outline: Surface, spacing: tuple[float, ...]
) -> bool:  # fmt: skip
    """Return True if node s is past a rim of facet m where another body's surface goes on.

    ``share`` and ``normal`` are those of :func:`distance_to`.
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
