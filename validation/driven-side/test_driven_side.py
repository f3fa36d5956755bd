"""Driven side: σ_yy of uniaxial strain in a block that its sides press together, wherever they lie in a cell.

Turned by 30°: mean, and extremes by the distance from sides as they are at the start.
"""
# cost: 60

import math

import strain

from mpmfw.validation import RECOMMENDED, SHAPES, Place, Runs, each, methods


def place(at, size, past=0.3, upper=1.6, when=""):
    """Return a grid whose lines are ``past`` cells before the sides."""
    lower, upper = round(-0.5 - past * size, 4), round(upper - past * size, 4)
    grid = {"grid.cell_size": size, "grid.lower": [lower, lower], "grid.upper": [upper, upper]}
    return Place(at, grid, when=when)


def sides(size, upper):
    """Return sides on the grid's lines, and 0.3 cells past one."""
    return [place(f"h = {size} m, sides at {past:g} h", size, past, upper) for past in (0, 0.3)]


every = Runs("every", methods=methods([""], SHAPES), places=sides(0.1, 1.6), when="full")
reduced = Runs("reduced", methods=methods([""]), places=sides(0.1, 1.6), when="quick")
finer = Runs(
    "finer",
    methods=methods([""], RECOMMENDED),
    places=[*sides(0.05, 1.55), *sides(0.025, 1.525)],
    when="full",
)
turned = Runs(
    "turned",
    methods=methods([""]),
    places=[place("h = 0.1 m", 0.1), place("h = 0.05 m", 0.05, upper=1.55, when="full")],
    set={"bodies.block.geometry.angle": math.radians(30.0)},
    binds=["*"],
)


@each(every, reduced, finer)
def test_extremes(run):
    run.gates(
        strain.extremes,
        ("least σ_yy, error, {at}", "least", 0.0, 2.0, "%"),
        ("largest σ_yy, error, {at}", "largest", 0.0, 2.0, "%"),
    )


@turned
def test_turned(run):
    run.gates(
        strain.turned,
        ("mean σ_yy, error, turned by 30°, {at}", "mean", 0.0, 1.0, "%"),
        ("largest error farther than 3 h from sides, turned by 30°, {at}", "far", 0.0, (0.0, 2.0), "%"),
        ("largest error within 3 h of one side, turned by 30°, {at}", "one", 0.0, None, "%"),
        ("largest error within 3 h of two, turned by 30°, {at}", "two", 0.0, None, "%"),
        binds=True,
    )
