"""Field declarations: name, dims, unit and meaning of every array, for code, files and documentation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.int64]
IndexArray: TypeAlias = npt.NDArray[np.int32]
AnyArray: TypeAlias = npt.NDArray[Any]

Group: TypeAlias = Literal["particles", "grid", "surface", "contact", "series"]


@dataclass(frozen=True, slots=True)
class Field:
    """Declaration of an array: name, meaning and layout."""

    name: str  #: the same in the code, the file and the documentation
    dims: tuple[str, ...]  #: such as ``("particle", "axis")``
    unit: str  #: SI, as CF writes it (``"m s-1"``); ``"1"`` if dimensionless
    long_name: str  #: meaning, with the symbol of the formulation where there is one
    group: Group = "particles"  #: of the results' file
    dtype: str = "f8"  #: NumPy type code
    output: bool = False  #: whether frames of the results' file hold the field
    missing: bool = False  #: whether NaN means a missing value; otherwise it fails the run
    mean: bool = False  #: whether a series is a mean over the time since the last output

    def allocate(self, sizes: Mapping[str, int]) -> AnyArray:
        """Return a zero array of shape ``[sizes[dim] for dim in dims]``."""
        return np.zeros(tuple(map(sizes.__getitem__, self.dims)), dtype=self.dtype)

    @property
    def attributes(self) -> dict[str, str]:
        """CF attributes of the variable."""
        mean = {"cell_methods": "time: mean"} if self.mean else {}
        return {"units": self.unit, "long_name": self.long_name, **mean}


_P = ("particle",)
_PA = ("particle", "axis")
_PAA = ("particle", "axis", "axis2")

PARTICLE_FIELDS: tuple[Field, ...] = (
    Field("position", _PA, "m", "position x_p", output=True),
    Field("velocity", _PA, "m s-1", "velocity v_p", output=True),
    Field("mass", _P, "kg m-1", "mass m_p (in 2D per metre of thickness, or of the whole body)", output=True),
    Field("initial_volume", _P, "m2", "volume V_p in the reference state (in 2D the area in the plane)"),
    Field("volume", _P, "m2", "volume V_p = J V_p0 (in 2D the area in the plane)", output=True),
    Field("deformation_gradient", _PAA, "1", "deformation gradient F_p", output=True),
    Field("velocity_gradient", _PAA, "s-1", "velocity gradient L_p of the last step"),
    Field("stress", _PAA, "Pa", "in-plane Cauchy stress sigma_p", output=True),
)

AFFINE_FIELD = Field("affine", _PAA, "s-1", "affine velocity gradient C_p")
MOMENT_FIELD = Field("moment", _PAA, "m2 s-1", "affine moment B_p = sum phi v q^T (apic)")

_grid = partial(Field, group="grid")
_NA = ("node", "axis")

GRID_FIELDS: tuple[Field, ...] = (
    _grid("position", _NA, "m", "node position x_i"),
    _grid("mass", ("node",), "kg m-1", "nodal mass m_i of one velocity field"),
    _grid("momentum", _NA, "kg m s-1 m-1", "nodal momentum (m v)_i"),
    _grid("start_velocity", _NA, "m s-1", "nodal velocity as projected, before any force or correction"),
    _grid("force", _NA, "N m-1", "nodal force f_i"),
    _grid("velocity", _NA, "m s-1", "nodal velocity at the end of the step"),
)

_surface = partial(Field, group="surface")
_SA = ("surface_node", "axis")

SURFACE_FIELDS: tuple[Field, ...] = (
    _surface("position", _SA, "m", "surface node position x_s", output=True),
    _surface("displacement", _SA, "m", "motion of x_s over the last step"),
    _surface("tributary", ("surface_node",), "m", "tributary length of the surface node at the start"),
)

_series = partial(Field, group="series", output=True)
_B = ("body",)
_BA = ("body", "axis")
_BR = ("body", "rotation")
_ROTATION = "sum m (x-c) x (v-v_c) / sum m |x-c|^2 over material points, counter-clockwise positive"
_SPIN = "angular momentum of the material points about the centre of mass"

SERIES_FIELDS: tuple[Field, ...] = (
    _series("centre_of_mass", _BA, "m", "centre of mass of the material points"),
    _series("mean_velocity", _BA, "m s-1", "linear momentum over mass"),
    _series("angular_velocity", _BR, "rad s-1", _ROTATION),
    _series("linear_momentum", _BA, "kg m s-1 m-1", "linear momentum"),
    _series("angular_momentum", _BR, "kg m2 s-1 m-1", _SPIN),
    _series("kinetic_energy", _B, "J m-1", "kinetic energy sum m v^2 / 2 of the material points"),
    _series("strain_energy", _B, "J m-1", "stored elastic energy"),
    _series("total_energy", _B, "J m-1", "kinetic and strain energy"),
)

_DISSIPATED = "energy dissipated by the material since the run began, such as plastic work"
_WITHIN = "kinetic energy of the affine motion within the material points"
MATERIAL_WORK = _series("material_dissipation", _B, "J m-1", _DISSIPATED)
AFFINE_ENERGY = _series("affine_energy", _B, "J m-1", _WITHIN)

_PAIR = ("pair",)
_ON_FIRST = "force on the pair's first body, mean over the output interval (its integral is the impulse)"
_ALONG = "its part along the surface, mean over the output interval"

CONTACT_SERIES: tuple[Field, ...] = (
    _series("contact_force", ("pair", "axis"), "N m-1", _ON_FIRST, mean=True),
    _series("friction_force", ("pair", "axis"), "N m-1", _ALONG, mean=True),
    _series("contact_count", _PAIR, "1", "surface or grid nodes in contact at the output"),
    _series("frictional_work", _PAIR, "J m-1", "energy dissipated by friction since time zero"),
    _series("contact_energy", _PAIR, "J m-1", "energy stored in contact springs (zero without springs)"),
    _series("damping_work", _PAIR, "J m-1", "energy dissipated by contact dashpots since time zero"),
)

_GAP = "least distance between the bodies' surfaces; negative where they penetrate"
MIN_GAP = _series("min_gap", _PAIR, "m", _GAP)

#: Stages of a step and of a run, in the order of the tables.
STAGES = ("shape", "projection", "force", "contact", "gather", "material", "gap", "output")

#: Stages that count as the cost of the method; ``gap`` (surfaces tracked for the diagnostic alone) and
#: ``output`` do not.
STEP_STAGES = STAGES[:6]

_ALONE = "largest resident memory of a process that did this run alone; NaN where it had done others before"
#: Root attributes of a run that are its costs: name, unit, meaning.
COSTS: tuple[tuple[str, str, str], ...] = (
    ("steps", "1", "time steps"),
    ("material_points", "1", "material points"),
    ("cpu_time", "s", "CPU time of the steps, without compilation, settling, gap diagnostic and output"),
    ("wall_time", "s", "wall time of the steps"),
    ("peak_memory", "B", _ALONE),
    ("settle_time", "s", "CPU time of settling"),
    ("output_time", "s", "CPU time of output"),
    ("gap_time", "s", "CPU time of the gap diagnostic"),
    ("compile_time", "s", "time of compilation or of loading compiled code"),
)
