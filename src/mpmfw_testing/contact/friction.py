"""Friction: within Coulomb's cone, on it in slip, no more than sticking needs."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Inapplicable, within
from mpmfw_testing.contact.drawing import impulse_history, impulses_at
from mpmfw_testing.contact.meeting import CELL, QUARTERS, WIDTH, Meeting, search_meetings
from mpmfw_testing.contact.motion import Motion, meetings, simulate
from mpmfw_testing.subject import Subject

#: Distance from the ends of a common face that is left out [cells]: there the normals of a block's corners
#: tilt.
ENDS = 2.0
#: Tangential impulse beyond the cone, or without friction, as a share of the largest normal impulse.
BEYOND = 0.01
#: Share of μ times the normal impulse that slipping bodies feel at least.
SLIPPING = 0.9
#: Tangential impulse that bodies at slow slip exchange at most, over what makes their velocities equal.
NEEDED = 3.0
#: Steps of a meeting of blocks that count: until the first waves from the far ends are back, and the faces
#: part.
LASTING = 0.5
#: Ladders of a second body that is heavier and stiffer.
_UNEQUAL: dict[str, Any] = {"heavier": (1.0, 9.0, 3), "stiffer": (1.0, 9.0, 3)}


def face_impulse(meeting: Meeting, motion: Motion) -> FloatArray:
    """Impulse on the first block through the middle of the face, (steps, 2) [N s/m]: normal push, tangential.

    The nodes within two cells of the ends are left out. Where bodies share one velocity field, it is the
    impulse on the whole body.
    """
    n, t = meeting.normal, meeting.tangent
    first = motion.simulation.state.bodies[0].field
    if motion.simulation.state.grid.n_fields < 2:
        whole = motion.impulse[:, 0]
        return np.column_stack([-whole @ n, whole @ t])
    rows = []
    for nodal in motion.nodal:
        own = nodal.of(first)
        along = np.abs((own.position - meeting.origin) @ t)
        total = own.impulse[along < 0.5 * WIDTH - ENDS * CELL].sum(axis=0)
        rows.append((-total @ n, total @ t))
    return np.array(rows)


@meetings(
    friction=(0.1, 0.9, 5), slide=(1.0, 0.2, 5), turn=QUARTERS, **_UNEQUAL, lasting=LASTING, partial=True
)
def coulomb_cone(meeting: Meeting, motion: Motion) -> None:
    """Friction is at most the friction coefficient times the normal impulse. Through the middle of two
    blocks' face, |J_t| − μ J_n is at most 1 % of the largest J_n, in every step.

    The face bends a little, so that a true normal has a tangential part; a law without a cone exceeds the
    bound by the friction coefficient's order.
    """
    push, drag = face_impulse(meeting, motion).T
    excess = np.abs(drag) - meeting.friction * np.maximum(push, 0.0)
    step = int(excess.argmax())
    within(
        float(excess.max()) / _largest(push, meeting),
        BEYOND,
        "the tangential impulse is beyond Coulomb's cone (by a share of the largest normal impulse)",
        {"step": step + 1, "tangential [N s/m]": float(drag[step]), "normal [N s/m]": float(push[step])},
        impulses_at(motion, step),
    )


def slip_on_the_cone(subject: Subject) -> None:
    """Bodies that slip feel the full friction, against their slip. Blocks that slip fast feel at least 90 %
    of μ times the normal impulse, against their slip.

    Over the meeting, through the middle of the face, at a sliding speed that friction cannot stop. The rest
    is left for springs that must be stretched before they carry.
    """
    if not getattr(subject.make(), "uses_friction", False):
        raise Inapplicable("the law says that it does not use friction (uses_friction is false)")

    def trial(meeting: Meeting) -> None:
        motion = simulate(subject, meeting.mapping(), duration=LASTING * meeting.duration)
        push, drag = face_impulse(meeting, motion).T
        expected = meeting.friction * float(push.sum())
        against = -float(np.sign(meeting.slide) * drag.sum())
        within(
            1.0 - against / expected if expected > 0.0 else 1.0,
            1.0 - SLIPPING,
            "bodies that slip lack friction (share of mu times the normal impulse that is missing)",
            {
                "friction impulse against the slip [N s/m]": against,
                "mu times normal impulse [N s/m]": expected,
            },
            impulse_history(motion, meeting.tangent, "tangential impulse"),
        )

    search_meetings(
        trial,
        friction=(0.1, 0.3, 3),
        slide=[2.0, -2.0, 1.5, -1.5],
        turn=QUARTERS,
        heavier=(1.0, 9.0, 3),
        examples=5,
    )


@meetings(
    friction=(0.5, 1.0, 3),
    slide=(0.02, 0.06, 3),
    turn=QUARTERS,
    heavier=(1.0, 4.0, 3),
    lasting=LASTING,
    partial=True,
    examples=5,
)
def sticking(meeting: Meeting, motion: Motion) -> None:
    """Where less friction is enough to stick, no more acts. Where little friction makes bodies stick, Σ |J_t|
    over the meeting is at most 3 times what equalises their speeds.

    That is the reduced mass times the sliding speed; twice it if friction is stored and given back in full,
    and half as much again for what the faces' own oscillation moves to and fro. A law that applies μ J_n
    whatever sticking needs exceeds it by μ times the speed of approach over the sliding speed, 10 to 50 here.
    """
    drag = motion.impulse[:, 0] @ meeting.tangent
    needed = meeting.reduced_mass * abs(meeting.slide)
    within(
        float(np.abs(drag).sum()) / needed,
        NEEDED,
        "bodies that would stick with little friction are given more (over what equalises their speeds)",
        {"sum of |tangential impulse| [N s/m]": float(np.abs(drag).sum()), "needed [N s/m]": needed},
        impulse_history(motion, meeting.tangent, "tangential impulse"),
    )


@meetings(slide=(1.0, 0.0, 5), turn=QUARTERS, **_UNEQUAL, lasting=LASTING, partial=True, friction=0.0)
def frictionless(meeting: Meeting, motion: Motion) -> None:
    """Without friction, contact leaves the tangential velocity alone. With μ = 0 the tangential impulse
    through the middle of a face is at most 1 % of the largest normal one.

    In every step, at any sliding speed; the face bends a little, so that a true normal has a tangential part.
    """
    push, drag = face_impulse(meeting, motion).T
    step = int(np.abs(drag).argmax())
    within(
        float(np.abs(drag).max()) / _largest(push, meeting),
        BEYOND,
        "contact without friction changes the tangential velocity (impulse over the largest normal one)",
        {"step": step + 1, "tangential [N s/m]": float(drag[step]), "normal [N s/m]": float(push[step])},
        impulses_at(motion, step),
    )


def _largest(push: FloatArray, meeting: Meeting) -> float:
    """Largest normal impulse of a step; of bodies that do not push, a thousandth of their momentum."""
    return max(float(push.max()), 1e-3 * meeting.reduced_mass * abs(meeting.speed))
