"""No option without effect."""

from __future__ import annotations

import functools
import hashlib
from typing import Any

from mpmfw_testing.contact.meeting import Meeting
from mpmfw_testing.contact.motion import simulate
from mpmfw_testing.options import every_option_acts
from mpmfw_testing.subject import Subject

#: Scenes in which an option may act: with slip and stick, unequal bodies, at an angle.
SCENES = (
    Meeting(form="blocks", slide=0.5, friction=0.3, heavier=2.0, stiffer=4.0),
    Meeting(form="discs", slide=0.3, friction=0.9, turn=30.0),
    Meeting(form="blocks", speed=2.0, slide=1.0, friction=0.3, turn=90.0, shift=0.4, rise=0.3),
)
STEPS = 30


def options(subject: Subject) -> None:
    """Every option changes something or is refused. Every option changes the motion of one of three scenes by
    a bit at least, for one of its values.

    Values are tried alone, and together with each choice of the other options, since an option may need
    another one. Values may be refused, by the model or as a ``SceneError``, but not all that are tried.
    """
    every_option_acts(subject, [functools.partial(_digest, subject, meeting) for meeting in SCENES])


def _digest(subject: Subject, meeting: Meeting, options: dict[str, Any]) -> str:
    """Digest of the motion's last bits; a run that fails has the error's words."""
    motion = simulate(subject.make(**options), meeting.mapping(), STEPS, partial=True)
    if motion.failure is not None:
        return f"failed: {motion.failure}"
    particles = motion.simulation.state.particles
    return hashlib.sha256(particles.position.tobytes() + particles.velocity.tobytes()).hexdigest()
