"""Principal values and directions of symmetric tensors."""

from __future__ import annotations

import math

from mpmfw.kernels import device
from mpmfw.kernels.types import Floats

#: Sweeps of Jacobi's rotations at most; three to five reach round-off.
SWEEPS = 12


@device
def push_forward(f: Floats, metric: Floats, out: Floats) -> None:
    """Write f metric fᵀ (3, 3) to ``out``."""
    for i in range(3):
        for j in range(3):
            out[i, j] = 0.0
            for a in range(3):
                for b in range(3):
                    out[i, j] += f[i, a] * metric[a, b] * f[j, b]


@device
def compose(values: Floats, vectors: Floats, out: Floats) -> None:
    """Write Σ values_a n_a n_aᵀ (3, 3) to ``out``; n_a are the columns of ``vectors``."""
    for i in range(3):
        for j in range(3):
            out[i, j] = 0.0
            for a in range(3):
                out[i, j] += values[a] * vectors[i, a] * vectors[j, a]


@device
def rotate(b: Floats, vectors: Floats, i: int, j: int) -> None:
    """Make ``b[i, j]`` zero by a rotation of the axes ``i`` and ``j``; ``vectors`` turn with them."""
    ratio = 0.5 * (b[j, j] - b[i, i]) / b[i, j]
    tangent = math.copysign(1.0, ratio) / (abs(ratio) + math.sqrt(ratio * ratio + 1.0))
    cosine = 1.0 / math.sqrt(tangent * tangent + 1.0)
    sine = tangent * cosine
    for m in range(3):
        b[m, i], b[m, j] = cosine * b[m, i] - sine * b[m, j], sine * b[m, i] + cosine * b[m, j]
    for m in range(3):
        b[i, m], b[j, m] = cosine * b[i, m] - sine * b[j, m], sine * b[i, m] + cosine * b[j, m]
        u, v = vectors[m, i], vectors[m, j]
        vectors[m, i], vectors[m, j] = cosine * u - sine * v, sine * u + cosine * v


@device
def diagonalise(b: Floats, values: Floats, vectors: Floats) -> None:
    """Write eigenvalues of a symmetric ``b`` (3, 3), and its eigenvectors as columns; destroys ``b``."""
    for i in range(3):
        for j in range(3):
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(SWEEPS):
        size = b[0, 0] ** 2 + b[1, 1] ** 2 + b[2, 2] ** 2
        if b[0, 1] ** 2 + b[0, 2] ** 2 + b[1, 2] ** 2 <= 1e-34 * size:
            break
        for i in range(2):
            for j in range(i + 1, 3):
                if b[i, j] != 0.0:
                    rotate(b, vectors, i, j)
    for a in range(3):
        values[a] = b[a, a]
