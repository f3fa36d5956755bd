"""Outputs of another code as the results of a run: the same groups, series, costs and attributes."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.results import Frame, RunHeader, RunWriter, provenance
from mpmfw.state.fields import CONTACT_SERIES, PARTICLE_FIELDS, SERIES_FIELDS, FloatArray

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.scene import Scene

_SERIES = tuple(one for one in SERIES_FIELDS if one.name not in ("strain_energy", "total_energy"))
_FORCE = tuple(one for one in CONTACT_SERIES if one.name == "contact_force")
_POINTS = tuple(one for one in PARTICLE_FIELDS if one.name in ("position", "velocity", "mass"))

#: Mass, position and velocity below which products of them are finite.
_HUGE = 1e60


@dataclass(frozen=True)
class RunCost:
    """Cost of the process, start and input included."""

    cpu_time: float  #: [s]
    wall_time: float  #: [s]
    peak_memory: float  #: [B]


@dataclass(frozen=True)
class MovingPoints:
    """Points of one body that carry its mass, at every output."""

    mass: FloatArray  #: (n,) [kg], in 2D per metre of thickness
    position: FloatArray  #: (time, n, dim) [m]
    velocity: FloatArray  #: (time, n, dim) [m/s]


@dataclass(frozen=True)
class MotionOutputs:
    """Motion of the deformable bodies, with steps, costs and notes of the run."""

    time: FloatArray  #: of the outputs, the first at 0 (time,) [s]
    bodies: Mapping[str, MovingPoints]
    code: str  #: title, version, float width and device, for the table
    steps: int  #: of time
    costs: Mapping[str, float] = field(default_factory=dict)  #: those of a run that are known better
    status: str = "ok"  #: ``ok``, ``suspect: …`` or ``failed: …``
    notes: tuple[str, ...] = ()  #: how the run differs from the scene
    versions: Mapping[str, str] = field(default_factory=dict)  #: of the code and its libraries

    def check(self, scene: Scene, cost: RunCost | None) -> None:
        """Refuse a cost and outputs that are not those of a scene; a ValueError says why."""
        if self.bodies.keys() != (soft := deformable(scene)).keys():
            raise ValueError(f"it has the bodies {sorted(self.bodies)}; expected {sorted(soft)}")
        frames = self.time.size
        if self.time.shape != (frames,) or self.time.dtype.kind != "f" or not np.isfinite(self.time).all():
            raise ValueError("its times are not a row of finite numbers")
        if frames < 1 or self.time[0] != 0.0 or not (np.diff(self.time) > 0.0).all():
            raise ValueError("its times do not rise from 0")
        if type(self.steps) is not int or not 0 <= self.steps < 2**63:
            raise ValueError("its number of steps is not a whole number from 0")
        known = {} if cost is None else asdict(cost)
        for name, value in (*known.items(), *self.costs.items()):
            if not isinstance(value, int | float) or isinstance(value, bool) or not 0.0 <= value < math.inf:
                raise ValueError(f"its {name} is not a finite number from 0")
        for name, points in self.bodies.items():
            shape = (frames, points.mass.size, scene.dim)
            if {one.dtype.kind for one in (points.mass, points.position, points.velocity)} != {"f"}:
                raise ValueError(f"'{name}' has arrays of other kinds than float")
            if points.position.shape != shape or points.velocity.shape != shape or not shape[1]:
                raise ValueError(f"'{name}' has arrays of other shapes than {shape}")
            if points.mass.shape != shape[1:2] or not ((points.mass > 0.0) & (points.mass < _HUGE)).all():
                raise ValueError(f"'{name}' has points without mass")
            if not (np.abs(points.position) < _HUGE).all() or not (np.abs(points.velocity) < _HUGE).all():
                raise ValueError(f"'{name}' has a motion that is not finite")


def deformable(scene: Scene) -> dict[str, Any]:
    """Return the bodies that are not rigid, or that forces move, by name."""
    return {name: body for name, body in scene.bodies.items() if not body.prescribed}


def gravity_of(scene: Scene, *, settling: bool = False) -> FloatArray:
    """Return gravity of the motion, or that of ``settling`` before it (dim,) [m/s²]."""
    given = scene.settle.gravity if settling and scene.settle is not None else None
    table = given or scene.gravity
    return np.zeros(scene.dim) if table is None else np.array(table.at(0.0))


def output_times(scene: Scene, last: float) -> FloatArray:
    """Return the times of the outputs up to that of a code's last state [s]."""
    interval, reached = scene.time.output_interval, min(scene.time.end, (1.0 + 1e-6) * last)
    return np.asarray(interval * np.arange(int(reached / interval + 1e-6) + 1.0))


def at_times(time: FloatArray, known: Any, values: Any) -> FloatArray:
    """Return values of the times ``known`` at others by linear interpolation (time, …)."""
    times, stacked = np.asarray(known), np.asarray(values)
    after = np.clip(np.searchsorted(times, time), 1, len(times) - 1)
    share = np.clip((time - times[after - 1]) / (times[after] - times[after - 1]), 0.0, 1.0)
    share = share.reshape(-1, *(1,) * (stacked.ndim - 1))
    return np.asarray((1.0 - share) * stacked[after - 1] + share * stacked[after])


def printable(text: str) -> str:
    """Return at most 500 printable characters of a code's text, as one line."""
    kept = "".join(one if one.isprintable() else " " for one in text[:5000])
    return " ".join(kept.split())[:500]


