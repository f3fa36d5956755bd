"""Sliding block: acceleration and friction force against Coulomb's law, with every method.

The closed form is the scene's own: a = g (sin θ − μ cos θ) = 2.402 m/s². Height of the interface over a
grid line, in cells of 0.1 m; the scene's is 0.13.
"""
# cost: 70

import numpy as np
from common import LITERAL, MASTER, POSITION, elastic, fixed, rectangle, scene, specified

from mpmfw.campaigns.measures import exact_of, measure_of
from mpmfw.plugin.measure import About
from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Place, Runs, methods

FRICTION, GRAVITY, DEPTH = 0.3, 10.0, 0.4  #: μ, g [m/s²], of the sand [m]
#: The share of the block's motion that is judged: the start, when the tilt is sudden, is left out.
FROM = 0.2


def acceleration(run):
    """Return the error of the fitted acceleration against the scene's closed form [%]."""
    measure, about = measure_of("acceleration"), About()
    measured, exact = measure.of(run.results, run.scene, about), exact_of(measure, run.scene, about)
    return 100.0 * (float(measured.values[0]) / float(exact.at(measured.time)[0]) - 1.0)


def friction(tree):
    """Return the error of mean T over μ times mean N; None without a contact force."""
    series = tree["series"].to_dataset()
    if "contact_force" not in series:
        return None
    late = series["time"].values > FROM * series["time"].values[-1]
    force = series["contact_force"].sel(pair="block-plane")[late].mean("time")
    return -float(force.sel(axis="x")) / (FRICTION * float(force.sel(axis="y"))) - 1.0


def on_sand(cells):
    """Return a rigid block that slides to rest on sand so many ``cells`` deep."""
    cell, sides = DEPTH / cells, fixed(bottom="xy", left="x", right="x")
    sand = elastic(1600.0, 1e7, 0.3, "mohr_coulomb", friction_angle=float(np.radians(33.0)))
    rigid = {"density": 800.0, "held": ["rotation"]}
    bodies = {
        "sand": rectangle(0.0, 0.0, 2.0, DEPTH, initial_stress={"k0": 0.5}, sides=sides),
        "block": rectangle(0.6, DEPTH, 1.1, 0.6, velocity=[1.0, 0.0], rigid=rigid),
    }
    return scene(
        *(cell, [-4.0 * cell, -4.0 * cell], [2.2, 1.0], 0.3, 0.01, sand, bodies),
        time={"outputs": "nearest"},
        contact={"friction": FRICTION},
        gravity={"vector": [0.0, -GRAVITY]},
        settle={"tolerance": 1e-3},
        output={"particles": False, "surface": False},
    )


def braking(tree):
    """Return the error [%] of the block's mean deceleration against μ g."""
    speed = tree["series"]["mean_velocity"].sel(body="block", axis="x")
    rate = np.polyfit(speed["time"].values, speed.values, 1)[0]
    return -100.0 * float(rate / (FRICTION * GRAVITY)) - 100.0


def interface(block, plane, y):
    """Return the interface at y; ``block`` and ``plane`` are the other edges."""
    bodies = {"block": rectangle(0.03, y, 0.63, block), "plane": rectangle(-0.4, plane, 3.2, y)}
    return {f"bodies.{name}.geometry": body["geometry"] for name, body in bodies.items()}


DOWN = specified(0.0, -1.0)
FORMS = {
    "criterion position": POSITION,
    "normal master": MASTER,
    "normal specified": DOWN,
    "normal specified, criterion position": {**DOWN, **POSITION},
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
    run.gate("fitted acceleration, error", acceleration(run), 0.0, 0.5, "%")
    run.gate("mean T / (mu N), error", run.of(friction, scale=100.0), 0.0, 0.5, "%")


@Runs("bed", on_sand, places=[Place("on sand, 8 cells deep", make={"cells": 8})])
def test_bed(run):
    run.gate(f"deceleration, error, {run.place.at}", run.of(braking), 0.0, 2.0, "%")
