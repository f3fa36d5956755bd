"""What isotropic materials share: moduli by K and G or by E and ν, and plane strain in three dimensions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError, model_validator

from mpmfw.api.material import Material
from mpmfw.api.types import FloatArray, OptionsModel, Setup, hookimpl
from mpmfw.api.units import Pressure

_PAIRS = ("bulk_modulus", "shear_modulus"), ("youngs_modulus", "poissons_ratio")
_PRESSURE = TypeAdapter(Pressure)


class Moduli(OptionsModel):
    """Moduli at small strain: K and G, or E and ν, from which K and G follow."""

    bulk_modulus: Pressure = Field(gt=0, description="bulk modulus K")
    shear_modulus: Pressure = Field(gt=0, description="shear modulus G")
    youngs_modulus: Pressure | None = Field(
        None, gt=0, description="Young's modulus E, with poissons_ratio instead of K and G"
    )
    poissons_ratio: float | None = Field(
        None, gt=-1, lt=0.5, description="Poisson's ratio ν, with youngs_modulus"
    )

    @model_validator(mode="before")
    @classmethod
    def _one_pair(cls, values: Any) -> Any:
        """K = E / (3 (1 − 2ν)), G = E / (2 (1 + ν))."""
        first, second = ([name for name in names if name in values] for names in _PAIRS)
        if not second:
            return values
        if len(second) == 1:
            (other,) = set(_PAIRS[1]) - set(second)
            raise ValueError(f"'{second[0]}' goes with '{other}', which is missing")
        try:
            e = float(_PRESSURE.validate_python(values["youngs_modulus"]))
            nu = float(values["poissons_ratio"])
            found = e / (3.0 * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu))
        except (ValidationError, ValueError, TypeError, ZeroDivisionError):
            found = 1.0, 1.0  # what is wrong with E or ν is told by their own fields
        if first and [values.get(name) for name in _PAIRS[0]] != list(found):
            raise ValueError(
                "expected bulk_modulus and shear_modulus, or youngs_modulus and poissons_ratio, not both"
            )
        return {**values, **dict(zip(_PAIRS[0], found, strict=True))}


class Isotropic(Material):
    """Base of materials with :class:`Moduli` among their options."""

    Options: ClassVar[type[Moduli]] = Moduli
    options: Moduli

    @property
    def bulk_modulus(self) -> float:
        return float(self.options.bulk_modulus)

    @property
    def shear_modulus(self) -> float:
        return float(self.options.shear_modulus)


class Elastic(Isotropic):
    """Base of materials whose stress is a function of F alone, which a kernel evaluates."""

    @property
    def kernel(self) -> Callable[..., None]:
        """Write σ(F) [Pa] of points, called as ``kernel(first, last, F, stress, bulk, shear, spacing)``."""
        raise NotImplementedError

    @hookimpl
    def setup(self, setup: Setup) -> None:
        self.evaluate = self.kernel
        self.constants = self.bulk_modulus, self.shear_modulus, setup.state.grid.tensor_spacing

    def cauchy_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        f = pad_plane_strain(deformation_gradient)
        stress = np.empty_like(f)
        self.kernel(0, len(f), f, stress, self.bulk_modulus, self.shear_modulus, (1.0, 1.0, 1.0))
        return stress


def pad_plane_strain(deformation_gradient: FloatArray) -> FloatArray:
    """F in 3×3; plane strain has F_zz = 1."""
    n, dim, _ = deformation_gradient.shape
    f = np.zeros((n, 3, 3))
    f[:, 2, 2] = 1.0
    f[:, :dim, :dim] = deformation_gradient
    return f
