"""How much of a given displacement contact springs take, as ``mpmfw explain`` estimates it."""

from __future__ import annotations

from typing import Any

import pytest

from mpmfw.runs.prediction import driven_speed, share_of_springs
from mpmfw.runs.simulation import Simulation

CELL = 0.1


def pressed(contact: str, **options: Any) -> Simulation:
    """A block on another one of four times its modulus, whose top is driven down."""
    materials = {
        name: {"model": "linear_elastic", "density": 1000, "youngs_modulus": young, "poissons_ratio": 0.0}
        for name, young in (("soft", 1e6), ("firm", 4e6))
    }
    driven = {"side": "top", "velocity": ["free", -0.01]}
    bodies = {
        name: {"material": name, "geometry": {"type": "rectangle", "lower": lower, "upper": upper}}
        for name, lower, upper in (
            ("firm", [0.0, -1.0], [1.0, 0.0]),
            ("soft", [0.0, 0.0], [1.0, 0.5]),
        )
    }
    for body in bodies.values():
        body["particles"] = {"size": 0.05}
    bodies["soft"]["sides"] = [driven]
    scene = {
        "grid": {"cell_size": CELL, "lower": [-1.0, -2.0], "upper": [2.0, 2.0]},
        "time": {"end": 0.01, "output_interval": 0.01},
        "shape": {"method": "cpdi"},
        "contact": {"method": contact, **options},
        "materials": materials,
        "bodies": bodies,
    }
    return Simulation(scene)


SOFT = {"penalty": {"kappa": 1.0}}


@pytest.mark.parametrize(
    ("contact", "options", "kappa"), [("penalty", {}, 4.0), ("penalty", SOFT, 1.0), ("adhesion", {}, 4.0)]
)
def test_springs_and_bodies_are_in_series(contact: str, options: dict[str, Any], kappa: float) -> None:
    """h / (κ M) of the softer body's modulus beside L / M of both, along the motion alone."""
    simulation = pressed(contact, **options)
    springs, bodies = CELL / (kappa * 1e6), 0.5 / 1e6 + 1.0 / 4e6
    assert driven_speed(simulation).tolist() == [0.0, 0.01]
    assert share_of_springs(simulation, 1) == pytest.approx(springs / (springs + bodies), rel=1e-12)
    assert share_of_springs(simulation, 0) == 0.0  # the blocks do not press on each other along x
