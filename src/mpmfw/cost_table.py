"""Measured times that predictions are made of: a + b n + c m seconds for n entities of one kind and m of another.

Both kinds and a come from the same scene at three sizes: of points and grid nodes, or of a contact that works on outlines
surface nodes and those of them that are near another body.

A table of them ships with the package; one that ``mpmfw explain --measure`` made on this machine takes its place. It has times a
step of every shape function (``shape``, by stage), contact strategy (``contact``) and effect (``effect``), times a frame
(``frame``), and the time of a whole process that takes no steps (``start``).
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs

from mpmfw.benchmark.sampling import stage_times
from mpmfw.clock import STAGES, STEP_STAGES
from mpmfw.contact.strategy import NoInteraction
from mpmfw.discovery import available
from mpmfw.pairs import overlapping
from mpmfw.results import RunWriter
from mpmfw.scene.toml_text import toml_text
from mpmfw.simulation import Simulation

#: Stages that a shape function decides; the contact's own is measured for each strategy.
SHAPE_STAGES = tuple(stage for stage in STEP_STAGES if stage != "contact")

#: Cells along the edges of each of two blocks: small, large, and thin, with many grid nodes and few that are near the other.
SIZES = ((5, 5), (40, 40), (80, 1))

#: Steps before the first sample, samples, steps of each, and steps between two outputs.
WARM_UP, REPEATS, STEPS, BETWEEN = 5, 5, 40, 20

#: Frames of a sample.
FRAMES = 10

#: Share of surface nodes that are taken to be near another body where none is at the start.
NEAR = 0.25

Line = list[float]
Costs = dict[str, Any]


def measured_costs() -> tuple[Costs, str]:
    """Measured times, and in words where they were measured."""
    own = own_table()
    if own.exists():
        return json.loads(own.read_text(encoding="utf-8")), "measured here by mpmfw explain --measure"
    shipped = json.loads((files("mpmfw") / "reference" / "costs.json").read_text(encoding="utf-8"))
    return shipped, "the shipped table; mpmfw explain --measure takes one of this machine"


def own_table() -> Path:
    """Where this user's own table is kept."""
    return platformdirs.user_cache_path("mpmfw") / "costs.json"


def seconds(line: Line, counts: tuple[float, float]) -> float:
    """a + b n + c m [s]."""
    return line[0] + line[1] * counts[0] + line[2] * counts[1]


def points_and_nodes(simulation: Simulation) -> tuple[float, float]:
    """Numbers of material points and of grid nodes in all windows."""
    return float(simulation.state.particles.count), float(simulation.state.grid.offset[-1])


def surface_and_near(simulation: Simulation) -> tuple[float, float]:
    """Numbers of surface nodes, and of those within the reach of the search of another body's box at the start."""
    surface, bodies, near = simulation.state.surface, simulation.state.bodies, 0
    if surface is None:
        return 0.0, 0.0
    reach = getattr(simulation.contact, "reach", lambda _: None)(simulation.state.grid.cell_size) or 0.0
    lower, upper = (np.array([getattr(body, end) for body in bodies]) for end in ("lower", "upper"))
    for first, second in zip(*overlapping(lower - 0.5 * reach, upper + 0.5 * reach), strict=True):
        for one, other in ((first, second), (second, first)):
            x = surface.position[surface.of(one)]
            near += int(((x >= lower[other] - reach) & (x <= upper[other] + reach)).all(axis=1).sum())
    return float(surface.count), near or NEAR * surface.count


def measure(path: Path) -> None:
    """Measure every installed shape function and contact strategy, the effects and the output, and write the table."""
    costs = {
        "shape": {
            name: _lines(SHAPE_STAGES, shape=name, contact=NoInteraction()) for name in available("shape")
        },
        "contact": {
            name: _lines(("contact",), contact=name, pressed=True)["contact"] for name in available("contact")
        },
        "effect": {name: _effect(name) for name in EFFECTS},
        "frame": _frames(),
        "start": _start(),
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(costs, indent=1) + "\n", encoding="utf-8")


