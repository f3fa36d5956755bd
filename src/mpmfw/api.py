"""What plug-ins may import, together with :mod:`mpmfw.kernels` and :mod:`mpmfw_testing`.

A plug-in is a class with an ``Options`` model (pydantic), a constructor that takes those options as keywords,
a ``name``, and implementations of the hooks of :class:`mpmfw.hookspecs.HookSpecs`, marked with
:data:`hookimpl`. It derives from :class:`ContactStrategy`, :class:`ShapeFunction`, :class:`Material`, :class:`BodyLoad`,
:class:`SurfaceLoad`, :class:`Boundary` or :class:`OutputSeries`, and is announced as an entry point of the group
``mpmfw.contact``, ``mpmfw.shape``, ``mpmfw.material``, ``mpmfw.load``, ``mpmfw.boundary`` or ``mpmfw.output``.
A geometry, of the group ``mpmfw.geometry``, is a model itself, derived from :class:`PlaneGeometry` or :class:`SolidGeometry`; a
:class:`Measure` and a :class:`Reference`, of ``mpmfw.measure`` and ``mpmfw.reference``, read results and scenes alone.

Names that are neither classes nor functions:

``hookimpl``
    Marks a method as the implementation of the hook with its name; arguments that are not used may be left out.
``CONTACT_SERIES``
    Declarations (:class:`Field`) of the series that contact strategies may record, one value a pair: contact_force
    and friction_force [N/m], contact_count, frictional_work, contact_energy and damping_work [J/m].
``FloatArray``, ``IntArray``, ``IndexArray``, ``AnyArray``
    Types of NumPy arrays of float64, int64, int32 (node indices in a :class:`Stencil`) and any type. Shapes stand where
    the types are used.
``Length``, ``Time``, ``Velocity``, ``AngularVelocity``, ``Acceleration``, ``Angle``, ``Pressure``, ``Force``, ``Density``
    And ``Number``: annotations for fields of an ``Options`` model in m, s, m/s, rad/s, m/s^2, rad, Pa, N, kg/m^3 and 1. A
    scene gives them as a bare number in that unit or as a string with any unit that converts to it; the plug-in gets a
    float. A unit of another kind is refused. :func:`quantity` makes one for any other unit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from mpmfw.boundary import Boundary
from mpmfw.contact.detection import Detection
from mpmfw.contact.friction import FrictionLaw
from mpmfw.contact.law import ContactLaw, ForceLaw, ImpulseLaw
from mpmfw.contact.records import PairRecords
from mpmfw.contact.row_contact import ForceContact, ImpulseContact
from mpmfw.contact.rows import ContactRows
from mpmfw.contact.strategy import ContactStrategy
from mpmfw.errors import MpmfwError, PluginError, SceneError, SimulationError
from mpmfw.fields import CONTACT_SERIES, AnyArray, Field, FloatArray, IndexArray, IntArray
from mpmfw.geometry.base import BodyGeometry
from mpmfw.geometry.layout import Layout
from mpmfw.geometry.plane import PlaneGeometry
from mpmfw.geometry.solid import SolidGeometry
from mpmfw.hookspecs import hookimpl
from mpmfw.load import BodyLoad, Load, LoadedFacets, SurfaceLoad
from mpmfw.measure import About, Exact, Measure, Measured, Reference
from mpmfw.named import NamedPlugIn, shares_near
from mpmfw.output_series import OutputSeries
from mpmfw.plugin import NoOptions, PlugIn
from mpmfw.setup import Setup
from mpmfw.state import Body, Grid, OutsideGrid, Pair, Particles, State, Stencil, Surface
from mpmfw.time_table import TimeTable, number_in_time, problems_in_time, vector_in_time
from mpmfw.units import (
    Acceleration,
    Angle,
    AngularVelocity,
    Density,
    Force,
    Length,
    Number,
    Pressure,
    Time,
    Velocity,
    quantity,
)


class ShapeFunction(PlugIn):
    """Base of shape functions.

    Subclasses implement the hooks ``particle_reach``, ``interpolate`` and ``interpolate_surface``.
    """

    #: Dimensions that the shape function works in.
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    #: Whether boundary nodes may carry no mass of the body whose surface touches them (point-like particles).
    massless_boundary: ClassVar[bool] = False
    #: Degree of the B-splines that are the boundary basis: 1 bilinear.
    boundary_degree: ClassVar[int] = 1
    #: Whether nodes with mass are those of two grids, whose indices are all even or all odd; the boundary basis is then the
    #: compact kernel of each, over two cells to either side.
    staggered: ClassVar[bool] = False
    #: Whether Σ φ q qᵀ may be singular, so that the affine field must be taken from Σ v ∇φᵀ.
    singular_spread: ClassVar[bool] = False
    #: Whether the nodes of every row of its tables ascend: then several threads share the nodes out when they project.
    rows_ascend: ClassVar[bool] = False
    #: Largest Courant number c Δt / h that is not refused.
    courant: ClassVar[float] = 0.8
    auto_scheme: ClassVar[str] = "usl"  #: what ``auto`` means for the scheme
    auto_transfer: ClassVar[str] = "aflip"  #: what ``auto`` means for the transfer
    #: Treatment of a free body's rotational inertia where the scene says none: ``spin``, ``exact`` or ``lumped``.
    auto_rotation: ClassVar[str] = "spin"


class Material(PlugIn):
    """Base of materials: one instance for each material of the scene, told its bodies' slices in ``setup``.

    Subclasses implement the hook ``update_stress``, the moduli, and :meth:`energy_density` and :meth:`cauchy_stress` where F says
    all. One whose points have a history implements :meth:`energy_of_points` and :meth:`stress_of_points` instead, and allocates
    the history in ``setup`` (:meth:`Setup.allocate`), so that it is saved with the run.
    """

    #: Whether its points lose energy, which :meth:`dissipated_by_points` says.
    dissipates: ClassVar[bool] = False

    #: Slices of the material points made of this material.
    slices: tuple[slice, ...] = ()

    def over_points(self, kernel: Callable[..., None], particles: Particles, *arguments: Any) -> None:
        """``kernel(first, last, *arguments)`` for the material's points, of which several threads have a part each.

        A kernel that is called so writes to the points ``first:last`` alone, and asks no other.
        """
        if particles.threads is not None:
            particles.threads.over_slices(kernel, self.slices, *arguments)
            return
        for own in self.slices:
            kernel(own.start, own.stop, *arguments)

    @property
    def bulk_modulus(self) -> float:
        """Bulk modulus K [Pa] at small strain."""
        raise NotImplementedError

    @property
    def shear_modulus(self) -> float:
        """Shear modulus G [Pa] at small strain."""
        raise NotImplementedError

    def energy_density(self, deformation_gradient: FloatArray) -> FloatArray:
        """Stored energy per reference volume W(F), (n,) [J/m^3].

        ``deformation_gradient`` is F, (n, dim, dim); plane strain in 2D, F_zz = 1.
        """
        raise NotImplementedError

    def cauchy_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Full Cauchy stress σ(F), (n, 3, 3) [Pa], out-of-plane components included; for outputs.

        ``deformation_gradient`` is F, (n, dim, dim); plane strain in 2D, F_zz = 1.
        """
        raise NotImplementedError

    def energy_of_points(self, particles: Particles, own: slice) -> FloatArray:
        """Stored energy per reference volume of the points ``own`` of ``particles``, (n,) [J/m^3]; by F alone W(F)."""
        return self.energy_density(particles.deformation_gradient[own])

    def stress_of_points(self, particles: Particles, own: slice) -> FloatArray:
        """Full Cauchy stress of the points ``own`` of ``particles``, (n, 3, 3) [Pa]; by F alone σ(F)."""
        return self.cauchy_stress(particles.deformation_gradient[own])

    def dissipated_by_points(self, particles: Particles, own: slice) -> FloatArray:
        """Energy that the points ``own`` of ``particles`` have lost since the start, per reference volume (n,) [J/m^3]."""
        return np.zeros(len(particles.mass[own]))


