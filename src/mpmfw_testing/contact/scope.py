"""Where a law holds: at the time step that it states, with every shape function, in space."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available, distribution_of
from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Inapplicable, Violation, within
from mpmfw_testing.contact.conservation import require_balance, require_one_line
from mpmfw_testing.contact.impact import (
    BULK_MODULUS,
    CELL,
    DENSITY,
    DEPTH,
    NAMES,
    WIDTH,
    Impact,
    NoInteraction,
    body,
    material,
    scene,
    search_impacts,
)
from mpmfw_testing.contact.motion import STEPS, Motion, simulate
from mpmfw_testing.contact.separation import LEFT
from mpmfw_testing.searching import hypothesis, ladder, raised, search, try_all
from mpmfw_testing.subject import Subject

#: Share of the law's own limit, and of the bulk's h / c, that a step takes.
OF_OWN_LIMIT, OF_BULK_LIMIT = 0.9, 0.8
#: K + 4 G / 3 of the first body [Pa].
MODULUS = BULK_MODULUS * 5.0 / 3.0
#: Acceleration that presses the bodies together [m/s²]: compresses a block by 1 %.
PRESSING = 0.01 * MODULUS / (DENSITY * DEPTH)
#: Kinetic energy of pressed bodies over the work that presses them.
SHAKEN = 2.0
#: Steps at the limit: enough for an instability to grow by many orders.
LONG = 250
#: Drift of all bodies' momentum over the momentum that they bring.
DRIFT = 1e-9
#: Edge of the cubes, and half the edge of their grid [m].
EDGE, HALF = 0.3, 0.6
#: Difference of motions along two axes [cells, and share of the largest momentum]: triangles halve a face one
#: way or the other.
TRIANGLES = 0.01
AXES = {"x": 0, "y": 1, "z": 2}


def time_step(subject: Subject) -> None:
    """The law is stable at the time step that it states as its limit. At 0.9 of the law's own limit (0.8 h /
    c at most) two pressed blocks stay at rest: kinetic energy ≤ 2 × the work done.

    One block lies on the other under a weight that compresses it by 1 %; the work is that of the weight over
    the blocks' static compression. Bodies released so swing with less than it. Past a limit of stability the
    energy grows by orders of magnitude within the 250 steps.
    """
    still: dict[str, Any] = {"speed": 0.0, "gap": 0.0}
    pressed = _pressed(subject, Impact(**still)).simulation
    pressed.start()
    if _own_limit(pressed) is None:
        raise Inapplicable("the law states no time-step limit: the bulk's h / c applies")

    def trial(impact: Impact) -> None:
        motion = _pressed(subject, impact)
        motion.simulation.start()
        bulk = motion.simulation.limits()[0][0]
        for _ in range(LONG):
            own = _own_limit(motion.simulation) or math.inf
            motion.advance(1, min(OF_BULK_LIMIT * bulk, OF_OWN_LIMIT * own))
        kinetic = motion.of("kinetic_energy").sum(axis=1)
        case = {"step of the maximum": int(kinetic.argmax()), "step [s]": max(motion.dt)}
        text = (
            f"at {OF_OWN_LIMIT} of the law's own time-step limit the motion grows (energy over the work done)"
        )
        within(kinetic.max() / _work_of_pressing(impact), SHAKEN, text, case)

    ratios: dict[str, Any] = {"stiffer": (1.0, 9.0, 3), "heavier": (1.0, 9.0, 3), "friction": (0.0, 0.5, 2)}
    search_impacts(trial, **ratios, **still, examples=4, most=12)


def _pressed(subject: Subject, impact: Impact) -> Motion:
    """Return the first block pressed onto the second, whose far side is fixed; any step is allowed."""
    gravity = {"vector": (PRESSING * impact.normal).tolist()}
    mapping = impact.mapping(allow_unstable=True, gravity=gravity)
    mapping["bodies"]["second"]["sides"] = [{"side": "right", "fixed": True}]
    return Motion(subject, mapping)


def _own_limit(simulation: Simulation) -> float | None:
    """Return the strategy's own stable time step at this moment [s], with its parts; None without one."""
    contact = simulation.contact
    parts = () if contact is None else tuple(type(part) for part in contact.parts())
    stated = []
    for impl in simulation.registry.implementations["stable_timestep"]:
        if impl.plugin is contact or isinstance(impl.plugin, parts):
            answer: Any = impl.function(*[simulation.state for _ in impl.argnames])
            if answer is not None:
                stated.append(float(answer[0]))
    return min(stated) if stated else None


def _work_of_pressing(impact: Impact) -> float:
    """Return the weight of both blocks times the way by which they are compressed statically [J/m]."""
    weights = [PRESSING * mass for mass in impact.mass]
    first = 0.5 * weights[0] * DEPTH / (MODULUS * WIDTH)
    second = (weights[0] + 0.5 * weights[1]) * DEPTH / (impact.stiffer * MODULUS * WIDTH)
    return weights[0] * (first + second) + weights[1] * second


