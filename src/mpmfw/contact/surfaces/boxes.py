"""Bounding boxes of bodies, facets and nodes, and which bodies are searched against which."""

from __future__ import annotations

import numpy as np

from mpmfw.contact.surfaces.outline import Outline
from mpmfw.kernels import Struct, device, kernel
from mpmfw.kernels.gaps import bounding_boxes
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw.state.fields import IntArray


class Boxes(Struct):
    """Bounding boxes of all bodies."""

    lower: Floats  #: (n_bodies, dim) [m]
    upper: Floats  #: (n_bodies, dim) [m]


class Partners(Struct):
    """Bodies that each body is searched against, in ascending order."""

    first: Ints  #: (n_bodies + 1,) partners of body a are ``body[first[a]:first[a + 1]]``
    body: Ints  #: (n,)


def partners_of(first: IntArray, second: IntArray, rank: IntArray) -> Partners:
    """Return the bodies that each body is searched against: of its pairs those of no lower ``rank`` (body,).

    ``first`` and ``second`` are the bodies of all pairs (pair,).
    """
    body, other = np.concatenate([first, second]), np.concatenate([second, first])
    searched = rank[body] <= rank[other]
    body, other = body[searched], other[searched]
    order = np.lexsort((other, body))
    return Partners(first=np.searchsorted(body[order], np.arange(len(rank) + 1)), body=other[order])


@device
def read_box(
    i: int, corners: Ints, position: Floats, lower: Floats, upper: Floats, spacing: tuple[float, ...]
) -> None:
    """Write the bounding box of the surface nodes ``corners[i]`` into ``lower`` and ``upper`` (dim,) [m]."""
    for d in range(len(spacing)):
        lower[d] = upper[d] = position[corners[i, 0], d]
        for a in range(1, corners.shape[1]):
            lower[d] = min(lower[d], position[corners[i, a], d])
            upper[d] = max(upper[d], position[corners[i, a], d])


@device
def square_between(
    lower: Floats, upper: Floats, other_lower: Floats, other_upper: Floats, spacing: tuple[float, ...]
) -> Float:
    """Squared distance of two boxes [m²]."""
    square = 0.0
    for d in range(len(spacing)):
        beyond = max(lower[d] - other_upper[d], other_lower[d] - upper[d], 0.0)
        square += beyond * beyond
    return square


@device
def boxes_apart(a: int, b: int, boxes: Boxes, reach: Float) -> bool:
    """Return true if the boxes of bodies a and b are farther apart than ``reach`` [m] along an axis."""
    apart, lower, upper = False, boxes.lower, boxes.upper
    for d in range(lower.shape[1]):
        if lower[a, d] - upper[b, d] > reach or lower[b, d] - upper[a, d] > reach:
            apart = True
    return apart


@kernel
def near_boxes(first: Ints, second: Ints, reach: float, outline: Outline, boxes: Boxes) -> bool:
    """Fill the boxes of all bodies; return true if those of any pair are within ``reach`` [m]."""
    bounding_boxes(outline.body_first, outline.position, boxes.lower, boxes.upper)
    near = False
    for c in range(len(first)):
        near = near or not boxes_apart(first[c], second[c], boxes, reach)
    return near
