"""The cost of a run before it runs: steps, CPU time by stage, of settling and output, memory, from measured times.

A stage's time per step is taken as a + b n + c m: a for the calls, b for each of n material points and c for each of m grid
nodes, or for surface nodes of a contact that works on outlines (:mod:`mpmfw.cost_table`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mpmfw.clock import STEP_STAGES
from mpmfw.cost_table import (
    SHAPE_STAGES,
    Costs,
    measured_costs,
    points_and_nodes,
    seconds,
    surface_and_near,
)
from mpmfw.discovery import available, load
from mpmfw.limits import frames_of, particle_frames_of
from mpmfw.settling import longest_settling

if TYPE_CHECKING:
    from mpmfw.simulation import Simulation


@dataclass(frozen=True)
class Prediction:
    """What a run will take.

    Attributes
    ----------
    steps
        If the time step's limit stays what it is at the start.
    stages
        CPU time of the steps by stage [s].
    settle_steps
        Most that settling may take before it gives up; 0 in a scene that does not settle.
    output_time
        CPU time of frames, energy ledger and gap diagnostic [s].
    start_time
        CPU time of the process that is neither [s]: imports, loading of compiled kernels, the build.
    memory
        Bytes of all arrays, those that are allocated with the first step included.
    source
        Where the times per stage come from.
    unknown
        Plug-ins without measured times, whose nearest relative's were taken.
    """

    steps: int
    stages: Mapping[str, float]
    settle_steps: int
    output_time: float
    start_time: float
    memory: int
    source: str
    unknown: tuple[str, ...]

    @property
    def cpu_time(self) -> float:
        """CPU time of all steps [s], those of settling left out."""
        return sum(self.stages.values())

    @property
    def settle_time(self) -> float:
        """CPU time of the most steps of settling [s]."""
        return self.settle_steps * self.cpu_time / max(self.steps, 1)


def predict(simulation: Simulation, arrays: Iterable[int]) -> Prediction:
    """Predict the cost of a simulation that has not begun.

    Parameters
    ----------
    arrays
        Sizes of the arrays that are allocated already [bytes].
    """
    costs, source = measured_costs()
    state, settle = simulation.state, simulation.scene.settle
    shape, contact = simulation.shape.name, simulation.contact
    unknown = [] if shape in costs["shape"] else [shape]
    table, counts = costs["shape"].get(shape, costs["shape"]["cpdi"]), points_and_nodes(simulation)
    times = {stage: seconds(table[stage], counts) for stage in SHAPE_STAGES}
    forces, sides = _effects(simulation, costs["effect"])
    times["force"] += forces + sides
    if simulation.scheme != "usl":  # sides are asked again for the velocity of the strain
        times["projection"] += sides
    times["contact"] = 0.0
    if contact is not None:
        if contact.name not in costs["contact"]:
            unknown.append(contact.name)
        line = costs["contact"].get(contact.name) or _relative(contact, costs["contact"])
        times["contact"] = seconds(line, surface_and_near(simulation) if contact.needs_surface else counts)
    step = _step(simulation)
    steps = _steps(simulation, step)
    settle_steps = 0 if settle is None else math.ceil(longest_settling(settle, state.bodies) / step)
    return Prediction(
        steps=steps,
        stages={stage: steps * times[stage] for stage in STEP_STAGES},
        settle_steps=settle_steps,
        output_time=output_time(simulation, costs, steps, settle_steps),
        start_time=seconds(costs["start"], counts),
        memory=sum(arrays) + _tables(simulation),
        source=source,
        unknown=tuple(unknown),
    )


def _tables(simulation: Simulation) -> int:
    """Bytes of the tables of interpolation, which are filled with the first step, and of the rows of contact."""
    state, shape = simulation.state, simulation.shape.name
    dim, surface = state.grid.dim, state.surface
    at_points = {"linear": 2**dim, "bspline": 3**dim, "cubic_bspline": 4**dim, "ck": 2 ** (dim + 1)}
    over_domains = {"gimp": 3.0**dim}.get(shape, 7.0 ** (dim / 2))
    total = int(state.particles.count * at_points.get(shape, over_domains) * (4 + 8 + 8 * dim))
    if surface is not None:
        total += surface.count * at_points.get(shape, 2**dim) * (4 + 8)
    rows = {id(each): each for each in (getattr(simulation.contact, name, None) for name in ("rows", "old"))}
    for each in rows.values():
        total += 0 if each is None else sum(int(array.nbytes) for array in each.arrays().values())
    return total


def _effects(simulation: Simulation, costs: Costs) -> tuple[float, float]:
    """Seconds a step of gravity and rotation, and of prescribed sides."""
    state, scene = simulation.state, simulation.scene
    total = sides = 0.0
    if simulation.manager.has_plugin("gravity"):
        total += seconds(costs["gravity"], points_and_nodes(simulation))
    for body in state.bodies:
        nodes = state.grid.field_nodes(body.field)
        own = (float(body.particles.stop - body.particles.start), float(nodes.stop - nodes.start))
        held = [side for side in scene.bodies[body.name].sides if not side.is_loaded]
        sides += len(held) * seconds(costs["sides"], own)
        how = simulation.rotations[body.name]
        total += seconds(costs[how], own) if how != "lumped" else 0.0
    return total, sides


def output_time(simulation: Simulation, costs: Costs, steps: int, settle_steps: int) -> float:
    """Seconds of frames, and of what is measured in every step; the ledger looks away while a scene settles."""
    counts, surface = points_and_nodes(simulation), simulation.state.surface
    total = frames_of(simulation) * seconds(costs["frame"]["series"], counts)
    if simulation.scene.output.particles:
        total += particle_frames_of(simulation) * seconds(costs["frame"]["points"], counts)
    if simulation.manager.has_plugin("energy_ledger"):
        total += steps * seconds(costs["effect"]["ledger"], counts)
    if surface is not None and surface.stage == "gap":
        total += (steps + settle_steps) * seconds(costs["effect"]["gap"], surface_and_near(simulation))
    return total


def _relative(contact: Any, known: Mapping[str, Any]) -> Any:
    """Of the measured contacts that work on surfaces as this does, or not as it does not, the costliest; else of all."""
    alike = [
        line
        for name, line in known.items()
        if name in available("contact") and load("contact", name).needs_surface == contact.needs_surface
    ]
    return max(alike or known.values(), key=lambda line: seconds(line, (1000.0, 100.0)))


def _step(simulation: Simulation) -> float:
    """Length of a step [s] as the limits are at the start."""
    time = simulation.scene.time
    limits = _limits(simulation)
    return float(time.safety * min(limits)[0] if time.step is None else time.step)


def _steps(simulation: Simulation, step: float) -> int:
    """Outputs times the steps between two, which are of equal length, or all steps where outputs shorten none."""
    time = simulation.scene.time
    if time.outputs == "nearest":
        steps: int = math.ceil(time.end / step - 1e-9)
        return steps
    outputs = max(1, math.ceil(time.end / time.output_interval - 1e-9))
    return int(outputs * math.ceil(min(time.output_interval, time.end) / step - 1e-9))


def _limits(simulation: Simulation) -> list[tuple[float, str]]:
    """Stable time steps [s] with the contacts of the start; where bodies do not meet yet, those taken for granted.

    Nothing is detected, and compiled for it, where contact limits no step or its search is asleep.
    """
    before = simulation.limits()
    asleep = any(effect.name == "contact search" and not effect.on for effect in simulation.effects)
    if asleep or not hasattr(simulation.contact, "stable_timestep"):
        return before
    with simulation.blaming():
        simulation.detect()
    after = simulation.limits()
    return after if len(after) >= len(before) else before