LEDGER_PLUGINS = tuple(
    f"energy_ledger{part}" for part in ("", "_before", "_after", " before gravity", " after gravity")
)

GRAVITY = {"gravity": {"vector": [0.0, -1e-4]}}
SIDES = {"sides": [{"side": side, "fixed": True} for side in ("bottom", "left", "right")]}
LEDGER = {"output": {"gap": False, "ledger": True}}

#: Of each effect what the measured scene has of it, its plug-ins, and how many of what it is counted by are in the scene (sides
#: of ``sides``, bodies of the kinds of rotation), and how often it is counted by each point.
EFFECTS: dict[str, tuple[dict[str, Any], tuple[str, ...], int, int]] = {
    "gravity": (GRAVITY, ("gravity",), 1, 1),
    "sides": (GRAVITY | SIDES, ("constraint",), 6, 3),
    "spin": ({"rotation": "spin"}, ("local_spin",), 2, 1),
    "exact": ({"rotation": "exact"}, ("rotation",), 2, 1),
    "ledger": (GRAVITY | SIDES | LEDGER, LEDGER_PLUGINS, 1, 1),
    "gap": ({"output": {"gap": True}}, (), 1, 1),
}


def _effect(name: str) -> Line:
    """Seconds a step: a for each of what it is counted by, b for each of its points and c for each of its nodes."""
    changes, plugins, number, times = EFFECTS[name]
    contact = next(iter(available("contact"))) if name == "ledger" else NoInteraction()
    a, b, c = _lines(("gap",), contact=contact, watched=plugins, **changes)["gap"]
    return [a / number, b / times, c / times]


def _lines(
    stages: Sequence[str], *, contact: Any, shape: str = "cpdi", watched: Sequence[str] = (), **changes: Any
) -> dict[str, Line]:
    """Seconds a step of some stages; the time of the plug-ins ``watched`` goes to the gap, where there is no other."""
    counts, times = [], []
    for size in SIZES:
        simulation = _watching(Simulation(_touching(*size, **changes), shape=shape, contact=contact), watched)
        surface = simulation.state.surface
        by_surface = surface is not None and surface.stage in stages
        counts.append(surface_and_near(simulation) if by_surface else points_and_nodes(simulation))
        times.append(_sample(simulation))
    return {stage: _fit(counts, [each[stage] for each in times]) for stage in stages}


def _watching(simulation: Simulation, plugins: Sequence[str]) -> Simulation:
    """The simulation, with the time of some plug-ins going to the gap."""
    for name in plugins:
        if (plugin := simulation.manager.get_plugin(name)) is not None:
            plugin.stage = "gap"
    simulation._bind_hooks()
    return simulation


