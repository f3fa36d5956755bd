"""Tiling of an axis-aligned rectangle or box by equal cells."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.geometry.clipped_lattice import SMALLEST_PIECE
from mpmfw.geometry.layout import FloatArray, Layout, layout_of_boxes


def tiling(
    lower: tuple[float, ...], upper: tuple[float, ...], size: float, offset: tuple[float, ...]
) -> Layout:
    """Cells of edge length/ceil(length/size) along each axis, which fill the box between two corners [m].

    With an ``offset`` (fractions of a cell) the cells are shifted and cut at the faces; what is cut off too
    short joins the next cell.
    """
    dim = len(lower)
    faces = [_faces(lower[a], upper[a], size, offset[a], dim) for a in range(dim)]
    centres = np.meshgrid(*(0.5 * (x[1:] + x[:-1]) for x in faces), indexing="ij")
    edges = np.meshgrid(*(np.diff(x) for x in faces), indexing="ij")
    return layout_of_boxes(np.stack(centres, -1).reshape(-1, dim), np.stack(edges, -1).reshape(-1, dim))


def _faces(lower: float, upper: float, size: float, offset: float, dim: int) -> FloatArray:
    """Coordinates (n + 1,) [m] of the faces between cells along one axis."""
    n = max(1, math.ceil((upper - lower) / size - 1e-9))
    if offset == 0:
        return np.linspace(lower, upper, n + 1)
    edge = (upper - lower) / n
    inner = lower + edge * (np.arange(n) + offset)
    # The root keeps a piece cut in every direction above the smallest volume
    least = SMALLEST_PIECE ** (1 / dim) * edge
    inner = inner[(inner - lower >= least) & (upper - inner >= least)]
    return np.concatenate([[lower], inner, [upper]])
