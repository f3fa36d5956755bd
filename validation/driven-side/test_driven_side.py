"""Driven side: σ_yy of uniaxial strain in a block that its sides press together, wherever they lie in a cell.

Turned by 30°: mean, and extremes far from sides. Closed form: Neo-Hookean (`split`) at F = diag(1, 1 − ε).
"""
# cost: 60

import math

import numpy as np

from mpmfw.validation import RECOMMENDED, SHAPES, Place, Runs, each, methods

BULK, SHEAR, STRAIN = 12e6, 6e6, 0.1  # Pa, Pa, 1: as in scene.toml
TURN = math.radians(30.0)
CENTRE = 0.5  # m


def exact():
    """σ_yy [Pa] at the last strain."""
    j = 1.0 - STRAIN
    return 0.5 * BULK * (j - 1.0 / j) + SHEAR * j ** (-5.0 / 3.0) * (j * j - (2.0 + j * j) / 3.0)


def stress(tree, angle=0.0):
    """Stress across the driven side over its closed form, at every point at the end."""
    n = np.array([-math.sin(angle), math.cos(angle)])
    found = tree["particles/block"]["stress"].isel(time=-1).values
    return np.asarray(np.einsum("d,pde,e->p", n, found, n) / exact())


def extremes(tree):
    """Errors of the ``least`` and ``largest`` σ_yy [%]."""
    found = 100.0 * (stress(tree) - 1.0)
    return {"least": float(found.min()), "largest": float(found.max())}


def errors_of_turned(tree):
    """Return errors of σ_yy in the turned block [%]: ``mean``, and the largest ``far`` from sides, and within
    three cells of ``two``."""
    found = 100.0 * (stress(tree, TURN) - 1.0)
    begin = tree["particles/block"]["position"].isel(time=0).values - CENTRE
    c, s = math.cos(TURN), math.sin(TURN)
    # Distance from the nearer of two opposite sides
    inside = 0.5 - np.abs(begin @ np.array([[c, -s], [s, c]]))
    near = (inside < 3.0 * float(tree.attrs["cell_size"])).sum(axis=1)
    far, two = (float(np.abs(found[near == count]).max()) for count in (0, 2))
    return {"mean": float(found.mean()), "far": far, "two": two}


def place(at, size, past=0.3, upper=1.6, when=""):
    """Return a grid whose lines are ``past`` cells before the sides."""
    lower, upper = round(-0.5 - past * size, 4), round(upper - past * size, 4)
    grid = {"grid.cell_size": size, "grid.lower": [lower, lower], "grid.upper": [upper, upper]}
    return Place(at, grid, when=when)


def sides(size, upper):
    """Return sides on the grid's lines, and 0.3 cells past one."""
    return [place(f"h = {size} m, sides at {past:g} h", size, past, upper) for past in (0, 0.3)]


every = Runs(
    "every",
    methods=[*methods([""], SHAPES, when="full"), *methods([""], when="quick")],
    places=sides(0.1, 1.6),
)
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


@each(every, finer)
def test_extremes(run):
    run.gates(
        extremes,
        ("least σ_yy, error, {at}", "least", 0.0, 2.0, "%"),
        ("largest σ_yy, error, {at}", "largest", 0.0, 2.0, "%"),
    )


@turned
def test_turned(run):
    run.gates(
        errors_of_turned,
        ("mean σ_yy, error, turned by 30°, {at}", "mean", 0.0, 1.0, "%"),
        ("largest error farther than 3 h from sides, turned by 30°, {at}", "far", 0.0, (0.0, 2.0), "%"),
        ("largest error within 3 h of two, turned by 30°, {at}", "two", 0.0, None, "%"),
        binds=True,
    )
