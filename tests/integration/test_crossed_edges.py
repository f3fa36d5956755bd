"""Two bars whose edges meet crosswise: nothing looks for a crossing of edges, and what that leaves to the
nodes.

A ridge along x under a ridge along y, both of a right angle. At depth d of the crossing the node of one ridge
at distance s from it is inside the other bar if s < d: contact begins late by the distance of the nearest
node, at most half a segment."""

from __future__ import annotations

import numpy as np
import pytest

from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene

CELL = 0.25
SEGMENT = 0.5 * CELL
SOFT = {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 12e6, "shear_modulus": 6e6}


def bar(along, centre, speed):
    """A bar of 4 by 1.5 by 1.5 cells along an axis, on its edge."""
    half = np.where(np.arange(3) == along, 2.0 * CELL, 0.75 * CELL)
    angles = [0.0, 0.0, 0.0]
    angles[along] = "45 deg"
    lower, upper = np.subtract(centre, half).tolist(), np.add(centre, half).tolist()
    return {
        "material": "soft",
        "geometry": {"type": "box", "lower": lower, "upper": upper, "angles": angles},
        "particles": {"layout": "fitted", "size": "0.5 cells"},
        "segment": "0.5 cells",
        "velocity": [0.0, 0.0, speed],
    }


def meeting(shift):
    """The upper bar falls on the lower one; the edges cross ``shift`` [m] from a node of either."""
    reach = 0.75 * CELL * np.sqrt(2.0)
    return {
        "grid": {"cell_size": CELL, "lower": [-5 * CELL] * 3, "upper": [5 * CELL] * 3},
        "time": {"end": 1.0, "output_interval": 1.0},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": 0.3},
        "materials": {"soft": SOFT},
        "bodies": {
            "lower": bar(0, [shift, 0.0, 0.02 - reach], 1.0),
            "upper": bar(1, [0.0, shift, 0.021 + reach], -1.0),
        },
    }


def ridges(sim):
    """Nodes of the edges that meet, of the lower bar along x and of the upper one along y."""
    surface = sim.state.surface
    height = surface.position[:, 2]
    lower, upper = (np.arange(len(height))[surface.of(k)] for k in range(2))
    low = lower[height[lower] > height[lower].max() - 1e-6]
    high = upper[height[upper] < height[upper].min() + 1e-6]
    return low[np.argsort(surface.position[low, 0])], high[np.argsort(surface.position[high, 1])]


def depth(sim, low, high):
    """Depth of the crossing of the two ridges [m], as polylines."""
    lower, upper = sim.state.surface.position[low], sim.state.surface.position[high]
    x, y = upper[:, 0].mean(), lower[:, 1].mean()
    return float(np.interp(x, lower[:, 0], lower[:, 2]) - np.interp(y, upper[:, 1], upper[:, 2]))


def crossing(shift):
    """Deepest crossing and that at which contact began [segments], drift of momentum, the upper bar's speed
    in the end [m/s].
    """
    sim = Simulation(load_scene(meeting(shift)))
    low, high = ridges(sim)
    sim.advance(1)
    p = sim.state.particles
    upper = sim.state.bodies[1].particles
    before = p.mass @ np.abs(p.velocity)
    deepest, began = 0.0, None
    for _ in range(400):
        sim.step()
        now = depth(sim, low, high)
        deepest = max(deepest, now)
        if began is None and (sim.contact.rows.gap[: sim.contact.rows.count] < 0.0).any():
            began = now
        if began is not None and p.velocity[upper, 2].mean() > 0.2:
            break
    after = p.mass @ p.velocity
    return deepest / SEGMENT, began / SEGMENT, np.abs(after).max() / before.max(), p.velocity[upper, 2].mean()


@pytest.mark.parametrize("shift", [0.0, 0.25, 0.5])
def test_crossed_edges_are_held_by_the_nodes_that_are_inside(shift):
    deepest, began, drift, speed = crossing(shift * SEGMENT)
    assert shift - 0.15 < began < shift + 0.05
    assert deepest < began + 0.3
    assert speed > 0.2
    assert drift < 1e-12
