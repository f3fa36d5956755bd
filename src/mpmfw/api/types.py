"""Names for plug-ins of all kinds: arrays and structs of a run, hooks and errors.

``hookimpl``
    Marks a method as the implementation of the hook with its name; arguments that are not used may be left
    out.
``FloatArray``, ``IntArray``, ``IndexArray``, ``AnyArray``
    Types of NumPy arrays of float64, int64, int32 (node indices in a :class:`Stencil`) and any type. Shapes
    stand where the types are used.
``INTERFACE``
    Version of the plug-in interface. A class that says ``interface = N`` is refused where N is another one.
"""

from __future__ import annotations

from mpmfw.errors import MpmfwError, PluginError, SceneError, SimulationError
from mpmfw.plugin.base import NoOptions, OptionsModel, PlugIn
from mpmfw.plugin.discovery import INTERFACE
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray, IndexArray, IntArray
from mpmfw.state.history import NotSaved, check_indices
from mpmfw.state.structs import Body, Grid, Pair, Particles, Products, State, Stencil, Surface

__all__ = [
    "INTERFACE",
    "AnyArray",
    "Body",
    "Field",
    "FloatArray",
    "Grid",
    "IndexArray",
    "IntArray",
    "MpmfwError",
    "NoOptions",
    "NotSaved",
    "OptionsModel",
    "Pair",
    "Particles",
    "PlugIn",
    "PluginError",
    "Products",
    "SceneError",
    "Setup",
    "SimulationError",
    "State",
    "Stencil",
    "Surface",
    "check_indices",
    "hookimpl",
]
