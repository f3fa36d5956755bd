"""The cost of a run before it runs: steps, CPU time by stage, memory, from measured times per stage.

A stage's time per step is taken as a + b n: a for the calls, b for each of the n entities that it works on, material
points, or surface nodes for a contact strategy that works on outlines. Both come from the same scene at two sizes
(:func:`measure`). A table of them ships with the package; one that ``mpmfw explain --measure`` made on this
machine takes its place.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import platformdirs

from mpmfw.clock import STEP_STAGES
from mpmfw.discovery import available, load

if TYPE_CHECKING:
    from mpmfw.simulation import Simulation

#: Stages that a shape function decides; the contact's own is measured for each strategy.
SHAPE_STAGES = tuple(stage for stage in STEP_STAGES if stage != "contact")

#: Cells along the edge of each of two blocks, at the two sizes.
SIZES = (5, 40)

Costs = dict[str, dict[str, dict[str, list[float]]]]


@dataclass(frozen=True)
class Prediction:
    """What a run will take, settling and output left out.

    Attributes
    ----------
    steps
        If the time step's limit stays what it is at the start.
    stages
        CPU time by stage [s].
    memory
        Bytes of all arrays, those that are allocated with the first step included.
    source
        Where the times per stage come from.
    unknown
        Plug-ins without measured times, whose nearest relative's were taken.
    """

    steps: int
    stages: Mapping[str, float]
    memory: int
    source: str
    unknown: tuple[str, ...]

    @property
    def cpu_time(self) -> float:
        """CPU time of all steps [s]."""
        return sum(self.stages.values())


def predict(simulation: Simulation, arrays: Iterable[int]) -> Prediction:
    """Predict the cost of a simulation that has not begun.

    Parameters
    ----------
    arrays
        Sizes of the arrays that are allocated already [bytes].
    """
    costs, source = measured_costs()
    state = simulation.state
    shape, contact = simulation.shape.name, simulation.contact
    unknown = [] if shape in costs["shape"] else [shape]
    table = costs["shape"].get(shape, costs["shape"]["cpdi"])
    times = {stage: _time(table[stage], state.particles.count) for stage in SHAPE_STAGES}
    times["contact"] = 0.0
    if contact is not None:
        if contact.name not in costs["contact"]:
            unknown.append(contact.name)
        entry = costs["contact"].get(contact.name) or _relative(contact, costs["contact"])
        entry = entry["contact"]
        surface = state.surface if contact.needs_surface else None
        times["contact"] = _time(entry, surface.count if surface is not None else state.particles.count)
    steps = _steps(simulation)
    stages = {stage: steps * times[stage] for stage in STEP_STAGES}
    entries = {"linear": 4, "gimp": 9, "bspline": 9}.get(shape, 7) ** (state.grid.dim / 2)
    table_bytes = int(state.particles.count * entries * (4 + 8 + 8 * state.grid.dim))
    return Prediction(steps, stages, sum(arrays) + table_bytes, source, tuple(unknown))


def _relative(contact: Any, known: Mapping[str, Any]) -> Any:
    """Of the measured contacts that work on surfaces as this does, or not as it does not, the costliest; else of all."""
    alike = [
        times
        for name, times in known.items()
        if name in available("contact") and load("contact", name).needs_surface == contact.needs_surface
    ]
    return max(alike or known.values(), key=lambda times: _time(times["contact"], 1000))


def _time(cost: list[float], count: int) -> float:
    """a + b n [s]."""
    return cost[0] + cost[1] * count


def _steps(simulation: Simulation) -> int:
    """Outputs times the steps between two, which are of equal length, or all steps where outputs shorten none."""
    time = simulation.scene.time
    limits = _limits(simulation)
    step: float = time.safety * min(limits)[0] if time.step is None else time.step
    if time.outputs == "nearest":
        steps: int = math.ceil(time.end / step - 1e-9)
        return steps
    outputs = max(1, math.ceil(time.end / time.output_interval - 1e-9))
    return int(outputs * math.ceil(min(time.output_interval, time.end) / step - 1e-9))


def _limits(simulation: Simulation) -> list[tuple[float, str]]:
    """Stable time steps [s] with the contacts of the start; where bodies do not meet yet, those taken for granted."""
    before = simulation.limits()
    with simulation.blaming():
        simulation.detect()
    after = simulation.limits()
    return after if len(after) >= len(before) else before


def measured_costs() -> tuple[Costs, str]:
    """Measured times per stage, and in words where they were measured."""
    own = own_table()
    if own.exists():
        return json.loads(own.read_text(encoding="utf-8")), "measured here by mpmfw explain --measure"
    shipped = json.loads((files("mpmfw") / "reference" / "costs.json").read_text(encoding="utf-8"))
    return shipped, "the shipped table; mpmfw explain --measure takes one of this machine"


def own_table() -> Path:
    """Where this user's own table is kept."""
    return platformdirs.user_cache_path("mpmfw") / "costs.json"


def measure(path: Path) -> None:
    """Measure every installed shape function and contact strategy, and write the table."""
    from mpmfw.benchmark import measure_scene
    from mpmfw.contact.strategy import NoInteraction

    def line(stages: tuple[str, ...], by_surface: bool, contact: Any, shape: str) -> dict[str, list[float]]:
        rows = [measure_scene(_touching(cells), 5, steps=40, contact=contact, shape=shape) for cells in SIZES]
        counts = [
            _surface_nodes(cells) if by_surface else row["particles"]
            for cells, row in zip(SIZES, rows, strict=True)
        ]
        return {
            stage: _fit(counts, [1e-9 * row[f"ns_{stage}"] * row["particles"] for row in rows])
            for stage in stages
        }

    contacts = {name: load("contact", name).needs_surface for name in available("contact")}
    costs = {
        "shape": {
            name: line(SHAPE_STAGES, False, shape=name, contact=NoInteraction())
            for name in available("shape")
        },
        "contact": {
            name: line(("contact",), by_surface, shape="cpdi", contact=name)
            for name, by_surface in contacts.items()
        },
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(costs, indent=1) + "\n", encoding="utf-8")


def _fit(counts: list[int], times: list[float]) -> list[float]:
    """a and b of the line through two measurements, neither negative."""
    slope = max((times[1] - times[0]) / (counts[1] - counts[0]), 0.0)
    return [max(times[0] - slope * counts[0], 0.0), slope]


def _surface_nodes(cells: int) -> int:
    """Of two blocks with segments of a quarter of a cell."""
    return 2 * 4 * 4 * cells


def _touching(cells: int) -> dict[str, Any]:
    """Two blocks that touch along one face and are pushed together."""

    def block(left: float, speed: float) -> dict[str, Any]:
        geometry = {"type": "rectangle", "lower": [left, 0.3], "upper": [left + cells, 0.3 + cells]}
        particles = {"layout": "fitted", "size": "0.5 cells"}
        return {"material": "m", "geometry": geometry, "particles": particles, "velocity": [speed, 0.0]}

    return {
        "grid": {"cell_size": 1.0, "lower": [-cells - 4, -4], "upper": [cells + 4, cells + 4]},
        "time": {"end": 1e3, "output_interval": 1e3},
        "shape": {"method": "cpdi"},
        "contact": {"method": next(iter(available("contact"))), "friction": 0.3},  # others take its place
        "output": {"gap": False, "particles": False, "surface": False},
        "materials": {
            "m": {"model": "neo_hookean", "density": 1.0, "bulk_modulus": 1.0, "shear_modulus": 0.5}
        },
        "bodies": {"left": block(0.4 - cells, 1e-3), "right": block(0.4, -1e-3)},
    }
