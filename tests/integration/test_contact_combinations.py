"""Every detection with every law: what makes sense runs the rolling cylinder, what makes none is refused with
the reason.
"""

from __future__ import annotations

import pickle
import warnings

import numpy as np
import pytest

from contact_scenes import impact, run
from mpmfw.contact.surfaces import Surfaces
from mpmfw.errors import ResultsWarning, SceneError
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

#: Bounds of the error of the fitted acceleration of the slipping cylinder in its first half second [%].
SLIPPING = {
    "nodes+impulse": (-20.0, -5.0),  # averaged normals hold the cylinder back
    "nodes+penalty": (-6.0, 1.0),
    "nodes+lcp": (-20.0, -5.0),  # as with impulses
    "logistic+impulse": (-6.0, 1.0),
    "logistic+lcp": (-6.0, 1.0),
    "points+impulse": (-35.0, -10.0),
    "points+lcp": (-35.0, -10.0),
    "points+penalty": (-35.0, -10.0),
    "points+adhesion": (-35.0, -10.0),
    "midplane+adhesion": (-3.0, 1.0),
    "midplane+hamad2017": (-3.0, 1.0),
    "midplane+hybrid": (-10.0, 1.0),  # the cap of a row is that of an overlap that comes and goes
    "midplane+impulse": (-3.0, 1.0),
    "midplane+lcp": (-3.0, 1.0),
    "midplane+penalty": (-3.0, 1.0),
    "surfaces+adhesion": (-3.0, 1.0),
    "surfaces+barrier": (-3.0, 1.0),
    "surfaces+hamad2017": (-3.0, 1.0),
    "surfaces+hybrid": (-3.0, 1.0),
    "surfaces+impulse": (-3.0, 1.0),
    "surfaces+lcp": (-3.0, 1.0),
    "surfaces+penalty": (-3.0, 1.0),
}


def test_the_table_has_every_combination():
    assert set(SLIPPING) | set(REFUSED) == set(COMBINED)
    assert set(COMBINED) == set(choices("contact")) - set(available("contact"))


@pytest.mark.parametrize("name", SLIPPING)
def test_every_combination_that_makes_sense_rolls_the_cylinder(name):
    changes = {"time.end": 0.5, "output.gap": False, "output.particles": False, "settle.max_time": 1.0}
    simulation = Simulation(load_scene("rolling-cylinder-slip", set=changes), contact=name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultsWarning)  # the settling is cut short
        simulation.start()
    p, own = simulation.state.particles, simulation.state.bodies[0].particles
    time, speed = [], []
    while simulation.state.time < 0.5:
        simulation.step()
        time.append(simulation.state.time)
        speed.append(np.average(p.velocity[own, 0], weights=p.mass[own]))
    late = len(time) // 5
    exact = 10.0 * (np.sin(np.pi / 3.0) - 0.286 * np.cos(np.pi / 3.0))
    error = 100.0 * (np.polyfit(time[late:], speed[late:], 1)[0] / exact - 1.0)
    low, high = SLIPPING[name]
    assert low < error < high


@pytest.mark.parametrize("name", SLIPPING)
def test_every_combination_exchanges_equal_impulses_and_records_them(name):
    simulation = Simulation(impact(), contact=name)
    simulation.start()
    motion = run(simulation, 120)
    total = motion.total_momentum
    assert np.abs(total - total[0]).max() < 1e-11 * np.abs(motion.momentum["left"]).max()
    gained = motion.momentum["left"][-1] - motion.momentum["left"][0]
    np.testing.assert_allclose(motion.impulse[:, 0].sum(axis=0), gained, rtol=1e-9, atol=1e-9)
    assert gained[0] < -1.0


@pytest.mark.parametrize("name", REFUSED)
def test_what_makes_no_sense_is_refused_with_the_reason(name):
    with pytest.raises(SceneError) as caught:
        Simulation(impact(), contact=name)
    assert REFUSED[name] in str(caught.value)


@pytest.mark.parametrize(
    ("published", "combined"),
    [
        ("penalty", "surfaces+penalty"),
        ("bardenhagen", "nodes+impulse"),
        ("nairn", "logistic+impulse"),
        ("lcp", "surfaces+lcp"),
        ("hybrid", "surfaces+hybrid"),
        ("barrier", "surfaces+barrier"),
        ("midplane", "midplane+hamad2017"),
        ("adhesion", "surfaces+adhesion"),
        ("impulse", "surfaces+impulse"),
    ],
)
def test_a_published_method_is_its_combination(published, combined):
    positions = []
    for name in (published, combined):
        simulation = Simulation(impact(), contact=name)
        simulation.start()
        run(simulation, 60)
        positions.append(simulation.state.particles.position)
    np.testing.assert_array_equal(*positions)


def test_options_of_both_parts_are_the_combination_s():
    contact = Simulation(impact(), contact="nodes+penalty(kappa=2, cut_off=0.7)").contact
    assert (contact.law.options.kappa, contact.detection.options.cut_off) == (2.0, 0.7)
    assert contact.label == "nodes+penalty(cut_off=0.7, kappa=2.0)"


def test_what_a_law_needs_of_its_detection_is_asked_for():
    with pytest.raises(
        SceneError, match='"velocity" measures no gap, which the law needs; expected "position"'
    ):
        Simulation(impact(), contact="nodes+penalty(criterion=velocity)")
    with pytest.raises(SceneError, match="measures no area"):
        Simulation(impact(), contact="nodes+penalty(normal=specified, direction=[1, 0])")


def test_a_cut_off_that_nothing_is_compared_with_is_refused():
    with pytest.raises(SceneError, match="'cut_off' has no effect with the criterion of velocity"):
        Simulation(impact(), contact="nodes+impulse(cut_off=0.5)")
    Simulation(impact(), contact="nodes+penalty(cut_off=0.5)")  # measures a gap, whose zero it is


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
    ("contact", "said"),
    [
        (
            "adhesion(traction=100, separation=0.05, search_radius=0.2)",
            r"contact\.adhesion\.search_radius = 0\.2 finds gaps of up to 0\.02 m, and law 'adhesion' acts across gaps of up "  # noqa: E501
            r"to 0\.05 m; expected at least 0\.5",
        ),
        (
            "points+adhesion(traction=100, separation=0.05)",
            r"detection 'points' finds gaps of up to 0\.0125 m",
        ),
        ("barrier(reach=0.3, search_radius=0.2)", r"search_radius = 0\.2 .*expected at least 0\.3"),
    ],
)
def test_a_law_that_acts_across_wider_gaps_than_are_found_is_refused(contact, said):
    """The force would end short of its reach."""
    with pytest.raises(SceneError, match=said):
        Simulation(impact(), contact=contact)


@pytest.mark.parametrize(
    "contact",
    ["adhesion(traction=100, separation=0.02, search_radius=0.2)", "barrier(reach=0.1, search_radius=0.1)"],
)
def test_a_law_that_acts_across_gaps_that_are_found_is_not(contact):
    Simulation(impact(), contact=contact)


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
        law = Simulation(load_scene(scene), contact=name).contact.law
        softest = min(body.p_wave_modulus for body in law.state.bodies)
        assert law.modulus == pytest.approx(expected * softest / law.cell_size)
