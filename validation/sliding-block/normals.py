"""Averaged normals of classical contact at the leading corner of a rectangle on a plane, integrated exactly.

The nodal gradient g_i = Σ_p V_p ∇φ_ip = ∮ N_i n dS is that of the shape function's resolution of the body;
with the bilinear N_i and an axis-parallel rectangle the integral is a product of two integrals along the
axes. Coordinates are in cells, x along the plane."""

import math

import numpy as np


def corner_tilt(corner: float, interface: float) -> float:
    """Steepest tilt [°] of the averaged normal at the leading corner, out of the block and towards its front.

    The block's leading face is at ``corner``, 0 to 1; behind it the block is long. The plane's surface and
    the block's lower face lie ``interface`` cells over a grid line, 0 ≤ interface < 1.
    """
    tilts = []
    for x in (corner + 1.0, corner, corner - 1.0):  # from the nodes that both bodies share
        for y in (interface, interface - 1.0):
            block = _hat(x) * _hat_integral(y, math.inf), -_hat(y) * _hat_integral(-math.inf, x)
            if _hat(y) > 0.0 and _hat_integral(-math.inf, x) > 0.0:
                tilts.append(math.degrees(math.atan2(block[0], _hat(y) - block[1])))
    return max(tilts)


def steepest_tilt(interface: float) -> float:
    """Steepest tilt [°] while the corner crosses one cell."""
    return max(corner_tilt(corner, interface) for corner in np.linspace(0.0, 1.0, 101))


def _hat(x: float) -> float:
    """N(x), linear, of a node at zero."""
    return max(0.0, 1.0 - abs(x))


def _hat_integral(lower: float, upper: float) -> float:
    """∫ N dx from ``lower`` to ``upper``."""

    def from_left(x: float) -> float:
        x = min(max(x, -1.0), 1.0)
        return 0.5 * (1.0 + x) ** 2 if x < 0.0 else 1.0 - 0.5 * (1.0 - x) ** 2

    return from_left(upper) - from_left(lower)
