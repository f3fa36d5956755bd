"""The base class of adapters to other codes, and what they write and return."""

from __future__ import annotations

from mpmfw.codes.code import Code, elastic_constants, points_of_body, read_arrays
from mpmfw.codes.outputs import MotionOutputs, MovingPoints
from mpmfw.codes.process import ProcessLimits, read_log
from mpmfw.scene import Scene

__all__ = [
    "Code",
    "MotionOutputs",
    "MovingPoints",
    "ProcessLimits",
    "Scene",
    "elastic_constants",
    "points_of_body",
    "read_arrays",
    "read_log",
]
