"""Which of two outlines' segments face each other: at the corners of flush bodies the closest one may not."""

from __future__ import annotations

import math
from typing import Any

from mpmfw.kernels import device
from mpmfw.kernels.polyline import signed_distance
from mpmfw.kernels.types import Float, Floats, Ints


@device
def node_normal(s: int, position: Floats, following: Ints, previous: Ints) -> tuple[Float, Float]:
    """Sum of the outward unit normals of a surface node's two segments."""
    a, b = previous[s], following[s]
    before_x, before_y = position[s, 0] - position[a, 0], position[s, 1] - position[a, 1]
    after_x, after_y = position[b, 0] - position[s, 0], position[b, 1] - position[s, 1]
    before, after = math.hypot(before_x, before_y), math.hypot(after_x, after_y)
    return before_y / before + after_y / after, -before_x / before - after_x / after


#: Least cosine between a slave node's reversed normal and that of a segment that faces it: blocks have sides at right angles,
#: and rounding must not decide.
LEAST_COSINE = 1e-6


@device
def faces(s: int, m: int, position: Floats, following: Ints, previous: Ints) -> bool:
    """Whether the outward normals of a slave node and of a segment are against each other."""
    n_x, n_y = node_normal(s, position, following, previous)
    e = following[m]
    x, y = position[e, 0] - position[m, 0], position[e, 1] - position[m, 1]
    against: bool = n_y * x - n_x * y > LEAST_COSINE * math.hypot(n_x, n_y) * math.hypot(x, y)
    return against


#: How far along the outline, in search radii, a segment that faces the node may be from the closest point.
ROUND_THE_CORNER = 0.25

#: How far outside, in lengths of the closest segment, a node still counts as flush with it.
FLUSH = 0.05


@device
def facing_segment(
    s: int, m: int, xi: Float, reach: Float, position: Floats, following: Ints, previous: Ints
) -> Any:
    """The segment nearest to the point ξ of segment m along the outline that faces node s; −1 if none within ``reach``."""
    e = following[m]
    length = math.hypot(position[e, 0] - position[m, 0], position[e, 1] - position[m, 1])
    ahead, behind = (1.0 - xi) * length, xi * length
    forward, backward = following[m], previous[m]
    while min(ahead, behind) <= reach:
        if ahead <= behind:
            if faces(s, forward, position, following, previous):
                return forward
            e = following[forward]
            ahead += math.hypot(position[e, 0] - position[forward, 0], position[e, 1] - position[forward, 1])
            forward = e
        else:
            if faces(s, backward, position, following, previous):
                return backward
            e = following[backward]
            behind += math.hypot(
                position[e, 0] - position[backward, 0], position[e, 1] - position[backward, 1]
            )
            backward = previous[backward]
    return -1


@device
def turn_to_facing(
    s: int, radius: Float, position: Floats, following: Ints, previous: Ints,
    master: Ints, segment: Ints, coordinate: Floats, gap: Floats, normal: Floats,
) -> None:  # fmt: skip
    """Candidates of node s that do not face it give way to a segment round the corner that does, or are dropped.

    Where two bodies are flush, the node at the corner of one lies on the side of the other, with no gap: it would be held
    there, and its part of the face would carry nothing. A node that is outside is not turned: it may be inside of nothing
    but the line of a far face.
    """
    for j in range(segment.shape[1]):
        m = segment[s, j]
        if m >= 0 and not faces(s, m, position, following, previous):
            e = following[m]
            length = math.hypot(position[e, 0] - position[m, 0], position[e, 1] - position[m, 1])
            reach = ROUND_THE_CORNER * radius if gap[s, j] <= FLUSH * length else -1.0
            m = facing_segment(s, m, coordinate[s, j], reach, position, following, previous)
            segment[s, j] = m
            if m < 0:
                master[s, j] = -1
            else:
                x, y = position[s, 0], position[s, 1]
                g, xi, e_x, e_y = signed_distance(x, y, m, position, following, previous)
                coordinate[s, j], gap[s, j], normal[s, j, 0], normal[s, j, 1] = xi, g, e_x, e_y
