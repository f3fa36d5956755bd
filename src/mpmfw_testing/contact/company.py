"""Checks with more contacts, more points on a surface, a second meeting, and a moving frame."""

from __future__ import annotations

import numpy as np

from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import within
from mpmfw_testing.contact.drawing import histories, impulses_at
from mpmfw_testing.contact.meeting import (
    CELL,
    DEPTH,
    RADIUS,
    WAVE_SPEED,
    Meeting,
    body,
    material,
    rectangle,
    scene,
)
from mpmfw_testing.contact.motion import Motion, note, recorded, simulate
from mpmfw_testing.contact.separation import LEFT
from mpmfw_testing.contact.symmetry import GRID, SAME
from mpmfw_testing.saving import remember
from mpmfw_testing.searching import try_all
from mpmfw_testing.subject import Subject

#: Blocks on the plate, and their width and distance from one to the next [cells].
BLOCKS, ACROSS, APART = 20, 4, 6
#: Length of a long face [cells].
LONG = 120
#: Share by which the impulses on blocks that lie alike on the grid may differ: some laws stop at a tolerance.
ALIKE = 0.05
#: Share of the whole impulse by which the points of a surface may change what was exchanged by any time.
REFINED = 0.03
#: Steps before the frame moves, and its velocity [m/s].
BEFORE, BOOST = 12, (4.0, -2.0)


def many_contacts(subject: Subject) -> None:
    """Of many bodies that touch each gets its share. Twenty blocks that come down on one plate, whole cells
    apart, get the same impulse, to 5 %; so do halves of a long face.

    Twenty-one bodies have 210 pairs, twenty of which touch; two strips of 120 cells share some 360 nodes, and
    have 480 points on their faces: arrays that are too small for them leave the last ones without contact.
    """
    pitch, low = CELL * APART, np.array([0.03, 0.02])
    width = CELL * (BLOCKS * APART + 6)
    bodies = {
        "plate": body(
            rectangle(low - CELL * np.array([4, 3]), low + np.array([width - CELL * 4, 0.0])),
            "plate",
            [0.0, 0.0],
        )
    }
    for k in range(BLOCKS):
        corner = low + np.array([k * pitch, 0.005])
        block = rectangle(corner, corner + CELL * np.array([ACROSS, 2]))
        bodies[f"block_{k}"] = body(block, "plate", [0.0, -1.0])
    grid = {"cell_size": CELL, "lower": [-1.0, -1.0], "upper": [width + 1.0, 1.0]}
    motion = simulate(subject, scene(bodies, {"plate": material()}, 0.0, grid=grid), 12, partial=True)
    motion.require_whole()
    got = np.diff(motion.momentum[:, 1:, 1], axis=0).sum(axis=0)[2:-2]
    worst = int(np.abs(got - got[0]).argmax())
    within(
        float(np.abs(got - got[0]).max() / max(np.abs(got).max(), 1e-300)),
        ALIKE,
        "of many blocks on one plate some get another impulse than the first (share of it)",
        {"block": worst + 2, "its impulse [N s/m]": float(got[worst]), "of the first [N s/m]": float(got[0])},
        impulses_at(motion, motion.largest_step),
    )
    _long_face(subject)


