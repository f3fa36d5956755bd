"""Whom contact must not touch: a body alone, and one that is far from those that meet."""

from __future__ import annotations

from mpmfw.contact.strategy import NoInteraction
from mpmfw.runs.simulation import Simulation
from mpmfw_testing.check import Violation
from mpmfw_testing.contact.meeting import CELL, EXTENT, TURNS, Meeting, body, rectangle, search_meetings
from mpmfw_testing.contact.motion import simulate
from mpmfw_testing.contact.separation import fixed_step, same_bits
from mpmfw_testing.subject import Subject


def one_body(subject: Subject) -> None:
    """A body alone moves as if no contact were named, to the bit. The law is not called."""

    def trial(meeting: Meeting) -> None:
        mapping = meeting.mapping(gravity={"vector": [0.0, -5.0]})
        mapping["bodies"] = {"first": mapping["bodies"]["first"]}
        mapping["materials"] = {"first": mapping["materials"]["first"]}
        motion, reference = (simulate(contact, mapping, 20) for contact in (subject, NoInteraction()))
        simulation: Simulation = motion.simulation
        if simulation.contact is not None:
            raise Violation("the law is called though there is nothing to touch")
        same_bits(motion, reference, "one body does not move as if there were no contact")

    search_meetings(trial, "discs", turn=TURNS, examples=2)


def bystander(subject: Subject) -> None:
    """A body far from those that meet is left alone, to the bit. A body three cells or more from two that
    meet moves bit by bit as it would if they did not.

    All three run at the same fixed step.
    """

    def trial(meeting: Meeting) -> None:
        mapping = meeting.mapping(time=fixed_step(meeting), allow_unstable=True)
        low = EXTENT - 5.3 * CELL
        far = rectangle(meeting.origin * 0.0 + low, meeting.origin * 0.0 + low + 3.0 * CELL)
        mapping["bodies"]["bystander"] = body(far, "first", [-0.2, 0.1])
        for table in mapping["bodies"].values():
            table["rotation"] = "lumped"
        motion, reference = (simulate(contact, mapping, 40) for contact in (subject, NoInteraction()))
        same_bits(motion, reference, "a body far from those that meet is disturbed by their contact", body=2)

    search_meetings(
        trial, "discs", turn=(0.0, 180.0, 13), slide=(0.0, 1.0, 3), friction=(0.0, 0.5, 3), examples=4
    )
