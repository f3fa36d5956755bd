import numpy as np
import pytest
from square import SCENE

import mpmfw


def test_the_body_falls_with_the_mass_of_its_area():
    egg = {**SCENE["bodies"]["block"], "geometry": {"type": "template", "semi_axes": [0.5, "20 cm"]}}
    series = mpmfw.run({**SCENE, "bodies": {"egg": egg}})["series"]
    momentum = series["linear_momentum"].sel(axis="y").values[-1]
    assert momentum == pytest.approx(-1000.0 * np.pi * 0.5 * 0.2 * 10.0 * 0.01, rel=1e-6)
