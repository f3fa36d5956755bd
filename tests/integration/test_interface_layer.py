"""The surface layer's inertia keeps linear momentum, moves with its body, and reaches every projection."""

import numpy as np
import pytest

from mpmfw.runs.simulation import Simulation
from scenes_for_tests import disc

THICKNESS = 0.02


def two_discs(**stepping):
    """Two discs apart, one of them moving: contact is named and never acts."""
    layer = {"method": "penalty", "penalty": {"interface_thickness": THICKNESS}}
    scene = disc("fitted", stepping=stepping, contact=layer, bodies__solid__velocity=[1.0, 0.5])
    other = {"type": "disc", "centre": [4.0, 0.0], "radius": 1.0}
    scene["bodies"]["right"] = {**scene["bodies"]["solid"], "geometry": other, "velocity": [0.0, 0.0]}
    scene["grid"]["upper"] = [6.0, 2.0]
    return scene


@pytest.mark.parametrize("scheme", ["usl", "musl", "usf"])
def test_a_moving_body_with_a_layer_is_not_strained(scheme):
    sim = Simulation(two_discs(scheme=scheme))
    sim.advance(20)
    strain = np.abs(sim.state.particles.deformation_gradient - np.eye(2)).max()
    assert strain < 1e-12


@pytest.mark.parametrize("transfer", ["pic", "aflip"])
def test_points_and_layer_keep_linear_momentum_while_the_body_vibrates(transfer):
    sim = Simulation(two_discs(scheme="usl", transfer=transfer))
    sim.start()
    p, layer = sim.state.particles, sim.manager.get_plugin("surface_layer")
    own = sim.state.bodies[0].particles
    p.deformation_gradient[own] = np.diag([1.02, 0.99])  # it springs back
    sim.step(1e-6)

    def momentum():
        return np.asarray(p.mass @ p.velocity + layer.mass @ layer.velocity)

    before = momentum()
    sim.advance(50)
    scale = float(p.mass[own].sum())
    assert np.abs(p.velocity[own] - p.velocity[own].mean(axis=0)).max() > 0.1
    np.testing.assert_allclose(momentum() / scale, before / scale, atol=1e-13)