def empty_stencil(points: int, entries: int, dim: int, *, gradient: bool = True) -> Stencil:
    """An interpolation table to be filled, all zero, with the same number of entries for every point.

    Parameters
    ----------
    points
        Number of material points or surface nodes, n.
    entries
        Number of nodes that a point touches, such as 2**dim with linear functions.
    dim
        Number of space dimensions.
    gradient
        Whether there are gradients, (n entries, dim) [1/m]; surface nodes need none, and get an array of length 0.
    """
    return Stencil(
        row=np.arange(points + 1, dtype=np.int64) * entries,
        nodes=np.zeros(points * entries, dtype=np.int32),
        weight=np.zeros(points * entries),
        gradient=np.zeros((points * entries if gradient else 0, dim)),
    )


def check_inside(index: int) -> None:
    """Say which point left its window, if a fill kernel returned one.

    Parameters
    ----------
    index
        What the kernel returned: the first point outside its window, or −1.

    Raises
    ------
    OutsideGrid
        ``index`` is not negative. The core then lays the window anew and asks again.
    """
    if index >= 0:
        raise OutsideGrid(index)


__all__ = [
    "CONTACT_SERIES",
    "About",
    "Acceleration",
    "Angle",
    "AngularVelocity",
    "AnyArray",
    "Body",
    "BodyGeometry",
    "BodyLoad",
    "Boundary",
    "ContactLaw",
    "ContactRows",
    "ContactStrategy",
    "Density",
    "Detection",
    "Exact",
    "Field",
    "FloatArray",
    "Force",
    "ForceContact",
    "ForceLaw",
    "FrictionLaw",
    "Grid",
    "ImpulseContact",
    "ImpulseLaw",
    "IndexArray",
    "IntArray",
    "Layout",
    "Length",
    "Load",
    "LoadedFacets",
    "Material",
    "Measure",
    "Measured",
    "MpmfwError",
    "NamedPlugIn",
    "NoOptions",
    "Number",
    "OutputSeries",
    "OutsideGrid",
    "Pair",
    "PairRecords",
    "Particles",
    "PlaneGeometry",
    "PlugIn",
    "PluginError",
    "Pressure",
    "Reference",
    "SceneError",
    "Setup",
    "ShapeFunction",
    "SimulationError",
    "SolidGeometry",
    "State",
    "Stencil",
    "Surface",
    "SurfaceLoad",
    "Time",
    "TimeTable",
    "Velocity",
    "check_inside",
    "empty_stencil",
    "hookimpl",
    "number_in_time",
    "problems_in_time",
    "quantity",
    "shares_near",
    "vector_in_time",
]
