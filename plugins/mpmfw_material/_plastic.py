"""History of materials with plastic flow: plastic metric, plastic strain and plastic work."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from mpmfw.api.types import AnyArray, Field, FloatArray, Particles, Setup, State, hookimpl
from mpmfw.kernels import Struct, device
from mpmfw.kernels.types import Floats
from mpmfw_material._isotropic import Isotropic

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
        """Plastic work, (n,) [J/m^3]."""
        work: FloatArray = self.flow.work[own]
        return work
