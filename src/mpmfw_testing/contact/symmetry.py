"""Changes that must not matter: the order of bodies, place, direction, common velocity, units, outputs."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pint

from mpmfw.plugin.discovery import options_of
from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Violation, within
from mpmfw_testing.contact.impact import CELL, NAMES, Impact, three_blocks
from mpmfw_testing.contact.motion import SAME, STEPS, Motion, simulate
from mpmfw_testing.searching import try_all
from mpmfw_testing.subject import Subject

#: Share of the exchanged impulse by which the grid may be felt.
GRID = 0.15
#: By how much lengths, times and densities are larger or smaller: powers of two, which change no digit.
FACTORS = (1024.0, 1.0 / 1024.0)
#: Steps before the frame moves, and its velocity [m/s].
BEFORE, BOOST = 12, (4.0, -2.0)


def relabelling(subject: Subject) -> None:
    """The order in which the scene names the bodies does not matter. The order of the bodies in the scene
    changes positions and momenta by at most 1e-9 cells and of the largest momentum.

    Two blocks, or three that meet at one spot, reversed and moved on by one; equal ones and unequal ones.
    """

    def trial(bodies: int, **numbers: Any) -> None:
        two = Impact(gap=0.05, friction=0.3, **numbers)
        mapping = three_blocks(**numbers) if bodies == 3 else two.mapping()
        names = list(mapping["bodies"])
        reference = simulate(subject, mapping, STEPS)
        for order in dict.fromkeys([(*names[::-1],), (*names[1:], names[0])]):
            changed = {**mapping, "bodies": {name: mapping["bodies"][name] for name in order}}
            off = reference.difference(simulate(subject, changed, STEPS))
            case = {"order": ", ".join(order), "instead of": ", ".join(names)}
            within(off, SAME, "the motion depends on the order in which the scene names the bodies", case)

    cases = {"bodies": (2, 3), "slide": (0.5, 0.0), "heavier": (1.0, 4.0), "stiffer": (1.0, 4.0)}
    try_all(cases, trial, names={**NAMES, "bodies": "number of bodies"})


def shift(subject: Subject) -> None:
    """Where the scene lies on the grid does not matter. A shift by whole cells changes the motion by at most
    1e-9; by part of a cell, the exchanged impulse by 15 %.

    The grid may be seen by a method, but the impulse in an impact without friction is set by masses and
    speed. 15 % covers contact that begins up to a cell early and a bounce that depends on it.
    """

    def back(impact: Impact, x: FloatArray) -> FloatArray:
        return x - CELL * np.array([impact.shift, impact.rise])

    def whole(impact: Impact) -> bool:
        return impact.shift.is_integer() and impact.rise.is_integer()

    text = "the motion depends on where the scene lies: a shift by whole cells changes it"
    _placed_elsewhere(subject, {"shift": (0.0, 1.0, 0.5), "rise": (0.0, -5.0, -0.5)}, back, whole, text)


def rotation(subject: Subject) -> None:
    """Which way the scene is turned does not matter. A quarter turn of the scene changes the motion by at
    most 1e-9; another turn, the exchanged impulse by 15 %.

    The impulse's direction counts as well, so that a normal which prefers the grid's axes is seen.
    """

    def back(impact: Impact, x: FloatArray) -> FloatArray:
        return np.asarray(x @ np.column_stack([impact.normal, impact.tangent]))

    turns = (90.0, 180.0, 270.0, 15.0, 45.0, 75.0, 120.0, 210.0, 330.0)
    text = "a quarter turn of the scene does not turn the motion"
    _placed_elsewhere(subject, {"turn": turns}, back, lambda impact: impact.turn % 90.0 == 0.0, text)


def _placed_elsewhere(
    subject: Subject,
    cases: Mapping[str, Sequence[float]],
    back: Callable[[Impact, FloatArray], FloatArray],
    exactly: Callable[[Impact], bool],
    message: str,
) -> None:
    """Compare the impulse of discs elsewhere with that at home, and their motion where it is ``exactly``
    the same.
    """
    # Contact begins within a step. With a gap of 0.1 it begins at the end of one, so that rounding decides.
    home = Impact(form="discs", gap=0.12)
    reference = simulate(subject, home.mapping(), duration=home.duration)

    def trial(**numbers: Any) -> None:
        impact = replace(home, **numbers)
        motion = simulate(subject, impact.mapping(), duration=home.duration)
        if exactly(impact):
            within(reference.difference(motion, functools.partial(back, impact)), SAME, message)
        expected, found = (
            m.impulse[:, 0].sum(axis=0) @ np.column_stack([at.normal, at.tangent])
            for m, at in ((reference, home), (motion, impact))
        )
        scale = max(float(np.linalg.norm(expected)), 1e-6 * home.reduced_mass * home.speed)
        text = "the impulse that the bodies exchange depends on how they lie on the grid"
        case = {
            "impulse, normal and tangential [N s/m]": found.round(3).tolist(),
            "unchanged scene [N s/m]": expected.round(3).tolist(),
        }
        within(np.linalg.norm(found - expected) / scale, GRID, text, case)

    try_all(cases, trial, names=NAMES)


def moving_frame(subject: Subject) -> None:
    """A velocity that all bodies share does not matter. Two that touch and slide exchange the same impulses
    in a step that both enter with 4 m/s more, to 1e-9 of the largest.

    Points and springs are where they were: only the bodies' motion against each other counts in this step.
    """
    found = []
    for boost in (np.zeros(2), np.array(BOOST)):
        motion = simulate(subject, Impact(gap=0.05, friction=0.3, slide=0.5, heavier=4.0).mapping(), BEFORE)
        dt = 0.5 * motion.simulation.stable_step()
        motion.simulation.state.particles.velocity += boost
        found.append(motion.advance(1, dt).impulse[-1])
    off = np.abs(found[1] - found[0]).max() / max(np.abs(found[0]).max(), 1e-300)
    text = "contact depends on the velocity that all bodies have in common (share of the impulse of a step)"
    within(off, SAME, text, {"step": BEFORE + 1, "common velocity [m/s]": list(BOOST)})


def similarity(subject: Subject) -> None:
    """The scene in other units moves alike. The scene with lengths, times or densities 1024 times as large or
    small moves alike, to 1e-9 cells and of its momentum.

    Moduli go with density (length / time)², and options that declare a unit with theirs. A tolerance in
    metres, a stiffness as a constant or a speed that counts as zero changes the motion.
    """
    impact = Impact(form="discs", gap=0.05, friction=0.3, slide=0.5, heavier=4.0, stiffer=4.0)
    reference = simulate(subject, impact.mapping(), STEPS)
    centre, momenta = reference.of("centre_of_mass"), reference.momentum

    def trial(quantity: str, factor: float) -> None:
        units = {"length": 1.0, "time": 1.0, "density": 1.0, quantity: factor}
        law = subject.make(**_options_in_units(subject, **units))
        motion = simulate(law, in_units(impact.mapping(), **units), STEPS)
        momentum = units["density"] * units["length"] ** (centre.shape[-1] + 1) / units["time"]
        apart = np.abs(centre - motion.of("centre_of_mass") / units["length"]).max() / CELL
        pushed = np.abs(momenta - motion.momentum / momentum).max() / np.abs(momenta).max()
        within(max(apart, pushed), SAME, "the motion is another one in other units")

    try_all({"quantity": ("length", "time", "density"), "factor": FACTORS}, trial)


def in_units(mapping: dict[str, Any], length: float, time: float, density: float) -> dict[str, Any]:
    """Return a scene of the kit with every length, time and density times a factor."""
    factors = {
        **dict.fromkeys(("cell_size", "lower", "upper", "centre", "radius", "size", "segment"), length),
        **dict.fromkeys(("end", "output_interval", "step"), time),
        "velocity": length / time,
        "density": density,
        **dict.fromkeys(("bulk_modulus", "shear_modulus"), density * (length / time) ** 2),
    }

    def times(key: str, value: Any) -> Any:
        if isinstance(value, dict):
            return {name: times(name, each) for name, each in value.items()}
        return np.multiply(value, factors[key]).tolist() if key in factors else value

    scaled: dict[str, Any] = times("", mapping)
    return scaled


def _options_in_units(subject: Subject, length: float, time: float, density: float) -> dict[str, Any]:
    """Return the options that declare one unit, times its factor; tables in time stay."""
    if not options_of(subject.plugin):
        return {}
    made, scaled = subject.make(), {}
    options = getattr(made, "options", made)
    for name, field in type(options).model_json_schema().get("properties", {}).items():
        units, value = set(_units(field)), getattr(options, name)
        if len(units) == 1 and type(value) in (int, float, list, tuple):
            mass, extent, duration = powers_of(units.pop())
            factor = float((density * length**3) ** mass * length**extent * time**duration)
            scaled[name] = np.multiply(value, factor).tolist()
    return scaled


def _units(field: Any) -> Iterator[str]:
    """Yield all units in the schema of one option."""
    for key, value in field.items() if isinstance(field, Mapping) else enumerate(field):
        if key == "unit" and isinstance(value, str):
            yield value
        elif isinstance(value, Mapping | list):
            yield from _units(value)


def outputs(subject: Subject) -> None:
    """How often outputs are asked for does not matter, to the bit."""

    def trial(slide: float) -> None:
        mapping = Impact(gap=0.05, friction=0.3, slide=slide).mapping()
        asked: Motion = simulate(subject, mapping, STEPS)
        silent = Simulation(mapping, contact=subject.make())
        silent.advance(STEPS)
        off = np.abs(asked.positions[-1] - silent.state.particles.position).max()
        if off > 0.0:
            text = "the motion depends on how often outputs are asked for"
            raise Violation(text, {"largest difference [m]": float(off)})

    try_all({"slide": (0.5, 0.0)}, trial, names=NAMES)


def powers_of(unit: str) -> tuple[float, float, float]:
    """Powers of mass, length and time in a unit, ``N s m-1`` or ``kg/m^3``; a ValueError refuses others."""
    text = re.sub(r"([^\W\d_])\^?(-?\d)", r"\1**\2", unit.strip().replace(" ", " * "))
    try:
        found = dict(pint.application_registry.parse_units("" if unit == "1" else text).dimensionality)
    except Exception as error:  # pint's own, of many kinds
        raise ValueError(f"expected a unit, found '{unit}': {error}") from error
    mass, length, time = (float(found.get(f"[{name}]", 0.0)) for name in ("mass", "length", "time"))
    return mass, length, time
