"""The surface layer's inertia keeps linear momentum, moves with its body, and reaches every projection."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mpmfw.runs.simulation import Simulation

THICKNESS = 0.02


def two_discs(**stepping: Any) -> dict[str, Any]:
    """Two discs apart, one of them moving: contact is named and never acts."""
    soft = {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 6e6, "shear_modulus": 3e6}
    body = {"material": "soft", "particles": {"layout": "fitted", "size": 0.1}, "segment": 0.1}
    return {
        "grid": {"cell_size": 0.2, "lower": [-3.0, -2.0], "upper": [4.0, 2.0]},
        "time": {"end": 0.1, "output_interval": 0.1},
        "stepping": stepping,
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "penalty": {"interface_thickness": THICKNESS}},
        "materials": {"soft": soft},
        "bodies": {
            "left": {
                **body,
                "geometry": {"type": "disc", "centre": [-1.0, 0.03], "radius": 0.6},
                "velocity": [1.0, 0.5],
            },
            "right": {**body, "geometry": {"type": "disc", "centre": [2.0, 0.0], "radius": 0.6}},
        },
    }


@pytest.mark.parametrize("scheme", ["usl", "musl", "usf"])
def test_a_moving_body_with_a_layer_is_not_strained(scheme: str) -> None:
    sim = Simulation(two_discs(scheme=scheme))
    sim.advance(20)
    strain = np.abs(sim.state.particles.deformation_gradient - np.eye(2)).max()
    assert strain < 1e-12


@pytest.mark.parametrize("transfer", ["flip", "pic", "aflip"])
def test_points_and_layer_keep_linear_momentum_while_the_body_vibrates(transfer: str) -> None:
    sim = Simulation(two_discs(scheme="usl", transfer=transfer))
    sim.start()
    p, layer = sim.state.particles, sim.manager.get_plugin("surface_layer")
    own = sim.state.bodies[0].particles
    p.deformation_gradient[own] = np.diag([1.02, 0.99])  # it springs back
    sim.step(1e-6)

    def momentum() -> np.ndarray:
        return np.asarray(p.mass @ p.velocity + layer.mass @ layer.velocity)

    before = momentum()
    sim.advance(50)
    scale = float(p.mass[own].sum())
    assert np.abs(p.velocity[own] - p.velocity[own].mean(axis=0)).max() > 0.1
    np.testing.assert_allclose(momentum() / scale, before / scale, atol=1e-13)


def test_rotational_inertia_is_left_lumped_beside_a_layer() -> None:
    effects = {effect.name: effect for effect in Simulation(two_discs()).effects}
    assert "adds inertia" in effects["rotation of left: lumped"].reason
