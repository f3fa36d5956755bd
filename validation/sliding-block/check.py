"""Sliding block: the acceleration fitted to the last 80 % of the motion, for every method."""

# cost: 60

from __future__ import annotations

import math

from mpmfw.analysis import fitted_acceleration
from mpmfw.validation import CONTACTS, SHAPES, Case

TILT, FRICTION, GRAVITY = math.radians(30.0), 0.3, 10.0
ACCELERATION = GRAVITY * (math.sin(TILT) - FRICTION * math.cos(TILT))


def check(case: Case) -> None:
    """Run every contact strategy with every shape function."""
    shapes = ("cpdi", "cpdi2") if case.quick else SHAPES
    for method, tree in case.runs(case.methods(CONTACTS, shapes), set={"output.particles": False}):
        series = tree["series"].to_dataset()
        time = series["time"].values
        x = series["centre_of_mass"].sel(body="block", axis="x").values
        fitted = fitted_acceleration(time, x - x[0], 0.2 * time[-1], time[-1])
        error = 100.0 * (fitted / ACCELERATION - 1.0)
        case.judge(method, "fitted acceleration, error", error, within=(-0.5, 0.5), unit="%", reference=0.0)
