"""The normal spring: linear as far as surfaces stand for bodies, stiffer where they are deep in each other."""

from __future__ import annotations

from mpmfw.kernels import device
from mpmfw.kernels.types import Float

#: Depth in cells from which a spring grows stiffer: beyond it bodies at the speed of their waves would cross.
LINEAR_TO = 0.25

#: By how much: f = k (d + GROWTH (d − LINEAR_TO h)² / h).
GROWTH = 16.0


@device
def normal_force(k: Float, depth: Float, limit: Float) -> Float:
    """Force of a spring of stiffness k at a depth [N/m]; ``limit`` is the depth from which it grows stiffer [m]."""
    if depth <= limit:
        return k * depth
    over = depth - limit
    return k * (depth + GROWTH * LINEAR_TO * over * over / limit)


@device
def spring_energy(k: Float, depth: Float, limit: Float) -> Float:
    """Work that pressing it took [J/m]."""
    if depth <= limit:
        return 0.5 * k * depth * depth
    over = depth - limit
    return k * (0.5 * depth * depth + GROWTH * LINEAR_TO * over * over * over / (3.0 * limit))


@device
def tangent_stiffness(k: Float, depth: Float, limit: Float) -> Float:
    """df/dd [N/m²]."""
    if depth <= limit:
        return k
    return k * (1.0 + 2.0 * GROWTH * LINEAR_TO * (depth - limit) / limit)
