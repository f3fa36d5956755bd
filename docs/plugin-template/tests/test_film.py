# tests/test_film.py
import numpy as np
import pytest

import mpmfw
from mpmfw_testing import contact_conformance


@contact_conformance("nodes+film")
def test_conformance(check):
    check()


@pytest.mark.parametrize("contact", ["nodes+film(normal=master, resistance=600)"])
def test_the_film_slows_a_block_as_its_closed_form_says(contact):
    settings = {"contact.friction": 0.0, "time.end": 0.3, "output.particles": False}
    series = mpmfw.run("sliding-block", contact=contact, set=settings)["series"]
    speed = series["mean_velocity"].sel(body="block", axis="x").values
    decay = 1000.0 * 0.3 / 600.0
    exact = 5.0 * decay * (1.0 - np.exp(-series["time"].values / decay))
    assert np.abs(speed - exact).max() < 0.01 * exact[-1]
