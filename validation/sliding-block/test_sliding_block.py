"""Sliding block: acceleration and friction force against Coulomb's law, with every method.

The closed form is the scene's own: a = g (sin θ − μ cos θ) = 2.402 m/s². Height of the interface over a
grid line, in cells of 0.1 m; the scene's is 0.13.
"""
# cost: 70

import incline
import normals
import sand
from classical import LITERAL, MASTER, POSITION, specified

from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Place, Runs, methods

DOWN = specified(0.0, -1.0)
FORMS = {
    "criterion position": POSITION,
    "normal master": MASTER,
    "normal specified": DOWN,
    "normal specified, criterion position": {**DOWN, **POSITION},
}


def interface(block, plane, y):
    """Return the interface at y; ``block`` and ``plane`` are the other edges."""
    corners = {"block": ([0.03, y], [0.63, block]), "plane": ([-0.4, plane], [3.2, y])}
    return {
        f"bodies.{body}.geometry": {"type": "rectangle", "lower": lower, "upper": upper}
        for body, (lower, upper) in corners.items()
    }


HEIGHTS = {
    "interface on a grid line": interface(0.3, -0.213, 0.0),
    "interface in mid-cell": interface(0.35, -0.163, 0.05),
}

slides = Runs(
    "slides",
    methods=[
        *methods(shape=RECOMMENDED, when="quick"),
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(["bardenhagen"], SHAPES, FORMS, when="full"),
        *methods(["bardenhagen", "penalty"], settings=HEIGHTS, when="full"),
        *methods(["hamad2017"], settings={"": {}, "literal": LITERAL}, when="full"),
    ],
    set={"output.particles": False},
    quick={"time.end": 0.5},
)


@slides
def test_slides(run):
    acceleration = run.of("acceleration", scale=100.0, relative=True)
    run.gate("fitted acceleration, error", acceleration, 0.0, 0.5, "%")
    run.gate("mean T / (mu N), error", run.of(incline.sliding, "friction", scale=100.0), 0.0, 0.5, "%")
    run.gate("mean N / (m g cos theta)", run.of(incline.sliding, "normal"), 1.0)


def test_normals(case):
    for height, where in ((0.13, "as in the scene"), (0.0, "on a grid line"), (0.5, "in mid-cell")):
        with case.timed():
            tilt = normals.steepest_tilt(interface=height)
        quantity = f"steepest averaged normal at the leading corner, interface {where}"
        case.gate(quantity, tilt, "locks above 13.3", unit="deg")


bed = Runs("bed", scene=sand.scene, places=[Place("on sand, 8 cells deep", make={"cells": 8})])


@bed
def test_bed(run):
    run.gate(f"deceleration, error, {run.place.at}", run.of(sand.braking), 0.0, 2.0, "%")
