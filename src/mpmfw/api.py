"""What plug-ins may import, together with :mod:`mpmfw.kernels`.

A plug-in is a class with an ``Options`` model (pydantic), a constructor that takes those options as keywords,
a ``name``, and implementations of the hooks of :class:`mpmfw.hookspecs.HookSpecs`, marked with
:data:`hookimpl`. Options with a unit are annotated with the quantity types of :mod:`mpmfw.units`, which are
named here too.
"""

from __future__ import annotations

from typing import Any, ClassVar, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict

from mpmfw.errors import SceneError, SimulationError
from mpmfw.fields import CONTACT_SERIES, AnyArray, Field, FloatArray, IndexArray, IntArray
from mpmfw.hookspecs import hookimpl
from mpmfw.setup import Setup
from mpmfw.state import Body, Grid, OutsideGrid, Pair, Particles, State, Stencil, Surface
from mpmfw.units import (
    Acceleration,
    Angle,
    AngularVelocity,
    Density,
    Length,
    Number,
    Pressure,
    Time,
    Velocity,
    quantity,
)


class NoOptions(BaseModel):
    """Options of a plug-in that has none."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class PlugIn:
    """Base of plug-ins: a name, and options validated by the plug-in's own model."""

    name: ClassVar[str]
    Options: ClassVar[type[BaseModel]] = NoOptions

    def __init__(self, **options: Any) -> None:
        self.options = self.Options(**options)

    @classmethod
    def from_options(cls, options: BaseModel) -> Self:
        """Make the plug-in from an instance of its model, keeping which options were set."""
        return cls(**{key: getattr(options, key) for key in options.model_fields_set})

    @property
    def label(self) -> str:
        """Name and the options that were set, for tables and coordinates."""
        changed = ", ".join(
            f"{key}={getattr(self.options, key)}" for key in sorted(self.options.model_fields_set)
        )
        return f"{self.name}({changed})" if changed else self.name


class ShapeFunction(PlugIn):
    """Base of shape functions.

    Subclasses implement the hooks ``particle_reach``, ``interpolate`` and ``interpolate_surface``.
    """

    #: Dimensions that the shape function works in.
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    #: Whether boundary nodes may carry no mass of the body whose surface touches them (point-like particles).
    massless_boundary: ClassVar[bool] = False
    #: Whether Σ φ q qᵀ may be singular, so that the affine field must be taken from Σ v ∇φᵀ.
    singular_spread: ClassVar[bool] = False
    #: What ``auto`` means for scheme and transfer.
    auto_scheme: ClassVar[str] = "usl"
    auto_transfer: ClassVar[str] = "aflip"


class ContactStrategy(PlugIn):
    """Base of contact strategies.

    Subclasses implement the hooks of their place in the step. Their series are those of
    :data:`mpmfw.fields.CONTACT_SERIES` as far as they declare them.
    """

    #: One velocity field for all bodies, or one per body.
    velocity_fields: ClassVar[Literal["single", "per_body"]] = "per_body"
    #: Whether the strategy acts through tracked outlines (``state.surface``), which it then pays for.
    needs_surface: ClassVar[bool] = False
    #: How surface nodes are mapped to the grid: ``auto`` follows the shape function.
    surface_map: Literal["auto", "plain", "mass_weighted"] = "auto"
    #: Whether the strategy adds inertia of its own to the nodes, which a body's rotational inertia would have to know.
    adds_mass: bool = False
    #: Whether the strategy uses the pairs' friction.
    uses_friction: ClassVar[bool] = False
    #: Dimensions that the strategy works in.
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)

    def parts(self) -> list[Any]:
        """Plug-ins that the strategy's options call for beside it, registered with it."""
        return []

    def reach(self, cell_size: float) -> float | None:  # noqa: ARG002
        """Distance of two bodies' bounding boxes [m] beyond which nothing is searched; None without a search."""
        return None

    def monitors(self) -> list[Any]:
        """Plug-ins that watch the strategy's own stability, registered where a scene says ``output.stability``."""
        return []

    def restart(self) -> None:
        """Time zero, after settling: forget accumulated work and impulse, keep the state of contact."""


class Material(PlugIn):
    """Base of materials: one instance for each material of the scene, told its bodies' slices in ``setup``.

    Subclasses implement the hook ``update_stress`` and the methods below.
    """

    #: Slices of the material points made of this material.
    slices: tuple[slice, ...] = ()

    @property
    def bulk_modulus(self) -> float:
        """Bulk modulus K [Pa] at small strain."""
        raise NotImplementedError

    @property
    def shear_modulus(self) -> float:
        """Shear modulus G [Pa] at small strain."""
        raise NotImplementedError

    def energy_density(self, deformation_gradient: FloatArray) -> FloatArray:
        """Stored energy per reference volume W(F), (n,) [J/m^3]; F is (n, dim, dim), plane strain in 2D."""
        raise NotImplementedError

    def cauchy_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Full Cauchy stress, (n, 3, 3) [Pa], out-of-plane components included; for outputs."""
        raise NotImplementedError


def empty_stencil(points: int, entries: int, dim: int, *, gradient: bool = True) -> Stencil:
    """A table with ``entries`` entries for each of ``points`` points; without gradients for surface nodes."""
    return Stencil(
        row=np.arange(points + 1, dtype=np.int64) * entries,
        nodes=np.zeros(points * entries, dtype=np.int32),
        weight=np.zeros(points * entries),
        gradient=np.zeros((points * entries if gradient else 0, dim)),
    )


def check_inside(index: int) -> None:
    """Raise :class:`OutsideGrid` if a fill kernel returned the index of a point outside its window."""
    if index >= 0:
        raise OutsideGrid(index)


__all__ = [
    "CONTACT_SERIES",
    "Acceleration",
    "Angle",
    "AngularVelocity",
    "AnyArray",
    "Body",
    "ContactStrategy",
    "Density",
    "Field",
    "FloatArray",
    "Grid",
    "IndexArray",
    "IntArray",
    "Length",
    "Material",
    "NoOptions",
    "Number",
    "OutsideGrid",
    "Pair",
    "Particles",
    "PlugIn",
    "Pressure",
    "SceneError",
    "Setup",
    "ShapeFunction",
    "SimulationError",
    "State",
    "Stencil",
    "Surface",
    "Time",
    "Velocity",
    "check_inside",
    "empty_stencil",
    "hookimpl",
    "quantity",
]
