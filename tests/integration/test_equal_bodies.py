"""A box set on a moving belt of the same material: the order of the scene's tables must not decide the
drag.
"""

from __future__ import annotations

import pytest

import mpmfw

#: Time at which the box slides still [s], friction and gravity [m/s²].
TIME, MU, GRAVITY = 0.1, 0.2, 10.0


def box_on_belt(order: tuple[str, str]) -> dict[str, object]:
    """The box rests on a belt that moves at 1 m/s, bodies in this order."""
    points = {"size": 0.05}
    bodies = {
        "box": {
            "material": "stiff",
            "geometry": {"type": "rectangle", "lower": [1.0, 0.3], "upper": [1.6, 0.7]},
            "particles": points,
        },
        "belt": {
            "material": "stiff",
            "geometry": {"type": "rectangle", "lower": [0.0, 0.0], "upper": [2.4, 0.3]},
            "particles": points,
            "velocity": [1.0, 0.0],
            "sides": [{"side": "bottom", "velocity": [1.0, 0.0]}],
        },
    }
    return {
        "grid": {"cell_size": 0.1, "lower": [-0.5, -0.5], "upper": [3.5, 1.2]},
        "time": {"end": TIME, "output_interval": 0.01},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": MU},
        "materials": {
            "stiff": {"model": "neo_hookean", "density": 1000, "youngs_modulus": 1e7, "poissons_ratio": 0.3}
        },
        "bodies": {name: bodies[name] for name in order},
        "gravity": {"vector": [0.0, -GRAVITY]},
        "settle": {"tolerance": 0.01},
        "output": {"particles": False, "surface": False},
    }


@pytest.mark.parametrize("order", [("box", "belt"), ("belt", "box")])
@pytest.mark.parametrize(
    "contact", ["bardenhagen(criterion=position, normal=master)", "penalty(passes=one)", "hamad2017"]
)
def test_a_belt_drags_a_box_of_its_material_by_coulombs_law(contact: str, order: tuple[str, str]) -> None:
    run = mpmfw.run(box_on_belt(order), contact=contact)
    speed = float(run["series"]["mean_velocity"].sel(body="box", axis="x")[-1])
    assert speed == pytest.approx(MU * GRAVITY * TIME, rel=0.02)
