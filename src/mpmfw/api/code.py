"""The base class of adapters to other codes, and what they write and return."""

from __future__ import annotations

from mpmfw.codes.code import (
    SIDES,
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
from mpmfw.codes.hexahedra import HexMesh, mesh_of_body
from mpmfw.codes.outputs import MotionOutputs, MovingPoints, at_times
from mpmfw.codes.process import ProcessLimits, read_log
from mpmfw.scene import Scene

__all__ = [
    "SIDES",
    "Code",
    "Elasticity",
    "HexMesh",
    "MotionOutputs",
    "MovingPoints",
    "ProcessLimits",
    "Scene",
    "at_times",
    "elasticity",
    "gravity_of",
    "mesh_of_body",
    "points_of_body",
    "read_arrays",
    "read_log",
    "spin_of",
    "starting_velocity",
    "surface_velocity",
]
