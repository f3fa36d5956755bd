"""What the law reports is what it does."""

from __future__ import annotations

import numpy as np

from mpmfw_testing.check import Inapplicable, within
from mpmfw_testing.contact.drawing import histories
from mpmfw_testing.contact.meeting import TURNS, Meeting
from mpmfw_testing.contact.motion import Motion, meetings

#: Difference of reported and measured impulse, as a share of what was exchanged.
REPORTED = 1e-9
#: Fall of an accumulated work, as a share of the largest value or of the energy that the bodies bring.
FALLEN = 1e-12


@meetings(
    "discs",
    friction=(0.3, 0.9, 3),
    slide=(0.5, 0.0, 3),
    heavier=(1.0, 9.0, 3),
    turn=TURNS,
    steps=40,
    examples=4,
)
def reports(meeting: Meeting, motion: Motion) -> None:
    """The reported contact force is the momentum exchanged. The series ``contact_force`` times the interval
    is the impulse on the pair's first body, to 1e-9 of all exchanged.

    And ``frictional_work`` never falls: from one output to the next by at most 1e-12 of its largest value or
    of the energy that the bodies bring, whichever is more. That is rounding: where bodies stick the slip that
    is left, times the impulse, is the difference of two equal numbers. Laws that declare neither series are
    not asked.
    """
    if not {"contact_force", "frictional_work"} & set(motion.series):
        raise Inapplicable("the law declares neither of the series contact_force and frictional_work")
    if "contact_force" in motion.series:
        _is_the_impulse(motion, meeting)
    if "frictional_work" in motion.series:
        _never_falls(motion)


def _never_falls(motion: Motion) -> None:
    """Hold the work of friction at every step against that at the one before; it begins with nothing."""
    work = motion.of("frictional_work")[:, 0]
    change = np.diff(work, prepend=0.0)
    time = np.concatenate([[0.0], np.cumsum(motion.dt)])
    within(
        float(-change.min()),
        FALLEN * max(float(np.abs(work).max()), float(motion.energy[0])),
        "frictional_work falls: friction gives energy [J/m]",
        {"step": int(change.argmin()), "largest work [J/m]": float(work.max())},
        histories({"frictional_work": (time, work)}, "frictional_work [J/m]"),
    )


def _is_the_impulse(motion: Motion, meeting: Meeting) -> None:
    """Hold the reported force of every step against the momentum that the first body gets."""
    dt = np.array(motion.dt)[:, np.newaxis]
    text, did = motion.of("contact_force")[1:, 0] * dt, motion.impulse[:, 0]
    time, n = np.cumsum(motion.dt), meeting.normal
    step = int(np.abs(text - did).max(axis=1).argmax())
    within(
        float(np.abs(text - did).max()) / max(float(np.abs(did).sum()), 1e-300),
        REPORTED,
        "the reported contact_force is not the momentum that the first body gets",
        {
            "step": step + 1,
            "reported [N s/m]": text[step].tolist(),
            "measured [N s/m]": did[step].tolist(),
        },
        histories(
            {"measured": (time, did @ n), "reported": (time, text @ n)},
            "normal impulse, each step [N s/m]",
        ),
    )
