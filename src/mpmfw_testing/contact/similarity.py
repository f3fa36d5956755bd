"""What a change of units, of the outputs, or of other bodies must leave as it is."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.runs.simulation import Simulation
from mpmfw_testing.check import Violation, within
from mpmfw_testing.contact.drawing import places
from mpmfw_testing.contact.energy import require_no_gain
from mpmfw_testing.contact.meeting import CELL, NAMES, Meeting, body, material, rectangle, scene
from mpmfw_testing.contact.motion import Motion, simulate
from mpmfw_testing.contact.symmetry import SAME, STEPS, difference, three_blocks
from mpmfw_testing.other_units import options_in_units
from mpmfw_testing.searching import try_all
from mpmfw_testing.subject import Subject

#: By how much lengths, times and densities are larger or smaller: powers of two, which change no digit.
FACTORS = (1024.0, 1.0 / 1024.0)


def similarity(subject: Subject) -> None:
    """The scene in other units moves alike. The scene with lengths, times or densities 1024 times as large or
    small moves alike, to 1e-9 cells and of its momentum.

    Moduli go with density (length / time)², and options that say a unit with theirs: the two are one motion
    in other units; all factors are powers of two, so that arithmetic gives the same digits. A tolerance in
    metres, a stiffness as a constant or a speed that counts as zero does not.
    """
    meeting = Meeting(form="discs", gap=0.05, friction=0.3, slide=0.5, heavier=4.0, stiffer=4.0)
    reference = simulate(subject, meeting.mapping(), STEPS)

    def trial(quantity: str, factor: float) -> None:
        units = {"length": 1.0, "time": 1.0, "density": 1.0, quantity: factor}
        law = subject.make(**options_in_units(subject, units))
        motion = simulate(law, in_units(meeting.mapping(), **units), STEPS)
        length, time, density = units["length"], units["time"], units["density"]
        momentum = density * length ** (reference.centre.shape[-1] + 1) / time
        within(
            _apart(reference, motion, length, momentum),
            SAME,
            "the motion is another one in other units",
            None,
            places(reference, motion, lambda x: x / length),
        )

    try_all({"quantity": ("length", "time", "density"), "factor": FACTORS}, trial)


def _apart(reference: Motion, motion: Motion, length: float, momentum: float) -> float:
    """Largest difference of centres [cells] and momenta (over the largest), in the units of the first."""
    centres = np.abs(reference.centre - motion.centre / length).max() / CELL
    momenta = np.abs(reference.momentum - motion.momentum / momentum).max()
    return float(max(centres, momenta / np.abs(reference.momentum).max()))


def in_units(mapping: dict[str, Any], length: float, time: float, density: float) -> dict[str, Any]:
    """A scene of the kit with every length, time and density times a factor."""
    speed = length / time

    def sized(table: dict[str, Any], names: tuple[str, ...], factor: float) -> dict[str, Any]:
        return {
            key: (np.multiply(value, factor).tolist() if key in names else value)
            for key, value in table.items()
        }

    bodies = {}
    for name, given in mapping["bodies"].items():
        one = sized(sized(given, ("segment",), length), ("velocity",), speed)
        one = sized(one, ("angular_velocity",), 1.0 / time)
        one["geometry"] = sized(one["geometry"], ("lower", "upper", "centre", "radius"), length)
        one["particles"] = sized(one["particles"], ("size",), length)
        bodies[name] = one
    moduli = ("bulk_modulus", "shear_modulus")
    materials = {
        name: sized(sized(given, ("density",), density), moduli, density * speed**2)
        for name, given in mapping["materials"].items()
    }
    grid = sized(mapping["grid"], ("cell_size", "lower", "upper"), length)
    instants = sized(mapping["time"], ("end", "output_interval", "step"), time)
    return {**mapping, "grid": grid, "time": instants, "bodies": bodies, "materials": materials}


def outputs(subject: Subject) -> None:
    """How often outputs are asked for does not matter, to the bit."""

    def trial(slide: float) -> None:
        mapping = Meeting(gap=0.05, friction=0.3, slide=slide).mapping()
        asked = simulate(subject, mapping, STEPS)
        silent = Simulation(mapping, contact=subject.make())
        silent.advance(STEPS)
        found, expected = (one.state.particles.position for one in (asked.simulation, silent))
        if not np.array_equal(found, expected):
            apart = float(np.abs(found - expected).max())
            raise Violation(
                "the motion depends on how often outputs are asked for", {"largest difference [m]": apart}
            )

    try_all({"slide": (0.5, 0.0)}, trial, names=NAMES)


def three_bodies(subject: Subject) -> None:
    """Three bodies get no energy, and each pair has its own friction. Three bodies that meet at one spot gain
    at most 0.5 % of energy, and every pair has its own friction.

    A node that two others touch has one mass to give. Two blocks beside a third that is far away, listed
    before or after them and rough against both, move as without it, to 1e-9.
    """

    def trial(slide: float, heavier: float) -> None:
        numbers = {"slide": slide, "heavier": heavier, "stiffer": heavier}
        motion = simulate(subject, three_blocks(numbers), 3 * STEPS, partial=True)
        require_no_gain(motion, "three bodies that meet gain energy from contact")
        motion.require_whole()

    try_all({"slide": (0.5, 0.0), "heavier": (1.0, 4.0)}, trial, names=NAMES)
    _own_friction(subject)


def _own_friction(subject: Subject) -> None:
    """A far body that is rough against both others changes nothing between these."""
    meeting = Meeting(gap=0.05, friction=0.1, slide=0.5)
    alone = meeting.mapping()
    far = {"far": body(rectangle(np.array([-1.33, -1.28]), np.array([-1.13, -1.08])), "far", [0.0, 0.0])}
    pairs = [{"bodies": ["far", name], "friction": 0.9} for name in alone["bodies"]]
    contact = {**alone["contact"], "pairs": pairs}
    materials = {"far": material(), **alone["materials"]}
    step = {"step": 0.5 * simulate(subject, alone, 1).dt[0]}
    without = simulate(subject, {**alone, "time": {**alone["time"], **step}}, STEPS)
    for order, bodies in (("first", {**far, **alone["bodies"]}), ("last", {**alone["bodies"], **far})):
        beside = {**scene(bodies, materials, 0.1), "contact": contact}
        with_it = simulate(subject, {**beside, "time": {**beside["time"], **step}}, STEPS)
        within(
            difference(without, with_it),
            SAME,
            "two bodies feel the friction of a pair that is far away",
            {"friction of the two": 0.1, "friction of the far pairs": 0.9, "the far body is listed": order},
            places(without, with_it),
        )
