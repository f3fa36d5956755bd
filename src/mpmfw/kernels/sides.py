"""Surface nodes inside another body or through it, least gaps of bodies, and facing nodes of one surface."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.facets import bounding_boxes, boxes_apart, dot, length_of, read_point, square_between
from mpmfw.kernels.surfaces import (
    BLOCK,
    block_boxes,
    closest_facet,
    node_normal,
    signed_distance,
    turns_round,
)
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


@device
def least_gap(
    first_a: int, last_a: int, first_b: int, last_b: int, start: int, least: Float, surface: Faceted,
    boxes: Floats, spacing: tuple[float, ...],
) -> Float:  # fmt: skip
    """``least``, or the least signed distance of nodes ``first_a:last_a`` from the facets ``first_b:last_b``
    if less [m].

    From row ``start`` on ``boxes`` are those of the facets' blocks; behind them is room for one more. The
    node closest to the box round them all goes first: most others are farther from that box than its
    distance.
    """
    dim = len(spacing)
    x, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    blocks = (last_b - first_b + BLOCK - 1) // BLOCK
    whole = start + blocks
    for d in range(dim):
        boxes[whole, 0, d], boxes[whole, 1, d] = math.inf, -math.inf
    for block in range(start, start + blocks):
        for d in range(dim):
            boxes[whole, 0, d] = min(boxes[whole, 0, d], boxes[block, 0, d])
            boxes[whole, 1, d] = max(boxes[whole, 1, d], boxes[block, 1, d])
    nearest, shortest = first_a, math.inf
    for s in range(first_a, last_a):
        read_point(s, surface.position, x, spacing)
        box = square_between(x, x, boxes[whole, 0], boxes[whole, 1], spacing)
        if box < shortest:
            nearest, shortest = s, box
    closest = first_b
    for visit in range(first_a - 1, last_a):
        s = nearest if visit < first_a else visit
        read_point(s, surface.position, x, spacing)
        box = square_between(x, x, boxes[whole, 0], boxes[whole, 1], spacing)
        square = max(least, 0.0) * max(least, 0.0)
        if box > square:
            # farther from the whole surface's box than the least distance, or outside where another is inside
            continue
        # What is within the box may be inside, and deeper than the least distance found.
        within = square * (1.0 + 1e-9) if box > 0.0 else math.inf
        m = closest_facet(x, within, closest, first_b, last_b, start, surface, boxes, spacing)
        if m >= 0:
            closest = m
            gap = signed_distance(x, m, surface, share, normal, spacing)
            # Where a corner is folded over, normals do not separate inside from outside
            if gap < min(least, 0.0) and dim == 2 and turns_round(x, first_b, last_b, surface) <= 0:
                gap = -gap
            least = min(least, gap)
    return least


@kernel
def minimum_gap(
    first_a: int, last_a: int, first_b: int, last_b: int, surface: Faceted, spacing: tuple[float, ...]
) -> float:
    """Least signed distance of nodes ``first_a:last_a`` from the facets ``first_b:last_b`` [m], negative
    as soon as one is inside."""
    boxes = np.empty(((last_b - first_b) // BLOCK + 2, 2, len(spacing)))
    block_boxes(first_b, last_b, 0, surface, boxes, spacing)
    least: float = least_gap(first_a, last_a, first_b, last_b, 0, math.inf, surface, boxes, spacing)
    return least


@kernel
def minimum_gaps(
    first: Ints, second: Ints, body_first: Ints, facet_first: Ints, surface: Faceted, gaps: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Least distance of the surfaces of every two bodies ``first`` and ``second``, into ``gaps`` [m]: the
    lesser of both ways of :func:`mpmfw.kernels.minimum_gap`; infinite of a body and itself.

    Nodes and facets of body b are ``body_first[b]:body_first[b + 1]`` and ``facet_first[b]:facet_first[b +
    1]``.
    """
    n_bodies = len(body_first) - 1
    boxes = np.empty((facet_first[n_bodies] // BLOCK + 2 * n_bodies, 2, len(spacing)))
    for b in range(n_bodies):
        start = facet_first[b] // BLOCK + 2 * b
        block_boxes(facet_first[b], facet_first[b + 1], start, surface, boxes, spacing)
    for c in range(len(first)):
        least = math.inf
        for way in range(0 if first[c] == second[c] else 2):
            a, b = (first[c], second[c]) if way == 0 else (second[c], first[c])
            least = least_gap(
                body_first[a], body_first[a + 1], facet_first[b], facet_first[b + 1],
                facet_first[b] // BLOCK + 2 * b, least, surface, boxes, spacing,
            )  # fmt: skip
        gaps[c] = least
