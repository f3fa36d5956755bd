"""Kernels of material points alone, several at a time: deformation, and the affine field carried along.

Arguments are those of the table in :mod:`mpmfw.kernels`, where shapes and units stand.
"""

from __future__ import annotations

import numpy as np

from mpmfw.kernels import lanes
from mpmfw.kernels._jit import kernel
from mpmfw.kernels.arithmetic import determinant, set_to_motion
from mpmfw.kernels.lanes import WIDTH
from mpmfw.kernels.types import Floats, Points


@kernel
def transport_affine(points: Points, affine: Floats, dt: float, spacing: tuple[float, ...]) -> None:
    """C ← C (1 + Δt C)⁻¹ of every point.

    A field v(x) = C x carried along x ← (1 + Δt C) x has, at the new positions, the gradient C (1 + Δt C)⁻¹.
    Without it a spinning disc loses angular momentum at second order in Δt every step.
    """
    c, inverse = lanes.matrix(spacing, spacing), lanes.matrix(spacing, spacing)
    motion = lanes.matrix(spacing, spacing)
    for p in range(0, len(points.mass), WIDTH):
        own = lanes.points_from(p, len(points.mass))
        lanes.read(affine, own, c, spacing)
        set_to_motion(motion, dt, c, spacing)
        lanes.invert(motion, inverse, spacing)
        lanes.multiply(c, inverse, motion, spacing)
        lanes.write(affine, own, motion, spacing)


@kernel
def update_deformation(points: Points, dt: float, spacing: tuple[float, ...]) -> int:
    """F ← (1 + Δt L) F and V = det(F) V⁰ of all points.

    Return the first one whose det F is not positive (NaN included), or −1.
    """
    f, l = lanes.matrix(spacing, spacing), lanes.matrix(spacing, spacing)
    motion, volume = lanes.matrix(spacing, spacing), lanes.matrix((0.0,), (0.0,))
    bad = -1
    for p in range(0, len(points.volume), WIDTH):
        own = lanes.points_from(p, len(points.volume))
        lanes.read(points.deformation_gradient, own, f, spacing)
        lanes.read(points.velocity_gradient, own, l, spacing)
        set_to_motion(motion, dt, l, spacing)
        lanes.multiply(motion, f, l, spacing)
        lanes.write(points.deformation_gradient, own, l, spacing)
        jacobian = determinant(l, spacing)
        lanes.read(points.initial_volume, own, volume, spacing)
        volume[0, 0] = jacobian * volume[0, 0]
        lanes.write(points.volume, own, volume, spacing)
        if bad < 0 and not lanes.within(jacobian, 0.0, np.inf):
            for q in own:
                if bad < 0 and not points.volume[q] > 0.0:
                    bad = q
    return bad
