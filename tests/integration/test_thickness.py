"""Bodies of the plane with a thickness: masses, forces and energies go with it, and motion does not."""

import numpy as np
import pytest

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import SOFT, block, box, two_blocks

HOOKE = {**SOFT, "model": "linear_elastic"}


def blocks(contact, *thicknesses, **changes):
    """The two blocks with these thicknesses [m]."""
    scene = two_blocks(contact, **changes)
    for body, thickness in zip(scene["bodies"].values(), thicknesses, strict=False):
        body["thickness"] = thickness
    return scene


def pressed(load, thickness):
    """Points of a block that has settled between walls under a load on its top."""
    walls = [{"side": "left", "fixed": ["x"]}, {"side": "right", "fixed": ["x"]}]
    sides = [{"side": "bottom", "fixed": ["y"]}, *walls, {"side": "top", **load}]
    scene = block(bodies__solid__sides=sides, materials__soft=HOOKE, settle={})
    if thickness is not None:
        scene["bodies"]["solid"]["thickness"] = thickness
    sim = Simulation(scene)
    sim.start()
    return sim.state.particles


def test_a_plate_of_another_thickness_has_another_mass_and_the_same_stress_under_pressure():
    """The stress is the pressure, to the bit for powers of two."""
    plain, thin = (pressed({"pressure": 1e4}, thickness) for thickness in (None, 0.25))
    np.testing.assert_array_equal(thin.mass, 0.25 * plain.mass)
    np.testing.assert_array_equal(thin.stress, plain.stress)
    assert thin.stress[:, 1, 1].mean() == pytest.approx(-1e4, rel=0.01)


def test_a_force_on_a_thinner_plate_stresses_it_more():
    """σ = F / (L t); F in N."""
    stress = pressed({"force": [0.0, -100.0]}, 0.02).stress
    assert stress[:, 1, 1].mean() == pytest.approx(-100.0 / 0.02, rel=0.01)


@pytest.mark.parametrize(
    "contact", ["penalty", "adhesion", "barrier", "hybrid", "nodes+penalty", "bardenhagen", "lcp"]
)
def test_every_energy_and_force_goes_with_the_thickness_and_motion_does_not(contact):
    """Half steps and contact's losses too, to the bit."""
    changes = {"time__end": 0.02, "time__output_interval": 0.01, "output__ledger": True}
    slow = {"bodies.left.velocity": [0.5, 0.15], "bodies.right.velocity": [-0.5, -0.15]}
    whole, thin = (mpmfw.run(blocks(contact, t, t, **changes), set=slow)["series"] for t in (1.0, 0.25))
    plain = mpmfw.run(blocks(contact, **changes), set=slow)["series"]
    assert [tree["kinetic_energy"].attrs["units"] for tree in (plain, thin)] == ["J m-1", "J"]
    for name, factor in (("centre_of_mass", 1.0), ("contact_force", 0.25)):
        np.testing.assert_array_equal(thin[name], factor * plain[name], err_msg=name)
    energies = [name for name in whole.data_vars if whole[name].attrs.get("units") == "J"]
    assert {"half_step_work", "energy_residual", "contact_work"} <= set(energies)
    assert whole["half_step_work"].values[-1] != 0.0
    for name in energies:
        np.testing.assert_array_equal(thin[name], 0.25 * whole[name], err_msg=name)


@pytest.mark.parametrize(
    "contact", ["penalty", "surfaces+lcp", "barrier", "midplane", "nodes+penalty(kappa=1)"]
)
def test_two_bodies_touch_over_the_lesser_thickness(contact):
    """Squares with sides of 0.5 m: the rows have 0.5 m times the lesser one, whichever body is first."""

    def area(*thicknesses):
        sim = Simulation(blocks("penalty", *thicknesses), contact=contact)
        sim.advance(3)
        rows = sim.contact.last_rows
        assert rows.count > 0
        return float(rows.area[: rows.count].sum())

    one = area(1.0, 1.0)
    assert one == pytest.approx(0.5, rel=0.07)  # the squares' corners are no whole rows
    for thicknesses in ((2.0, 0.25), (0.25, 2.0)):
        assert area(*thicknesses) == pytest.approx(0.25 * one, rel=1e-2)


def test_a_thickness_in_space_and_one_of_nothing_are_refused():
    with pytest.raises(SceneError, match=r"bodies\.solid\.thickness: must be greater than 0"):
        mpmfw.load_scene(block(bodies__solid__thickness=0.0))
    with pytest.raises(SceneError, match=r"bodies\.solid\.thickness: is for two dimensions"):
        mpmfw.load_scene(box(bodies__solid__thickness=0.5))
