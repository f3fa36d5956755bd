"""The base class of adapters to other codes, and what they write and return."""

from __future__ import annotations

from mpmfw.codes.code import (
    SIDES,
    Code,
    Elasticity,
    elasticity,
    is_turned,
    points_of_body,
    read_arrays,
    spin_of,
    starting_velocity,
    surface_velocity,
)
from mpmfw.codes.hexahedra import HexMesh, mesh_of_body
from mpmfw.codes.outputs import MotionOutputs, MovingPoints, at_times, deformable, gravity_of, output_times
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
    "deformable",
    "elasticity",
    "gravity_of",
    "is_turned",
    "mesh_of_body",
    "output_times",
    "points_of_body",
    "read_arrays",
    "read_log",
    "spin_of",
    "starting_velocity",
    "surface_velocity",
]
