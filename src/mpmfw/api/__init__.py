"""Names that plug-ins may import: all names of the modules below, :mod:`mpmfw.kernels` and
:mod:`mpmfw_testing`.

A plug-in is a class with an ``Options`` model (pydantic), a constructor that takes those options as keywords,
a ``name``, and implementations of the hooks of :class:`mpmfw.plugin.hookspecs.HookSpecs`, marked with
``hookimpl``. It derives from a base class of its kind, and is announced as an entry point of the group
``mpmfw.KIND``. Geometries, measures, references and adapters to other codes have no hooks.

======================== ================================================================================
module                   groups of entry points
======================== ================================================================================
``mpmfw.api.contact``    ``mpmfw.contact``, ``mpmfw.detection``, ``mpmfw.law``, ``mpmfw.friction``
``mpmfw.api.shape``      ``mpmfw.shape``
``mpmfw.api.material``   ``mpmfw.material``
``mpmfw.api.load``       ``mpmfw.load``, ``mpmfw.boundary``, ``mpmfw.output``
``mpmfw.api.geometry``   ``mpmfw.geometry``
``mpmfw.api.results``    ``mpmfw.measure``, ``mpmfw.reference``
``mpmfw.api.code``       ``mpmfw.code``; only this module has its names
``mpmfw.api.types``      needed by all: arrays and structs of a run, hooks, errors
``mpmfw.api.units``      needed by all: annotations of options that have a unit
======================== ================================================================================
"""

# ruff: noqa: F403
from __future__ import annotations

from mpmfw.api import contact, geometry, load, material, results, shape, types, units
from mpmfw.api.contact import *
from mpmfw.api.geometry import *
from mpmfw.api.load import *
from mpmfw.api.material import *
from mpmfw.api.results import *
from mpmfw.api.shape import *
from mpmfw.api.types import *
from mpmfw.api.units import *

__all__: list[str] = []
__all__ += contact.__all__
__all__ += geometry.__all__
__all__ += load.__all__
__all__ += material.__all__
__all__ += results.__all__
__all__ += shape.__all__
__all__ += types.__all__
__all__ += units.__all__
