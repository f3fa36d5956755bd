"""Contact pushes; it does not pull, and it leaves bodies alone that are apart."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw_testing.check import within
from mpmfw_testing.contact.impact import (
    CELL,
    EXTENT,
    TURNS,
    UNEQUAL,
    WAVE_SPEED,
    Impact,
    NoInteraction,
    body,
    rectangle,
    search_impacts,
)
from mpmfw_testing.contact.motion import Motion, impacts, simulate
from mpmfw_testing.generic import require_same
from mpmfw_testing.searching import try_all
from mpmfw_testing.subject import Subject

#: Pull in a step, as a share of the largest push.
PULL = 0.01
#: Speed of approach that may be left after the impact, as a share of that before.
LEFT = 0.05
#: Impulse between bodies that part, as a share of their momentum.
NOTHING = 1e-12


@impacts("discs", turn=TURNS, **UNEQUAL, speed=(1.0, 0.5, 3))
def pushes_apart(impact: Impact, motion: Motion) -> None:
    """Bodies that meet are pushed apart until they stop, and never pulled. At most 5 % of the speed of
    approach is left, and no step pulls by more than 1 % of the largest push.

    A step may pull a little where friction at inclined parts of a face has a component along the line between
    the bodies. Speed may be left where a method lets go as soon as the bodies' mean velocities agree.
    """
    motion.require_stopped(impact, LEFT)
    push = -motion.impulse[:, 0] @ impact.normal
    case = {"step": int(push.argmin()) + 1, "pull [N s/m]": float(-push.min())}
    text = "the bodies pull at each other while they meet, by a share of the largest push"
    within(-push.min() / push.max(), PULL, text, case)


def unequal(subject: Subject) -> None:
    """A light body is stopped by a heavy one, and the reverse. Discs one of which has a thousand times the
    other's density and moduli are stopped, to 5 % of their speed, and gain at most 0.5 % of energy.

    A tolerance for small masses is larger than a body here.
    """

    def trial(ratio: float) -> None:
        impact = Impact(form="discs", heavier=ratio, stiffer=ratio)
        motion = simulate(subject, impact.mapping(), duration=impact.duration)
        motion.require_stopped(impact, LEFT, "a light body and a heavy one")
        motion.require_no_gain("a light body and a heavy one")

    try_all({"ratio": (1e3, 1e-3)}, trial, names={"ratio": "density of the second body over the first's"})


@impacts(
    "discs", turn=(45.0, 390.0, 24), gap=(0.0, 0.4, 5), friction=(0.0, 1.0, 3), heavier=(1.0, 9.0, 3),
    speed=(-1.0, -0.25, 4), steps=25,
)  # fmt: skip
def no_adhesion(impact: Impact, motion: Motion) -> None:
    """Bodies that touch and part do not feel each other. Bodies that touch, or nearly so, and part exchange
    less than 1e-12 of their momentum in every step.

    They are without stress and part along the line between them, so that contact has nothing to transmit.
    The first two touch along a diagonal of the grid, where their points are nearest to each other.
    """
    exchanged = np.linalg.norm(motion.impulse[:, 0], axis=1)
    step = int(exchanged.argmax())
    case = {"step": step + 1, "impulse on the first body [N s/m]": motion.impulse[step, 0].tolist()}
    text = "bodies that part pull at each other (share of their momentum in a step)"
    within(exchanged.max() / (impact.reduced_mass * abs(impact.speed)), NOTHING, text, case)


def isolation(subject: Subject) -> None:
    """A body that touches no other moves as if there were no contact, to the bit. Two bodies three cells
    apart or more, and a third three cells from two that meet, move bit by bit as without contact.

    All run at the same fixed step. Three cells are more than two bodies' shape functions reach.
    """

    def apart(impact: Impact) -> None:
        _require_undisturbed(subject, impact, impact.mapping(), None)

    def beside(impact: Impact) -> None:
        mapping, low = impact.mapping(), np.full(2, EXTENT - 5.3 * CELL)
        mapping["bodies"]["bystander"] = body(rectangle(low, low + 3.0 * CELL), "first", [-0.2, 0.1])
        _require_undisturbed(subject, impact, mapping, 2)

    search_impacts(
        apart, "discs", turn=TURNS, gap=(3.5, 8.5, 6), heavier=(1.0, 9.0, 3), friction=(0.0, 1.0, 3),
        speed=(0.5, -1.0, 4),
    )  # fmt: skip
    turns: dict[str, Any] = {"turn": (0.0, 180.0, 13), "slide": (0.0, 1.0, 3), "friction": (0.0, 0.5, 3)}
    search_impacts(beside, "discs", **turns, examples=4)


def _require_undisturbed(subject: Subject, impact: Impact, mapping: dict[str, Any], body: int | None) -> None:
    """Require the points of one body, or of all, to have the same bits as without contact."""
    fastest = WAVE_SPEED * max(1.0, (impact.stiffer / impact.heavier) ** 0.5)
    time = {"end": 1.0, "output_interval": 1.0, "step": 0.3 * CELL / fastest}  # below every limit
    for table in mapping["bodies"].values():
        table["rotation"] = "lumped"  # a strategy that adds mass leaves no other choice
    mapping = {**mapping, "time": time, "allow_unstable": True}
    found = []
    for contact in (NoInteraction(), subject):
        simulation = simulate(contact, mapping, 40).simulation
        own = slice(None) if body is None else simulation.state.bodies[body].particles
        names = ("position", "velocity", "stress")
        found.append({name: getattr(simulation.state.particles, name)[own] for name in names})
    which = "bodies that are apart do" if body is None else "a body far from those that meet does"
    require_same(found[0], found[1], f"{which} not move as if there were no contact")
