"""Impacts of spheres in space: thrown obliquely, turned about a line in the plane of contact, and straight.

Two that turn against each other, as gears do: their points of contact move alike, and friction has nothing
to do.
"""
# cost: 700

import bounce
import drawn
import elastic
import spheres

from mpmfw.validation import CLASSICAL, Place, Runs, full, methods, together

#: Limits [%] with smaller cells, and of a force over the time of contact.
ALONG, SPIN, SLIDING = {"along": (-2.5, 2.5)}, {"spin": (-2.0, 2.0)}, {"spin, rigid": (-2.0, 2.0)}
HERTZ = {"force": (-5.0, 5.0), "time": (-5.0, 5.0)}
SMALL = dict.fromkeys(("along", "spin"), "the circle of contact is 0.2 cells")


def impact(at, test, cells=6, within=None, shown=None, when="full", **make):
    """Return an impact: a test of the source, and what spheres.scene takes besides."""
    make = {"test": test, "cells": cells, **make}
    return Place(f"{at}, R/h = {cells}", make=make, within=within or {}, open=shown or {}, when=when)


def nylon(spin, cells=6, within=None, shown=None, when="full"):
    """Return an impact of nylon that turns, at an eighth of the source's speed."""
    at = f"6, nylon, ω R / v_n = {spin / 2}"
    return impact(at, "6 nylon", cells, within, shown, when, spin=spin, pace=8)


def steel(angle, cells=6, within=None, when="full"):
    """Return an oblique impact of steel."""
    return impact(f"5, steel, {angle}°", "5 steel", cells, within, when=when, angle=angle)


COPPER = {"test": "7 copper", "spin": 3, "pace": 18, "partner": "twin"}
TURNING = "ω R / v_n = 1.5"
TOO_LOW = {"force": "seven per cent too low, with finer surfaces as well"}
UNSURE = {"spin": "within 5 % or not as the cell size has it"}

oblique = Runs(
    "oblique",
    scene=spheres.scene,
    methods=[*methods(), *methods(CLASSICAL, when="full")],
    places=[
        *(steel(angle, when="" if angle == 70 else "full") for angle in (17, 45, 70)),
        *(steel(angle, 10, ALONG | SPIN | SLIDING) for angle in (17, 45, 70)),
        *(impact(f"4, oxide, {angle}°", "4 oxide", angle=angle) for angle in (10, 50)),
        nylon(3, when=""),
        *(nylon(1, cells, shown=UNSURE) for cells in (6, 10)),
        nylon(9),
        nylon(3, 10, ALONG | SPIN),
        nylon(9, 10, SLIDING),
        impact(f"6, nylon at their speed, {TURNING}", "6 nylon", shown=SMALL, spin=3),
        impact(f"6, aluminium, {TURNING}", "6 aluminium", spin=3, pace=25),
        impact(f"7, two of copper, {TURNING}", **COPPER),
        impact(f"7, two of copper, {TURNING}", cells=10, within=ALONG | SPIN, **COPPER),
        impact(f"8, nylon on a larger sphere, {TURNING}", "6 nylon", spin=3, pace=8, partner="cap"),
    ],
)
alike = Runs(
    "alike",
    scene=spheres.scene,
    methods=oblique.methods,
    places=[impact("7, two of copper that turn as gears do", when="", sense=-1, **COPPER)],
)
straight = Runs(
    "straight",
    scene=spheres.scene,
    methods=[*methods(settings={"": {}, "kappa 8": {"contact.penalty.kappa": 8.0}}), *methods(CLASSICAL)],
    places=[
        impact("1, two of glass", "1 glass", partner="twin"),
        impact("1, two of glass", "1 glass", 10, HERTZ, partner="twin"),
        impact("1, two of limestone", "1 limestone", partner="twin"),
        impact("2, aluminium", "2 aluminium", pace=25),
        impact("2, aluminium", "2 aluminium", 10, HERTZ, TOO_LOW, pace=25),
        impact("2, magnesium", "2 magnesium", pace=25),
    ],
    binds=["penalty, cpdi, kappa 8"],
    when="full",
)
#: Places whose point of contact sticks at some time, and those where it slides throughout.
STICKS = ("5*17°*", "5*45°*", "4*10°*", "6*0.5,*", "6*1.5,*", "7*", "8*")
SLIDES = ("5*70°*", "4*50°*", "6*4.5*")


@oblique
def test_oblique(run):
    if run.at(*STICKS):
        run.gates(
            bounce.errors,
            (
                "{at}: velocity of the point of contact over what it had, less the elastic sphere's",
                "contact",
                0.0,
                None,
                "%",
            ),
        )
        for name, key in (("v_t", "along"), ("ω R", "spin")):
            quantity, value = "against the elastic sphere", run.of(bounce.errors, key)
            run.gate(f"{run.place.at}: change of {name} {quantity}", value, 0.0, 5.0, "%", key=key)
    if run.at(*SLIDES):
        against = "against the rigid sphere that slides"
        for name, key, most in (("v_t", "along, rigid", 1.0), ("ω R", "spin, rigid", 2.5)):
            value = run.of(bounce.errors, key)
            run.gate(f"{run.place.at}: change of {name} {against}", value, 0.0, most, "%", key=key)
    run.gates(bounce.impact, ("{at}: coefficient of restitution", "restitution", 1.0))


@alike
def test_alike(run):
    run.gates(
        bounce.impact,
        ("{at}: change of v_t over ω R", "along", 0.0, 1.0, "%"),
        ("{at}: change of ω R over ω R", "spin", 0.0, 1.0, "%"),
        scale=100.0,
    )


@straight
def test_straight(run):
    at, binds = run.place.at, run.method.matches("penalty, cpdi, kappa 8")
    for quantity, key in (("largest force", "force"), ("time of contact", "time")):
        value = run.of(bounce.against_hertz, key)
        run.gate(f"{at}: {quantity} against Hertz", value, 0.0, unit="%", key=key, binds=binds)
    run.gates(bounce.impact, ("{at}: coefficient of restitution", "restitution", 1.0))


@together(oblique, alike, straight)
def test_conservation(case, runs):
    for method, same in runs.by_method():
        for quantity, key, reference, most in (
            ("linear momentum of both, change", "momentum", 0.0, 1e-12),
            ("moment of contact on both in a step, over their angular momentum", "moment", 0.0, 1e-9),
            ("energy and what is dissipated, over the start", "energy", 1.0, 1.005),
        ):
            value = same.of(bounce.largest, of=key)
            case.gate(f"{quantity}, of all runs", value, reference, (0.0, most), method=method)


@together(oblique, alike)
def test_angular_momentum(case, runs):
    for method, same in runs.by_method():
        value = same.of(bounce.largest, of="angular")
        case.gate("angular momentum of both, change, of all runs", value, 0.0, unit="%", method=method)


def test_elastic(case):
    for quantity, of, most in (
        ("elastic sphere, departure from sliding throughout in ψ", elastic.sliding_limit, 1e-6),
        ("elastic sphere at 45°, half as many springs and steps", elastic.refined, (0.0, 1e-3)),
    ):
        with case.timed():
            value = of()
        case.gate(quantity, value, 0.0, most, method="reference")


@full
@together(oblique)
def test_figure(case, runs):
    case.figure("", drawn.draw(runs))