def _long_face(subject: Subject) -> None:
    """Two strips of 120 cells: the left half of the face takes what the right half takes, to 5 %."""
    low, span = np.array([0.03, 0.02]), CELL * np.array([LONG, 2])
    rise = np.array([0.0, 0.005])
    strips = {
        "lower": body(rectangle(low - [0.0, span[1]], low + span * [1.0, 0.0]), "strip", [0.0, 0.0]),
        "upper": body(rectangle(low + rise, low + span + rise), "strip", [0.0, -1.0]),
    }
    grid = {"cell_size": CELL, "lower": [-1.0, -1.0], "upper": [span[0] + 1.0, 1.0]}
    motion = simulate(subject, scene(strips, {"strip": material()}, 0.0, grid=grid), 12)
    halves = np.zeros(2)
    for nodal in motion.nodal:
        upper = nodal.of(motion.simulation.state.bodies[1].field)
        cell = np.rint(upper.position[:, 0] / CELL)
        for k, first in enumerate((10, LONG // 2)):
            inside = (cell >= first) & (cell < first + LONG // 2 - 10)
            halves[k] += upper.impulse[inside, 1].sum()
    within(
        float(abs(halves[1] - halves[0]) / max(abs(halves[0]), 1e-300)),
        ALIKE,
        "of a long face one half takes another impulse than the other (share of it)",
        {"left [N s/m]": float(halves[0]), "right [N s/m]": float(halves[1])},
        impulses_at(motion, motion.largest_step),
    )


def refinement(subject: Subject) -> None:
    """How many points a surface has does not matter. Twice and four times as many points on the surface of
    either block change the impulse by any time by 3 % of the whole.

    What a point bears goes with the length that is its own. A law without surfaces has no such points.
    """
    meeting = Meeting(gap=0.05)
    reference = _refined(subject, meeting, 1, 1)

    def trial(first: int, second: int) -> None:
        motion = _refined(subject, meeting, first, second)
        time = np.linspace(0.0, min(sum(m.dt) for m in (reference, motion)), 60)
        found, expected = (_by_time(m, meeting, time) for m in (motion, reference))
        within(
            float(np.abs(found - expected).max() / max(np.abs(expected).max(), 1e-300)),
            REFINED,
            "what is exchanged depends on how many points a body's surface has (share of the whole impulse)",
            None,
            histories({"impulse": (time, found), "coarser": (time, expected)}, "impulse by then [N s/m]"),
        )

    names = {"first": "points on the first body, times", "second": "points on the second body, times"}
    try_all({"first": (1, 4), "second": (1, 4)}, trial, names=names)


def _refined(subject: Subject, meeting: Meeting, first: int, second: int) -> Motion:
    """Half a meeting with so many times the points on each surface."""
    mapping = meeting.mapping()
    for name, finer in (("first", first), ("second", second)):
        mapping["bodies"][name]["segment"] = 0.5 * CELL / finer * (1.0 + 1e-6)
    return simulate(subject, mapping, duration=2.0 * DEPTH / WAVE_SPEED)


def step_length(subject: Subject) -> None:
    """How long a step is does not matter. In steps of a quarter of half the stable one, blocks that stick
    exchange the same by any time: 10 % along, 20 % across.

    What a law does in every step, however long that is, it does four times as often: stop a part of the
    approach, or let a part of what springs hold go.
    """
    meeting = Meeting(gap=0.05, slide=0.2, friction=1.0)
    longest = 0.5 * simulate(subject, meeting.mapping(), 1).dt[0]

    def trial(shorter: float) -> None:
        coarse, fine = (
            simulate(
                subject,
                meeting.mapping(time={"end": 1.0, "output_interval": 1.0, "step": step}),
                duration=meeting.duration,
            )
            for step in (longest, longest / shorter)
        )
        time = np.linspace(0.0, min(sum(m.dt) for m in (coarse, fine)), 60)
        across = np.array([-meeting.normal[1], meeting.normal[0]])
        for what, direction, bound in (("along", meeting.normal, 0.1), ("across", across, 0.2)):
            found, expected = (_by_time(m, meeting, time, direction) for m in (fine, coarse))
            within(
                float(np.abs(found - expected).max() / max(np.abs(expected).max(), 1e-300)),
                bound,
                f"what is exchanged {what} the line between the bodies depends on how long a step is (share "
                "of the whole)",
                {"step [s]": longest},
                histories({"shorter": (time, found), "longer": (time, expected)}, "impulse by then [N s/m]"),
            )

    try_all({"shorter": (4.0,)}, trial, names={"shorter": "steps are shorter by"})


def _by_time(
    motion: Motion, meeting: Meeting, time: FloatArray, direction: FloatArray | None = None
) -> FloatArray:
    """Impulse on the second block along the line between the bodies, by time [N s/m]."""
    along = meeting.normal if direction is None else direction
    taken = np.concatenate([[0.0], np.cumsum(motion.impulse[:, 1] @ along)])
    by_step = np.concatenate([[0.0], np.cumsum(motion.dt)])
    return np.asarray(np.interp(time, by_step, taken))


def met_again(subject: Subject) -> None:
    """Bodies that met and parted are stopped when they meet again. Discs that met, were drawn apart and are
    thrown at each other from another side are stopped again.

    At most 5 % of the speed of approach is left, and 15 % of it across the line between them.

    What a law keeps of the first meeting, its normals or that it was one, must not stand in the way of the
    second.
    """
    meeting = Meeting(form="discs", gap=0.05)
    simulation = Simulation(meeting.mapping(), contact=subject.make())
    simulation.start()
    steps = int(np.ceil(meeting.duration / simulation.stable_step()))
    remember(meeting.mapping(), steps)
    simulation.advance(steps)
    _throw(simulation, -3.0 * meeting.normal)
    while np.linalg.norm(_line(simulation)) < 2.0 * RADIUS + 1.5 * CELL:
        simulation.step()
    _throw(simulation, -3.0 * meeting.tangent)
    while _line(simulation) @ meeting.tangent < _line(simulation) @ meeting.normal:
        simulation.step()
    line = _line(simulation) / np.linalg.norm(_line(simulation))
    _throw(simulation, 0.5 * line)
    with recorded(simulation) as motion:
        simulation.advance(3 * steps, lambda frame: note(motion, frame))
    moving = motion.velocity[-1, 0] - motion.velocity[-1, 1]
    left, across = moving @ line, np.linalg.norm(moving - (moving @ line) * line)
    time = np.concatenate([[0.0], np.cumsum(motion.dt)])
    approach = (motion.velocity[:, 0] - motion.velocity[:, 1]) @ line
    picture = histories({"second meeting": (time, approach)}, "speed of approach [m/s]")
    case = {
        "second line from the first to the second body": line.round(3).tolist(),
        "speed of approach [m/s]": 1.0,
    }
    within(
        float(left), LEFT,
        "bodies that met and parted are not stopped when they meet again: share of their speed left",
        case, picture,
    )  # fmt: skip
    within(
        float(across), GRID,
        "bodies that meet again are not pushed along the line between them: share of their speed across it",
        case, picture,
    )  # fmt: skip


def _throw(simulation: Simulation, velocity: FloatArray) -> None:
    """Give the first body a velocity [m/s], and the second the opposite."""
    for one, sign in zip(simulation.state.bodies, (1.0, -1.0), strict=True):
        simulation.state.particles.velocity[one.particles] = sign * velocity


def _line(simulation: Simulation) -> FloatArray:
    """From the middle of the first body's points to that of the second's [m]."""
    first, second = (
        simulation.state.particles.position[b.particles].mean(axis=0) for b in simulation.state.bodies
    )
    return np.asarray(second - first)


def moving_frame(subject: Subject) -> None:
    """A velocity that all bodies share does not matter. Two that touch and slide exchange the same impulses
    in a step that both enter with 4 m/s more, to 1e-9 of the largest.

    Points and springs are where they were: what the law does in this step is a matter of the bodies' motion
    against each other.
    """
    meeting = Meeting(gap=0.05, friction=0.3, slide=0.5, heavier=4.0)
    slow, fast = (_seen(subject, meeting, np.array(boost)) for boost in ([0.0, 0.0], BOOST))
    within(
        float(np.abs(fast.impulse - slow.impulse).max() / max(np.abs(slow.impulse).max(), 1e-300)),
        SAME,
        "contact depends on the velocity that all bodies have in common (share of the impulse of a step)",
        {"step": BEFORE + 1, "common velocity [m/s]": list(BOOST)},
        impulses_at(fast, 0),
    )


def _seen(subject: Subject, meeting: Meeting, boost: FloatArray) -> Motion:
    """One step of a meeting that the bodies enter with a velocity more."""
    remember(meeting.mapping(), BEFORE + 1)
    simulation = Simulation(meeting.mapping(), contact=subject.make())
    simulation.advance(BEFORE)
    dt = 0.5 * simulation.stable_step()
    simulation.state.particles.velocity += boost
    with recorded(simulation) as motion:
        simulation.advance(0, lambda frame: note(motion, frame))
        simulation.step(dt)
        simulation.advance(0, lambda frame: note(motion, frame))
    return motion
