"""Contact pushes; it does not pull, and it sleeps while bodies are apart."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.contact.strategy import NoInteraction
from mpmfw_testing.check import Violation, within
from mpmfw_testing.contact.drawing import impulse_history, impulses_at
from mpmfw_testing.contact.meeting import CELL, TURNS, UNEQUAL, WAVE_SPEED, Meeting, search_meetings, slowest
from mpmfw_testing.contact.motion import Motion, meetings, simulate
from mpmfw_testing.searching import try_all
from mpmfw_testing.subject import Subject

#: Pull in a step, as a share of the largest push.
PULL = 0.01
#: Speed of approach that may be left after the meeting, as a share of that before.
LEFT = 0.05
#: Energy that a light body and a heavy one may gain, as a share of that at the start.
GAINED = 0.005
#: Impulse between bodies that part, as a share of their momentum.
NOTHING = 1e-12


@meetings("discs", turn=TURNS, **UNEQUAL, speed=(1.0, 0.5, 3))
def pushes_apart(meeting: Meeting, motion: Motion) -> None:
    """Bodies that meet are pushed apart until they stop, and never pulled. Bodies that meet are stopped (5 %
    of the speed of approach may be left), and no step pulls (1 % of the largest push).

    A step may pull a little where friction at inclined parts of a face has a component along the line between
    the bodies. Speed may be left where a method lets go as soon as the bodies' mean velocities agree.
    """
    push = -motion.impulse[:, 0] @ meeting.normal
    picture = impulses_at(motion) if motion.nodal and push.any() else None
    left = (motion.velocity[-1, 0] - motion.velocity[-1, 1]) @ meeting.normal
    within(
        float(left) / meeting.speed,
        LEFT,
        "bodies that meet are not stopped: a share of the speed of approach is left",
        {"impulse that pushed the first body back [N s/m]": float(push.sum())},
        picture or impulses_at(motion),
    )
    worst = int(push.argmin())
    within(
        float(-push.min() / push.max()),
        PULL,
        "the bodies pull at each other while they meet, by a share of the largest push",
        {"step": worst + 1, "pull [N s/m]": float(-push.min())},
        impulse_history(motion, -meeting.normal, "push on the first"),
    )


def unequal(subject: Subject) -> None:
    """A light body is stopped by a heavy one, and the reverse. Discs one of which has a thousand times the
    other's density and moduli are stopped, and gain at most 0.5 % of energy.

    At most 5 % of the speed of approach is left. What a law takes for no mass, or for a small one, is that of
    a body here.
    """

    def trial(ratio: float) -> None:
        meeting = Meeting(form="discs", heavier=ratio, stiffer=ratio)
        motion = simulate(subject, meeting.mapping(), duration=meeting.duration)
        left = (motion.velocity[-1, 0] - motion.velocity[-1, 1]) @ meeting.normal
        growth = float(motion.energy.max() / motion.energy[0]) - 1.0
        picture = impulses_at(motion)
        text = "a light body and a heavy one are not stopped: a share of the speed of approach is left"
        within(float(left) / meeting.speed, LEFT, text, None, picture)
        within(
            growth,
            GAINED,
            "a light body and a heavy one gain energy (a share of that at the start)",
            None,
            picture,
        )

    try_all({"ratio": (1e3, 1e-3)}, trial, names={"ratio": "density of the second body over the first's"})


@meetings(
    "discs",
    turn=TURNS,
    gap=(0.0, 0.4, 5),
    friction=(0.0, 1.0, 3),
    heavier=(1.0, 9.0, 3),
    speed=(-1.0, -0.25, 4),
    steps=25,
)
def no_adhesion(meeting: Meeting, motion: Motion) -> None:
    """Bodies that touch and part do not feel each other. Bodies that touch, or nearly so, and part exchange
    less than 1e-12 of their momentum in every step.

    They are without stress and part along the line between them, so that there is nothing that a contact
    would have to transmit. Discs that also slide would graze each other for a law that sees them through a
    cell.
    """
    exchanged = np.linalg.norm(motion.impulse[:, 0], axis=1)
    worst = int(exchanged.argmax())
    within(
        float(exchanged.max()) / (meeting.reduced_mass * abs(meeting.speed)),
        NOTHING,
        "bodies that part pull at each other (share of their momentum in a step)",
        {"step": worst + 1, "impulse on the first body [N s/m]": motion.impulse[worst, 0].tolist()},
        impulses_at(motion, worst),
    )


def asleep_apart(subject: Subject) -> None:
    """Bodies that are apart move as if there were no contact, to the bit. Bodies three cells apart or more
    move bit by bit as with contact ``separate``, at the same time step.

    Three cells: farther than two bodies' shape functions reach, and than any search need look.
    """

    def trial(meeting: Meeting) -> None:
        apart = {"time": fixed_step(meeting), "allow_unstable": True}
        mapping = meeting.mapping(**apart)
        for table in mapping["bodies"].values():
            table["rotation"] = "lumped"  # which is what a strategy that adds mass leaves
        motion, reference = (simulate(contact, mapping, 30) for contact in (subject, NoInteraction()))
        same_bits(motion, reference, "bodies that are apart do not move as if there were no contact")

    search_meetings(
        trial,
        "discs",
        turn=TURNS,
        gap=(3.5, 8.5, 6),
        heavier=(1.0, 9.0, 3),
        friction=(0.0, 1.0, 3),
        speed=(0.5, -1.0, 4),
    )


def fixed_step(meeting: Meeting, share: float = 0.3) -> dict[str, Any]:
    """Table ``time`` of a scene with a fixed step of a share of h / c, below every limit."""
    fastest = WAVE_SPEED * max(1.0, (meeting.stiffer / meeting.heavier) ** 0.5)
    return {"end": 1.0, "output_interval": 1.0, "step": share * CELL / max(fastest, slowest(1.0, 1.0))}


def same_bits(motion: Motion, reference: Motion, message: str, body: int | None = None) -> None:
    """Raise a violation unless two runs left the same bits in the points, of one body or of all.

    Raises
    ------
    Violation
        With the largest difference, and the step of the first one.
    """
    own = slice(None) if body is None else motion.simulation.state.bodies[body].particles
    for name, unit in (("position", "m"), ("velocity", "m/s"), ("stress", "Pa")):
        actual, expected = (getattr(m.simulation.state.particles, name)[own] for m in (motion, reference))
        if not np.array_equal(actual, expected):
            pairs = zip(motion.positions, reference.positions, strict=True)
            differs = [not np.array_equal(a[own], b[own]) for a, b in pairs]
            case = {
                "first step that differs": differs.index(True) if True in differs else len(differs),
                f"largest difference of {name} [{unit}]": float(np.abs(actual - expected).max()),
            }
            raise Violation(message, case, impulses_at(motion))
