"""State: runs are independent, and time zero resets the records but not the contact."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.runs.simulation import Simulation
from mpmfw.state.history import NotSaved
from mpmfw_testing.check import Picture, Violation, within
from mpmfw_testing.contact.drawing import histories
from mpmfw_testing.contact.meeting import Meeting, search_meetings
from mpmfw_testing.contact.motion import Motion, note, recorded, simulate
from mpmfw_testing.contact.separation import same_bits
from mpmfw_testing.saving import remember
from mpmfw_testing.subject import Subject

#: Steps before and after the restart.
BEFORE, AFTER = 12, 12
#: Series that count since time zero.
ACCUMULATED = ("frictional_work", "damping_work", "spring_work")


def used_twice(subject: Subject) -> None:
    """A strategy object carries nothing from one run to the next. An object that has served one simulation
    serves the next with the same bits as a fresh one.

    Comparisons and studies hand one configured object to many runs.
    """

    def trial(meeting: Meeting) -> None:
        reference = simulate(subject, meeting.mapping(), BEFORE + AFTER)
        used = subject.make()
        simulate(used, meeting.mapping(), BEFORE)  # ends in the middle of contact
        motion = simulate(used, meeting.mapping(), BEFORE + AFTER)
        same_bits(
            motion, reference, "a strategy object that was used before gives another motion than a fresh one"
        )

    search_meetings(trial, **_SLIDING, examples=3)


def restart(subject: Subject) -> None:
    """restart() forgets work and impulse and keeps the state of contact. ``restart()`` in the middle of
    contact changes no bit of the motion, and sets the recorded work to zero.

    It is called at time zero, after settling: springs stay loaded, work and impulse of the settling are
    forgotten. So the first force reported after it is that of the interval after it.
    """

    def trial(meeting: Meeting) -> None:
        reference = _restarted(subject, meeting, call=False)
        motion = _restarted(subject, meeting, call=True)
        same_bits(motion, reference, "restart() changes the motion: the state of contact is lost")
        for name in ACCUMULATED:
            if name in motion.series:
                left = float(np.abs(motion.series[name][BEFORE + 1]).max())
                picture = _side_by_side(motion, reference, name, "J/m")
                within(left, 0.0, f"restart() does not forget the series {name}", None, picture)
        if "contact_force" in motion.series:
            force, expected = (np.asarray(m.series["contact_force"][BEFORE + 2]) for m in (motion, reference))
            scale = max(float(np.abs(expected).max()), 1e-300)
            within(
                float(np.abs(force - expected).max()) / scale,
                1e-9,
                "the first contact force after restart() is not that of the step (share of it)",
                {"reported [N/m]": force.tolist(), "without restart() [N/m]": expected.tolist()},
                _side_by_side(motion, reference, "contact_force", "N/m"),
            )

    search_meetings(trial, **_SLIDING, examples=3)


def saved(subject: Subject) -> None:
    """A run that is saved in the middle and loaded goes on to the same bits. A run that is saved in the
    middle of contact and loaded into a simulation built anew goes on with the same bits.

    Saved is what the classes of plug-ins name in ``history``, and declared arrays of points, surface nodes,
    bodies and pairs. What is kept elsewhere is lost.
    """

    def trial(meeting: Meeting) -> None:
        remember(meeting.mapping(), BEFORE + AFTER)
        first = Simulation(meeting.mapping(), contact=subject.make())
        with recorded(first) as reference:
            first.advance(BEFORE, lambda frame: note(reference, frame))
            try:
                snapshot = first.snapshot()
            except NotSaved as error:
                raise Violation(str(error)) from error
            first.advance(AFTER, lambda frame: note(reference, frame))
        second = Simulation(meeting.mapping(), contact=subject.make())
        with recorded(second) as motion:
            try:
                second.restore(snapshot)
            except NotSaved as error:
                raise Violation(str(error)) from error
            second.advance(AFTER, lambda frame: note(motion, frame))
        motion.positions[:0] = reference.positions[: BEFORE + 1]
        same_bits(
            motion,
            reference,
            "what was saved and loaded goes on otherwise: history does not name all that is kept",
        )
        for name in motion.series:
            one, other = (np.array(m.series[name][-AFTER - 1 :]) for m in (motion, reference))
            if not np.array_equal(one, other, equal_nan=True):
                raise Violation(
                    f"the series {name} goes on otherwise after loading: history does not name all that is "
                    "kept"
                )

    search_meetings(trial, **_SLIDING, examples=3)


#: Blocks that slide on each other from the first step on.
_SLIDING: dict[str, Any] = {"friction": (0.3, 0.9, 3), "slide": (0.2, 1.0, 3), "heavier": (1.0, 4.0, 2)}


def _side_by_side(motion: Motion, reference: Motion, name: str, unit: str) -> Picture:
    """A series of the first pair with and without the call, over time; of a vector its size."""
    curves = {}
    for label, run in ((f"restart() after step {BEFORE}", motion), ("not called", reference)):
        values = run.of(name)[:, 0]
        dt = np.array([0.0, *run.dt])
        dt[BEFORE + 1] = 0.0  # two outputs at one time: before and after the call
        curves[label] = (np.cumsum(dt), values if values.ndim == 1 else np.linalg.norm(values, axis=1))
    return histories(curves, f"{name} [{unit}]")


def _restarted(subject: Subject, meeting: Meeting, *, call: bool) -> Motion:
    """A run with ``restart()`` called in the middle, or not; an output follows either way."""
    remember(meeting.mapping(), BEFORE + AFTER)
    simulation = Simulation(meeting.mapping(), contact=subject.make())
    with recorded(simulation) as motion:
        simulation.advance(BEFORE, lambda frame: note(motion, frame))
        if call:
            if simulation.contact is None:
                raise Violation("the scene's contact was dropped though there are two bodies")
            simulation.contact.restart()
        simulation.advance(AFTER, lambda frame: note(motion, frame))
    return motion
