"""A smooth rigid cone that is pushed into weightless soil about its axis, against the finest run."""
# cost: 100

import numpy as np
from common import elastic, fixed, polygon, rectangle, scene

from mpmfw.validation import Place, Runs, full, methods, together

#: tan of half the apex angle; radius of the print in level ground at the end [m]; cohesion [Pa].
SLOPE, RADIUS, COHESION = float(np.tan(np.radians(60.0))), 1.0, 1e4
#: Depth at the end [m], speed [m/s], and width and depth of the soil [m].
DEPTH, SPEED, FAR = RADIUS / SLOPE, 0.25, 4.0 * RADIUS
SOIL = elastic(2e3, 300.0 * COHESION, 0.3, "mohr_coulomb", cohesion=COHESION, friction_angle="20 degree")


def pushed(cells):
    """Return the cone over soil with so many ``cells`` in the print's radius at the end."""
    cell, rise = RADIUS / cells, 0.05 * DEPTH / SPEED
    end, top = DEPTH / SPEED + 0.5 * rise, 0.5 * FAR / SLOPE
    motion = {"velocity": [[0.0, 0.0, 0.0], [rise, 0.0, -SPEED], [end, 0.0, -SPEED]]}
    bodies = {
        "soil": rectangle(0.0, -FAR, FAR, 0.0, sides=fixed(bottom="y", right="x")),
        "cone": polygon([[0.0, 0.0], [0.5 * FAR, top], [0.0, top]], rigid={"motion": motion}),
    }
    lower, upper = [0.0, -FAR - 2.0 * cell], [FAR + 4.0 * cell, top + 4.0 * cell]
    more = {"grid": {"axisymmetric": True}, "time": {"outputs": "nearest"}}
    more["output"] = {"particles": False, "surface": False}
    return scene(cell, lower, upper, end, end / 100.0, SOIL, bodies, **more)


indented = Runs(
    "indented",
    scene=pushed,
    methods=methods(),
    places=[
        Place("b/h = 5", make={"cells": 5}),
        Place("b/h = 10", make={"cells": 10}, when="full"),
        Place("b/h = 20", make={"cells": 20}, when="full"),
    ],
)


def resistance(tree):
    """Return F / (π δ² tan² α c), the mean over the second half of the depth δ, and by what the mean over
    the second half of these exceeds that over the first [%]: F ∝ δ², as nothing has a length."""
    series = tree["series"]
    force = series["reaction"].sel(body="cone", axis="y").values
    place = series["centre_of_mass"].sel(body="cone", axis="y").values
    depth = place[0] - place
    factor = force[1:] / (np.pi * (depth[1:] * SLOPE) ** 2 * COHESION)
    late = factor[depth[1:] > 0.5 * DEPTH]
    first, second = np.array_split(late, 2)
    return {"factor": float(late.mean()), "change": 100.0 * float(second.mean() / first.mean() - 1.0)}


@indented
def test_cone(run):
    run.gates(
        resistance,
        ("F / (π b² c), {at}", "factor", 0.0, None),
        ("its change over the depth, {at}", "change", 0.0, 5.0, "%"),
    )


@full
@together(indented)
def test_against_the_finest(case, runs):
    found = {run.place.at: run.of(resistance, "factor") for run in runs}
    finest = found.pop("b/h = 20")
    for at, factor in found.items():
        error = 100.0 * (factor / finest - 1.0)
        case.gate(f"F less the finest's, {at}", error, 0.0, 5.0, "%", method="penalty, cpdi")
