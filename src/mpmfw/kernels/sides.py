"""Surface nodes that are inside another body or have gone through it, and facing nodes of one surface."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.boxes import BLOCK, block_boxes, bounding_boxes, boxes_apart
from mpmfw.kernels.facets import dot, length_of, read_point
from mpmfw.kernels.surfaces import closest_facet, node_normal, signed_distance, turns_round
from mpmfw.kernels.types import Faceted, Float, Floats, Ints

#: Largest cosine between the normals of a node and of the facet by which it enters a body, and least cosine
#: where it leaves. A node that slides off round a right angle, such as a spike's tip, cannot have both.
FACING, THROUGH = -0.7, 0.8


@kernel
def find_inside(
    first: Ints, second: Ints, body_first: Ints, facet_first: Ints, surface: Faceted, inside: Ints,
    depth: Floats, passed: Ints, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Find how deep nodes of two bodies are inside each other, and how many have gone through.

    ``first`` and ``second`` are the bodies of every pair. Nodes of body b are
    ``body_first[b]:body_first[b + 1]``, its facets ``facet_first[b]:facet_first[b + 1]``. ``inside`` (n_s,)
    is the body that a node has entered by a facet that faces it, −1 of none; it is updated. ``depth``
    (n_pairs,) is the deepest node [m], 0 of none. ``passed`` (n_pairs,) counts the nodes that came out of the
    other body, since the last call, by a facet that has the node's own direction.
    """
    n_bodies = len(body_first) - 1
    lower, upper = np.empty((n_bodies, len(spacing))), np.empty((n_bodies, len(spacing)))
    bounding_boxes(body_first, surface.position, lower, upper)
    boxes = np.empty((facet_first[n_bodies] // BLOCK + 2 * n_bodies, 2, len(spacing)))
    ready, entered = np.empty(n_bodies, dtype=np.int64), np.empty(len(inside), dtype=np.int64)
    for b in range(n_bodies):
        ready[b] = 0
    for s in range(len(inside)):
        entered[s] = -1
    x, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    own = scratch.vector(spacing)
    for c in range(len(first)):
        depth[c], passed[c] = 0.0, 0
        if first[c] == second[c] or boxes_apart(first[c], second[c], lower, upper, spacing[0]):
            continue
        for way in range(2):
            a, b = (first[c], second[c]) if way == 0 else (second[c], first[c])
            start = facet_first[b] // BLOCK + 2 * b
            closest = facet_first[b]
            for s in range(body_first[a], body_first[a + 1]):
                read_point(s, surface.position, x, spacing)
                outside = False
                for d in range(len(spacing)):
                    outside = outside or x[d] < lower[b, d] or x[d] > upper[b, d]
                if outside and inside[s] != b:
                    continue
                if ready[b] == 0:
                    block_boxes(facet_first[b], facet_first[b + 1], start, surface, boxes, spacing)
                    ready[b] = 1
                closest = closest_facet(
                    x, math.inf, closest, facet_first[b], facet_first[b + 1], start, surface, boxes, spacing
                )
                gap = signed_distance(x, closest, surface, share, normal, spacing)
                # Where a corner is folded over, normals do not separate inside from outside
                folded = gap < 0.0 and len(spacing) == 2
                if folded and turns_round(x, facet_first[b], facet_first[b + 1], surface) <= 0:
                    gap = -gap
                if gap >= 0.0 and inside[s] != b:
                    continue
                node_normal(s, surface, own, spacing)
                cosine = dot(own, normal, spacing) / length_of(own, spacing)
                if gap < 0.0:
                    depth[c] = max(depth[c], -gap)
                    if cosine < FACING or inside[s] == b:
                        entered[s] = b
                elif cosine > THROUGH:
                    passed[c] += 1
    for s in range(len(inside)):  # a whole array's assignment would compile the text of its error
        inside[s] = entered[s]


@kernel
def node_normals(surface: Faceted, normal: Floats, spacing: tuple[float, ...]) -> None:
    """Outward unit normals of all surface nodes, into ``normal`` (n_s, dim)."""
    own = scratch.vector(spacing)
    for s in range(len(normal)):
        node_normal(s, surface, own, spacing)
        length = length_of(own, spacing)
        for d in range(len(spacing)):
            normal[s, d] = own[d] / length if length > 0.0 else 0.0


@device
def faces(
    s: int, t: int, position: Floats, normal: Floats, towards: Float, spacing: tuple[float, ...]
) -> Float:
    """Mean gap between two nodes along their normals [m], infinite unless each is in front of the other.

    ``towards`` is the least cosine between the normals and the line that joins the nodes.
    """
    mine, other, between, square = 0.0, 0.0, 0.0, 0.0
    for d in range(len(spacing)):
        way = position[t, d] - position[s, d]
        mine += way * normal[s, d]
        other -= way * normal[t, d]
        between += normal[s, d] * normal[t, d]
        square += way * way
    least = towards * math.sqrt(square)
    return 0.5 * (mine + other) if between < FACING and mine > least and other > least else math.inf


@kernel
def least_own_gaps(
    body_first: Ints, order: Ints, start: Floats, start_normal: Floats, position: Floats, normal: Floats,
    gaps: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Write the least gap between parts of each body's surface that came within a cell, to ``gaps`` (B,) [m].

    Two nodes count that face each other within a cell and have come closer by a tenth of a cell. At the start
    they faced each other across a gap, or were more than three cells apart: a wrinkle of a surface is no gap.
    Without such nodes the gap is infinite. Nodes of body b are ``order[body_first[b]:body_first[b + 1]]``, by
    their first coordinate. ``start`` [m] and ``start_normal`` (n_s, dim) are those at the start, ``position``
    and ``normal`` those of now.
    """
    h = spacing[0]
    for b in range(len(body_first) - 1):
        gaps[b] = math.inf
        for i in range(body_first[b], body_first[b + 1]):
            s = order[i]
            for j in range(i + 1, body_first[b + 1]):
                t = order[j]
                if position[t, 0] - position[s, 0] > h:
                    break
                near = True
                for d in range(1, len(spacing)):
                    near = near and abs(position[t, d] - position[s, d]) < h
                gap = faces(s, t, position, normal, 0.7, spacing) if near else math.inf
                if gap >= min(h, gaps[b]):
                    continue
                now, then = 0.0, 0.0
                for d in range(len(spacing)):
                    now += (position[t, d] - position[s, d]) ** 2
                    then += (start[t, d] - start[s, d]) ** 2
                closer = math.sqrt(then) - math.sqrt(now) > 0.1 * h
                across = faces(s, t, start, start_normal, 0.0, spacing) < math.inf
                if closer and (across or then > 9.0 * h * h):
                    gaps[b] = gap
