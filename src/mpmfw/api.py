"""What plug-ins may import, together with :mod:`mpmfw.kernels` and :mod:`mpmfw_testing`.

A plug-in is a class with an ``Options`` model (pydantic), a constructor that takes those options as keywords,
a ``name``, and implementations of the hooks of :class:`mpmfw.plugin.hookspecs.HookSpecs`, marked with
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

from mpmfw.contact.detection import Detection
from mpmfw.contact.force_contact import ForceContact, ForceLaw
from mpmfw.contact.friction import FrictionLaw
from mpmfw.contact.impulse_contact import ImpulseContact, ImpulseLaw
from mpmfw.contact.records import PairRecords
from mpmfw.contact.row_contact import ContactLaw
from mpmfw.contact.rows import ContactRows
from mpmfw.contact.strategy import ContactStrategy
from mpmfw.errors import MpmfwError, PluginError, SceneError, SimulationError
from mpmfw.geometry.base import BodyGeometry
from mpmfw.geometry.layout import Layout
from mpmfw.geometry.plane import PlaneGeometry
from mpmfw.geometry.solid import SolidGeometry
from mpmfw.plugin.base import NoOptions, PlugIn
from mpmfw.plugin.boundary import Boundary
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.load import BodyLoad, Load, LoadedFacets, SurfaceLoad
from mpmfw.plugin.material import Material
from mpmfw.plugin.measure import About, Exact, Measure, Measured, Reference
from mpmfw.plugin.named import NamedPlugIn, shares_near
from mpmfw.plugin.output_series import OutputSeries
from mpmfw.plugin.setup import Setup
from mpmfw.plugin.shape_function import ShapeFunction, check_inside, empty_stencil
from mpmfw.state.fields import CONTACT_SERIES, AnyArray, Field, FloatArray, IndexArray, IntArray
from mpmfw.state.history import NotSaved, check_indices
from mpmfw.state.structs import Body, Grid, OutsideGrid, Pair, Particles, State, Stencil, Surface
from mpmfw.state.time_table import TimeTable, number_in_time, problems_in_time, vector_in_time
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
    "NotSaved",
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
    "check_indices",
    "check_inside",
    "empty_stencil",
    "hookimpl",
    "number_in_time",
    "problems_in_time",
    "quantity",
    "shares_near",
    "vector_in_time",
]
