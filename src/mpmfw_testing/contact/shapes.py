"""The law with every bundled shape function."""

from __future__ import annotations

import numpy as np

from mpmfw.contact.strategy import NoInteraction
from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available, distribution_of
from mpmfw.runs.simulation import Simulation
from mpmfw_testing.check import Inapplicable, Violation, within
from mpmfw_testing.contact.drawing import impulses_at
from mpmfw_testing.contact.meeting import Meeting
from mpmfw_testing.contact.motion import simulate
from mpmfw_testing.contact.separation import LEFT
from mpmfw_testing.searching import raised, try_all
from mpmfw_testing.subject import Subject

#: Drift of all bodies' momentum over the momentum that they bring.
DRIFT = 1e-9


def bundled_shapes() -> list[str]:
    """Names of the shape functions that mpmfw brings along."""
    return [name for name, entry in available("shape").items() if distribution_of(entry) == "mpmfw"]


def shapes(subject: Subject) -> str | None:
    """The law works with every bundled shape function, or refuses it. With each bundled shape function two
    discs are stopped (5 % of their speed may be left), momentum kept to 1e-9.

    Or the law refuses, with a ``SceneError`` that says why, a scene that can be run without contact. Every
    shape function runs with its own default scheme and transfer. Energy is not asked here: linear functions
    make some by themselves when points cross cells.

    Returns
    -------
    Which shape functions the law refuses; None if it works with all of them.
    """
    refused: list[str] = []

    def trial(shape: str) -> None:
        if not _works_with(subject, shape):
            refused.append(shape)

    shapes = bundled_shapes()
    try_all({"shape": shapes}, trial, names={"shape": "shape function"})
    if set(refused) == set(shapes):
        raise Inapplicable("the law refuses every bundled shape function")
    return f"refuses: {', '.join(refused)}" if refused else None


def _works_with(subject: Subject, shape: str) -> bool:
    """Whether the law accepts the shape function; a violation if it does and does not work with it."""
    meeting = Meeting(form="discs", turn=30.0, slide=0.3, friction=0.3, heavier=2.0)
    try:
        motion = simulate(subject, meeting.mapping(), duration=meeting.duration, shape=shape)
    except SceneError:
        Simulation(
            meeting.mapping(), contact=NoInteraction(), shape=shape
        )  # what this refuses, no law can run
        return False
    except (Violation, Inapplicable):
        raise
    except Exception as error:
        start = simulate(NoInteraction(), meeting.mapping(), 1, shape=shape)
        raise Violation(
            f"the law does not run with this shape function: {raised(error).message}", {}, impulses_at(start)
        ) from error
    left = (motion.velocity[-1, 0] - motion.velocity[-1, 1]) @ meeting.normal / meeting.speed
    picture = impulses_at(motion)
    within(
        float(left), LEFT, "bodies that meet are not stopped: a share of their speed is left", None, picture
    )
    total = motion.momentum.sum(axis=1)
    brought = meeting.mass[0] * meeting.speed
    drift = float(np.abs(total - total[0]).max()) / brought
    within(drift, DRIFT, "the momentum of both bodies drifts (share of what they bring)", None, picture)
    return True


def runs(subject: Subject) -> None:
    """A scene of two bodies that meet runs to its end. A hundred steps of two discs that meet, slide and have
    friction come to their end.

    It is the plainest thing that a law does: what breaks it breaks most other checks as well.
    """
    meeting = Meeting(form="discs", turn=30.0, slide=0.3, friction=0.3)
    simulate(subject, meeting.mapping(), 100)
