"""Free expansion at a contact corner: slope of the sides' displacement over the strain, for every method."""
# cost: 100

import numpy as np
from common import MASTER, POSITION

from mpmfw.validation import SHAPES, Place, Runs, each, methods

WIDTH = 10e-3  #: of the block [m]
POISSON = 0.3
#: Free expansion in plane strain: σ_xx = 0, ε_zz = 0, hence ε_xx = −ν/(1 − ν) ε_yy; u of each side over the
#: strain [m].
SLOPE = POISSON * WIDTH / (2.0 * (1.0 - POISSON))
PLACES = {"mid-height": 0.5, "bottom corners": 0.0, "top corners": 1.0}  #: height over that of the block


def errors(run):
    """Return errors of the slope at PLACES [%]."""
    return {place: 100.0 * (slope(run, place) / SLOPE - 1.0) for place in PLACES}


def slope(run, place):
    """Return the outward displacement of both sides over the strain [m], by least squares, through zero, over
    the last 80 %.

    Contact springs take a part of the sides' motion, so the block's strain is measured.
    """
    position = run["surface/block"]["position"].values
    start, moved = position[0], position - position[0]
    (left, bottom), (right, top) = start.min(axis=0), start.max(axis=0)
    below, above = (np.abs(start[:, 1] - y) < 1e-9 for y in (bottom, top))
    strain = (moved[:, below, 1].mean(axis=1) - moved[:, above, 1].mean(axis=1)) / (top - bottom)
    height = bottom + PLACES[place] * (top - bottom)
    outwards = np.zeros(len(position))
    for x, way in ((left, -0.5), (right, 0.5)):
        nodes = np.flatnonzero(np.abs(start[:, 0] - x) < 1e-9)
        nodes = nodes[np.argsort(start[nodes, 1])]
        outwards += way * np.array([np.interp(height, start[nodes, 1], row) for row in moved[:, nodes, 0]])
    chosen = strain > 0.2 * strain[-1]
    strain, outwards = strain[chosen], outwards[chosen]
    return float(strain @ outwards / (strain @ strain))


STRONGER = {"stiffer body's normal": MASTER, "stiffer body's normal, position": {**MASTER, **POSITION}}


def place(at, offset):
    """Return the block ``offset`` cells past −5 mm, with the lower contact 0.13 cells past it."""
    side, below = -0.005 + offset * 0.0005, -0.005 + 0.13 * 0.0005
    above = below + 0.01
    corners = {
        "block": ([side, below], [side + 0.01, above]),
        "bottom": ([-0.008, below - 0.003], [0.008, below]),
        "top": ([-0.008, above], [0.008, above + 0.003]),
    }
    values = {"grid.cell_size": 0.0005}
    for body, (lower, upper) in corners.items():
        values |= {f"bodies.{body}.geometry.lower": lower, f"bodies.{body}.geometry.upper": upper}
    return Place(at, values)


every = Runs(
    "methods",
    methods=[
        *methods(["penalty", "bardenhagen"], SHAPES, when="full"),
        *methods(["bardenhagen"], ["cpdi", "gimp"], STRONGER, when="full"),
        *methods(["none"], SHAPES, when="full"),
        *methods(when="quick"),
    ],
    places=[place("", 0.23)],
)
offsets = Runs(
    "offsets",
    places=[place(f", h = 0.5 mm, side at {offset:g} h", offset) for offset in (0, 0.5, 0.75)],
    when="full",
)


@each(every, offsets)
def test_slopes(run):
    for key in PLACES:
        run.gate(f"slope, {key}, error{run.place.at}", run.of(errors, key), 0.0, 5.0, "%")
