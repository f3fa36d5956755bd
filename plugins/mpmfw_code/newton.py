"""Newton's implicit MPM against a rigid plane (newton-physics, with Warp)."""

from __future__ import annotations

import importlib.util
import json
import math
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from mpmfw.api import OptionsModel, SceneError, Time
from mpmfw.api.code import (
    Code,
    MotionOutputs,
    MovingPoints,
    Scene,
    deformable,
    elasticity,
    gravity_of,
    is_turned,
    points_of_body,
    read_arrays,
    spin_of,
    starting_velocity,
)

#: Cells across a plane scene, which Newton has as a slab that is free on both sides.
SLAB = 2.0

#: Points so near to faces of cells move off them by OFF_FACE, in cells: one that lies on the face of a cell
#: without other points gives a motion that is not finite (Newton 1.8).
ON_FACE, OFF_FACE = 1e-4, 1e-3


class NewtonOptions(OptionsModel):
    """Settings of Newton's solver; those without a word here keep Newton's own values."""

    collider_basis: Literal["S2", "Q1", "pic", "pic8", "pic27"] = Field(
        default="S2", description="contact at nodes (S2, quadratic; Q1) or at material points (pic…)"
    )
    step: Time = Field(default=1.0 / 480.0, gt=0, description="longest time step, 1/480 s by default")
    tolerance: float = Field(default=1e-4, gt=0, description="of the solver of a step")
    max_iterations: int = Field(default=250, ge=1, description="of the solver of a step")
    device: Literal["cpu", "cuda"] = Field(default="cpu", description="processor; cuda was not measured here")


