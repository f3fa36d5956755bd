"""A smooth wall that holds soil, gives way to it, or pushes it: Rankine's and Coulomb's pressures."""
# cost: 40

import numpy as np
from common import elastic, fixed, rectangle, scene

from mpmfw.validation import Place, Runs, methods

HEIGHT, DENSITY, GRAVITY, FRICTION = 2.0, 2e3, 10.0, np.radians(30.0)
#: Horizontal over vertical stress of Rankine's states, and at rest.
ACTIVE = float((1.0 - np.sin(FRICTION)) / (1.0 + np.sin(FRICTION)))
RATIOS = {"at rest": 0.5, "active": ACTIVE, "passive": 1.0 / ACTIVE}
#: Speed of the wall [m/s], out of the soil, and for how long it moves [s].
SPEEDS = {"at rest": (0.0, 0.1), "active": (-0.02, 0.6), "passive": (0.1, 0.9)}
WIDTH = 3.0  #: of the soil, all of which comes into Rankine's state [m]


def smooth(state, cells):
    """Return soil so many ``cells`` deep on a smooth floor, between a smooth moving wall and one at rest."""
    (speed, end), cell = SPEEDS[state], HEIGHT / cells
    yields = {"friction_angle": float(FRICTION), "damping": {"critical": 0.01, "frequency": 10.0}}
    sides = [*fixed(bottom="y", right="x"), {"side": "left", "velocity": [speed, "free"]}]
    begins = {"initial_stress": {"k0": RATIOS["at rest"]}, "sides": sides}
    bodies = {"soil": rectangle(0.0, 0.0, WIDTH, HEIGHT, **begins)}
    return scene(
        *(cell, [-4.0 * cell, -4.0 * cell], [WIDTH + 4.0 * cell, 1.5 * HEIGHT], end, end / 60.0),
        *(elastic(DENSITY, 1e7, 0.3, "mohr_coulomb", **yields), bodies),
        time={"outputs": "nearest"},
        contact=None,
        gravity={"vector": [0.0, -GRAVITY]},
        output={"particles": False, "surface": False},
    )


def rough(cells, angle, volumetric="auto"):
    """Return the soil on a floor as rough as the soil, against a wall of the wall friction ``angle``
    [degrees] that gives way."""
    made, cell, speed = smooth("active", cells), HEIGHT / cells, SPEEDS["active"][0]
    made["time"] = {"end": 1.0, "output_interval": 0.02, "outputs": "nearest"}
    made["grid"]["lower"] = [-6.0 * cell, -4.0 * cell]
    made["bodies"]["soil"] |= {"sides": fixed(right="x"), "volumetric": volumetric}
    moving = {"motion": {"velocity": [[0.0, 0.0, 0.0], [0.1, speed, 0.0], [1.0, speed, 0.0]]}}
    made["bodies"] |= {
        "wall": rectangle(-3.0 * cell, 1e-6, 0.0, 1.3 * HEIGHT, rigid=moving),
        "floor": rectangle(-4.0 * cell, -3.0 * cell, WIDTH + 3.0 * cell, 0.0, rigid=True),
    }
    friction = {"soil-wall": float(np.tan(np.radians(angle))), "soil-floor": float(np.tan(FRICTION))}
    pairs = {pair: {"friction": value} for pair, value in friction.items()}
    return made | {"contact": {"method": "penalty", "pairs": pairs}, "settle": {"tolerance": 1e-3}}


def coulomb(tree, angle):
    """Return the error [%] of the wall's mean ``force`` over the last third against Coulomb's K_a cos δ ρ g
    H²/2, δ the ``angle`` [degrees], and how far friction over pressure is from tan δ [%], ``friction``."""
    force = tree["series"]["reaction"].sel(body="wall").values
    late, delta = np.abs(force[2 * len(force) // 3 :].mean(axis=0)), np.radians(angle)
    root = np.sqrt(np.sin(FRICTION + delta) * np.sin(FRICTION) / np.cos(delta))
    exact = (np.cos(FRICTION) / (1.0 + root)) ** 2 * 0.5 * DENSITY * GRAVITY * HEIGHT**2
    return {
        "force": 100.0 * float(late[0] / exact - 1.0),
        "friction": 100.0 * float(late[1] / late[0] / np.tan(delta) - 1.0),
    }


def pressure(tree, state):
    """Return the error [%] of the wall's mean ``force`` over the last third, when the soil yields, against
    K ρ g H²/2, and how far it ``varies`` there [%].

    H is that of soil that keeps its volume between the walls."""
    series = tree["series"]["side_reaction"].sel(side="soil-left", axis="x")
    force, moved = series.values[1:], SPEEDS[state][0] * series["time"].values[1:]
    share = force / (0.5 * DENSITY * GRAVITY * (HEIGHT * WIDTH / (WIDTH - moved)) ** 2)
    late = share[2 * len(share) // 3 :]
    return {
        "force": 100.0 * float(late.mean() / RATIOS[state] - 1.0),
        "varies": 100.0 * float(np.ptp(late) / late.mean()),
    }


wall = Runs(
    "wall",
    smooth,
    [*methods([""]), *methods([""], ["gimp", "bspline"], when="full")],
    [
        *(Place(f"{state}, H/h = 8", make={"state": state, "cells": 8}) for state in RATIOS),
        Place("active, H/h = 16", make={"state": "active", "cells": 16}, when="full"),
        Place("passive, H/h = 16", make={"state": "passive", "cells": 16}, when="full"),
    ],
)
#: Each point keeps its volume, and the soil locks.
LOCKS = {"make": {"cells": 16, "angle": 20.0, "volumetric": "pointwise"}, "open": {"force": "the soil locks"}}
against_rough = Runs(
    "rough",
    rough,
    places=[
        Place("δ = 20°, H/h = 16", make={"cells": 16, "angle": 20.0}),
        Place("δ = 10°, H/h = 16", make={"cells": 16, "angle": 10.0}, when="full"),
        Place("δ = 20°, H/h = 16, pointwise", when="full", **LOCKS),
    ],
)


@against_rough
def test_rough(run):
    at, angle = run.place.at, run.place.make["angle"]
    force, friction = (run.of(coulomb, key, angle=angle) for key in ("force", "friction"))
    run.gate(f"force on the rough wall against Coulomb, error, {at}", force, 0.0, 5.0, "%", key="force")
    run.gate(f"friction over pressure against tan δ, error, {at}", friction, 0.0, 1.0, "%")


@wall
def test_wall(run):
    state = run.place.make["state"]
    error, change = (0.1, 0.1) if state == "at rest" else (3.0, 10.0)
    run.gates(
        pressure,
        ("force on the wall, error, {at}", "force", 0.0, error, "%"),
        ("change of the force over the last third, {at}", "varies", 0.0, change, "%"),
        binds=run.method.matches("cpdi"),
        state=state,
    )
