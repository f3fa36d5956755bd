"""The cost of a run, from a trial of its first steps; later contacts and plastic flow are left out."""

from __future__ import annotations

import math
import time as clocks
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.effects.settling import longest_settling
from mpmfw.runs.limits import outputs_of, steps_of
from mpmfw.scene.bodies import motion_of
from mpmfw.state.fields import STEP_STAGES, FloatArray
from mpmfw.step.schemes import interpolate

if TYPE_CHECKING:
    from mpmfw.runs.simulation import Simulation

#: Steps before those that are timed, which compile and fill caches, and steps that are timed.
WARM_UP, TIMED = 3, 20


@dataclass(frozen=True)
class Prediction:
    """Cost of a run."""

    first_step: float  #: its length [s], of settling in a scene that settles
    steps: int  #: if the time step's limit stays as it is
    stages: Mapping[str, float]  #: CPU time of the steps by stage [s]
    settle_steps: int  #: at most; 0 in a scene that does not settle
    output_time: float  #: CPU time of frames, energy ledger and gap [s], without writing
    start_time: float  #: CPU time of this process up to the trial [s]
    memory: int  #: of all arrays [bytes]
    limits: tuple[tuple[float, str], ...]  #: stable steps [s] and their owners

    @property
    def cpu_time(self) -> float:
        """CPU time of all steps [s], those of settling left out."""
        return sum(self.stages.values())

    @property
    def settle_time(self) -> float:
        """CPU time of the most steps of settling [s]."""
        return self.settle_steps * self.cpu_time / max(self.steps, 1)


def predict(simulation: Simulation, arrays: Iterable[int]) -> Prediction:
    """Predict the cost of a simulation, which cannot be used afterwards; ``arrays`` [bytes] are its own."""
    before, clock, settle = clocks.process_time(), simulation.clock, simulation.scene.settle
    with ExitStack() as stack:
        stack.enter_context(clock.watching_compilation())
        time = simulation.scene.time
        if settle is not None:
            stack.enter_context(simulation.extra_plugin(simulation.begin_settling()))
            simulation.step()
        else:
            simulation.start()
            exact = time.outputs == "exact"
            simulation.step_towards(min(time.output_interval, time.end) if exact else time.end)
        first_step, limits = simulation.state.dt, simulation.limits()
        simulation.frame()  # from its first output on the ledger measures every step
        for _ in range(WARM_UP):
            simulation.step()
        outputs = outputs_of(simulation.scene)
        every = math.ceil(steps_of(simulation.scene, simulation.stable_step()) / outputs)
        clock.restart()
        for step in range(1, TIMED + 1):
            simulation.step()
            if step % every == 0:  # which displaces the steps' arrays from caches
                clock.flush()
                clock("output")
                simulation.frame()
                clock.flush()
        clock.flush()
        times = {stage: seconds / TIMED for stage, seconds in clock.cpu.items()}
        clock.restart()
        clock("output")
        simulation.frame()
        clock.flush()
        frame = clock.cpu["output"] + clock.cpu["gap"]
        length, tables = simulation.stable_step(), _tables(simulation)
    steps, settle_steps = int(steps_of(simulation.scene, length)), 0
    frames = max(outputs + 1 - steps * (TIMED // every) / TIMED, 0.0)  # beside those between the steps
    if settle is not None:
        settle_steps = math.ceil(longest_settling(settle, simulation.state.bodies) / length)
    return Prediction(
        first_step=first_step,
        steps=steps,
        stages={stage: steps * times[stage] for stage in STEP_STAGES},
        settle_steps=settle_steps,
        output_time=steps * (times["output"] + times["gap"]) + frames * frame,
        start_time=before,
        memory=sum(arrays) + tables,
        limits=tuple(limits),
    )


def _tables(simulation: Simulation) -> int:
    """Return the bytes of tables and contact rows, which a step fills."""
    surface, contact = simulation.state.surface, simulation.contact
    tables = [interpolate(simulation.state, simulation.hook, simulation.clock)]
    tables += [] if surface is None else [surface.table]
    rows = {id(each): each for name in ("rows", "old") if (each := getattr(contact, name, None)) is not None}
    arrays = [array for table in tables for array in table.kernel_arrays]
    arrays += [array for each in rows.values() for array in (each.members() | each.of_rows()).values()]
    return sum(int(array.nbytes) for array in arrays)


def driven_speed(simulation: Simulation) -> FloatArray:
    """Largest speed of driven sides and rigid bodies along each axis (dim,) [m/s]."""
    speed = np.zeros(simulation.scene.dim)
    for body in simulation.scene.bodies.values():
        for side in body.sides:
            speed = np.fmax(speed, np.abs(motion_of(side, len(speed)).values).max(axis=0))
    rigid: Any = simulation.state.rigid
    for velocity, *_ in () if rigid is None else rigid.motion:
        speed = np.maximum(speed, np.abs(velocity.values).max(axis=0))
    return speed


def share_of_springs(simulation: Simulation, axis: int | None) -> float:
    """Estimate the part of a displacement that contact springs take, in series with the bodies.

    Under a unit pressure, springs yield by h / (κ M) and a body by its length over M. A pair counts if its
    boxes are less than a cell apart and, with an ``axis``, follow each other along it."""
    state, h = simulation.state, simulation.scene.grid.cell_size
    contact: Any = simulation.contact
    springs = contact.compliance() if hasattr(contact, "compliance") else None
    if springs is None:
        return 0.0
    lower, upper = (np.array([getattr(body, end) for body in state.bodies]) for end in ("lower", "upper"))
    of_springs, loaded = 0.0, set()
    for pair, compliance in zip(state.pairs, springs, strict=True):
        both = [pair.first, pair.second]
        gap = lower[both].max(0) - upper[both].min(0)  # negative where boxes overlap
        if gap.max() < h and (axis is None or gap[axis] > -h):
            of_springs += float(compliance)
            loaded |= set(both)
    length = np.ptp(np.stack([lower, upper]), axis=0)
    along = length.min(1) if axis is None else length[:, axis]
    of_bodies = sum(along[b] / state.bodies[b].p_wave_modulus for b in loaded)
    return of_springs / (of_springs + of_bodies) if loaded else 0.0