class Newton(Code):
    """Newton, implicit MPM in single precision: one elastic body on a rigid plane.

    Its points are mpmfw's. A plane scene becomes a slab of two cells, free on both sides. Steps are of
    ``step`` or shorter, so that every output is met. Rest before the motion is found by steps that are ten
    times as long, after each of which the body stops."""

    name = "newton"
    title = "Newton"
    install = "pip install 'mpmfw[newton]'"
    best: ClassVar = {"collider_basis": "pic27"}
    versions = ("1.8",)
    reads = frozenset({"gravity", "settle", "spin", "start"})
    Options = NewtonOptions
    options: NewtonOptions

    def refusals(self, scene: Scene) -> Iterator[tuple[str, str]]:
        soft, count = deformable(scene), len(scene.bodies)
        lowest = min((body.geometry.bounds[0][1] for body in soft.values()), default=math.inf)
        if len(soft) != 1:
            yield "bodies", "has no contact between bodies of material points; expected one and rigid = true"
        if count != len(soft) + 1:
            yield "bodies", f"is run with one rigid body; the scene has {count - len(soft)}"
        for name, body in scene.bodies.items():
            shape, key = body.geometry, f"bodies.{name}.geometry"
            if body.sides:
                yield f"bodies.{name}.sides", "conditions on sides are not written"
            if name not in soft and (shape.type not in ("rectangle", "box") or is_turned(shape)):
                yield key, "stands as a level plane; expected an upright rectangle or box"
            elif name not in soft and lowest < shape.bounds[1][1] - 1e-9:
                yield key, "stands as a level plane; expected the other body above it"

    def write(self, scene: Scene, folder: Path) -> None:
        """Write ``newton.json`` and the points, ``points.npz``, in three dimensions, y upwards."""
        (name, body), (_, plane) = scene.bodies.items()  # a rigid body is the last
        cell = scene.grid.cell_size
        layout = points_of_body(scene, name)
        position, volume, velocity = layout.position, layout.volume, starting_velocity(scene, name, layout)
        if scene.dim == 2:
            layers = max(2, round(SLAB * cell / float(body.particles.size)))
            depth = SLAB * cell * (np.arange(layers) + 0.5) / layers
            position = np.column_stack([np.repeat(position, layers, axis=0), np.tile(depth, len(volume))])
            volume = np.repeat(volume * SLAB * cell / layers, layers)
            velocity = np.pad(np.repeat(velocity, layers, axis=0), ((0, 0), (0, 1)))
        near = np.abs(position / cell - np.round(position / cell)).min(axis=0) < ON_FACE
        shift = cell * np.where(near, OFF_FACE, 0.0)
        position = position + shift
        gradient = np.cross(spin_of(scene, name), np.eye(3)).T  # of v = ω × r
        solid, settle = elasticity(scene, name), scene.settle
        interval, end = scene.time.output_interval, scene.time.end
        times = np.append(interval * np.arange(math.ceil(end / interval - 1e-9)), end)
        facts = {
            "cell_size": cell,
            "density": solid.density,
            "young_modulus": solid.young,
            "poisson_ratio": solid.poisson,
            "height": float(plane.geometry.bounds[1][1] + shift[1]),
            "shift": shift.tolist(),
            "friction": scene.pairs[0][2],
            "gravity": [*gravity_of(scene).tolist(), 0.0][:3],
            "settle_gravity": settle and [*gravity_of(scene, settling=True).tolist(), 0.0][:3],
            "settle_tolerance": settle and settle.tolerance,
            "times": times.tolist(),
            **self.options.model_dump(),
        }
        (folder / "newton.json").write_text(json.dumps(facts, indent=1), encoding="utf-8")
        path = folder / "points.npz"
        np.savez(path, position=position, volume=volume, velocity=velocity, gradient=gradient)

    def program(self) -> str | None:
        found = all(importlib.util.find_spec(name) for name in ("newton", "warp"))
        return sys.executable if found else None

    def version(self, program: str) -> str:
        text = "from importlib.metadata import version as v; print(v('newton'), v('warp-lang'))"
        try:
            done = subprocess.run([program, "-I", "-c", text], capture_output=True, text=True, timeout=60)
            found = re.fullmatch(r"\d[\w.+-]* \d[\w.+-]*", done.stdout.strip())
        except (OSError, ValueError, subprocess.TimeoutExpired):
            found = None
        if found is None or done.returncode:
            raise SceneError(f"code {self.name}: {program} has no Newton; {self.install}")
        return found.group()

    def command(self, program: str, folder: Path) -> Sequence[str]:
        # without names of this package
        return [program, "-I", str(Path(__file__).with_name("newton_driver.py")), str(folder)]

    def outputs(self, scene: Scene, folder: Path) -> MotionOutputs:
        """Read ``motion.npz`` and ``motion.json``, which the driver writes last."""
        names = ("motion.json", "newton.json")
        facts, asked = (json.loads((folder / name).read_text(encoding="utf-8")) for name in names)
        motion = read_arrays(folder / "motion.npz")
        time, position, velocity = (motion[key].astype(float) for key in ("time", "position", "velocity"))
        position -= np.array(asked["shift"])
        mass = asked["density"] * read_arrays(folder / "points.npz")["volume"]
        notes = [
            "Newton's elastic law is Hooke's in logarithmic strain, with the scene's moduli at small strain",
            f"implicit steps of {facts['step']:.3g} s; its time step has no limit of stability",
            "no drag of air (default 1); a dense grid: on the default, sparse, the motion was not finite",
        ]
        if scene.dim == 2:
            width = SLAB * asked["cell_size"]
            mass = mass / width
            notes.append(f"a slab of {width:g} m, free on both sides, instead of plane strain")
        if asked["settle_gravity"] is not None:
            notes.append(
                f"settled in {facts['settle_steps']} steps of at most 200, ten times as long, each from rest,"
                f" to changes below {asked['settle_tolerance']:g} of the whole"
            )
            if not facts["settled"]:
                notes.append("it was not at rest after settling")
        if asked["device"] == "cuda":
            notes.append("costs are those of a graphics processor and one core beside it")
        version = str(facts["versions"]["newton"])
        (name,) = deformable(scene)
        points = MovingPoints(mass, position[..., : scene.dim], velocity[..., : scene.dim])
        return MotionOutputs(
            time=time,
            bodies={name: points},
            code=f"Newton {version}, float32, {facts['device']}",
            steps=facts["steps"],
            costs={key: facts[key] for key in ("cpu_time", "wall_time", "settle_time", "compile_time")},
            status="ok" if version.rpartition(".")[0] in self.versions else self.judged(version),
            notes=tuple(notes),
            versions={str(key): str(value) for key, value in facts["versions"].items()},
        )
