"""What must not matter: the order of the bodies, where the scene lies, which way it is turned."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import within
from mpmfw_testing.contact.drawing import places
from mpmfw_testing.contact.meeting import CELL, NAMES, Meeting, body, material, rectangle, scene
from mpmfw_testing.contact.motion import Motion, simulate
from mpmfw_testing.searching import try_all
from mpmfw_testing.subject import Subject

#: Difference of two motions that should be the same, as a share of a cell and of the largest momentum.
SAME = 1e-9
#: Share of the exchanged impulse by which the grid may be felt.
GRID = 0.15
STEPS = 45


def relabelling(subject: Subject) -> None:
    """The order in which the scene names the bodies does not matter. The order of the bodies in the scene
    changes positions and momenta by at most 1e-9 cells and of the largest momentum.

    Two blocks, or three that meet at one spot, in every order; equal ones and unequal ones. The bound leaves
    room for sums that run in another order, whose roundings grow over the steps.
    """

    def trial(bodies: int, **numbers: Any) -> None:
        mapping = (
            three_blocks(numbers) if bodies == 3 else Meeting(gap=0.05, friction=0.3, **numbers).mapping()
        )
        names = list(mapping["bodies"])
        reference = simulate(subject, mapping, STEPS)
        for order in list(itertools.permutations(names))[1:]:
            changed = {**mapping, "bodies": {name: mapping["bodies"][name] for name in order}}
            motion = simulate(subject, changed, STEPS)
            within(
                difference(reference, motion),
                SAME,
                "the motion depends on the order in which the scene names the bodies",
                {"order": ", ".join(order), "instead of": ", ".join(names)},
                places(reference, motion),
            )

    cases = {"bodies": (2, 3), "slide": (0.5, 0.0), "heavier": (1.0, 4.0), "stiffer": (1.0, 4.0)}
    try_all(cases, trial, names={**NAMES, "bodies": "number of bodies"})


def shift(subject: Subject) -> None:
    """Where the scene lies on the grid does not matter. A shift by whole cells changes the motion by at most
    1e-9; by part of a cell, the exchanged impulse by 15 %.

    The grid may be seen by a method, but what two bodies exchange in a meeting without friction is set by
    their masses and speed. 15 % covers contact that begins up to a cell early and a bounce that depends on
    it.
    """

    def back(meeting: Meeting, x: FloatArray) -> FloatArray:
        return x - CELL * np.array([meeting.shift, meeting.rise])

    def whole(meeting: Meeting) -> bool:
        return meeting.shift.is_integer() and meeting.rise.is_integer()

    text = "the motion depends on where the scene lies: a shift by whole cells changes it"
    cases = {"shift": (0.0, 1.0, 0.5), "rise": (0.0, -5.0, -0.5)}
    _placed_elsewhere(subject, cases, back, whole, text)


def rotation(subject: Subject) -> None:
    """Which way the scene is turned does not matter. A quarter turn of the scene changes the motion by at
    most 1e-9; another turn, the exchanged impulse by 15 %.

    As for a shift; the impulse's direction counts as well, so that a normal which prefers the grid's axes is
    seen.
    """

    def back(meeting: Meeting, x: FloatArray) -> FloatArray:
        return np.asarray(x @ np.column_stack([meeting.normal, meeting.tangent]))

    def quarter(meeting: Meeting) -> bool:
        return meeting.turn % 90.0 == 0.0

    text = "a quarter turn of the scene does not turn the motion"
    turns = (90.0, 180.0, 270.0, 15.0, 45.0, 75.0, 120.0, 210.0, 330.0)
    _placed_elsewhere(subject, {"turn": turns}, back, quarter, text)


def _placed_elsewhere(
    subject: Subject,
    cases: Mapping[str, Sequence[float]],
    back: Callable[[Meeting, FloatArray], FloatArray],
    exactly: Callable[[Meeting], bool],
    said: str,
) -> None:
    """Compare meetings of discs elsewhere with the one at home, or its bits if ``exactly``."""
    home = Meeting(form="discs")
    reference = simulate(subject, home.mapping(), duration=home.duration)

    def trial(**numbers: float) -> None:
        meeting = Meeting(form="discs", **numbers)
        motion = simulate(subject, meeting.mapping(), duration=home.duration)
        put_back = functools.partial(back, meeting)
        picture = places(reference, motion, put_back)
        if exactly(meeting):
            within(difference(reference, motion, put_back), SAME, said, None, picture)
        _same_exchange(reference, motion, home, meeting, picture)

    try_all(cases, trial, names=NAMES)


def _same_exchange(reference: Motion, motion: Motion, home: Meeting, meeting: Meeting, picture: Any) -> None:
    """Hold the impulse on the first body over the meeting, in its own directions, against the reference's."""
    expected, found = (
        m.impulse[:, 0].sum(axis=0) @ np.column_stack([at.normal, at.tangent])
        for m, at in ((reference, home), (motion, meeting))
    )
    scale = max(float(np.linalg.norm(expected)), 1e-6 * home.reduced_mass * home.speed)
    within(
        float(np.linalg.norm(found - expected)) / scale,
        GRID,
        "the impulse that the bodies exchange depends on how they lie on the grid",
        {
            "impulse, normal and tangential [N s/m]": found.round(3).tolist(),
            "unchanged scene [N s/m]": expected.round(3).tolist(),
        },
        picture,
    )


def difference(reference: Motion, motion: Motion, back: Any = np.asarray) -> float:
    """Largest difference of centres [cells] and relative momenta; ``back`` undoes a placement."""
    names = [b.name for b in reference.simulation.state.bodies]
    others = [b.name for b in motion.simulation.state.bodies]
    order = [others.index(name) for name in names]
    turn = back(np.zeros((1, reference.centre.shape[-1])))
    apart = np.abs(reference.centre - back(motion.centre[:, order])).max() / CELL
    pushed = np.abs(reference.momentum - (back(motion.momentum[:, order]) - turn)).max()
    return float(max(apart, pushed / np.abs(reference.momentum).max()))


def three_blocks(numbers: dict[str, Any]) -> dict[str, Any]:
    """Three blocks that meet at one spot; the second and the third by the ratios of the case."""
    slide = numbers["slide"]
    first = rectangle(*_corners(-0.41, -0.4, -0.01, 0.0))
    second = rectangle(*_corners(0.0, -0.4, 0.4, 0.0))
    third = rectangle(*_corners(-0.2, 0.01, 0.2, 0.41))
    bodies = {
        "first": body(first, "first", [0.8, slide]),
        "second": body(second, "second", [-0.5, 0.0]),
        "third": body(third, "second", [0.0, -0.6]),
    }
    materials = {"first": material(), "second": material(numbers["stiffer"], numbers["heavier"])}
    return scene(bodies, materials, 0.3)


def _corners(left: float, bottom: float, right: float, top: float) -> FloatArray:
    """Two opposite corners [m], moved off the grid's lines."""
    return np.array([[left, bottom], [right, top]]) + CELL * np.array([0.3, 0.2])
