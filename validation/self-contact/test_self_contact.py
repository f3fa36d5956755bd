"""Self-contact: two arms of one body that are pressed together bear what the arms of two bodies bear."""
# cost: 60

import numpy as np
from common import elastic, polygon, scene

import mpmfw
from mpmfw.validation import Place, Runs, each, methods

#: Lengths in thicknesses of an arm: of an arm, of the back along it, of the pad at its end, of the gap.
LONG, BACK, PAD, GAP = 5.0, 1.0, 1.25, 0.75
ARM, CLOSES, END = 0.4, 0.35, 0.8  #: thickness [m], way of the pads towards each other [m], time [s]


def upper(foot):
    """Return the outline of the upper arm from ``foot`` on [m], with its part of the back."""
    half, top, pad = 0.5 * GAP * ARM, (0.5 * GAP + 1.0) * ARM, (0.5 * GAP + 1.5) * ARM
    length, back, start = LONG * ARM, BACK * ARM, (LONG - PAD) * ARM
    corners = [[0.0, foot], [back, foot], [back, half], [length, half], [length, pad], [start, pad]]
    distinct = [place for k, place in enumerate(corners) if k == 0 or place != corners[k - 1]]
    return [*distinct, [start, top], [0.0, top]]


def mirrored(outline):
    """Return an outline on the other side of y = 0."""
    return [[x, -y] for x, y in outline[::-1]]


def arms(cells, joined=True):
    """Return arms of so many ``cells`` across; not ``joined`` they are tied to a piece of the back."""
    half, speed = 0.5 * GAP * ARM, 0.5 * CLOSES / END

    def body(outline, *sides, **keys):
        return polygon(outline, rotation="lumped", sides=sides, **keys)

    down, up = {"side": "top", "velocity": [0.0, -speed]}, {"side": "bottom", "velocity": [0.0, speed]}
    pairs, whole = {}, upper(0.0)[1:]
    if joined:
        bodies = {"arms": body([*whole, *mirrored(whole)], up, down, self_contact=True)}
    else:
        arm, middle = upper(half), [[0.0, -half], [BACK * ARM, -half], [BACK * ARM, half], [0.0, half]]
        bodies = {"low": body(mirrored(arm), up), "high": body(arm, down), "back": body(middle)}
        pairs = {"pairs": {f"{name}-back": {"method": "tied"} for name in ("low", "high")}}
    soft = elastic(1000.0, 1e6, 0.3, "neo_hookean", damping={"bulk": "5 ms", "shear": "5 ms"})
    box, output = ([-0.6, -1.6], [2.6, 1.6]), {"particles": False}
    return scene(ARM / cells, *box, END, 0.04, soft, bodies, contact=pairs, output=output)


def compare(joined):
    """Return what contact of one body differs in from that of tied bodies.

    ``force``: mean over the last third of the time in which they touch [%]; ``gap``: mean from half of the
    way on [cells]; ``early``: largest force before the tied ones touch, over the largest of all [%]."""
    given = joined.to_mapping()
    h = given["grid"]["cell_size"]
    apart = arms(round(ARM / h), joined=False)
    apart["contact"]["method"] = given["contact"]["method"]
    apart["shape"] = given["shape"]
    one, tied = (mpmfw.run(each)["series"].to_dataset() for each in (joined, apart))
    tied = tied.sel(pair="low-high")
    first, second = (np.abs(each["contact_force"].sel(axis="y").values.ravel()) for each in (one, tied))
    gaps = [each["min_gap"].values.ravel()[len(first) // 2 :] / h for each in (one, tied)]
    touching = np.flatnonzero(second > 0.0)
    late = touching[2 * len(touching) // 3 :]
    return {
        "force": 100.0 * float(first[late].sum() / second[late].sum() - 1.0),
        "gap": float(np.abs(np.minimum(gaps[1], gaps[0].max()) - gaps[0]).mean()),
        "early": 100.0 * float(first[: touching[0]].max() / first.max()),
    }


pressed = Runs(
    "pressed",
    arms,
    methods(["penalty", "lcp"], bound=True) + methods(shape=["gimp", "bspline"], bound=True, when="full"),
    [Place("arm/h = 4", make={"cells": 4})],
    by=compare,
)
fine = Runs("fine", arms, places=[Place("arm/h = 8", make={"cells": 8}, when="full")], by=compare)


@each(pressed, fine)
def test_pressed(run):
    for quantity, key, limit, unit in (
        ("contact force", "force", 2.0, "%"),
        ("gap, mean difference", "gap", 0.02, "cells"),
        ("force before they touch", "early", 0.5, "%"),
    ):
        run.gate(f"{quantity}, {run.place.at}", run.of(dict, key), 0.0, limit, unit)
