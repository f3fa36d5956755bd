"""Contact makes no energy, and holds at the time step that it says it holds at."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.errors import SimulationError
from mpmfw.runs.simulation import Simulation
from mpmfw_testing.check import Inapplicable, Violation, within
from mpmfw_testing.contact.drawing import histories
from mpmfw_testing.contact.meeting import (
    BULK_MODULUS,
    DENSITY,
    DEPTH,
    TURNS,
    UNEQUAL,
    WIDTH,
    Meeting,
    search_meetings,
)
from mpmfw_testing.contact.motion import Motion, meetings, note, recorded
from mpmfw_testing.saving import remember
from mpmfw_testing.subject import Subject

#: Growth of kinetic and strain energy over that at the start.
GROWTH = 0.005
#: Share of the law's own limit, and of the bulk's h / c, that a step takes.
OF_OWN_LIMIT, OF_BULK_LIMIT = 0.9, 0.8
#: Acceleration that presses the bodies together [m/s²]: compresses a block by 1 %.
PRESSING = 0.01 * BULK_MODULUS * 5.0 / 3.0 / (DENSITY * DEPTH)
#: Kinetic energy of pressed bodies over the work that presses them.
SHAKEN = 2.0
#: Steps at the limit: enough for an instability to grow by many orders.
LONG = 250


@meetings(
    "discs", **UNEQUAL, turn=TURNS, slide=(0.0, 1.0, 3), friction=(0.0, 1.0, 3), partial=True, examples=10
)
def energy(_meeting: Meeting, motion: Motion) -> None:
    """Contact gives the bodies no energy. Kinetic and strain energy of all bodies never exceed those at the
    start by more than 0.5 %.

    Springs of a law hold energy for a while, never less than nothing, so that what the bodies have can only
    be less. Half a per cent is left for the time integration. Bodies of unequal mass and stiffness meet at an
    angle, with friction.
    """
    require_no_gain(motion, "the bodies gain energy from contact")


def require_no_gain(motion: Motion, message: str) -> None:
    """Raise a violation where the bodies gain more than ``GROWTH`` of their energy."""
    energy = motion.energy / motion.energy[0]
    time = np.concatenate([[0.0], np.cumsum(motion.dt)])
    within(
        float(energy.max()) - 1.0,
        GROWTH,
        f"{message} (growth over the energy at the start)",
        {"step of the maximum": int(energy.argmax())},
        histories({"kinetic and strain energy": (time, energy)}, "energy over that at the start"),
    )


def time_step(subject: Subject) -> None:
    """The law is stable at the time step that it states as its limit. At 0.9 of the law's own limit (0.8 h /
    c at most) two pressed blocks stay at rest: kinetic energy ≤ 2 × the work done.

    One block lies on the other under a weight that compresses it by 1 %; the work is that of the weight over
    the blocks' static compression. Bodies released so swing with less than it. Past a limit of stability the
    energy grows by orders of magnitude within the 250 steps.
    """
    asked = _own_limit(_pressed(subject, Meeting(speed=0.0, gap=0.0)))
    if asked is None:
        raise Inapplicable("the law states no time-step limit of its own: the bulk's h / c rules")

    def trial(meeting: Meeting) -> None:
        simulation = _pressed(subject, meeting)
        work = _work_of_pressing(meeting)
        with recorded(simulation) as motion:
            try:
                _run_at_limit(simulation, motion)
            except SimulationError as error:
                raise Violation(
                    f"the run breaks down at {OF_OWN_LIMIT} of the law's own time-step limit: {error}",
                    {"steps taken": simulation.state.steps, "step [s]": simulation.state.dt},
                    _energy_picture(motion, work),
                ) from error
        kinetic = motion.of("kinetic_energy").sum(axis=1)
        within(
            float(kinetic.max()) / work,
            SHAKEN,
            f"at {OF_OWN_LIMIT} of the law's own time-step limit the motion grows (energy over the work "
            "done)",
            {"step of the maximum": int(kinetic.argmax()), "step [s]": max(motion.dt)},
            _energy_picture(motion, work),
        )

    search_meetings(
        trial,
        stiffer=(1.0, 9.0, 3),
        heavier=(1.0, 9.0, 3),
        friction=(0.0, 0.5, 2),
        speed=0.0,
        gap=0.0,
        examples=4,
        most=12,
    )


def _pressed(subject: Subject, meeting: Meeting) -> Simulation:
    """The first block pressed onto the second, whose far side is fixed; steps past any limit are allowed."""
    weight = {"gravity": {"vector": (PRESSING * meeting.normal).tolist()}}
    mapping = meeting.mapping(allow_unstable=True, **weight)
    mapping["bodies"]["second"]["sides"] = [{"side": "right", "fixed": True}]
    remember(mapping, 40)
    simulation = Simulation(mapping, contact=subject.make())
    simulation.start()
    return simulation


def _own_limit(simulation: Simulation) -> float | None:
    """The strategy's own stable time step at this moment [s], its parts' included; None if it states none."""
    contact = simulation.contact
    parts = () if contact is None else tuple(type(part) for part in contact.parts())
    stated = []
    for impl in simulation.manager.hook.stable_timestep.get_hookimpls():
        if impl.plugin is contact or isinstance(impl.plugin, parts):
            answer: Any = impl.function(*[simulation.state for _ in impl.argnames])
            if answer is not None:
                stated.append(float(answer[0]))
    return min(stated) if stated else None


def _run_at_limit(simulation: Simulation, motion: Motion) -> None:
    bulk = simulation.limits()[0][0]
    simulation.advance(0, lambda frame: note(motion, frame))
    for _ in range(LONG):
        own = _own_limit(simulation)
        step = OF_BULK_LIMIT * bulk
        simulation.step(step if own is None else min(step, OF_OWN_LIMIT * own))
        simulation.advance(0, lambda frame: note(motion, frame))


def _work_of_pressing(meeting: Meeting) -> float:
    """Weight of both blocks times the way that their static compression lets them go [J/m]."""
    modulus = BULK_MODULUS * 5.0 / 3.0
    weights = [PRESSING * mass for mass in meeting.mass]
    first = 0.5 * weights[0] * DEPTH / (modulus * WIDTH)
    second = (weights[0] + 0.5 * weights[1]) * DEPTH / (meeting.stiffer * modulus * WIDTH)
    return weights[0] * (first + second) + weights[1] * second


def _energy_picture(motion: Motion, work: float) -> Any:
    kinetic = motion.of("kinetic_energy").sum(axis=1) / work
    time = np.concatenate([[0.0], np.cumsum(motion.dt)])[: len(kinetic)]
    return histories({"kinetic energy": (time, kinetic)}, "energy over the work that presses")
