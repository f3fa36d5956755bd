"""Contact makes no momentum: neither linear nor angular."""

from __future__ import annotations

import numpy as np

from mpmfw_testing.check import Picture, within
from mpmfw_testing.contact.drawing import impulses_at
from mpmfw_testing.contact.meeting import CELL, TURNS, UNEQUAL, Meeting
from mpmfw_testing.contact.motion import Motion, meetings

#: Share of the impulses' sum: some hundred roundings of numbers of the same size.
ROUNDING = 1e-12
#: Lever arm of the net moment [cells].
LEVER = 1e-3
#: Steps that exchange less than this share of the largest are not asked: their quotients are roundings.
FAINT = 1e-6


@meetings(
    "discs", turn=TURNS, slide=(0.0, 1.0, 5), friction=(0.0, 1.0, 5), **UNEQUAL, lasting=0.6, partial=True
)
def equal_and_opposite(meeting: Meeting, motion: Motion) -> None:
    """What one body gets the other loses, in every step. In every step |Σ J_i| over all nodes is at most
    1e-12 of the largest Σ |J_i|; so is the points' change of momentum.

    The largest of all steps: J_i is the difference of two nodal momenta, and has their rounding. The second
    is counted in the momentum m v that the bodies bring: the transfer keeps it to rounding, so that whatever
    is missing there was taken by contact in a place that the grid's hooks do not show.
    """
    require_balance(motion)
    total = motion.momentum.sum(axis=1)
    brought = sum(meeting.mass) * (abs(meeting.speed) + abs(meeting.slide))
    change = np.abs(np.diff(total, axis=0, append=total[-1:])).max(axis=1)
    within(
        float(change.max()) / brought,
        ROUNDING,
        "the momentum of all bodies together changes in a step without external force",
        {"step": int(change.argmax()) + 1},
        impulses_at(motion, int(change.argmax())),
    )


def require_balance(motion: Motion, picture: Picture | None = None) -> None:
    """Raise a violation unless the impulses of every step add up to zero."""
    largest = max((nodal.magnitude() for nodal in motion.nodal), default=0.0)
    for step, nodal in enumerate(motion.nodal):
        within(
            float(np.abs(nodal.total()).max()),
            ROUNDING * largest,
            "the impulses on the two bodies do not add up to zero",
            {"step": step + 1, "impulses on the bodies [N s/m]": motion.impulse[step].round(9).tolist()},
            picture or impulses_at(motion, step),
        )


@meetings(
    "discs", slide=(1.0, 0.0, 3), friction=(0.5, 0.0, 3), turn=TURNS, **UNEQUAL, lasting=0.6, partial=True
)
def moment_balance(_meeting: Meeting, motion: Motion) -> None:
    """The impulses on two bodies have one line of action. Over the meeting, Σ |M| / Σ |J| is at most a
    thousandth of a cell, M the net moment of a step's nodal impulses.

    What two bodies do to each other has one line of action. Contact at common nodes keeps that exactly;
    forces of surface points spread by N_i keep it where Σ N_i x_i = x_s, which fails by less than a
    thousandth of a cell in the few steps in which a point touches a node without mass and the map is
    renormalised. A couple left out, such as gap times friction, is ten times the bound. Moments of the lumped
    transfer do not enter: contact alone is measured.
    """
    require_one_line(motion)


def require_one_line(motion: Motion, picture: Picture | None = None) -> None:
    """Raise a violation unless the steps' moments are those of forces on one line of action."""
    magnitudes = np.array([nodal.magnitude() for nodal in motion.nodal])
    acting = np.flatnonzero(magnitudes > FAINT * magnitudes.max(initial=0.0))
    if len(acting) == 0:
        return
    moments = np.zeros(len(magnitudes))
    for step in acting:
        nodal = motion.nodal[step]
        moments[step] = np.abs(nodal.moment(nodal.position.mean(axis=0))).max()
    worst = int(np.argmax(moments))
    within(
        moments.sum() / magnitudes[acting].sum() / CELL,
        LEVER,
        "the impulses on the two bodies leave a moment: its lever arm, in cells, is beyond the bound",
        {"step of the largest moment": worst + 1, "moment in it [N s]": float(moments[worst])},
        picture or impulses_at(motion, worst),
    )
