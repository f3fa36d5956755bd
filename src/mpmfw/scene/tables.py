"""The tables of a scene that the core reads; models of plug-ins' options are in the plug-ins."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BaseModel, Field, Strict, field_validator, model_validator
from pydantic.json_schema import SkipJsonSchema

from mpmfw.geometry.base import PositiveLength
from mpmfw.scene.base import (
    AccelerationVector,
    Friction,
    GravityRow,
    MomentPoint,
    NonNegativeTime,
    Position,
    PositiveNumber,
    PositiveTime,
    Table,
)
from mpmfw.scene.bodies import AnyBody, Body, RigidBody
from mpmfw.units import Acceleration, Angle, Density, Frequency, Number

#: Options of the chosen plug-in, an instance of its own model; scenes write them in a table of its name.
Options = SkipJsonSchema[BaseModel | None]


class Grid(Table):
    """Background grid of square or cubic cells of ``cell_size`` [m], from ``lower`` to ``upper`` [m], in the
    plane, in space, or in the half-plane of bodies of revolution."""

    cell_size: PositiveLength
    lower: Position
    upper: Position
    axisymmetric: bool = False  #: x is the radius, and y the axis

    @functools.cached_property
    def dim(self) -> int:
        """Number of space dimensions."""
        return len(self.lower)


class Time(Table):
    """Duration, output interval, and step relative to the stability limit.

    With ``exact`` outputs steps are shortened to end at each output. With ``nearest`` ones steps keep their
    length; an output is then the end of the nearest step, with the time of that step. The last output is
    exact.
    """

    end: PositiveTime  #: of the motion [s]
    output_interval: PositiveTime  #: time between records [s]
    outputs: Literal["exact", "nearest"] = "exact"
    safety: PositiveNumber = 0.5  #: fraction of the stability limit that a step takes
    step: PositiveTime | None = None  #: fixed step [s]; None lets the limit decide


class Stepping(Table):
    """Order of the step and transfer between grid and particles; ``auto`` follows the shape function."""

    scheme: Literal["auto", "usl", "musl", "usf"] = "auto"
    transfer: Literal["auto", "flip", "pic", "apic", "tpic", "aflip"] = "auto"
    transported: bool | None = None
    pic_fraction: Annotated[Number, Field(ge=0, le=1)] | None = None

    def chosen(self, shape: Any) -> tuple[str, str]:
        """Return scheme and transfer; ``auto`` is that of a shape function (its class or an object)."""
        scheme = str(shape.auto_scheme) if self.scheme == "auto" else self.scheme
        return scheme, str(shape.auto_transfer) if self.transfer == "auto" else self.transfer


class Shape(Table):
    """The shape function and its options."""

    method: str
    options: Options = Field(default=None, exclude=True)


class ContactPair(Table):
    """Friction coefficient and contact of one pair of bodies; None means that of all pairs."""

    bodies: Annotated[tuple[str, str], Strict(False)]
    friction: Friction | None = None
    method: str | None = None
    options: Options = Field(default=None, exclude=True)

    @model_validator(mode="after")
    def _has_an_effect(self) -> Self:
        """Refuse a pair that sets neither friction nor a method."""
        if self.friction is None and self.method is None:
            raise ValueError("expected friction, a method, or detection and law")
        return self


class Contact(Table):
    """The contact strategy, its options, and pairs with another friction or contact.

    A scene may write ``detection`` and ``law`` instead of a method; ``tables`` are then those of its options.
    ``friction_law`` is None for Coulomb's law; another law has its options in a separate table."""

    method: str
    friction: Friction = 0.0
    friction_law: str | None = None
    pairs: Annotated[tuple[ContactPair, ...], Strict(False)] = ()
    options: Options = Field(default=None, exclude=True)
    friction_options: SkipJsonSchema[Options] = Field(default=None, exclude=True)
    tables: SkipJsonSchema[tuple[str, ...]] = Field(default=(), exclude=True)


class Damping(Table):
    """Viscous stress by the stiffness: times [s], or a share of critical damping at a frequency [Hz]."""

    bulk: NonNegativeTime = 0.0
    shear: NonNegativeTime = 0.0
    critical: PositiveNumber | None = None
    frequency: Annotated[Frequency, Field(gt=0)] | None = None

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        """Refuse a mixture of both forms, half of one, and no damping at all."""
        by_share = (self.critical is not None) + (self.frequency is not None)
        if by_share == 1 or (by_share > 0) == (self.bulk + self.shear > 0.0):
            raise ValueError("expected bulk, shear or both, or critical and frequency")
        return self

    @property
    def times(self) -> tuple[float, float]:
        """Times of bulk and shear [s]; a share ξ of critical at a frequency f is ξ / (π f)."""
        if self.critical is None or self.frequency is None:
            return self.bulk, self.shear
        time = self.critical / (math.pi * self.frequency)
        return time, time


