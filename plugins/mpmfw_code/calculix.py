"""CalculiX: explicit finite elements with contact between nodes and surfaces."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field

from mpmfw.api import FloatArray, IntArray, OptionsModel
from mpmfw.api.code import (
    SIDES,
    Code,
    HexMesh,
    MotionOutputs,
    MovingPoints,
    Scene,
    at_times,
    deformable,
    elasticity,
    gravity_of,
    is_turned,
    mesh_of_body,
    output_times,
    read_arrays,
    read_log,
)

#: Growth of kinetic energy over the work of gravity that is not suspect, in shares of the largest.
BALANCE = 0.02

#: Size of the second body's elements over the first one's, so that nodes do not meet nodes: the springs then
#: feed energy into the motion without end (docs/arena/reports/calculix_discs.py).
UNLIKE = 0.9

#: Edges of a rigid body's elements, in cells; its faces are plane.
COARSE = 4.0


class CalculixOptions(OptionsModel):
    """Settings of the contact and the step."""

    size: float = Field(default=1.0, gt=0, description="longest edge of an element over a cell")
    stiffness: float = Field(default=1.0, gt=0, description="of contact, over the larger (K + 4G/3) / h")
    stick: float = Field(default=0.1, gt=0, description="tangential stiffness over the normal one")
    safety: float = Field(default=0.3, gt=0, le=1, description="longest step over h / c, the faster body's")


class Calculix(Code):
    """CalculiX, explicit finite elements, node to surface: two bodies, one of which may be rigid and at rest.

    Elements are hexahedra with the scene's neo-Hookean moduli; in the plane a slab of one that follows the
    outline, as mpmfw's fitted points do. Springs of a linear pressure-overclosure act at the nodes of the
    first deformable body. Rest before the motion is a static step; a round body begins it so low that its
    contact carries it. A run whose kinetic energy grows without cause is suspect."""

    name = "calculix"
    title = "CalculiX"
    install = "apt-get install calculix-ccx, or set MPMFW_CODE_CALCULIX to its program"
    executable = "ccx"
    reads = frozenset({"gravity", "settle"})
    models = ("neo_hookean",)
    versions = ("2.20",)
    Options = CalculixOptions
    options: CalculixOptions

    def refusals(self, scene: Scene) -> Iterator[tuple[str, str]]:
        soft, level = deformable(scene), gravity_of(scene, settling=True)
        if len(scene.bodies) != 2 or not soft:
            yield "bodies", "is run with two bodies, one of them at least deformable"
        for name, body in scene.bodies.items():
            shape = body.geometry
            if scene.dim == 3 and shape.type not in ("box", "ball"):
                yield f"bodies.{name}.geometry", "only balls and boxes are written in space"
            if name not in soft and shape.type not in ("rectangle", "box"):
                yield f"bodies.{name}.geometry", "only rectangles and boxes are rigid"
            if scene.dim == 2 and body.particles and body.particles.layout != "fitted":
                key = f"bodies.{name}.particles.layout"
                yield key, "needs 'fitted', whose quadrilaterals are its elements"
            if body.sides and (is_turned(shape) or any(side.fixed is not True for side in body.sides)):
                yield f"bodies.{name}.sides", "only upright sides fixed in all directions are written"
        if scene.settle and len(soft) > 1 and not any(body.sides for body in soft.values()):
            yield "settle", "bodies that nothing holds cannot be settled by a static step"
        for name in _rolling(scene):
            *_, floor = scene.bodies.values()  # rigid bodies are the last
            spans = floor.geometry.bounds - np.array(soft[name].geometry.centre)
            above = (spans.prod(axis=0)[level == 0.0] <= 0.0).all() and (spans @ level > 0.0).all()
            upright = floor.prescribed and not is_turned(floor.geometry)
            if np.count_nonzero(level) != 1 or not (upright and above):
                yield "settle", f"'{name}' can roll away, except from an upright rigid face across gravity"

    def write(self, scene: Scene, folder: Path) -> None:
        """Write ``scene.inp`` and the mesh, ``mesh.npz``."""
        size, meshes = self.options.size * scene.grid.cell_size, self._meshes(scene)
        soft, interval = deformable(scene), scene.time.output_interval
        solids = {name: elasticity(scene, name if name in soft else next(iter(soft))) for name in meshes}
        stiff = self.options.stiffness * max(one.uniaxial for one in solids.values()) / size
        through = min(meshes[name].mesh.shortest / solids[name].speed for name in soft)
        every = math.ceil(0.5 * interval / (self.options.safety * through) - 1e-9)
        step = interval / (2 * every)
        lines = _lines_of_meshes(meshes)
        for name, part in meshes.items():
            label = part.label
            lines += [f"*MATERIAL, NAME=M{label}", "*HYPERELASTIC, NEO HOOKE"]
            lines += [f"{solids[name].shear / 2:.9g},{2 / solids[name].bulk:.9g}"]
            lines += ["*DENSITY", f"{part.density:.9g}", f"*SOLID SECTION, ELSET=E{label}, MATERIAL=M{label}"]
            if velocity := getattr(scene.bodies[name], "velocity", None):
                lines.append("*INITIAL CONDITIONS, TYPE=VELOCITY")
                lines += [f"N{label},{axis + 1},{v:.9g}" for axis, v in enumerate(velocity)]
        lines += ["*SURFACE INTERACTION, NAME=CONTACT", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
        lines += [f"{stiff:.9g},"]
        if friction := scene.pairs[0][2]:
            lines += ["*FRICTION", f"{friction:.9g},{stiff * self.options.stick:.9g}"]
        lines += ["*CONTACT PAIR, INTERACTION=CONTACT, TYPE=NODE TO SURFACE"]
        lines += [",".join(f"S{part.label}" for part in meshes.values()), "*NSET, NSET=PRINT, GENERATE"]
        layers = 2 if scene.dim == 2 else 1  # of which the front is printed
        counts = {name: len(meshes[name].mesh.nodes) // layers for name in soft}
        lines += [f"{meshes[name].first + 1},{meshes[name].first + n}" for name, n in counts.items()]
        held = _supports(scene, meshes)
        lines += ["*BOUNDARY", *held]
        if scene.settle is not None:
            level = gravity_of(scene, settling=True)
            lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", "0.25,1.", *_weight(meshes, level, "*DLOAD")]
            lines += ["*BOUNDARY", *_upright(scene, meshes, level)]
            lines += ["*NODE PRINT, NSET=PRINT", "U", "*END STEP"]
        lines += ["*STEP, NLGEOM, INC=10000000", "*DYNAMIC, EXPLICIT"]
        lines += [f"{step:.9g},{scene.time.end:.9g},{1e-6 * step:.9g},{step:.9g}"]
        anew = ", OP=NEW" if scene.settle is not None else ""
        lines += [f"*BOUNDARY{anew}", *held, *_weight(meshes, gravity_of(scene), f"*DLOAD{anew}")]
        lines += [f"*NODE PRINT, NSET=PRINT, FREQUENCY={every}", "U,V", "*END STEP"]
        (folder / "scene.inp").write_text("\n".join(lines) + "\n", encoding="ascii")
        arrays: dict[str, Any] = {}
        for name, n in counts.items():
            part = meshes[name]
            arrays[f"{name}_numbers"] = part.first + 1 + np.arange(n)
            arrays[f"{name}_nodes"] = part.mesh.nodes[:n, : scene.dim]
            share = part.density * (2.0 / size if scene.dim == 2 else 1.0)
            arrays[f"{name}_mass"] = share * part.mesh.volume[:n]
        np.savez(folder / "mesh.npz", step=step, **arrays)

    def _meshes(self, scene: Scene) -> dict[str, _Part]:
        """Return the meshes of all bodies, by name."""
        size, meshes = self.options.size * scene.grid.cell_size, dict[str, _Part]()
        for name, body in scene.bodies.items():
            edge = size * (COARSE if body.prescribed else UNLIKE if meshes else 1.0)
            mesh = mesh_of_body(scene, name, edge, size)
            density = 1.0 if body.prescribed else scene.materials[body.material].density
            if body.geometry.type == "ball":  # the mass is that of the ball
                density *= body.geometry.exact_volume / mesh.volume.sum()
            first = sum(len(each.mesh.nodes) for each in meshes.values())
            before = sum(len(each.mesh.cells) for each in meshes.values())
            meshes[name] = _Part(f"B{len(meshes) + 1}", mesh, density, first, before)
        for name in _rolling(scene):
            meshes[name] = self._lowered(scene, meshes[name], name)
        return meshes

    def _lowered(self, scene: Scene, part: _Part, name: str) -> _Part:
        """Return a round body so low that its contact carries it as the static step begins."""
        *_, floor = scene.bodies.values()
        level = gravity_of(scene, settling=True)
        down = int(np.abs(level).argmax())
        face = floor.geometry.bounds[int(level[down] < 0.0)][down]
        lowest = _at_end(part, down, level[down] > 0.0)[0]
        weight = part.density * part.mesh.volume.sum() * level[down]
        overlap = weight / (elasticity(scene, name).uniaxial * self.options.size * scene.grid.cell_size)
        nodes = part.mesh.nodes.copy()
        nodes[:, down] += face + overlap - nodes[lowest - 1 - part.first, down]
        return replace(part, mesh=replace(part.mesh, nodes=nodes))

    def command(self, program: str, folder: Path) -> Sequence[str]:
        return [program, str(folder / "scene")]  # it adds the ending

    def outputs(self, scene: Scene, folder: Path) -> MotionOutputs:
        """Read ``scene.dat``: displacements and velocities of the nodes, interpolated to the outputs."""
        mesh, soft = read_arrays(folder / "mesh.npz"), deformable(scene)
        log = read_log(folder / "log.txt")
        named = re.search(r"CalculiX Version ([0-9.]+[0-9]).*Job finished", log, re.S)
        if named is None:
            raise ValueError("its log is not whole")
        numbers = np.concatenate([mesh[f"{name}_numbers"] for name in soft])
        place = np.concatenate([mesh[f"{name}_nodes"] for name in soft])
        moved, fast = _printed(folder / "scene.dat", numbers, scene.dim)
        settled = 1.0 if scene.settle is not None else 0.0
        rest = [u for t, u in moved if t <= settled] or [np.zeros_like(place)]
        moved = [(0.0, rest[-1]), *((t - settled, u) for t, u in moved if t > settled)]
        start = [np.zeros_like(mesh[f"{name}_nodes"]) + (soft[name].velocity or 0.0) for name in soft]
        fast = [(0.0, np.concatenate(start)), *((t - settled, v) for t, v in fast if t > settled)]
        time = output_times(scene, min(moved[-1][0], fast[-1][0]))
        displacement, velocity = (at_times(time, *zip(*blocks, strict=True)) for blocks in (moved, fast))
        bodies, first = {}, 0
        for name in soft:
            own = slice(first, first := first + len(mesh[f"{name}_nodes"]))
            position = place[own] + displacement[:, own]
            bodies[name] = MovingPoints(mesh[f"{name}_mass"], position, velocity[:, own])
        grown, status = _growth(scene, bodies), self.judged(named[1])
        if grown > BALANCE:
            status = f"suspect: the kinetic energy grew by {100 * grown:.3g} % of the largest without a cause"
        return MotionOutputs(
            time=time,
            bodies=bodies,
            code=f"CalculiX {named[1]}, float64, CPU",
            steps=round(float(time[-1]) / float(mesh["step"])),
            status=status,
            notes=self._notes(scene),
            versions={"calculix": named[1]},
        )

    def _notes(self, scene: Scene) -> tuple[str, ...]:
        options, size = self.options, self.options.size * scene.grid.cell_size
        notes = (
            "finite elements, not MPM: explicit, node to surface, springs of linear pressure-overclosure",
            f"elements C3D8 of {size:g} m, of the second body of {UNLIKE * size:g} m",
            f"contact stiffness {options.stiffness:g} (K + 4G/3) / h, tangential {options.stick:g} of it",
            "costs are those of the whole program, reading and settling included",
        )
        at_rest = "rest is a static step to the tolerance of CalculiX, not to that of the scene"
        return notes if scene.settle is None else (*notes, at_rest)


@dataclass(frozen=True)
class _Part:
    """A body in the input, with the numbers of nodes and elements before its own."""

    label: str  #: as the scene's name could be too long
    mesh: HexMesh
    density: float  #: [kg/m³]
    first: int
    before: int


def _rolling(scene: Scene) -> list[str]:
    """Return the round bodies that nothing but contact holds while they settle."""
    free = {name: body.geometry.type for name, body in deformable(scene).items() if not body.sides}
    return [name for name, shape in free.items() if scene.settle and shape in ("disc", "ball")]


def _lines_of_meshes(meshes: Mapping[str, _Part]) -> list[str]:
    """Return nodes, elements and surfaces."""
    lines = ["*NODE, NSET=ALL"]
    for part in meshes.values():
        for k, place in enumerate(part.mesh.nodes, part.first + 1):
            lines.append(f"{k}," + ",".join(f"{x:.12g}" for x in place))
    for part in meshes.values():
        label, count = part.label, len(part.mesh.nodes)
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET=E{label}")
        for k, cell in enumerate(part.mesh.cells + part.first + 1, part.before + 1):
            lines.append(",".join(map(str, (k, *cell.tolist()))))
        lines += [f"*SURFACE, NAME=S{label}, TYPE=ELEMENT"]
        lines += [f"{part.before + element + 1},S{side}" for element, side in part.mesh.outer.tolist()]
        lines += [f"*NSET, NSET=N{label}, GENERATE", f"{part.first + 1},{part.first + count}"]
    return lines


def _supports(scene: Scene, meshes: Mapping[str, _Part]) -> list[str]:
    """Return the nodes on fixed sides and of rigid bodies."""
    lines = ["ALL,3,3"] if scene.dim == 2 else []
    for name, body in scene.bodies.items():
        if body.prescribed:
            lines.append(f"N{meshes[name].label},1,3")
        for side in body.sides:
            lines += [f"{node},1,{scene.dim}" for node in _at_end(meshes[name], *SIDES[side.side])]
    return lines


def _at_end(part: _Part, axis: int, upper: int) -> list[int]:
    """Return the numbers of a body's nodes that are outermost along an axis."""
    nodes = part.mesh.nodes
    place = nodes[:, axis] if upper else -nodes[:, axis]
    near = place > place.max() - 1e-6 * np.ptp(nodes, axis=0).max()
    return (np.flatnonzero(near) + part.first + 1).tolist()


