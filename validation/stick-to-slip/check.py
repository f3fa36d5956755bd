"""Stick to slip: the time at which a block under a rising tangential load has slid, for every method.

Closed form (Coulomb, rigid block): T = m r t sticks until T = μ N = μ m g, at t_s = μ g / r. From then on the block's
acceleration is r (t − t_s), so it has slid r (t − t_s)³ / 6, and passes the distance s at t_s + (6 s / r)^(1/3).
"""

# cost: 65

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from figure import draw

from mpmfw.validation import CONTACTS, SHAPES, Case, Method

if TYPE_CHECKING:
    import xarray as xr

FRICTION, GRAVITY = 0.3, 10.0  # [1], [m/s²]
LENGTH = 0.6  # of the block [m]
THRESHOLD = 1e-3 * LENGTH  # of sliding [m]
RATE = 1.5  # of the tangential load per mass [m/s³]
QUICK_RATE = 4.5

CLASSICAL = {
    "criterion position": {"contact.bardenhagen.criterion": "position"},
    "normal master": {"contact.bardenhagen.normal": "master"},
    "normal specified": {
        "contact.bardenhagen.normal": "specified",
        "contact.bardenhagen.direction": [0.0, -1.0],
    },
}
#: Friction of [H17] to the letter, at the default step and at a quarter of it; both slide within the first 0.4 s.
LITERAL = {
    f"literal, step x {step:g}": {
        "contact.hamad2017.friction_law": "literal",
        "time.safety": 0.5 * step,
        "time.end": 0.6,
    }
    for step in (1.0, 0.25)
}


def check(case: Case) -> None:
    """Run every contact strategy with every shape function."""
    rate = QUICK_RATE if case.quick else RATE
    shapes = ("cpdi", "cpdi2") if case.quick else SHAPES
    methods = case.methods(("bardenhagen", "penalty") if case.quick else CONTACTS, shapes)
    if not case.quick:
        methods += case.methods(("bardenhagen",), ("gimp", "cpdi"), CLASSICAL)
        methods += case.methods(("hamad2017",), ("cpdi",), {"": {}, **LITERAL})
    values = {"output.particles": False}
    if case.quick:
        load = [[0.0, 0.0, -GRAVITY], [1.0, rate, -GRAVITY]]
        values |= {"gravity": {"table": load}, "time.end": 0.8, "time.output_interval": 0.005}
    results = {}
    for method, tree in case.runs(methods, set=values):
        _judge(case, method, tree, rate)
        results[method] = (tree["series"].to_dataset(), sliding(tree))
    case.figure("", draw(results, rate, FRICTION, GRAVITY, LENGTH))


def sliding(tree: xr.DataTree) -> np.ndarray:
    """Mean tangential displacement of the block's lower face over that of the plane's face below it [m], (time,)."""
    block = tree["surface/block"]["position"].values
    plane = tree["surface/plane"]["position"].values
    lower = np.isclose(block[0, :, 1], block[0, :, 1].min(), atol=0.01 * LENGTH)
    left, right = block[0, lower, 0].min(), block[0, lower, 0].max()
    upper = np.isclose(plane[0, :, 1], plane[0, :, 1].max(), atol=0.01 * LENGTH)
    upper &= (plane[0, :, 0] >= left) & (plane[0, :, 0] <= right)
    relative = block[:, lower, 0].mean(1) - plane[:, upper, 0].mean(1)
    return np.asarray(relative - relative[0])


def _judge(case: Case, method: Method, tree: xr.DataTree, rate: float) -> None:
    series = tree["series"].to_dataset()
    time, slid = series["time"].values, sliding(tree)
    start = FRICTION * GRAVITY / rate
    expected = start + (6.0 * THRESHOLD / rate) ** (1.0 / 3.0)
    found = _passes(time, slid)
    # Over the time of slip, the smaller one of the two: the stricter reading.
    case.judge(
        method,
        "time at which 1e-3 of the length is slid, error",
        100.0 * (found - expected) / start,
        within=(-2.0, 2.0),
        unit="%",
        reference=0.0,
    )
    if time[-1] < start:
        return
    before = 100.0 * float(np.interp(0.9 * start, time, slid)) / THRESHOLD
    case.show("slid at 0.9 of the slip load / threshold", before, unit="%", method=method, reference=0.0)
    if "contact_force" in series:
        force = series["contact_force"].sel(pair="block-plane").values[time >= time[-1] - 0.05].mean(0)
        case.show("T / N at the end", -force[0] / force[1], method=method, reference=FRICTION)


def _passes(time: np.ndarray, slid: np.ndarray) -> float:
    """When the threshold is exceeded first, linear between outputs [s]; NaN if it is not."""
    over = np.flatnonzero(slid > THRESHOLD)
    if len(over) == 0:
        return float("nan")
    k = over[0]
    return float(np.interp(THRESHOLD, slid[k - 1 : k + 1], time[k - 1 : k + 1]))