def shapes(subject: Subject) -> str | None:
    """The law works with every bundled shape function, or refuses it. With each bundled shape function two
    discs are stopped (5 % of their speed may be left), momentum kept to 1e-9.

    Or the law refuses, with a ``SceneError`` that says why, a scene that can be run without contact. Every
    shape function runs with its own default scheme and transfer. Energy is not asked here: linear functions
    make some by themselves when points cross cells. A note names the shape functions that are refused.
    """
    refused: list[str] = []
    names = [name for name, entry in available("shape").items() if distribution_of(entry) == "mpmfw"]
    impact = Impact(form="discs", turn=30.0, slide=0.3, friction=0.3, heavier=2.0)

    def trial(shape: str) -> None:
        try:
            motion = simulate(subject, impact.mapping(), duration=impact.duration, shape=shape)
        except SceneError:
            Simulation(impact.mapping(), contact=NoInteraction(), shape=shape)  # refused without contact too?
            refused.append(shape)
            return
        except (Violation, Inapplicable):
            raise
        except Exception as error:
            text = f"the law does not run with this shape function: {raised(error).message}"
            raise Violation(text) from error
        motion.require_stopped(impact, LEFT)
        total = motion.momentum.sum(axis=1)
        drift = np.abs(total - total[0]).max() / (impact.mass[0] * impact.speed)
        within(drift, DRIFT, "the momentum of both bodies drifts (share of what they bring)")

    try_all({"shape": names}, trial, names={"shape": "shape function"})
    if set(refused) == set(names):
        raise Inapplicable("the law refuses every bundled shape function")
    return f"refuses: {', '.join(refused)}" if refused else None


def three_dimensions(subject: Subject) -> None:
    """In three dimensions too, impulses balance and bodies stop. Two cubes that meet along any axis: impulses
    equal and opposite (1e-12), on one line (1e-3 cells), and they stop.

    With friction along both tangents the motion is the same along each axis, to 1 %.
    """
    if 3 not in subject.make().dimensions:
        raise Inapplicable("the law does not work in three dimensions, and says so")

    def trial(axis: str, speed: float, slide: float, heavier: float, friction: float) -> None:
        normal, tangent = np.eye(3)[AXES[axis]], np.eye(3)[(AXES[axis] + 1) % 3]
        cubes = _cubes(normal, speed * normal + slide * tangent, heavier, friction)
        motion = simulate(subject, cubes, STEPS)
        if not any(nodal.magnitude() for nodal in motion.nodal):
            raise Violation("cubes that meet do not exchange anything")
        require_balance(motion)
        require_one_line(motion)
        text = "cubes that meet are not stopped: share of their speed left"
        within(motion.left() @ normal / speed, LEFT, text)

    names = {
        **NAMES, "axis": "axis along which they meet", "speed": "speed of the first along it [m/s]"
    }  # fmt: skip
    cases = {"slide": ladder(0.3, 0.0, 2), "heavier": ladder(1.0, 4.0, 2), "friction": ladder(0.0, 0.5, 2)}
    draw = hypothesis().strategies
    reference: Motion | None = None
    for axis, k in AXES.items():
        which = {"axis": draw.just(axis), "speed": draw.sampled_from([1.0, -1.0])}
        search({**which, **cases}, trial, examples=2, most=10, names=names)
        normal = np.eye(3)[k]
        velocity = normal + 0.3 * np.roll(normal, 1) + 0.15 * np.roll(normal, 2)
        motion = simulate(subject, _cubes(normal, velocity, 4.0, 0.5), 25)
        reference = reference or motion
        off = reference.difference(motion, functools.partial(np.roll, shift=-k, axis=-1))
        text = "cubes that meet along another axis move in another way"
        within(off, TRIANGLES, text, {"axis along which they meet": axis, "instead of": "x"})


def _cubes(normal: FloatArray, velocity: FloatArray, heavier: float, friction: float) -> dict[str, Any]:
    """Return two cubes a tenth of a cell apart; the first comes with ``velocity`` along ``normal``."""
    apart = 0.5 * (EDGE + 0.1 * CELL) * normal * np.sign(velocity @ normal)
    at = CELL * sum(share * np.roll(np.abs(normal), k) for k, share in enumerate((0.3, 0.2, 0.1)))
    bodies = {}
    for name, sign in (("first", -1.0), ("second", 1.0)):
        middle = at + sign * apart
        corners = {"lower": (middle - 0.5 * EDGE).tolist(), "upper": (middle + 0.5 * EDGE).tolist()}
        bodies[name] = body({"type": "box", **corners}, name, -0.5 * sign * velocity)
    grid = {"cell_size": CELL, "lower": [-HALF] * 3, "upper": [HALF] * 3}
    return scene(bodies, {"first": material(), "second": material(1.0, heavier)}, friction, grid=grid)