def _upright(scene: Scene, meshes: Mapping[str, _Part], gravity: FloatArray) -> Iterator[str]:
    """Yield what keeps round bodies from rolling at rest: their tops, with little force, move up or down."""
    down = int(np.abs(gravity).argmax())
    across = [axis for axis in range(scene.dim) if axis != down]
    for name in _rolling(scene):
        for node in _at_end(meshes[name], down, gravity[down] < 0.0):
            yield from (f"{node},{axis + 1}" for axis in across)
        if scene.dim == 3:
            yield f"{_at_end(meshes[name], across[0], True)[0]},{across[1] + 1}"


def _weight(meshes: Mapping[str, _Part], gravity: FloatArray, card: str) -> list[str]:
    """Return gravity; a weight of zero takes that of an earlier step away."""
    size = math.hypot(*gravity)
    along = ",".join(f"{g / size if size else -1.0:.12g}" for g in (*gravity, 0.0)[:3])
    return [card, *(f"E{part.label},GRAV,{size:.9g},{along}" for part in meshes.values())]


Blocks = list[tuple[float, FloatArray]]


def _printed(path: Path, numbers: IntArray, dim: int) -> tuple[Blocks, Blocks]:
    """Return displacements and velocities (n, dim) of the nodes, each with its time, from a ``.dat`` file."""
    blocks: dict[str, Blocks] = {"displacements": [], "velocities": []}
    with path.open(encoding="ascii") as lines:
        for line in lines:
            words = line.split()
            if words and words[0] in blocks:
                next(lines)
                rows = np.loadtxt([next(lines) for _ in numbers], ndmin=2)
                if not np.array_equal(rows[:, 0], numbers):
                    raise ValueError("a block has other nodes than the mesh")
                blocks[words[0]].append((float(words[-1]), rows[:, 1 : dim + 1]))
    if not blocks["displacements"] or not blocks["velocities"]:
        raise ValueError("it printed no motion")
    return blocks["displacements"], blocks["velocities"]


def _growth(scene: Scene, bodies: Mapping[str, MovingPoints]) -> float:
    """Return the growth of kinetic energy over its start and the work of gravity, over the largest."""
    gravity, every = gravity_of(scene), bodies.values()
    kinetic: Any = sum(0.5 * (one.velocity**2).sum(axis=2) @ one.mass for one in every)
    work: Any = sum(((one.position - one.position[0]) @ gravity) @ one.mass for one in every)
    grown = float((kinetic - kinetic[0] - work).max())
    return grown / float(kinetic.max()) if kinetic.max() > 0.0 else 0.0
