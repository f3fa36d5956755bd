"""Materials with plastic flow: their history, and principal values and directions of symmetric tensors."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from mpmfw.api.types import AnyArray, Field, FloatArray, Particles, Setup, State, hookimpl
from mpmfw.kernels import Struct, device
from mpmfw.kernels.types import Floats
from mpmfw_material._isotropic import Isotropic

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


#: In three dimensions whatever the grid's are: plastic flow leaves the plane.
SPACE = (1.0, 1.0, 1.0)

PLASTIC_STRAIN = Field(
    "plastic_strain", ("particle",), "1", "equivalent plastic strain, the sum of its increments", output=True
)
PLASTIC_METRIC = Field(
    "plastic_metric", ("particle", "three", "three2"), "1", "inverse plastic right Cauchy-Green tensor"
)
PLASTIC_WORK = Field("plastic_work", ("particle",), "J m-3", "plastic work per reference volume")
OPENED = Field("opened", ("particle",), "1", "logarithm of the volume that tension has opened")
MODULUS = Field("wave_modulus", ("particle",), "Pa", "modulus of plane waves under the present pressure")


class Flow(Struct):
    """Plastic flow of the points."""

    metric: Floats  #: (n, 3, 3) C_p⁻¹
    strain: Floats  #: (n,) equivalent plastic strain
    work: Floats  #: (n,) [J/m³]


@device
def pad(deformation_gradient: Floats, p: int, f: Floats, spacing: tuple[float, ...]) -> None:
    """Write F of point ``p`` to ``f`` (3, 3); plane strain has F_zz = 1."""
    for i in range(3):
        for j in range(3):
            f[i, j] = 1.0 if i == j else 0.0
    for i in range(len(spacing)):
        for j in range(len(spacing)):
            f[i, j] = deformation_gradient[p, i, j]


class Plastic(Isotropic):
    """Base of materials with plastic flow; all of one model share the arrays of the history."""

    dissipates = True
    history_fields: ClassVar[tuple[Field, ...]] = (PLASTIC_STRAIN, PLASTIC_METRIC, PLASTIC_WORK)

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [*self.history_fields]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Allocate the history, or take that of another material of this model."""
        self.spacing = setup.state.grid.tensor_spacing
        self.flow = Flow(
            metric=self.shared(setup, PLASTIC_METRIC),
            strain=self.shared(setup, PLASTIC_STRAIN),
            work=self.shared(setup, PLASTIC_WORK),
        )
        for own in self.slices:
            self.flow.metric[own] = np.eye(3)

    def shared(self, setup: Setup, field: Field) -> AnyArray:
        """Return the array of a field, allocated once for all materials of this model."""
        known = setup.state.arrays.get(f"{self.name}/{field.name}")
        return setup.allocate(self.name, field, three=3, three2=3) if known is None else known

    @hookimpl
    def diagnostics(self, state: State, points: bool) -> dict[str, AnyArray]:  # noqa: ARG002
        """The plastic strain of all points, 0 in other materials."""
        return {"plastic_strain": self.flow.strain.copy()} if points else {}

    def dissipated_by_points(self, particles: Particles, own: slice) -> FloatArray:  # noqa: ARG002
        work: FloatArray = self.flow.work[own]
        return work
