"""Adhesion: the force of a place by its gap, its energy, and the pull-off of a flat punch."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from contact_scenes import rectangle, scene
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw_contact.adhesion import energy_of, normal_force, reach_of

K, PULL = 50.0, 2.0  # the spring comes to the pull at 0.04
WIDTH, TRACTION = 0.4, 500.0


@pytest.mark.parametrize(("separation", "reach"), [(0.0, 0.04), (0.03, 0.04), (0.1, 0.1)])
def test_the_energy_is_the_work_of_the_force(separation, reach):
    assert reach_of(K, PULL, separation) == pytest.approx(reach)
    for gap in (-0.02, 0.0, 0.02, 0.05, 0.2):
        breaks = [x for x in (0.0, 0.04, reach) if x > gap]
        work, _ = quad(lambda g: normal_force(K, g, PULL, separation), gap, 1.0, points=breaks, limit=200)
        assert energy_of(K, gap, PULL, separation) == pytest.approx(work, abs=1e-9)
    assert normal_force(K, 0.03, PULL, separation) == pytest.approx(-1.5)
    assert normal_force(K, reach - 1e-6, PULL, separation) == pytest.approx(-PULL, abs=1e-4)
    assert normal_force(K, reach, PULL, separation) == 0.0


def test_the_work_of_adhesion_is_traction_times_separation():
    """But for what the spring takes up to the traction, half of σ_0 g_0."""
    assert energy_of(K, 0.0, PULL, 0.1) == pytest.approx(-PULL * (0.1 - 0.5 * 0.04))


#: The share that a detection may be off: of nodes, those of the ground at the punch's edges bear by whole
#: tributary lengths.
OFF = {"surfaces": 0.04, "midplane": 0.01}


@pytest.mark.parametrize("contact", OFF)
def test_a_flat_punch_is_pulled_off_by_traction_times_area(contact):
    """The upper block is drawn up by its top; the force comes to σ_0 A, and then there is none."""
    blocks = {
        "punch": rectangle(
            [-0.5 * WIDTH, 0.0],
            [0.5 * WIDTH, 0.3],
            velocity=[0.0, 0.0],
            sides=[{"side": "top", "velocity": [0.0, 0.02]}],
        ),
        "ground": rectangle(
            [-0.4, -0.3], [0.4, 0.0], velocity=[0.0, 0.0], sides=[{"side": "bottom", "fixed": True}]
        ),
    }
    mapping = scene(blocks, friction=0.0, output={"particles": False, "gap": False})
    options = {"traction": TRACTION, "separation": 0.003}
    mapping["contact"] = {"detection": contact, "law": "adhesion", "adhesion": options}
    simulation = Simulation(load_scene(mapping))
    simulation.start()
    records, pull, times = simulation.contact.records, [], []
    before = 0.0
    while simulation.state.time < 0.4:
        simulation.step()
        impulse = float(records.impulse[0, 1])
        pull.append((impulse - before) / simulation.state.dt)
        times.append(simulation.state.time)
        before = impulse
    pull = -np.array(pull)
    assert pull.max() == pytest.approx(TRACTION * WIDTH, rel=OFF[contact])
    assert not pull[-20:].any()
    # the force rises in no jump: at half of the way there is some of it
    assert 0.2 < pull[np.searchsorted(times, 0.5 * times[int(pull.argmax())])] / pull.max() < 0.8


def test_a_separation_without_traction_is_refused():
    mapping = scene({"a": rectangle([0.0, 0.0], [0.2, 0.2]), "b": rectangle([0.3, 0.0], [0.5, 0.2])})
    mapping["contact"] = {"method": "adhesion", "adhesion": {"separation": 0.1}}
    with pytest.raises(SceneError, match="no effect without tension"):
        load_scene(mapping)
