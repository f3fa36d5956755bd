"""CalculiX: explicit finite elements with contact between nodes and surfaces."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field

from mpmfw.api import FloatArray, IntArray, OptionsModel
from mpmfw.api.code import (
    Code,
    MotionOutputs,
    MovingPoints,
    Scene,
    elasticity,
    gravity_of,
    points_of_body,
    read_arrays,
    read_log,
)

#: Growth of kinetic energy over the work of gravity that is not suspect, in shares of the largest.
BALANCE = 0.02

#: Size of the second body's elements over the first one's. Where nodes met nodes, colliding rings gained 14 %
#: of their energy, at steps a quarter longer than now; so they gain none.
UNLIKE = 0.9

_SIDES = {"left": (0, 0), "right": (0, 1), "bottom": (1, 0), "top": (1, 1)}


class CalculixOptions(OptionsModel):
    """Settings of the contact and the step."""

    size: float = Field(default=1.0, gt=0, description="longest edge of an element over a cell")
    stiffness: float = Field(
        default=1.0, gt=0, description="contact stiffness over (K + 4G/3) / h, the stiffer body's"
    )
    stick: float = Field(default=0.1, gt=0, description="tangential stiffness over the normal one")
    safety: float = Field(default=0.3, gt=0, le=1, description="longest step over h / c, the faster body's")


class Calculix(Code):
    """CalculiX, explicit finite elements in plane strain: two deformable bodies, node to surface.

    Elements are quadrilaterals that follow the outline, as mpmfw's fitted points do, with the scene's
    neo-Hookean moduli. Springs of a linear pressure-overclosure act at the nodes of the first body. Rest
    before the motion is a static step. A run whose kinetic energy grows without cause is suspect."""

    name = "calculix"
    title = "CalculiX"
    install = "apt-get install calculix-ccx, or set MPMFW_CODE_CALCULIX to its program"
    executable = "ccx"
    reads = frozenset({"gravity", "settle"})
    models = ("neo_hookean",)
    versions = ("2.20",)
    dimensions = (2,)
    Options = CalculixOptions
    options: CalculixOptions

    def refusals(self, scene: Scene) -> Iterator[tuple[str, str]]:
        """Yield what is not written."""
        if scene.dim != 2:
            yield "grid", "is written in the plane alone"
            return
        if len(scene.bodies) != 2:
            yield "bodies", f"is run with two bodies; the scene has {len(scene.bodies)}"
        for name, body in scene.bodies.items():
            if body.prescribed:
                yield f"bodies.{name}.rigid", "rigid bodies are not written"
                continue
            if body.particles.layout != "fitted":
                yield (
                    f"bodies.{name}.particles.layout",
                    "needs 'fitted', whose quadrilaterals are its elements",
                )
            if body.angular_velocity:
                yield f"bodies.{name}.angular_velocity", "a spin at the start is not written"
            if scene.settle and not body.sides and type(body.geometry).__name__ == "Disc":
                yield "settle", f"'{name}' can roll away, which a static step does not survive"
            if scene.settle and np.any(body.velocity or 0.0):
                yield f"bodies.{name}.velocity", "a velocity after a static step is not written"
            for side in body.sides:
                if side.fixed is not True:
                    yield f"bodies.{name}.sides", "only sides that are fixed in all directions are written"
        if all(not body.sides for body in scene.bodies.values() if not body.prescribed) and scene.settle:
            yield "settle", "bodies that nothing holds cannot be settled by a static step"

    def write(self, scene: Scene, folder: Path) -> None:
        """Write ``scene.inp`` and the mesh, ``mesh.npz``."""
        size = self.options.size * float(scene.grid.cell_size)
        meshes: dict[str, _Mesh] = {}
        count = 0
        for name in scene.bodies:
            layout = points_of_body(scene, name, size * (UNLIKE if meshes else 1.0))
            density = scene.materials[scene.bodies[name].material].density
            meshes[name] = _mesh(f"B{len(meshes) + 1}", layout.corners, count, density)
            count += len(meshes[name].nodes)
        solids = {name: elasticity(scene, name) for name in meshes}
        stiff = self.options.stiffness * max(one.uniaxial for one in solids.values()) / size
        through = min(mesh.shortest / solids[name].speed for name, mesh in meshes.items())
        interval = float(scene.time.output_interval)
        every = math.ceil(0.5 * interval / (self.options.safety * through) - 1e-9)
        step = interval / (2 * every)
        lines = _lines_of_meshes(meshes, size, count)
        for name, mesh in meshes.items():
            lines += [f"*MATERIAL, NAME=M{mesh.label}", "*HYPERELASTIC, NEO HOOKE"]
            lines += [f"{solids[name].shear / 2:.9g},{2 / solids[name].bulk:.9g}"]
            lines += ["*DENSITY", f"{mesh.density:.9g}"]
            lines += [f"*SOLID SECTION, ELSET=E{mesh.label}, MATERIAL=M{mesh.label}"]
            if velocity := scene.bodies[name].velocity:
                lines.append("*INITIAL CONDITIONS, TYPE=VELOCITY")
                lines += [f"N{mesh.label},{axis + 1},{v:.9g}" for axis, v in enumerate(velocity)]
        lines += ["*SURFACE INTERACTION, NAME=CONTACT", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
        lines += [f"{stiff:.9g},"]
        if friction := scene.pairs[0][2]:
            lines += ["*FRICTION", f"{friction:.9g},{stiff * self.options.stick:.9g}"]
        lines += ["*CONTACT PAIR, INTERACTION=CONTACT, TYPE=NODE TO SURFACE", "SB1,SB2"]
        lines += ["*BOUNDARY", "ALL,3,3", *_supports(scene, meshes, count)]
        if scene.settle is not None:
            lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", "0.25,1."]
            lines += _weight(meshes, gravity_of(scene, settling=True), "*DLOAD")
            lines += ["*NODE PRINT, NSET=FRONT", "U", "*END STEP"]
        lines += ["*STEP, NLGEOM, INC=10000000", "*DYNAMIC, EXPLICIT"]
        lines += [f"{step:.9g},{float(scene.time.end):.9g},{1e-6 * step:.9g},{step:.9g}"]
        lines += _weight(
            meshes, gravity_of(scene), "*DLOAD, OP=NEW" if scene.settle is not None else "*DLOAD"
        )
        lines += [f"*NODE PRINT, NSET=FRONT, FREQUENCY={every}", "U,V", "*END STEP"]
        (folder / "scene.inp").write_text("\n".join(lines) + "\n", encoding="ascii")
        arrays: dict[str, Any] = {f"{name}_nodes": mesh.nodes for name, mesh in meshes.items()}
        arrays |= {f"{name}_mass": mesh.mass for name, mesh in meshes.items()}
        np.savez(folder / "mesh.npz", step=step, **arrays)

    def command(self, program: str, folder: Path) -> Sequence[str]:
        """Return the arguments; ccx adds the ending."""
        return [program, str(folder / "scene")]

    def outputs(self, scene: Scene, folder: Path) -> MotionOutputs:
        """Read ``scene.dat``: displacements and velocities of the nodes, interpolated to the outputs."""
        mesh = read_arrays(folder / "mesh.npz")
        log = read_log(folder / "log.txt")
        named = re.search(r"CalculiX Version ([0-9.]+[0-9])", log)
        if named is None or "Job finished" not in log:
            raise ValueError("its log is not whole")
        version = named.group(1)
        moved, fast = _printed(folder / "scene.dat", sum(len(mesh[f"{name}_nodes"]) for name in scene.bodies))
        settled = 1.0 if scene.settle is not None else 0.0
        before = [u for t, u in moved if t <= settled] or [np.zeros_like(moved[0][1])]
        moved = [(0.0, before[-1]), *((t - settled, u) for t, u in moved if t > settled)]
        start = np.concatenate(
            [
                np.tile(body.velocity or (0.0, 0.0), (len(mesh[f"{name}_nodes"]), 1))
                for name, body in scene.bodies.items()
            ]
        )
        fast = [(0.0, start), *((t - settled, v) for t, v in fast if t > settled)]
        interval, end = float(scene.time.output_interval), float(scene.time.end)
        reached = min(end, (1.0 + 1e-6) * moved[-1][0], (1.0 + 1e-6) * fast[-1][0])
        time = interval * np.arange(int(reached / interval + 1e-6) + 1.0)
        displacement, velocity = _at(moved, time), _at(fast, time)
        bodies, first = {}, 0
        for name in scene.bodies:
            own = slice(first, first := first + len(mesh[f"{name}_nodes"]))
            position = mesh[f"{name}_nodes"] + displacement[:, own]
            bodies[name] = MovingPoints(mesh[f"{name}_mass"], position, velocity[:, own])
        grown = _growth(scene, bodies)
        status = self.judged(version)
        if grown > BALANCE:
            status = f"suspect: the kinetic energy grew by {100 * grown:.3g} % of the largest without a cause"
        return MotionOutputs(
            time=time,
            bodies=bodies,
            code=f"CalculiX {version}, float64, CPU",
            steps=round(float(time[-1]) / float(mesh["step"])),
            status=status,
            notes=self._notes(scene),
            versions={"calculix": version},
        )

    def _notes(self, scene: Scene) -> tuple[str, ...]:
        size, options = self.options.size * float(scene.grid.cell_size), self.options
        notes = (
            "finite elements, not MPM: explicit, node to surface, springs of linear pressure-overclosure",
            f"elements C3D8 of {size:g} m, of the second body of {UNLIKE * size:g} m",
            f"contact stiffness {options.stiffness:g} (K + 4G/3) / h, tangential {options.stick:g} of it",
            "costs are those of the whole program, reading and settling included",
        )
        at_rest = "rest is a static step to the tolerance of CalculiX, not to that of the scene"
        return notes if scene.settle is None else (*notes, at_rest)


@dataclass(frozen=True)
class _Mesh:
    """Quadrilaterals of one body; ``first`` is the number of nodes before them."""

    label: str  #: in names of the input, where the scene's name could be too long
    nodes: FloatArray  #: (n, 2) [m]
    cells: IntArray  #: (m, 4), counter-clockwise
    outline: IntArray  #: element and side of the edges of the outermost loop (k, 2)
    mass: FloatArray  #: lumped (n,) [kg/m]
    shortest: float  #: edge [m]
    density: float  #: [kg/m³]
    first: int


def _mesh(label: str, corners: FloatArray | None, first: int, density: float) -> _Mesh:
    """Join quadrilaterals at equal corners (m, 4, 2)."""
    assert corners is not None
    flat = corners.reshape(-1, 2)
    _, index, cells = np.unique(
        np.round(flat / np.ptp(flat, axis=0).max(), 9), axis=0, return_index=True, return_inverse=True
    )
    nodes, cells = flat[index], cells.reshape(-1, 4)
    edges = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2)
    inner = {(b, a) for a, b in edges.reshape(-1, 2).tolist()}
    free = {
        int(a): (k, s, int(b))
        for k, row in enumerate(edges)
        for s, (a, b) in enumerate(row.tolist())
        if (a, b) not in inner
    }
    loop: list[tuple[int, int]] = []
    at = max(free, key=lambda node: float(nodes[node, 0]))  # the rightmost node is of the outer loop
    begin = at
    while not loop or at != begin:
        element, side, at = free[at]
        loop.append((element, side))
    x = nodes[cells]
    one, two = x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]
    mass = np.zeros(len(nodes))
    np.add.at(
        mass, cells.ravel(), np.repeat(density * (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) / 8, 4)
    )
    shortest = float(np.linalg.norm(x - np.roll(x, -1, axis=1), axis=2).min())
    return _Mesh(label, nodes, cells, np.array(loop), mass, shortest, density, first)


def _lines_of_meshes(meshes: Mapping[str, _Mesh], depth: float, count: int) -> list[str]:
    """Return nodes, elements and surfaces of slabs one element thick."""
    lines = ["*NODE, NSET=ALL"]
    for layer in (0, 1):
        for mesh in meshes.values():
            begin = 1 + layer * count + mesh.first
            lines += [
                f"{begin + k},{x:.12g},{y:.12g},{layer * depth:.12g}" for k, (x, y) in enumerate(mesh.nodes)
            ]
    lines += ["*NSET, NSET=FRONT, GENERATE", f"1,{count}"]
    before = 0
    for mesh in meshes.values():
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET=E{mesh.label}")
        for k, cell in enumerate(mesh.cells + mesh.first + 1):
            lines.append(",".join(map(str, (before + k + 1, *cell.tolist(), *(cell + count).tolist()))))
        lines += [f"*SURFACE, NAME=S{mesh.label}, TYPE=ELEMENT"]
        lines += [f"{before + element + 1},S{side + 3}" for element, side in mesh.outline.tolist()]
        begin, end = mesh.first + 1, mesh.first + len(mesh.nodes)
        lines += [f"*NSET, NSET=N{mesh.label}, GENERATE", f"{begin},{end}", f"{begin + count},{end + count}"]
        before += len(mesh.cells)
    return lines


def _supports(scene: Scene, meshes: Mapping[str, _Mesh], count: int) -> list[str]:
    """Return the nodes on fixed sides."""
    fixed: set[int] = set()
    for name, body in scene.bodies.items():
        mesh = meshes[name]
        for side in body.sides:
            axis, upper = _SIDES[side.side]
            place = mesh.nodes[:, axis].max() if upper else mesh.nodes[:, axis].min()
            near = np.abs(mesh.nodes[:, axis] - place) < 1e-6 * np.ptp(mesh.nodes)
            fixed |= set((np.flatnonzero(near) + mesh.first + 1).tolist())
    return [f"{node + layer * count},1,2" for node in sorted(fixed) for layer in (0, 1)]


def _weight(meshes: Mapping[str, _Mesh], gravity: FloatArray, card: str) -> list[str]:
    """Return gravity; a weight of zero takes that of an earlier step away."""
    size = math.hypot(*gravity)
    along = f"{gravity[0] / size:.12g},{gravity[1] / size:.12g}" if size else "0.,-1."
    return [card, *(f"E{mesh.label},GRAV,{size:.9g},{along},0." for mesh in meshes.values())]


Blocks = list[tuple[float, FloatArray]]


def _printed(path: Path, count: int) -> tuple[Blocks, Blocks]:
    """Return displacements and velocities (n, 2) of the nodes, each with its time, from a ``.dat`` file."""
    blocks: dict[str, Blocks] = {"displacements": [], "velocities": []}
    with path.open(encoding="ascii") as file:
        lines = iter(file)
        for line in lines:
            words = line.split()
            if words and words[0] in blocks:
                next(lines)
                rows = np.loadtxt([next(lines) for _ in range(count)], ndmin=2)
                if not np.array_equal(rows[:, 0], np.arange(1, count + 1)):
                    raise ValueError("a block has other nodes than the mesh")
                blocks[words[0]].append((float(words[-1]), rows[:, 1:3]))
    if not blocks["displacements"] or not blocks["velocities"]:
        raise ValueError("it printed no motion")
    return blocks["displacements"], blocks["velocities"]


def _at(blocks: Blocks, time: FloatArray) -> FloatArray:
    """Return values between blocks by linear interpolation, (time, n, 2)."""
    known, values = np.array([t for t, _ in blocks]), np.array([each for _, each in blocks])
    after = np.clip(np.searchsorted(known, time), 1, len(known) - 1)
    share = np.clip((time - known[after - 1]) / (known[after] - known[after - 1]), 0.0, 1.0)[:, None, None]
    return np.asarray((1.0 - share) * values[after - 1] + share * values[after])


def _growth(scene: Scene, bodies: Mapping[str, MovingPoints]) -> float:
    """Return the growth of kinetic energy over its start and the work of gravity, over the largest."""
    kinetic: Any = sum(0.5 * (one.velocity**2).sum(axis=2) @ one.mass for one in bodies.values())
    work: Any = sum(
        ((one.position - one.position[0]) @ gravity_of(scene)) @ one.mass for one in bodies.values()
    )
    grown = float((kinetic - kinetic[0] - work).max())
    return grown / float(kinetic.max()) if kinetic.max() > 0.0 else 0.0