class Material(Table):
    """A material model, its reference density [kg/m^3], its damping and its options."""

    model: str
    density: Annotated[Density, Field(gt=0)]
    damping: Damping | None = None
    options: Options = Field(default=None, exclude=True)


class Named(Table):
    """A plug-in with its options, and the bodies that it concerns; None means all."""

    model: str
    bodies: Annotated[tuple[str, ...], Strict(False), Field(min_length=1)] | None = None
    options: Options = Field(default=None, exclude=True)


class Load(Named):
    """A load, and the bodies that it acts on."""


class Boundary(Named):
    """A motion prescribed by time and place, and its bodies."""


class Series(Named):
    """Series of a plug-in, and the bodies that it measures."""


class Gravity(Table):
    """Gravity as a vector [m/s^2], or a magnitude [m/s^2] with a tilt [rad] that drives bodies towards +x.

    Or ``table``: rows (t, g_x, g_y[, g_z]), linear in between and constant outside.
    """

    vector: AccelerationVector | None = None
    magnitude: Annotated[Acceleration, Field(gt=0)] | None = None
    tilt: Angle | None = None
    table: Annotated[tuple[GravityRow, ...], Strict(False), Field(min_length=2)] | None = None

    def at(self, time: float) -> tuple[float, ...]:
        """Components (dim,) [m/s^2] at ``time`` [s]; by the tilt g (sin θ, -cos θ)."""
        if self.table is not None:
            times, *components = np.array(self.table).T
            return tuple(float(np.interp(time, times, values)) for values in components)
        if self.vector is not None:
            return tuple(self.vector)
        g, tilt = self.magnitude or 0.0, self.tilt or 0.0
        return g * math.sin(tilt), -g * math.cos(tilt)

    @property
    def is_constant(self) -> bool:
        """Return True if it is the same at all times."""
        return self.table is None


class Settle(Table):
    """Settling before the motion, until the residual force is below ``tolerance`` of the internal forces."""

    tolerance: Annotated[Number, Field(gt=0, lt=1)] = 1e-3
    max_time: PositiveTime | None = None
    gravity: Gravity | None = None  #: without a table


class Sleep(Table):
    """Exclude bodies at rest from the steps until something disturbs them.

    ``strain`` bounds the speed of every material point, relative to the body's wave speed: the strain of a
    plane wave of that speed. The body must stay below it for ``crossings`` times the wave's travel time along
    its longest edge.
    """

    strain: Annotated[Number, Field(gt=0, lt=1)] = 1e-6
    crossings: PositiveNumber = 10.0


class Output(Table):
    """What a run records in addition to the series of every run."""

    gap: bool = True  #: least gap of every pair
    particles: bool = True  #: fields of material points
    #: Time between the outputs that have fields of material points [s]; None has them at every output. The
    #: first and the last output always have them.
    particle_interval: PositiveTime | None = None
    surface: bool = True  #: fields of surface nodes
    energy: bool = True  #: kinetic, affine and strain energy of every body
    #: Energy balance: work, dissipation and residual, measured in every step; a run whose energy grows is
    #: stopped.
    ledger: bool = False
    #: The time step, its limit and what sets it; stability series of the contact strategy.
    stability: bool = False
    #: What moments of contact are about: each body's ``centre_of_mass``, or a point [m]; None has none.
    contact_moment: MomentPoint | None = None
    side_moment: Position | None = None  #: point of the moments of fixed and driven sides [m]; None has none


class Reference(Table):
    """The kind of reference for the motion, bundled or announced under ``mpmfw.reference``."""

    kind: str


class Tables(Table):
    """All tables of a scene."""

    title: str = ""
    allow_overlap: bool = False
    allow_unstable: bool = False
    threads: Annotated[int, Strict(), Field(ge=1)] = 1
    grid: Grid
    time: Time
    stepping: Stepping = Stepping()
    shape: Shape
    contact: Contact | None = None
    materials: Annotated[Mapping[str, Material], Field(min_length=1)]
    bodies: Annotated[Mapping[str, AnyBody], Field(min_length=1)]
    gravity: Gravity | None = None
    loads: Mapping[str, Load] = {}
    boundaries: Mapping[str, Boundary] = {}
    settle: Settle | None = None
    sleep: Sleep | None = None
    output: Output = Output()
    outputs: Mapping[str, Series] = {}
    reference: Reference | None = None

    @functools.cached_property
    def dim(self) -> int:
        """Number of space dimensions."""
        return self.grid.dim

    @field_validator("bodies")
    @classmethod
    def _rigid_bodies_last(cls, bodies: Mapping[str, Body]) -> Mapping[str, Body]:
        """Put rigid bodies last; their mass points follow the grid's nodes."""
        return dict(sorted(bodies.items(), key=lambda each: isinstance(each[1], RigidBody)))
