"""Friction: within Coulomb's cone, on it in slip, no more than sticking needs, and each pair its own."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Inapplicable, within
from mpmfw_testing.contact.impact import (
    CELL,
    QUARTERS,
    WIDTH,
    Impact,
    body,
    material,
    rectangle,
    scene,
    search_impacts,
)
from mpmfw_testing.contact.motion import SAME, STEPS, Motion, impacts, simulate
from mpmfw_testing.subject import Subject

#: Distance from the ends of a common face that is left out [cells]: there the normals of a block's corners
#: tilt.
ENDS = 2.0
#: Tangential impulse beyond the cone, or without friction, as a share of the largest normal impulse.
BEYOND = 0.01
#: Share of μ times the normal impulse that slipping bodies feel at least.
SLIPPING = 0.9
#: Tangential impulse that bodies at slow slip exchange at most, over that which makes their velocities equal.
NEEDED = 3.0
#: Share of an impact of blocks that counts: until the first waves from the far ends are back, and the faces
#: part.
LASTING = 0.5
#: Ladders of a second body that is heavier and stiffer.
_UNEQUAL: dict[str, Any] = {"heavier": (1.0, 9.0, 3), "stiffer": (1.0, 9.0, 3)}


def face_impulse(impact: Impact, motion: Motion) -> FloatArray:
    """Return the impulse on the first block through the middle of the face, (steps, 2) [N s/m].

    The normal push comes first, then the tangential impulse. The nodes within two cells of the ends are left
    out. Where bodies share one velocity field, it is the impulse on the whole body.
    """
    n, t = impact.normal, impact.tangent
    state = motion.simulation.state
    if state.grid.n_fields < 2:
        total = motion.impulse[:, 0]
    else:
        own = [nodal.of(state.bodies[0].field) for nodal in motion.nodal]
        inner = [np.abs((each.position - impact.origin) @ t) < 0.5 * WIDTH - ENDS * CELL for each in own]
        total = np.array([each.impulse[at].sum(axis=0) for each, at in zip(own, inner, strict=True)])
    return np.column_stack([-total @ n, total @ t])


@impacts(
    friction=(0.1, 0.9, 5), slide=(1.0, 0.2, 5), turn=QUARTERS, **_UNEQUAL, lasting=LASTING, partial=True
)
def coulomb_cone(impact: Impact, motion: Motion) -> None:
    """Friction is at most the friction coefficient times the normal impulse. Through the middle of two
    blocks' face, |J_t| − μ J_n is at most 1 % of the largest J_n, in every step.

    The face bends a little, so that a true normal has a tangential part; a law without a cone exceeds the
    bound by the friction coefficient's order.
    """
    _require_cone(impact, motion, "the tangential impulse is beyond Coulomb's cone")


@impacts(slide=(1.0, 0.0, 5), turn=QUARTERS, **_UNEQUAL, lasting=LASTING, partial=True, friction=0.0)
def frictionless(impact: Impact, motion: Motion) -> None:
    """Without friction, contact leaves the tangential velocity alone. With μ = 0 the tangential impulse
    through the middle of a face is at most 1 % of the largest normal one, in every step.

    The face bends a little, so that a true normal has a tangential part.
    """
    _require_cone(impact, motion, "contact without friction changes the tangential velocity")


def _require_cone(impact: Impact, motion: Motion, message: str) -> None:
    """Hold the tangential impulse of every step against μ times the normal one."""
    push, drag = face_impulse(impact, motion).T
    excess = np.abs(drag) - impact.friction * np.maximum(push, 0.0)
    step = int(excess.argmax())
    case = {
        "step": step + 1, "tangential [N s/m]": float(drag[step]), "normal [N s/m]": float(push[step])
    }  # fmt: skip
    largest = max(push.max(), 1e-3 * impact.reduced_mass * abs(impact.speed))  # of bodies that do not push
    within(excess.max() / largest, BEYOND, f"{message} (by a share of the largest normal impulse)", case)


def slip_on_the_cone(subject: Subject) -> None:
    """Bodies that slip feel the full friction, against their slip. Blocks that slip fast feel at least 90 %
    of μ times the normal impulse, against their slip.

    Over the impact, at a sliding speed that friction cannot stop; springs must be stretched before.
    """
    if not getattr(subject.make(), "uses_friction", False):
        raise Inapplicable("the law says that it does not use friction (uses_friction is false)")

    def trial(impact: Impact) -> None:
        motion = simulate(subject, impact.mapping(), duration=LASTING * impact.duration)
        push, drag = face_impulse(impact, motion).T
        expected = impact.friction * float(push.sum())
        against = -float(np.sign(impact.slide) * drag.sum())
        case = {
            "friction impulse against the slip [N s/m]": against,
            "mu times normal impulse [N s/m]": expected,
        }
        text = "bodies that slip lack friction (share of mu times the normal impulse that is missing)"
        within(1.0 - against / expected if expected > 0.0 else 1.0, 1.0 - SLIPPING, text, case)

    slides = [2.0, -2.0, 1.5, -1.5]
    search_impacts(
        trial, friction=(0.1, 0.3, 3), slide=slides, turn=QUARTERS, heavier=(1.0, 9.0, 3), examples=5
    )


@impacts(
    friction=(0.5, 1.0, 3), slide=(0.02, 0.06, 3), turn=QUARTERS, heavier=(1.0, 4.0, 3), lasting=LASTING,
    partial=True, examples=5,
)  # fmt: skip
def sticking(impact: Impact, motion: Motion) -> None:
    """Where less friction is enough to stick, no more acts. Where little friction makes bodies stick, Σ |J_t|
    over the impact is at most 3 times the impulse that equalises their speeds.

    That is the reduced mass times the sliding speed; twice it if friction is stored and given back in full,
    and half as much again for the faces' own oscillation to and fro. A law that applies μ J_n whatever
    sticking needs exceeds it by μ times the speed of approach over the sliding speed, 10 to 50 here.
    """
    given = float(np.abs(motion.impulse[:, 0] @ impact.tangent).sum())
    needed = impact.reduced_mass * abs(impact.slide)
    text = "bodies that would stick with little friction are given more (over what equalises their speeds)"
    case = {"sum of |tangential impulse| [N s/m]": given, "needed [N s/m]": needed}
    within(given / needed, NEEDED, text, case)


def friction_of_pairs(subject: Subject) -> None:
    """Each pair has its own friction. Two blocks beside a third that is far away, listed before or after them
    and rough against both, move as without it, to 1e-9."""
    alone = Impact(gap=0.05, friction=0.1, slide=0.5).mapping()
    far = {"far": body(rectangle(np.array([-1.33, -1.28]), np.array([-1.13, -1.08])), "far", [0.0, 0.0])}
    pairs = [{"bodies": ["far", name], "friction": 0.9} for name in alone["bodies"]]
    materials = {"far": material(), **alone["materials"]}
    time = {**alone["time"], "step": 0.5 * simulate(subject, alone, 1).dt[0]}
    without = simulate(subject, {**alone, "time": time}, STEPS)
    for order, bodies in (("first", {**far, **alone["bodies"]}), ("last", {**alone["bodies"], **far})):
        contact = {**alone["contact"], "pairs": pairs}
        beside = scene(bodies, materials, 0.1, contact=contact, time=time)
        off = without.difference(simulate(subject, beside, STEPS))
        case = {
            "friction of the two": 0.1, "friction of the far pairs": 0.9, "the far body is listed": order
        }  # fmt: skip
        within(off, SAME, "two bodies feel the friction of a pair that is far away", case)
