"""The base class of adapters to other codes, and what they write and return."""

from __future__ import annotations

from mpmfw.codes.code import (
    Code,
    Elasticity,
    elasticity,
    gravity_of,
    points_of_body,
    read_arrays,
    spin_of,
    starting_velocity,
    surface_velocity,
)
from mpmfw.codes.outputs import MotionOutputs, MovingPoints
from mpmfw.codes.process import ProcessLimits, read_log
from mpmfw.scene import Scene

__all__ = [
    "Code",
    "Elasticity",
    "MotionOutputs",
    "MovingPoints",
    "ProcessLimits",
    "Scene",
    "elasticity",
    "gravity_of",
    "points_of_body",
    "read_arrays",
    "read_log",
    "spin_of",
    "starting_velocity",
    "surface_velocity",
]
