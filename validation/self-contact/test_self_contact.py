"""Self-contact: arms that are pressed together or snap, and a ring that folds, bear what two bodies bear."""
# cost: 110

from functools import partial

import numpy as np
from common import disc, elastic, polygon, scene

import mpmfw
from mpmfw.validation import Place, Runs, each, methods

#: Lengths in thicknesses of an arm: of an arm, of the back along it, of the pad at its end, of the gap.
LONG, BACK, PAD, GAP = 5.0, 1.0, 1.25, 0.75
ARM, CLOSES, END = 0.4, 0.35, 0.8  #: thickness [m], way of the pads towards each other [m], time [s]
SNAP = 5e3  #: pressure on the pads of arms that snap [Pa]


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


def arms(cells, joined=True, snap=None):
    """Return arms of so many ``cells`` across; not ``joined`` they are tied to a piece of the back.

    A pressure ``snap`` [Pa] on the pads throws them together within 0.11 s; without it pads are driven."""
    half, speed = 0.5 * GAP * ARM, 0.5 * CLOSES / END

    def body(outline, *sides, **keys):
        return polygon(outline, rotation="lumped", sides=sides, **keys)

    down, up = {"side": "top", "velocity": [0.0, -speed]}, {"side": "bottom", "velocity": [0.0, speed]}
    if snap is not None:
        down, up = ({"side": side, "pressure": [[0.1, snap], [0.11, 0.0]]} for side in ("top", "bottom"))
    pairs, whole = {}, upper(0.0)[1:]
    if joined:
        bodies = {"arms": body([*whole, *mirrored(whole)], up, down, self_contact=True)}
    else:
        arm, middle = upper(half), [[0.0, -half], [BACK * ARM, -half], [BACK * ARM, half], [0.0, half]]
        bodies = {"low": body(mirrored(arm), up), "high": body(arm, down), "back": body(middle)}
        pairs = {"pairs": {f"{name}-back": {"method": "tied"} for name in ("low", "high")}}
    box, output = ([-0.6, -1.6], [2.6, 1.6]), {"particles": False}
    return scene(ARM / cells, *box, END, 0.04, rubber(5), bodies, contact=pairs, output=output)


def rubber(milliseconds):
    """Return rubber with as much damping."""
    time = f"{milliseconds:g} ms"
    return elastic(1000.0, 1e6, 0.3, "neo_hookean", damping={"bulk": time, "shear": time})


def ring(cells, joined=True, radius=0.5, thick=0.15, way=0.8):
    """Return a ring that two rigid discs fold until it touches itself; not ``joined`` it is tied of arcs."""

    def arc(first, last, **keys):
        angle = np.radians(np.linspace(first, last, round((last - first) / 4.0) + 1))
        ray = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return polygon([*(radius * ray), *((radius - thick) * ray[::-1])], **keys)

    bodies, pairs = {}, {}
    if joined:
        whole = {"type": "ring", "centre": [0.0, 0.0], "inner_radius": radius - thick, "outer_radius": radius}
        bodies = {"ring": {"geometry": whole, "self_contact": True}}
    else:
        for name, middle, half in (("low", 270, 70), ("high", 90, 70), ("left", 180, 20), ("right", 0, 20)):
            bodies[name] = arc(middle - half, middle + half)
        pairs = {
            "pairs": {f"{a}-{b}": {"method": "tied"} for a in ("low", "high") for b in ("left", "right")}
        }
    bodies = {name: {"rotation": "lumped", **body} for name, body in bodies.items()}
    for name, sign in (("top", 1.0), ("bottom", -1.0)):
        pushes = {"motion": {"velocity": [0.0, -0.5 * sign * way / END]}}
        bodies[name] = disc(0.0, sign * (radius + 0.2), 0.2, segment=0.01, rigid=pushes)
    box, output = ([-1.0, -1.0], [1.0, 1.0]), {"particles": False}
    return scene(thick / cells, *box, END, 0.02, rubber(0.5), bodies, contact=pairs, output=output)


def compare(joined, apart):
    """Return what contact of one body differs in from that of tied bodies, the scene ``apart``.

    ``force``: mean over the last third of the time in which they touch [%]; ``gap``: mean from half of the
    way on [cells]; ``early``: largest force before the tied ones touch, over the largest of all [%]."""
    given = joined.to_mapping()
    h = given["grid"]["cell_size"]
    apart = {**apart, "shape": given["shape"]}
    apart["contact"]["method"] = given["contact"]["method"]
    one, tied = (mpmfw.run(each)["series"].to_dataset() for each in (joined, apart))
    one, tied = one.isel(pair=0), tied.sel(pair="low-high")
    first, second = (np.abs(each["contact_force"].sel(axis="y").values) for each in (one, tied))
    gaps = [each["min_gap"].values[len(first) // 2 :] / h for each in (one, tied)]
    touching = np.flatnonzero(second > 0.0)
    late = touching[2 * len(touching) // 3 :]
    return {
        "force": 100.0 * float(first[late].sum() / second[late].sum() - 1.0),
        "gap": float(np.abs(np.minimum(gaps[1], gaps[0].max()) - gaps[0]).mean()),
        "early": 100.0 * float(first[: touching[0]].max() / first.max()),
    }


LAWS = methods(["penalty", "lcp"], bound=True)
pressed = Runs(
    "pressed",
    arms,
    LAWS + methods(shape=["gimp", "bspline"], bound=True, when="full"),
    [Place("arm/h = 4", make={"cells": 4})],
    by=lambda scene: compare(scene, arms(4, joined=False)),
)
fine = Runs(
    "fine",
    arms,
    places=[Place("arm/h = 8", make={"cells": 8}, when="full")],
    by=lambda scene: compare(scene, arms(8, joined=False)),
)
snaps = Runs(
    "snap",
    partial(arms, snap=SNAP),
    LAWS,
    [Place("arms that snap", make={"cells": 4}, when="full")],
    by=lambda scene: compare(scene, arms(4, joined=False, snap=SNAP)),
)
folds = Runs(
    "ring",
    ring,
    LAWS,
    [Place("ring that folds", make={"cells": 4}, when="full")],
    by=lambda scene: compare(scene, ring(4, joined=False)),
)


@each(pressed, fine, snaps, folds)
def test_pressed(run):
    for quantity, key, limit, unit in (
        ("contact force", "force", 2.0, "%"),
        ("gap, mean difference", "gap", 0.02, "cells"),
        ("force before they touch", "early", 0.5, "%"),
    ):
        run.gate(f"{quantity}, {run.place.at}", run.of(dict, key), 0.0, limit, unit)
