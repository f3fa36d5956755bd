"""Functions at the centres of a box's rectangles: the mean of the corners'."""

import numpy as np
import pytest

from mpmfw.runs.simulation import Simulation
from scenes_for_tests import scene_of, solid

H = 0.25


def block(shape="cpdi", angles=(0.0, 0.0, 0.0)):
    """A box of three cells with a pressure on one side."""
    sides = [{"side": "front", "pressure": 1.0}]
    body = solid([0.0] * 3, [3 * H] * 3, 0.5 * H, layout="fitted", segment=0.5 * H, sides=sides)
    body["geometry"]["angles"] = list(angles)
    corners = [-3 * H] * 3, [6 * H] * 3
    return Simulation(scene_of({"block": body}, H, *corners, end=1.0, shape={"method": shape}))


def boundary(sim):
    """Σ V ∇φ, and ∮ N n dA by the surface's table, of every grid node (n, 3) [m²]."""
    state = sim.state
    phi = sim.shape.interpolate(particles=state.particles, grid=state.grid)
    surface = state.surface
    table = sim.shape.interpolate_surface(position=surface.position, first=surface.first, grid=state.grid)
    inner, outer = (np.zeros((int(max(phi.nodes.max(), table.nodes.max())) + 1, 3)) for _ in range(2))
    volume = np.repeat(state.particles.volume, np.diff(phi.row))
    np.add.at(inner, phi.nodes, volume[:, np.newaxis] * phi.gradient)
    a, b, c = (surface.position[surface.facets[:, k]] for k in range(3))
    third = np.cross(b - a, c - a) / 6.0
    for corner in surface.facets.T:
        for facet, s in enumerate(corner):
            row = slice(table.row[s], table.row[s + 1])
            np.add.at(outer, table.nodes[row], table.weight[row, np.newaxis] * third[facet])
    return inner, outer


@pytest.mark.parametrize("angles", [(0.0, 0.0, 0.0), (0.35, 0.61, 0.87)], ids=["along", "turned"])
def test_the_surface_has_the_boundary_of_the_points(angles):
    inner, outer = boundary(block(angles=angles))
    np.testing.assert_allclose(outer, inner, atol=1e-12 * H**2)