def _sample(simulation: Simulation) -> dict[str, float]:
    """Seconds a step of every stage."""
    clock = simulation.clock
    simulation.advance(WARM_UP, write=lambda _: None)
    wall, cpu = np.zeros((REPEATS, len(STAGES))), np.zeros(REPEATS)
    for repeat in range(REPEATS):
        clock.restart()
        for _ in range(STEPS // BETWEEN):  # as in a run: an output leaves little in the caches
            _go_on(simulation)
            simulation._output(None, BETWEEN * simulation.state.dt)
        wall[repeat] = [clock.wall[stage] for stage in STAGES]
        cpu[repeat] = sum(clock.cpu.values())
    return dict(zip(STAGES, stage_times(wall, cpu) / STEPS, strict=True))


def _go_on(simulation: Simulation) -> None:
    """The steps between two outputs, towards the far end of the measured scene."""
    for _ in range(BETWEEN):
        simulation._step_towards(simulation.scene.time.end)


def _frames() -> dict[str, Line]:
    """Seconds a frame of a scene with all that is recorded: of one without material points, and what these add."""
    counts: list[tuple[float, float]] = []
    times: dict[bool, list[float]] = {False: [], True: []}
    for size in SIZES:
        simulation = _watching(Simulation(_touching(*size, output={"ledger": True})), LEDGER_PLUGINS)
        counts.append(points_and_nodes(simulation))
        with (
            tempfile.TemporaryDirectory() as folder,
            RunWriter(f"{folder}/run.nc", simulation.header()) as writer,
        ):
            simulation.advance(WARM_UP, writer.write)
            for points, found in times.items():
                found.append(min(_frame(simulation, writer, points) for _ in range(REPEATS)))
    added = [max(whole - series, 0.0) for whole, series in zip(times[True], times[False], strict=True)]
    return {"series": _fit(counts, times[False]), "points": _fit(counts, added)}


def _frame(simulation: Simulation, writer: RunWriter, points: bool) -> float:
    """Seconds of a frame, some steps after the last."""
    clock = simulation.clock
    clock.restart()
    for _ in range(FRAMES):
        _go_on(simulation)
        simulation._output(writer.write, BETWEEN * simulation.state.dt, points=points)
    return clock.cpu["output"] / FRAMES


def _start() -> Line:
    """Seconds of a process that builds a scene and takes next to no step, and seconds a material point of building one."""
    scene = _touching(*SIZES[0], time={"end": 1e-3, "output_interval": 1e-3})
    used = []
    with tempfile.TemporaryDirectory() as folder:
        Path(f"{folder}/scene.toml").write_text(toml_text(scene), encoding="utf-8")
        command = [sys.executable, "-m", "mpmfw", "run", "scene.toml", "-o", "run.nc", "--force"]
        for _ in range(3):
            before = _children()
            subprocess.run(command, cwd=folder, check=True, capture_output=True)
            used.append(_children() - before)
    begin = time.process_time()
    large = Simulation(_touching(*SIZES[1]))
    return [min(used), (time.process_time() - begin) / large.state.particles.count, 0.0]


def _children() -> float:
    """CPU time of the processes that this one has waited for [s]."""
    used = os.times()
    return used.children_user + used.children_system


def _fit(counts: Sequence[tuple[float, float]], times: Sequence[float]) -> Line:
    """a, b and c through three measurements, or the best that are not negative: what would be is left out."""
    rows = np.column_stack([np.ones(len(times)), np.array(counts)]) / np.array(times)[:, None].clip(1e-12)
    kept = [0, 1, 2]
    while True:
        found = np.zeros(3)
        found[kept] = np.linalg.lstsq(rows[:, kept], np.ones(len(times)), rcond=None)[0]
        if found.min() >= 0.0:
            return [float(value) for value in found]
        kept.remove(int(found.argmin()))


def _touching(
    width: int,
    height: int,
    *,
    rotation: str = "lumped",
    sides: Any = (),
    pressed: bool = False,
    **changes: Any,
) -> dict[str, Any]:
    """Two blocks of so many cells that touch along one face and move together, free or ``pressed`` by their other sides."""

    def block(left: float, speed: float) -> dict[str, Any]:
        sides_of = list(sides)
        if pressed:
            sides_of = [{"side": "left" if speed > 0.0 else "right", "velocity": [speed, "free"]}]
        geometry = {"type": "rectangle", "lower": [left, 0.3], "upper": [left + width, 0.3 + height]}
        particles = {"layout": "fitted", "size": "0.5 cells"}
        own = {"rotation": rotation, **({"sides": sides_of} if sides_of else {})}
        # F of a body at rest is 1, whose logarithm is quick
        motion = {"velocity": [speed, 0.0], "angular_velocity": 1e-4}
        return {"material": "m", "geometry": geometry, "particles": particles, **motion, **own}

    return {
        "grid": {"cell_size": 1.0, "lower": [-width - 4, -4], "upper": [width + 4, height + 4]},
        "time": {"end": 1e3, "output_interval": 1e3},
        "shape": {"method": "cpdi"},
        "contact": {"method": next(iter(available("contact"))), "friction": 0.3},  # others take its place
        "output": {"gap": False, "particles": False, "surface": False},
        "materials": {
            "m": {"model": "neo_hookean", "density": 1.0, "bulk_modulus": 1.0, "shear_modulus": 0.5}
        },
        "bodies": {"left": block(0.4 - width, 1e-3), "right": block(0.4, -1e-3)},
        **changes,
    }
