"""NairnMPM: explicit MPM with contact of materials at nodes (nairn-mpm-fea)."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar, Literal, cast

import numpy as np
from pydantic import Field

from mpmfw.api import FloatArray, OptionsModel
from mpmfw.api.code import (
    SIDES,
    Code,
    MotionOutputs,
    MovingPoints,
    Scene,
    deformable,
    elasticity,
    gravity_of,
    is_turned,
    points_of_body,
    read_log,
    starting_velocity,
    surface_velocity,
)

#: Cells that the grid has beyond the scene's, as points may not reach its outermost ones.
BORDER = 2

#: Time of settling, in times that a wave takes through the thickest body; damping takes one of them.
SETTLE = 20.0

#: Its numbers of ways to find normals.
NORMALS = {"MAXG": 0, "MAXV": 1, "AVGG": 2, "OWNG": 3, "SN": 4, "LINR": 5, "LOGR": 6}

_AXES = ("Horiz", "Vert", "Depth")


class NairnOptions(OptionsModel):
    """Settings of contact, shape functions and transfer."""

    normals: Literal["MAXG", "MAXV", "AVGG", "OWNG", "SN", "LINR", "LOGR"] = Field(
        default="AVGG",
        description="how contact normals are found; LOGR by logistic regression, SN is given",
    )
    azimuth: float = Field(default=-90.0, description="of SN, from the first body to the second, to x [deg]")
    apart: float | None = Field(
        default=None,
        gt=0,
        description="bodies touch below this distance of their positions at a node, in cells; without it by "
        "their displacements. LINR and LOGR find the distance themselves",
    )
    shape: Literal["uGIMP", "lCPDI", "qCPDI", "B2SPLINE", "B2CPDI"] = Field(
        default="uGIMP", description="shape functions"
    )
    fmpm: int = Field(default=0, ge=0, le=20, description="order of FMPM, which filters noise; 0 is FLIP")
    points: Literal["lattice", "scene"] = Field(
        default="lattice", description="squares in rows, as its own regions have them, or the scene's points"
    )
    safety: float = Field(default=0.5, gt=0, le=0.8, description="longest step over h / c, of the largest c")


class Nairn(Code):
    """NairnMPM, explicit MPM: each body is a material with a separate velocity at nodes.

    A rigid body is one of its rigid materials, a belt one that moves. Points are squares. Rest before the
    motion is a time with level gravity and damping, both of which end at once when the motion starts."""

    name = "nairn"
    title = "NairnMPM"
    install = "set MPMFW_CODE_NAIRN to its program (github.com/nairnj/nairn-mpm-fea)"
    best: ClassVar = {"apart": 0.8, "shape": "lCPDI", "points": "scene"}
    executable = "NairnMPM"
    reads = frozenset({"gravity", "settle", "motion", "spin"})
    versions = ("19.0",)
    Options = NairnOptions
    options: NairnOptions

    def refusals(self, scene: Scene) -> Iterator[tuple[str, str]]:
        if scene.dim == 3 and self.options.shape == "qCPDI":
            yield "grid", "has qCPDI in the plane alone"
        rigid = [name for name, body in scene.bodies.items() if body.prescribed]
        if len(rigid) > 1:
            yield f"bodies.{rigid[1]}.rigid", "is run with one rigid body at most"
        if len({friction for _, _, friction in scene.pairs}) > 1:
            yield "contact.pairs", "is run with one friction for all pairs"
        for name in rigid:
            body: Any = scene.bodies[name]
            if body.geometry.type == "half_space":
                yield f"bodies.{name}.geometry", "a half_space is not written"
            if surface_velocity(body) is None or (scene.settle and body.rigid is not True):
                yield f"bodies.{name}.rigid.motion", "only a constant velocity is written, without settling"
        for name, body in deformable(scene).items():
            for side in body.sides:
                if reason := self._refusal_of_side(scene, body.geometry, side):
                    yield f"bodies.{name}.sides", reason

    def _refusal_of_side(self, scene: Scene, shape: Any, side: Any) -> str:
        """Return why nodes of the grid cannot hold a side, if they cannot."""
        if not side.fixed:
            return "only sides that are fixed are written"
        if shape.type not in ("rectangle", "box"):
            return "only sides of rectangles and boxes are written"
        axis, upper = SIDES[side.side]
        place = (shape.bounds[upper][axis] - scene.grid.lower[axis]) / scene.grid.cell_size
        if is_turned(shape) or abs(place - round(place)) > 1e-6:
            return f"holds nodes; expected the side '{side.side}' along a line of the grid"
        return ""

    def write(self, scene: Scene, folder: Path) -> None:
        cell, interval = scene.grid.cell_size, scene.time.output_interval
        step, wait = self._times(scene)
        given = f' Polar="90" Azimuth="{self.options.azimuth:.12g}"' if self.options.normals == "SN" else ""
        contact = f'<MultiMaterialMode Normals="{NORMALS[self.options.normals]}"{given}>'
        contact += f"<Friction>{_text(max(f for _, _, f in scene.pairs))}</Friction>" if scene.pairs else ""
        if self.options.apart is not None:
            contact += f"<ContactPosition>{_text(self.options.apart)}</ContactPosition>"
        lines = ["<?xml version='1.0'?>", "<JANFEAInput version='3'>", "<Header>"]
        lines += ['<ConsistentUnits length="m" mass="kg" time="s"/>']
        lines += [f"<Analysis>{10 if scene.dim == 2 else 12}</Analysis>", "</Header>", "<MPMHeader>"]
        lines += [f'<Timing step="{_text(step)}" CFL="1"']  # its own limit is above the step
        lines[-1] += f' max="{_text(wait + scene.time.end - 0.5 * step)}"/>'
        archive = f'<ArchiveGroup time="{_text(interval * (1 - 1e-9))}"'
        lines += [archive + (f' start="{_text(wait - 0.5 * step)}"/>' if wait else "/>")]
        lines += ["<ArchiveRoot>motion</ArchiveRoot>", "<MPMArchiveOrder>iYY</MPMArchiveOrder>"]
        if wait:
            damped = f"{_text(0.5 * SETTLE / wait)}*(1-sgn(t-{_text(wait)}))"
            lines += [f'<Damping function="{damped}"/>']
        lines += [f"{contact}</MultiMaterialMode>", f'<GIMP type="{self.options.shape}"/>', "</MPMHeader>"]
        lines += [*_grid(scene, cell), "<MaterialPoints>", "<PointList>"]
        for k, name in enumerate(scene.bodies):
            lines += self._points(scene, name, k + 1)
        lines += ["</PointList>", "</MaterialPoints>"]
        for k, name in enumerate(scene.bodies):
            lines += _material(scene, name, k + 1)
        lines += ["<GridBCs>", *_supports(scene, cell), "</GridBCs>", *_gravity(scene, wait)]
        if self.options.fmpm:
            lines += ['<CustomTasks><Schedule name="PeriodicXPIC">']
            lines += [f'<Parameter name="FMPMOrder">{self.options.fmpm}</Parameter>']
            lines += ['<Parameter name="periodicSteps">1</Parameter></Schedule></CustomTasks>']
        (folder / "scene.fmcmd").write_text("\n".join([*lines, "</JANFEAInput>", ""]), encoding="ascii")

    def _points(self, scene: Scene, name: str, number: int) -> Iterator[str]:
        """Yield the points of a body; of a rigid one, two in a cell along each axis."""
        body, cell = cast(Any, scene.bodies[name]), scene.grid.cell_size
        if self.options.points == "scene" and not body.prescribed:
            layout = points_of_body(scene, name)
        else:
            size = 0.5 * cell if body.prescribed else body.particles.size
            layout = body.geometry.lattice(size, (0.0,) * scene.dim)
        size = layout.volume ** (1.0 / scene.dim) / cell
        known: Any = surface_velocity(body) if body.prescribed else starting_velocity(scene, name, layout)
        velocity = np.broadcast_to(known, layout.position.shape)
        for x, v, s in zip(layout.position, velocity, size, strict=True):
            sizes = " ".join(f'lp{axis}="{s:.12g}"' for axis in "xyz"[: scene.dim])
            yield f'<mp mat="{number}" thick="1" {sizes}>{_vector("pt", x)}{_vector("vel", v)}</mp>'

    def command(self, program: str, folder: Path) -> Sequence[str]:  # noqa: ARG002
        return [program, "-np", "1", "scene.fmcmd"]  # one processor

    def outputs(self, scene: Scene, folder: Path) -> MotionOutputs:
        """Read the archives that the log lists, ``motion.STEP``."""
        log = read_log(folder / "log.txt")
        named = re.search(r"\AMPM ANALYSIS BY NairnMPM ([0-9.]+).*NairnMPM RUN COMPLETED", log, re.S)
        spent = re.search(r"^CPU Time: ([0-9.e+-]+) secs$", log, re.M)
        if named is None or spent is None:
            raise ValueError("its log is not whole")
        version, cpu, interval = named[1], float(spent[1]), scene.time.output_interval
        step, wait = self._times(scene)
        before, every = round(wait / step), round(interval / step)
        steps = math.ceil(scene.time.end / step - 1e-6)
        counts = [*range(0, steps, every), steps]
        frames = [_archive(folder / f"motion.{before + count}", scene.dim) for count in counts]
        bodies = {}
        for k, name in enumerate(deformable(scene)):  # the first bodies
            own = [frame[frame["material"] == k + 1] for frame in frames]
            own = [each[np.lexsort(each["origin"].T)] for each in own]
            moved, fast = (np.array([each[key] for each in own]) for key in ("position", "velocity"))
            bodies[name] = MovingPoints(own[0]["mass"].astype(float), moved, fast)
        settling = before / max(before + steps, 1)
        status, notes = self.judged(version), self._notes(scene, step, before)
        for warning, times in re.findall(r"^The warning '(.*)' occurred on ([0-9]+) time steps", log, re.M):
            if warning.startswith("Logistic regression did not converge"):
                notes += (f"logistic regression did not converge in {times} of {before + steps} steps",)
            else:
                status = f"suspect: it warns on {times} steps: {warning}"
        return MotionOutputs(
            time=interval / every * np.array(counts, dtype=float),
            bodies=bodies,
            code=f"NairnMPM {version}, float64, CPU",
            steps=steps,
            costs={"cpu_time": (1.0 - settling) * cpu, "settle_time": settling * cpu},
            status=status,
            notes=notes,
            versions={"nairn-mpm-fea": version},
        )

    def _times(self, scene: Scene) -> tuple[float, float]:
        """Return the step, a part of the interval of outputs, and the time of settling, of steps [s]."""
        soft, interval = deformable(scene), scene.time.output_interval
        speed = {name: elasticity(scene, name).speed for name in soft}
        longest = self.options.safety * scene.grid.cell_size / max(speed.values())
        step = interval / math.ceil(interval / longest * (1.0 + 1e-6))
        through = [np.ptp(soft[name].geometry.bounds, axis=0).min() / speed[name] for name in soft]
        return step, step * math.ceil(SETTLE * max(through) / step) if scene.settle else 0.0

    def _notes(self, scene: Scene, step: float, before: int) -> tuple[str, ...]:
        models = {scene.materials[body.material].model for body in deformable(scene).values()}
        notes = [f"steps of {step:.3g} s; strains at the mean of the times before and after (USAVG)"]
        if self.options.points == "lattice":
            notes.append("points are squares in rows, cut by the outline, whatever layout the scene names")
        if "linear_elastic" in models:
            notes.append("its elastic law is hypoelastic, with the scene's moduli at small strain")
        if before:
            notes.append(f"settled in {before} damped steps; their share of the CPU time is that of settling")
        return tuple(notes)


def _text(number: float) -> str:
    """Return a number without an exponent, as its functions of time need it."""
    return np.format_float_positional(float(number), trim="-")


def _vector(tag: str, values: FloatArray) -> str:
    parts = " ".join(f'{axis}="{v:.12g}"' for axis, v in zip("xyz", values, strict=False))
    return f"<{tag} {parts}/>"


def _grid(scene: Scene, cell: float) -> list[str]:
    """Return the grid in whole cells, with a border."""
    given, counts = [], []
    for axis, name, low, high in zip("xyz", _AXES, scene.grid.lower, scene.grid.upper, strict=False):
        count = math.ceil((high - low) / cell - 1e-9) + 2 * BORDER
        first = low - BORDER * cell
        given.append(f'{axis}min="{first:.12g}" {axis}max="{first + count * cell:.12g}"')
        counts.append(f'<{name} n{axis}="{count}"/>')
    return ['<Mesh output="file">', f"<Grid {' '.join(given)}>", *counts, "</Grid>", "</Mesh>"]


def _material(scene: Scene, name: str, number: int) -> list[str]:
    """Return a material for each body, as bodies of one material share their velocity."""
    body: Any = scene.bodies[name]
    if body.prescribed:
        return [f'<Material Type="11" Name="B{number}"><SetDirection>8</SetDirection></Material>']
    table, solid = scene.materials[body.material], elasticity(scene, name)
    kind, moduli = 1, {"E": solid.young, "nu": solid.poisson}
    if table.model == "neo_hookean":
        kind, moduli = 8, {"K": solid.bulk, "G1": solid.shear, "UJOption": 0}
        if getattr(table.options, "energy", "split") == "log":
            kind, moduli = 28, {"Lame": solid.bulk - 2.0 * solid.shear / 3.0, "G": solid.shear, "UJOption": 1}
    given = "".join(f"<{key}>{value:.12g}</{key}>" for key, value in moduli.items())
    return [f'<Material Type="{kind}" Name="B{number}"><rho>{table.density:.12g}</rho>{given}</Material>']


def _supports(scene: Scene, cell: float) -> Iterator[str]:
    """Yield the nodes on and beyond fixed sides."""
    for body in scene.bodies.values():
        for side in body.sides:
            axis, upper = SIDES[side.side]
            low, high = np.array(body.geometry.bounds, dtype=float)
            low, high = low - (BORDER + 1) * cell, high + (BORDER + 1) * cell
            place = body.geometry.bounds[upper][axis] + (-1e-6 if upper else 1e-6) * cell
            (low if upper else high)[axis] = place
            for other in set(range(scene.dim)) - {axis}:  # not the nodes above a side of another body
                high[other] = body.geometry.bounds[1][other] + 1e-6 * cell
            ends = zip("xyz", low, high, strict=False)
            room = " ".join(f'{x}min="{a:.12g}" {x}max="{b:.12g}"' for x, a, b in ends)
            tag = "LdRect" if scene.dim == 2 else "BCBox"
            held: Any = "xyz"[: scene.dim] if side.fixed is True else side.fixed
            fixed = "".join(f'<DisBC dir="{"xyz".index(each) + 1}" disp="0"/>' for each in held)
            yield f"<{tag} {room}>{fixed}</{tag}>"


def _gravity(scene: Scene, wait: float) -> list[str]:
    """Return gravity, that of rest until the motion starts."""
    lines = []
    for axis, level, g in zip("XYZ", gravity_of(scene, settling=True), gravity_of(scene), strict=False):
        text = _text(g)
        if level != g:
            sign = "+" if g > level else "-"
            text = f"{_text(0.5 * (level + g))}{sign}{_text(0.5 * abs(g - level))}*sgn(t-{_text(wait)})"
        lines.append(f"<GridBody{axis}Force>{text}</GridBody{axis}Force>")
    return ["<Gravity>", *lines, "</Gravity>"] if scene.gravity else []


def _archive(path: Path, dim: int) -> Any:
    """Return the points of an archive of version 6: as records, as they stand in the file."""
    kinds: Any = [("element", "<i4"), ("mass", "<f8"), ("material", "<i2"), ("spare", "<i2")]
    kinds += [("turned", "<f8", dim)]  # in the plane an angle and the thickness
    kinds += [(name, "<f8", dim) for name in ("position", "origin", "velocity")]
    kinds += [("empty", "<f8")]  # records are as long as those of cracks
    content = path.read_bytes()
    order = b"iYY".ljust(content[4], b"N")
    if content[:4] != b"ver6" or content[5 : 5 + len(order)] != order:
        raise ValueError(f"{path.name} is not an archive of positions and velocities")
    return np.frombuffer(content, np.dtype(kinds), offset=64)  # behind the header