def results_of(
    scene: Scene,
    outputs: MotionOutputs,
    cost: RunCost | None,
    attributes: Mapping[str, Any],
    path: str | os.PathLike[str] | None,
) -> xr.DataTree:
    """Write outputs as a run's file, or keep them in memory where ``path`` is None.

    Where two bodies meet, the contact force is the momentum that one of them gains, without gravity's part.
    That body must be free of held sides. If neither is, no force is written."""
    pairs = tuple(f"{a}-{b}" for a, b, _ in scene.pairs)
    alone = [name for name in outputs.bodies if not scene.bodies[name].sides]
    other = scene.loads or scene.boundaries
    by_momentum = _FORCE if len(pairs) == 1 and alone and not other else ()
    counts = {name: len(points.mass) for name, points in outputs.bodies.items()}
    header = RunHeader(
        dim=scene.dim,
        bodies=tuple(scene.bodies),
        pairs=pairs,
        particle_count=counts,
        fields=(*_SERIES, *by_momentum, *(_POINTS if scene.output.particles else ())),
        attributes={
            "title": scene.title or scene.name,
            "scene": scene.text,
            "shape": "",
            "code": printable(outputs.code),
            "cell_size": scene.grid.cell_size,
            "outputs": "exact",
            "output_interval": scene.time.output_interval,
            "code_versions": {name: printable(each) for name, each in outputs.versions.items()},
            "notes": [printable(note) for note in outputs.notes],
            **attributes,
            **provenance(),
        },
    )
    moments = {name: _moments(points) for name, points in outputs.bodies.items()}
    with RunWriter(path, header) as writer:
        for k, time in enumerate(outputs.time):
            series = _series(scene, moments, k)
            if by_momentum:
                force, first = np.zeros((1, scene.dim)), next(iter(scene.bodies))
                if k:
                    mass, momentum = moments[alone[0]]["mass"], moments[alone[0]]["linear_momentum"]
                    rate = (momentum[k] - momentum[k - 1]) / (time - outputs.time[k - 1])
                    force[0] = (rate - mass * gravity_of(scene)) * (1.0 if alone[0] == first else -1.0)
                series["contact_force"] = force
            points = outputs.bodies.values() if scene.output.particles else ()
            arrays = {
                "position": [one.position[k] for one in points],
                "velocity": [one.velocity[k] for one in points],
                "mass": [one.mass for one in points],
            }
            particles = {name: np.concatenate(parts) for name, parts in arrays.items() if parts}
            writer.write(Frame(time=float(time), particles=particles, series=series))
        writer.finish({**_costs(outputs, cost), "status": printable(_status(scene, outputs))})
        return writer.results()


def _moments(points: MovingPoints) -> dict[str, Any]:
    """Return mass, momenta, angular velocity and energy of one body at all outputs."""
    mass, position, velocity = points.mass, points.position, points.velocity
    total = float(mass.sum())
    centre, mean = (np.einsum("p,tpd->td", mass, one) / total for one in (position, velocity))
    r, w = position - centre[:, None], velocity - mean[:, None]
    second = np.einsum("p,tpd,tpe->tde", mass, r, r)
    if position.shape[2] == 2:
        spin = np.einsum("p,tp->t", mass, r[..., 0] * w[..., 1] - r[..., 1] * w[..., 0])[:, None]
        turning = spin / np.trace(second, axis1=1, axis2=2)[:, None]
    else:
        spin = np.einsum("p,tpd->td", mass, np.cross(r, w))
        inertia = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
        turning = np.linalg.solve(inertia, spin[..., None])[..., 0]
    return {
        "mass": total,
        "centre_of_mass": centre,
        "mean_velocity": mean,
        "angular_velocity": turning,
        "linear_momentum": total * mean,
        "angular_momentum": spin,
        "kinetic_energy": 0.5 * np.einsum("p,tpd,tpd->t", mass, velocity, velocity),
    }


def _series(scene: Scene, moments: Mapping[str, Mapping[str, Any]], k: int) -> dict[str, Any]:
    """Return the series of output ``k``; rigid bodies are at rest."""
    series = {}
    for one in _SERIES:
        width = {"axis": scene.dim, "rotation": 1 if scene.dim == 2 else 3}
        rest: Any = np.zeros([width[dim] for dim in one.dims[1:]])
        values = [moments[name][one.name][k] if name in moments else rest for name in scene.bodies]
        series[one.name] = np.array(values, dtype=float)
    for index, (name, body) in enumerate(scene.bodies.items()):
        if name not in moments:
            series["centre_of_mass"][index] = body.geometry.centroid
    return series


def _costs(outputs: MotionOutputs, cost: RunCost | None) -> dict[str, float]:
    points = sum(len(one.mass) for one in outputs.bodies.values())
    known = asdict(cost) if cost else dict.fromkeys(("cpu_time", "wall_time", "peak_memory"), math.nan)
    none = {"settle_time": 0.0, "output_time": math.nan, "gap_time": 0.0, "compile_time": math.nan}
    return {**known, **none, **outputs.costs, "steps": outputs.steps, "material_points": points}


def _status(scene: Scene, outputs: MotionOutputs) -> str:
    end = float(scene.time.end)
    if outputs.status.startswith("failed") or outputs.time[-1] >= end * (1.0 - 1e-6):
        return outputs.status
    return f"failed: it ended at {outputs.time[-1]:.6g} s of {end:g} s"


def run_code(code: Any, scene: Scene, folder: Any, output: str | os.PathLike[str] | None) -> xr.DataTree:
    """Run a code on a scene in an empty folder and return its results; a failed run raises MpmfwError."""
    code.prepare(scene, folder)
    code.run(folder)
    tree: xr.DataTree = code.read(folder, output)
    if str(tree.attrs["status"]).startswith("failed"):
        raise MpmfwError(str(tree.attrs["status"]).removeprefix("failed: "))
    return tree
