"""Uintah: input for its MPM on many machines, which is not started here, and its output."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Literal
from xml.etree.ElementTree import Element, ElementTree, indent, parse

import numpy as np
from pydantic import Field

from mpmfw.api import AnyArray, OptionsModel
from mpmfw.api.code import (
    SIDES,
    Code,
    MotionOutputs,
    MovingPoints,
    ProcessLimits,
    Scene,
    at_times,
    deformable,
    elasticity,
    gravity_of,
    is_turned,
    output_times,
)
from mpmfw.api.units import TimeTable

#: Variables that are saved at outputs.
SAVED = ("p.x", "p.velocity", "p.mass", "p.stress", "p.particleID", "KineticEnergy", "TotalMomentum")

#: Numbers of eight bytes that a point has of the variables that are read.
_READ = {"p.x": (3, "f8"), "p.velocity": (3, "f8"), "p.mass": (1, "f8"), "p.particleID": (1, "i8")}
_SHAPES = ("rectangle", "disc", "ring", "box", "ball")
_PLAIN = {"energy": "split", "hardening_exponent": 1.0, "rate_factor": 0.0}
_NO_HEAT = {"thermal_conductivity": 1, "specific_heat": 1}  # they must be named


class UintahOptions(OptionsModel):
    """Settings that a scene does not have."""

    contact: Literal["friction_LR", "friction_bard"] = Field(
        default="friction_LR", description="between deformable bodies: logistic regression, or Bardenhagen's"
    )
    interpolator: Literal["linear", "gimp", "cpdi"] = Field(default="gimp", description="shape functions")


class Uintah(Code):
    """Uintah's MPM (github.com/Uintah/Uintah), which runs elsewhere.

    Each body is a material, with the scene's number of points in a cell, in rows. A plane scene is one cell
    deep between planes of symmetry. A rigid body is the master of a contact with friction. The grid ends at
    the sides of bodies that are fixed, divided into whole cells; its ends hold all that reaches them."""

    name = "uintah"
    runs_elsewhere = True
    title = "Uintah"
    install = "mpmfw export SCENE --to uintah writes its input, and it runs elsewhere"
    reads = frozenset({"gravity", "motion"})
    models = ("neo_hookean", "j2")
    Options = UintahOptions
    options: UintahOptions

    def refusals(self, scene: Scene) -> Iterator[tuple[str, str]]:
        for name, body in scene.bodies.items():
            shape: Any = body.geometry
            if shape.type not in _SHAPES or any(getattr(shape, "angles", ())):
                yield f"bodies.{name}.geometry", f"expected {', '.join(_SHAPES)}, in space not turned"
            options = scene.materials[body.material].options if body.material else None
            for key in (key for key, value in _PLAIN.items() if getattr(options, key, value) != value):
                yield f"materials.{body.material}.{key}", f"its law has {_PLAIN[key]}"
            motion = getattr(getattr(body, "rigid", None), "motion", None)
            if motion and (motion.velocity is None or motion.angular_velocity or motion.surface_velocity):
                yield f"bodies.{name}.rigid.motion", "only a velocity is written"
        ends: dict[str, Any] = {}
        for name, side, axis, end in _held(scene):
            shape, fixed = scene.bodies[name].geometry, side.fixed
            bounds = [body.geometry.bounds[end][axis] for body in scene.bodies.values()]
            if fixed is not True and tuple(fixed or ()) != ("xyz"[axis],):
                yield f"bodies.{name}.sides", "are written if they are fixed, in all directions or across"
            elif ends.setdefault(side.side, fixed) != fixed or is_turned(shape):
                yield f"bodies.{name}.sides", f"expected upright ones, alike at every '{side.side}'"
            elif shape.bounds[end][axis] != (max if end else min)(bounds):
                yield f"bodies.{name}.sides", f"end the grid; expected nothing beyond '{side.side}'"

    def write(self, scene: Scene, folder: Path) -> None:
        """Write ``scene.ups``, and ``motion-N.txt`` for the material N where a rigid body moves."""
        interval, exactly = scene.time.output_interval, ("end_at_max_time_exactly", "clamp_time_to_output")
        time = {"initTime": 0, "maxTime": scene.time.end, "delt_min": 0, "delt_max": interval}
        saved = [_tag("save", label=label) for label in SAVED]
        bodies = _tag("MPM", {}, [*self._materials(scene), *self._contacts(scene, folder)])
        parts = [
            _tag("Meta", {"title": scene.title or scene.name}),
            _tag("SimulationComponent", type="mpm"),
            _tag("Time", {**time, "timestep_multiplier": 0.4, **dict.fromkeys(exactly, "true")}),
            _tag("DataArchiver", {"filebase": "scene.uda", "outputInterval": interval}, saved),
            _tag("MPM", {"time_integrator": "explicit", "interpolator": self.options.interpolator}),
            _tag("PhysicalConstants", {"gravity": (*gravity_of(scene), 0.0)[:3]}),
            _tag("MaterialProperties", {}, [bodies]),
            _grid(scene, 0 if self.options.interpolator == "linear" else 1),
        ]
        indent(root := _tag("Uintah_specification", {}, parts))
        ElementTree(root).write(folder / "scene.ups", encoding="utf-8", xml_declaration=True)

    def _materials(self, scene: Scene) -> Iterator[Element]:
        """Yield a material for each body; the moduli of a rigid one have no part."""
        cell = scene.grid.cell_size
        for name, body in scene.bodies.items():
            kind, law = "rigid", {"bulk_modulus": 1e9, "shear_modulus": 1e9}
            density, velocity, count = 1.0, (0.0,) * scene.dim, 2
            if body.material:
                solid, options = elasticity(scene, name), scene.materials[body.material].options
                kind, law = "comp_neo_hook", {"bulk_modulus": solid.bulk, "shear_modulus": solid.shear}
                density, velocity = solid.density, body.velocity or velocity
                count = max(1, round(cell / float(body.particles.size)))
                if scene.materials[body.material].model == "j2":
                    kind, plastic = "comp_neo_hook_plastic", ("yield_stress", "hardening_modulus")
                    law |= {key: getattr(options, key) for key in plastic} | {"alpha": 0.0}
            points = {"res": (count, count, count if scene.dim == 3 else 1), "velocity": (*velocity, 0.0)[:3]}
            made = _tag("geom_object", {**points, "temperature": 300}, [_shape(body.geometry, cell)])
            model = _tag("constitutive_model", law, type=kind)
            yield _tag("material", {"density": density, **_NO_HEAT}, [model, made], name=name)

    def _contacts(self, scene: Scene, folder: Path) -> Iterator[Element]:
        """Yield a contact for each pair, and write the motion of rigid bodies."""
        names = list(scene.bodies)
        for one, other, friction in scene.pairs:
            pair = [names.index(one), names.index(other)]
            facts: dict[str, Any] = {"type": self.options.contact, "materials": pair, "mu": friction}
            for k in pair:
                rigid = getattr(scene.bodies[names[k]], "rigid", None)
                facts |= {"type": "specified_friction", "master_material": k} if rigid else {}
                if motion := getattr(rigid, "motion", None):
                    table, facts["filename"] = TimeTable.of(motion.velocity), f"motion-{k}.txt"
                    times = sorted({0.0, float(scene.time.end), *table.times.tolist()})
                    rows = [(time, *table.at(time), 0.0)[:4] for time in times]
                    np.savetxt(folder / facts["filename"], rows, fmt="%.12g")
            yield _tag("contact", facts)

    def outputs(self, scene: Scene, folder: Path) -> MotionOutputs:
        """Read the archive: positions and velocities, interpolated to the outputs."""
        archive = folder / "scene.uda"
        steps = list(parse(archive / "index.xml").iter("timestep"))
        known = np.array([float(step.attrib["time"]) for step in steps])
        if not known.size or (np.diff(known) <= 0.0).any():
            raise ValueError("expected timesteps in the order of time")
        frames = [_points(_within(archive, step.attrib["href"])) for step in steps]
        time, bodies = output_times(scene, known[-1]), {}
        depth = 1.0 if scene.dim == 3 else scene.grid.cell_size
        for k, name in enumerate(deformable(scene)):  # the first bodies
            _check_points(frames, k)
            place, fast = (np.array([frame[k, key] for frame in frames]) for key in ("p.x", "p.velocity"))
            times = known
            if known[0] > 0.0:  # the start is not in it
                place = np.concatenate([place[:1] - known[0] * fast[:1], place])
                times, fast = np.append(0.0, known), np.concatenate([fast[:1], fast])
            moved = (at_times(time, times, each)[:, :, : scene.dim] for each in (place, fast))
            bodies[name] = MovingPoints(frames[0][k, "p.mass"][:, 0] / depth, *moved)
        return MotionOutputs(
            time=time,
            bodies=bodies,
            code="Uintah, float64",
            steps=int(steps[-1].text or 0),
            status="suspect: its output does not name its version, and the adapter was measured with none",
        )


def _points(path: Path) -> dict[tuple[int, str], AnyArray]:
    """Return arrays of a timestep's points by material and variable, in order of the points' IDs."""
    step = parse(path)
    order = "<" if step.findtext("Meta/endianness") == "little_endian" else ">"
    parts: dict[tuple[int, str], list[AnyArray]] = {}
    for file in step.iter("Datafile"):
        patch = _within(path.parent, file.attrib["href"])
        for one in parse(patch).iter("Variable"):
            name, number = str(one.findtext("variable")), int(str(one.findtext("index")))
            if name in _READ:
                if one.findtext("compression"):
                    raise ValueError(f"{name} of material {number} is compressed")
                width, kind = _READ[name]
                content = _content(_within(patch.parent, str(one.findtext("filename"))), one)
                values = np.frombuffer(content, order + kind).reshape(-1, width)
                parts.setdefault((number, name), []).append(values.astype(kind))
    points = {key: np.concatenate(values) for key, values in parts.items()}
    for (k, name), values in points.items():
        if len(values) != len(points.get((k, "p.particleID"), ())):
            raise ValueError(f"{name} of material {k} has not as many points as p.particleID")
    return {key: values[np.argsort(points[key[0], "p.particleID"][:, 0])] for key, values in points.items()}


def _content(path: Path, variable: Element) -> bytes:
    """Return the bytes of a variable; raise ValueError unless a plain file of bounded size has them."""
    start, end = (int(str(variable.findtext(key))) for key in ("start", "end"))
    size = path.stat().st_size if path.is_file() else -1
    if not 0 <= start <= end <= size <= ProcessLimits.file:
        raise ValueError(f"{path.name}: expected a file of bounded size with bytes {start} to {end}")
    return np.fromfile(path, np.uint8, end - start, offset=start).tobytes()


def _check_points(frames: list[dict[tuple[int, str], AnyArray]], k: int) -> None:
    """Raise ValueError unless a material has all variables at all times, of the same points."""
    for frame in frames:
        for name in _READ:
            if (k, name) not in frame:
                raise ValueError(f"{name} of material {k} is absent")
        if not np.array_equal(frame[k, "p.particleID"], frames[0][k, "p.particleID"]):
            raise ValueError(f"p.particleID of material {k} changes: points have left or come")


def _within(folder: Path, name: str) -> Path:
    """Return a path in a folder; a ValueError refuses one that leads out of it."""
    if not (path := folder / name).resolve().is_relative_to(folder.resolve()):
        raise ValueError(f"{name} is not within its folder")
    return path


def _held(scene: Scene) -> list[tuple[str, Any, int, int]]:
    """Return bodies and their sides, with axis and end of the grid."""
    sides = [(name, side) for name, body in scene.bodies.items() for side in body.sides]
    return [(name, side, *SIDES.get(side.side, (0, 0))) for name, side in sides]


def _grid(scene: Scene, extra: int) -> Element:
    """Return the grid, and conditions at its six faces."""
    cell, ends = scene.grid.cell_size, np.array([scene.grid.lower, scene.grid.upper])
    kinds, faces = dict.fromkeys(SIDES, "Velocity"), []
    kinds |= dict.fromkeys(("back", "front"), "Symmetric") if scene.dim == 2 else {}
    for name, side, axis, end in _held(scene):
        ends[end, axis] = scene.bodies[name].geometry.bounds[end][axis]
        kinds[side.side] = "Velocity" if side.fixed is True else "Symmetric"
    for (axis, end), kind in zip(SIDES.values(), kinds.values(), strict=True):
        values, var = ({"value": (0, 0, 0)}, "Dirichlet") if kind == "Velocity" else ({}, "symmetry")
        condition = _tag("BCType", values, id="all", label=kind, var=var)
        faces.append(_tag("Face", {}, [condition], side="xyz"[axis] + "-+"[end]))
    counts = np.ceil(np.ptp(ends, axis=0) / cell - 1e-6)
    place = {"lower": (*ends[0], 0.0)[:3], "upper": (*ends[1], cell)[:3]}
    place |= {"resolution": (*counts, 1)[:3], "extraCells": (extra,) * 3}
    box = _tag("Box", {**place, "autoPatch": 1}, label="1")
    return _tag("Grid", {}, [_tag("BoundaryConditions", {}, faces), _tag("Level", {}, [box])])


def _shape(shape: Any, depth: float) -> Element:
    """Return a body's shape; in the plane, from z = 0 to ``depth`` [m]."""
    if shape.type in ("disc", "ring"):
        ends = {"bottom": (*shape.centre, 0.0), "top": (*shape.centre, depth)}
        radii = (shape.radius,) if shape.type == "disc" else (shape.outer_radius, shape.inner_radius)
        cylinders = [_tag("cylinder", {**ends, "radius": radius}) for radius in radii]
        return cylinders[0] if len(radii) == 1 else _tag("difference", {}, cylinders)
    if shape.type == "ball":
        return _tag("sphere", {"origin": shape.centre, "radius": shape.radius})
    if is_turned(shape):
        first, second, _, last = (np.array([*corner, 0.0]) for corner in shape.corners)
        corners = (first, second, last, first + np.array([0.0, 0.0, depth]))
        return _tag("parallelepiped", {f"p{k + 1}": corner for k, corner in enumerate(corners)})
    return _tag("box", {"min": (*shape.lower, 0.0)[:3], "max": (*shape.upper, depth)[:3]})


def _tag(tag: str, values: Any = (), children: Sequence[Element] = (), /, **attributes: str) -> Element:
    """Return an element with one for each text, number or vector, and with children."""
    made = Element(tag, attributes)
    for key, value in dict(values).items():
        made.append(one := Element(key))
        numbers = value if isinstance(value, str) else ",".join(f"{v:.12g}" for v in np.atleast_1d(value))
        one.text = f"[{numbers}]" if np.ndim(value) else numbers
    made.extend(children)
    return made
