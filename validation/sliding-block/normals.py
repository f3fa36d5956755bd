"""Averaged normals of classical contact at the leading corner of a rectangle on a plane, integrated exactly.

The nodal gradient g_i = Σ_p V_p ∇φ_ip = ∮ N_i n dS is that of the shape function's resolution of the body;
with the bilinear N_i and an axis-parallel rectangle the integral is a product of two integrals along the
axes. Coordinates are in cells, x along the plane."""

import math

import numpy as np


def corner_tilt(corner: float, interface: float) -> float:
    """Steepest tilt [°] of the averaged normal, out of the block and towards its front, at the shared nodes
    of the leading corner.

    Parameters
    ----------
    corner
        Position of the block's leading face, 0 to 1, behind it the block is long [cells].
    interface
        Height of the plane's surface and the block's lower face over a grid line, 0 ≤ interface < 1 [cells].
    """
    tilts = []
    for node_x in (-1.0, 0.0, 1.0):
        for node_y in (0.0, 1.0):
            block = np.array(
                [
                    _hat(corner - node_x) * _hat_integral(interface - node_y, math.inf),
                    -_hat(interface - node_y) * _hat_integral(-math.inf, corner - node_x),
                ]
            )
            plane = np.array([0.0, _hat(interface - node_y)])
            if plane[1] > 0.0 and _hat_integral(-math.inf, corner - node_x) > 0.0:
                normal = block - plane
                tilts.append(math.degrees(math.atan2(normal[0], -normal[1])))
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
