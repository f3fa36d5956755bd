"""Which of two outlines' segments face each other: at the corners of flush bodies the closest one may not."""

from __future__ import annotations

import math
from typing import Any

from mpmfw.kernels import device
from mpmfw.kernels.types import Float
from mpmfw_contact.surfaces.candidates import Candidates, put
from mpmfw_contact.surfaces.outline import Outline, distance_to


@device
def along_segment(m: int, outline: Outline) -> tuple[Float, Float]:
    """x_2 − x_1 of segment m [m]."""
    position, e = outline.position, outline.next[m]
    return position[e, 0] - position[m, 0], position[e, 1] - position[m, 1]


@device
def node_normal(s: int, outline: Outline) -> tuple[Float, Float]:
    """Sum of the outward unit normals of a surface node's two segments."""
    before_x, before_y = along_segment(outline.previous[s], outline)
    after_x, after_y = along_segment(s, outline)
    before, after = math.hypot(before_x, before_y), math.hypot(after_x, after_y)
    return before_y / before + after_y / after, -before_x / before - after_x / after


#: Least cosine between a slave node's reversed normal and that of a segment that faces it: blocks have sides at right angles,
#: and rounding must not decide.
LEAST_COSINE = 1e-6


@device
def faces(s: int, m: int, outline: Outline) -> bool:
    """Whether the outward normals of a slave node and of a segment are against each other."""
    n_x, n_y = node_normal(s, outline)
    x, y = along_segment(m, outline)
    against: bool = n_y * x - n_x * y > LEAST_COSINE * math.hypot(n_x, n_y) * math.hypot(x, y)
    return against


#: How far along the outline, in search radii, a segment that faces the node may be from the closest point.
ROUND_THE_CORNER = 0.25

#: How far outside, in lengths of the closest segment, a node still counts as flush with it.
FLUSH = 0.05


@device
def length_of(m: int, outline: Outline) -> Float:
    """Length of segment m [m]."""
    x, y = along_segment(m, outline)
    return math.hypot(x, y)


@device
def facing_segment(s: int, m: int, xi: Float, reach: Float, outline: Outline) -> Any:
    """The segment nearest to the point ξ of segment m along the outline that faces node s; −1 if none within ``reach``."""
    length = length_of(m, outline)
    ahead, behind = (1.0 - xi) * length, xi * length
    forward, backward = outline.next[m], outline.previous[m]
    while min(ahead, behind) <= reach:
        if ahead <= behind:
            if faces(s, forward, outline):
                return forward
            ahead += length_of(forward, outline)
            forward = outline.next[forward]
        else:
            if faces(s, backward, outline):
                return backward
            behind += length_of(backward, outline)
            backward = outline.previous[backward]
    return -1


@device
def turn_to_facing(s: int, radius: Float, outline: Outline, candidates: Candidates) -> None:
    """Candidates of node s that do not face it give way to a segment round the corner that does, or are dropped.

    Where two bodies are flush, the node at the corner of one lies on the side of the other, with no gap: it would be held
    there, and its part of the face would carry nothing. A node that is outside is not turned: it may be inside of nothing
    but the line of a far face.
    """
    for j in range(candidates.segment.shape[1]):
        m = candidates.segment[s, j]
        if m >= 0 and not faces(s, m, outline):
            flush = candidates.gap[s, j] <= FLUSH * length_of(m, outline)
            reach = ROUND_THE_CORNER * radius if flush else -1.0
            m = facing_segment(s, m, candidates.coordinate[s, j], reach, outline)
            candidates.segment[s, j] = m
            if m < 0:
                candidates.master[s, j] = -1
            else:
                g, xi, e_x, e_y = distance_to(s, m, outline)
                put(s, j, outline.body[m], m, g, xi, e_x, e_y, candidates)
