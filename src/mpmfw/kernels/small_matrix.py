"""Determinant and inverse of 2×2 and 3×3 matrices, written out: a library call costs more than the
arithmetic."""

from __future__ import annotations

from mpmfw.kernels._jit import device
from mpmfw.kernels.types import Float, Floats


@device
def determinant(a: Floats, spacing: tuple[float, ...]) -> Float:
    """det a; the length of ``spacing`` is the dimension."""
    if len(spacing) == 2:
        return a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
    return (
        a[0, 0] * (a[1, 1] * a[2, 2] - a[1, 2] * a[2, 1])
        - a[0, 1] * (a[1, 0] * a[2, 2] - a[1, 2] * a[2, 0])
        + a[0, 2] * (a[1, 0] * a[2, 1] - a[1, 1] * a[2, 0])
    )


@device
def invert(a: Floats, out: Floats, spacing: tuple[float, ...]) -> Float:
    """Write a⁻¹ to ``out`` and return det a; a singular matrix gives inf or nan, as in NumPy."""
    det = determinant(a, spacing)
    if len(spacing) == 2:
        out[0, 0] = a[1, 1] / det
        out[0, 1] = -a[0, 1] / det
        out[1, 0] = -a[1, 0] / det
        out[1, 1] = a[0, 0] / det
    else:
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            for m in range(3):
                n, o = (m + 1) % 3, (m + 2) % 3
                out[m, i] = (a[j, n] * a[k, o] - a[j, o] * a[k, n]) / det
    return det
