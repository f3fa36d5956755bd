"""Stick to slip: the time at which a block under a rising tangential load has slid, for every method.

Friction of [H17] to the letter, at the default step and at a quarter of it; both slide within the first 0.4
s. Over the time of slip, the smaller one of the two: the stricter reading.
"""
# cost: 65

import numpy as np
from common import LITERAL, MASTER, POSITION, specified

from mpmfw.results.stored_scene import scene_of
from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Runs, methods

FRICTION, GRAVITY = 0.3, 10.0  # [1], [m/s²]
LENGTH = 0.6  # of the block [m]
THRESHOLD = 1e-3 * LENGTH  # of sliding [m]


def time_of_slip(run):
    """Return the error of the time at which the threshold is slid, over the time at which slip begins.

    A rigid block sticks until m r t = μ m g, at t_s = μ g / r, and has then slid r (t − t_s)³ / 6."""
    last = scene_of(run.attrs)["gravity"]["table"][-1]
    rate = float(last[1] / last[0])  # of the tangential load per mass [m/s³]
    start = FRICTION * GRAVITY / rate
    expected = start + (6.0 * THRESHOLD / rate) ** (1.0 / 3.0)
    time, slid = run["series"]["time"].values, sliding(run)
    over = np.flatnonzero(slid > THRESHOLD)
    if len(over) == 0:
        return float("nan")
    between = slice(over[0] - 1, over[0] + 1)
    return (float(np.interp(THRESHOLD, slid[between], time[between])) - expected) / start


def sliding(run):
    """Return the mean displacement of the block's lower face over that of the plane below it [m], (time,)."""
    block = run["surface/block"]["position"].values
    plane = run["surface/plane"]["position"].values
    lower = np.isclose(block[0, :, 1], block[0, :, 1].min(), atol=0.01 * LENGTH)
    left, right = block[0, lower, 0].min(), block[0, lower, 0].max()
    upper = np.isclose(plane[0, :, 1], plane[0, :, 1].max(), atol=0.01 * LENGTH)
    upper &= (plane[0, :, 0] >= left) & (plane[0, :, 0] <= right)
    relative = block[:, lower, 0].mean(1) - plane[:, upper, 0].mean(1)
    return np.asarray(relative - relative[0])


SHORT = {**LITERAL, "time.end": 0.6}
CLASSICAL = {
    "criterion position": POSITION,
    "normal master": MASTER,
    "normal specified": specified(0.0, -1.0),
}
STEPS = {
    "": {},
    "literal, step x 1": {**SHORT, "time.safety": 0.5},
    "literal, step x 0.25": {**SHORT, "time.safety": 0.125},
}

block = Runs(
    "block",
    methods=[
        *methods(shape=RECOMMENDED, when="quick"),
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(["bardenhagen"], ["gimp", "cpdi"], CLASSICAL, when="full"),
        *methods(["hamad2017"], settings=STEPS, when="full"),
    ],
    set={"output.particles": False},
    quick={
        "gravity": {"table": [[0.0, 0.0, -10.0], [1.0, 4.5, -10.0]]},
        "time.end": 0.8,
        "time.output_interval": 0.005,
    },
)


@block
def test_block(run):
    time = run.of(time_of_slip, scale=100.0)
    run.gate("time at which 1e-3 of the length is slid, error", time, 0.0, 2.0, "%")
