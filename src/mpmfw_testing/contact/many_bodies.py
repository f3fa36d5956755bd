"""More contacts, more points on a surface, shorter steps, and a second impact."""

from __future__ import annotations

import numpy as np

from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import within
from mpmfw_testing.contact.impact import (
    CELL,
    DEPTH,
    RADIUS,
    WAVE_SPEED,
    Impact,
    body,
    material,
    rectangle,
    scene,
)
from mpmfw_testing.contact.motion import Motion, simulate
from mpmfw_testing.contact.separation import LEFT
from mpmfw_testing.contact.symmetry import GRID
from mpmfw_testing.searching import try_all
from mpmfw_testing.subject import Subject

#: Blocks on the plate, and their width and distance from one to the next [cells].
BLOCKS, ACROSS, APART = 20, 4, 6
#: Length of a long face [cells].
LONG = 120
#: Share by which the impulses on blocks that lie alike on the grid may differ: some laws stop at a tolerance.
ALIKE = 0.05
#: Share of the whole impulse by which the points of a surface may change that exchanged by any time.
REFINED = 0.03


def many_contacts(subject: Subject) -> None:
    """Of many bodies that touch each gets its share. Twenty blocks that come down on one plate, whole cells
    apart, get the same impulse, to 5 %; so do halves of a long face.

    Twenty-one bodies have 210 pairs; two strips of 120 cells share some 360 nodes, and have 480 points on
    their faces. Arrays that are too small for them leave the last ones without contact.
    """
    low, width = np.array([0.03, 0.02]), CELL * (BLOCKS * APART + 6)
    corners = [low + np.array([k * CELL * APART, 0.005]) for k in range(BLOCKS)]
    plate = rectangle(low - CELL * np.array([4, 3]), low + np.array([width - CELL * 4, 0.0]))
    blocks = [rectangle(corner, corner + CELL * np.array([ACROSS, 2])) for corner in corners]
    got = np.diff(_come_down(subject, [plate, *blocks]).momentum[:, 1:, 1], axis=0).sum(axis=0)[2:-2]
    worst = int(np.abs(got - got[0]).argmax())
    case = {
        "block": worst + 2, "its impulse [N s/m]": float(got[worst]), "of the first [N s/m]": float(got[0])
    }  # fmt: skip
    text = "of many blocks on one plate some get another impulse than the first (share of it)"
    within(np.abs(got - got[0]).max() / max(np.abs(got).max(), 1e-300), ALIKE, text, case)

    span, rise = CELL * np.array([LONG, 2]), np.array([0.0, 0.005])
    strips = [
        rectangle(low - [0.0, span[1]], low + span * [1.0, 0.0]),
        rectangle(low + rise, low + span + rise),
    ]
    motion, halves = _come_down(subject, strips), np.zeros(2)
    for nodal in motion.nodal:
        upper = nodal.of(motion.simulation.state.bodies[1].field)
        cell = np.rint(upper.position[:, 0] / CELL)
        for k, first in enumerate((10, LONG // 2)):
            inside = (cell >= first) & (cell < first + LONG // 2 - 10)
            halves[k] += upper.impulse[inside, 1].sum()
    case = {"left [N s/m]": float(halves[0]), "right [N s/m]": float(halves[1])}
    text = "of a long face one half takes another impulse than the other (share of it)"
    within(abs(halves[1] - halves[0]) / max(abs(halves[0]), 1e-300), ALIKE, text, case)


def _come_down(subject: Subject, shapes: list[dict[str, object]]) -> Motion:
    """Give all bodies but the first 1 m/s towards it."""
    bodies = {
        f"body_{k}": body(shape, "soft", [0.0, -1.0 if k else 0.0]) for k, shape in enumerate(shapes)
    }  # fmt: skip
    grid = {"cell_size": CELL, "lower": [-1.0, -1.0], "upper": [CELL * (LONG + 6) + 1.0, 1.0]}
    return simulate(subject, scene(bodies, {"soft": material()}, 0.0, grid=grid), 12)


def refinement(subject: Subject) -> None:
    """How many points a surface has does not matter. Twice and four times as many points on the surface of
    either block change the impulse by any time by 3 % of the whole.

    A point bears by the length that is its own. A law without surfaces has no such points.
    """
    impact = Impact(gap=0.05)

    def refined(first: int, second: int) -> Motion:
        mapping = impact.mapping()
        for name, finer in (("first", first), ("second", second)):
            mapping["bodies"][name]["segment"] = 0.5 * CELL / finer * (1.0 + 1e-6)
        return simulate(subject, mapping, duration=2.0 * DEPTH / WAVE_SPEED)

    reference = refined(1, 1)

    def trial(first: int, second: int) -> None:
        text = "the impulse depends on how many points a body's surface has (share of the whole)"
        within(_apart(reference, refined(first, second), impact.normal), REFINED, text)

    names = {"first": "points on the first body, times", "second": "points on the second body, times"}
    try_all({"first": (1, 4), "second": (1, 4)}, trial, names=names)


def step_length(subject: Subject) -> None:
    """How long a step is does not matter. In steps of a quarter of half the stable one, blocks that stick
    exchange the same by any time: 10 % along, 20 % across.

    A law that stops a part of the approach, or releases a part of its springs' load, in every step does it
    four times as often.
    """
    impact = Impact(gap=0.05, slide=0.2, friction=1.0)
    longest = 0.5 * simulate(subject, impact.mapping(), 1).dt[0]
    coarse, fine = (
        simulate(
            subject,
            impact.mapping(time={"end": 1.0, "output_interval": 1.0, "step": step}),
            duration=impact.duration,
        )
        for step in (longest, 0.25 * longest)
    )
    for name, direction, bound in (("along", impact.normal, 0.1), ("across", impact.tangent, 0.2)):
        text = f"the impulse {name} the line between the bodies depends on how long a step is (share of it)"
        within(_apart(coarse, fine, direction), bound, text, {"step [s]": longest, "a shorter one": 0.25})


def _apart(reference: Motion, motion: Motion, direction: FloatArray) -> float:
    """Return the largest difference of the second body's impulse by any time, over the largest impulse."""
    time = np.linspace(0.0, min(sum(m.dt) for m in (reference, motion)), 60)
    expected, found = (
        np.interp(time, np.cumsum([0.0, *m.dt]), np.cumsum([0.0, *(m.impulse[:, 1] @ direction)]))
        for m in (reference, motion)
    )
    return float(np.abs(found - expected).max() / max(np.abs(expected).max(), 1e-300))


def met_again(subject: Subject) -> None:
    """Bodies that met and parted are stopped when they meet again. Discs that met, were drawn apart and are
    thrown at each other from another side are stopped again.

    At most 5 % of the speed of approach is left, and 15 % of it across the line between them. A record of the
    first impact, such as its normals, must not stand in the way of the second.
    """
    impact = Impact(form="discs", gap=0.05)
    motion = simulate(subject, impact.mapping(), duration=impact.duration)
    simulation, steps = motion.simulation, len(motion.dt)
    _throw(simulation, -3.0 * impact.normal)
    while np.linalg.norm(_line(simulation)) < 2.0 * RADIUS + 1.5 * CELL:
        simulation.step()
    _throw(simulation, -3.0 * impact.tangent)
    while _line(simulation) @ impact.tangent < _line(simulation) @ impact.normal:
        simulation.step()
    line = _line(simulation) / np.linalg.norm(_line(simulation))
    _throw(simulation, 0.5 * line)
    motion.advance(3 * steps)
    moving = motion.left()
    left, across = moving @ line, np.linalg.norm(moving - (moving @ line) * line)
    case = {
        "second line from the first to the second body": line.round(3).tolist(),
        "speed of approach [m/s]": 1.0,
    }
    text = "bodies that met and parted are not stopped when they meet again: share of their speed left"
    within(left, LEFT, text, case)
    text = "bodies that meet again are not pushed along the line between them: share of their speed across it"
    within(across, GRID, text, case)


def _throw(simulation: Simulation, velocity: FloatArray) -> None:
    """Give the first body a velocity [m/s], and the second the opposite one."""
    for one, sign in zip(simulation.state.bodies, (1.0, -1.0), strict=True):
        simulation.state.particles.velocity[one.particles] = sign * velocity


def _line(simulation: Simulation) -> FloatArray:
    """Return the vector from the middle of the first body's points to that of the second's [m]."""
    x = simulation.state.particles.position
    first, second = (x[b.particles].mean(axis=0) for b in simulation.state.bodies)
    return np.asarray(second - first)
