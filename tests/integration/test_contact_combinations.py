"""Every detection with every law: what makes sense works, what makes none is refused with the reason."""

from __future__ import annotations

import pickle
import re

import numpy as np
import pytest

from contact_scenes import impact, run
from mpmfw.contact.surfaces import Surfaces
from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available, choices
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw_contact.penalty import PenaltyLaw

REFUSED = {
    f"{detection}+{law}": f"law '{law}' acts on facets of surfaces, and detection '{detection}' lists none"
    for detection in ("nodes", "logistic", "points")
    for law in ("hamad2017", "hybrid", "barrier")
} | {
    "logistic+penalty": "detection 'logistic' is for laws of impulses: its gap jumps as points come and go",
    **{
        f"{d}+adhesion": f"law 'adhesion' acts on gaps that do not jump, and detection '{d}' lists none"
        for d in ("nodes", "logistic")
    },
    "midplane+barrier": "law 'barrier' acts on surface nodes against facets, and detection 'midplane' lists none",  # noqa: E501
}
COMBINED = [f"{detection}+{law}" for detection in available("detection") for law in available("law")]

MEANT = sorted(set(COMBINED) - set(REFUSED))


def test_every_combination_is_a_choice():
    assert set(COMBINED) == set(choices("contact")) - set(available("contact"))


@pytest.mark.parametrize("name", MEANT)
def test_every_combination_exchanges_equal_impulses_and_records_them(name):
    simulation = Simulation(impact(), contact=name)
    simulation.start()
    motion = run(simulation, 120)
    total = motion.total_momentum
    assert np.abs(total - total[0]).max() < 1e-11 * np.abs(motion.momentum["left"]).max()
    gained = motion.momentum["left"][-1] - motion.momentum["left"][0]
    np.testing.assert_allclose(motion.impulse[:, 0].sum(axis=0), gained, rtol=1e-9, atol=1e-9)
    assert gained[0] < -1.0


@pytest.mark.parametrize(
    ("contact", "said"),
    [
        *REFUSED.items(),
        ("nodes+penalty(criterion=velocity)", '"velocity" measures no gap, which the law needs; expected'),
        ("nodes+penalty(normal=specified, direction=[1, 0])", "measures no area"),
        ("nodes+impulse(cut_off=0.5)", "'cut_off' has no effect with the criterion of velocity"),
        (
            "adhesion(traction=100, separation=0.05, search_radius=0.2)",
            "contact.adhesion.search_radius = 0.2 finds gaps of up to 0.02 m, and law 'adhesion' acts across "
            "gaps of up to 0.05 m; expected at least 0.5",
        ),
        ("points+adhesion(traction=100, separation=0.05)", "detection 'points' finds gaps of up to 0.0125 m"),
        ("barrier(reach=0.3, search_radius=0.2)", "expected at least 0.3"),
    ],
)
def test_what_makes_no_sense_is_refused_with_the_reason(contact, said):
    with pytest.raises(SceneError, match=re.escape(said)):
        Simulation(impact(), contact=contact)


@pytest.mark.parametrize(
    ("published", "combined"),
    [("penalty", "surfaces+penalty"), ("bardenhagen", "nodes+impulse"), ("nairn", "logistic+impulse")],
)
def test_a_published_method_is_its_combination(published, combined):
    positions = []
    for name in (published, combined):
        simulation = Simulation(impact(), contact=name)
        simulation.start()
        run(simulation, 60)
        positions.append(simulation.state.particles.position)
    np.testing.assert_array_equal(*positions)


def test_a_joined_contact_goes_to_another_process():
    scene = load_scene(
        "rolling-cylinder-slip",
        set={"contact.method": "surfaces+penalty", "contact.surfaces+penalty": {"kappa": 2}},
    )
    again = pickle.loads(pickle.dumps(scene))
    assert again.contact.options == scene.contact.options
    assert again.contact.options.model_fields_set == {"kappa"}
    contact = PenaltyLaw.joined_with(Surfaces)(kappa=3.0)
    assert pickle.loads(pickle.dumps(contact)).options == contact.options


@pytest.mark.parametrize(
    ("name", "why"), [("midplane", "plane form of a method for space"), ("barrier", "edges cross edges")]
)
def test_a_method_of_the_plane_says_why_it_refuses_space(name, why):
    scene = load_scene("rolling-sphere-slip", set={"grid.cell_size": 0.8})
    with pytest.raises(SceneError, match=f"'{name}' works in 2D .*{why}.*; the scene's grid is 3D"):
        Simulation(scene, contact=name)


@pytest.mark.parametrize("contact", ["penalty", "adhesion"])
@pytest.mark.parametrize(("scene", "kappa"), [("rolling-cylinder-slip", 4.0), ("rolling-sphere-slip", 1.0)])
def test_springs_have_kappa_by_dimension_unless_one_is_given(contact, scene, kappa):
    for name, expected in ((contact, kappa), (f"{contact}(kappa=2)", 2.0)):
        law = Simulation(load_scene(scene), contact=name).contact
        softest = min(body.p_wave_modulus for body in law.state.bodies)
        assert law.modulus == pytest.approx(expected * softest / law.cell_size)
