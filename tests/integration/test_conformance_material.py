"""The conformance kit of materials: bundled ones pass, and every planted fault is caught by the check that is
meant for it.
"""

from __future__ import annotations

import pytest

from faulty_plugins.material import faults
from faulty_plugins.material.sound import Sound
from mpmfw_testing import checks_of, examine, material_conformance, subject_of

CHECKS = {check.name: check for check in checks_of("material")}
MODULI = "bulk_modulus=5e6, shear_modulus=3e6"

#: The check that is meant for each fault.
FAULTS = {
    faults.PreStressed: "rest",
    faults.EnergyFromNothing: "rest",
    faults.SmallStrain: "rest",
    faults.TwiceTheShear: "moduli",
    faults.RightForLeft: "objectivity",
    faults.FixedFibres: "objectivity",
    faults.Lopsided: "full-stress",
    faults.OutputsOfAnother: "full-stress",
    faults.KirchhoffForCauchy: "work",
    faults.EnergyOfAnother: "work",
    faults.Damaged: "work",
    faults.PlaneWithoutDepth: "plane-strain",
    faults.OutputsInThePlane: "plane-strain",
    faults.Yielding: "work",
    faults.Closed: "sent",
    faults.EverybodysStress: "own-points",
    faults.Correcting: "own-points",
    faults.MeanPressure: "each-for-itself",
    faults.Counting: "declared-history",
    faults.Noisy: "repeatable",
    faults.LosingInSilence: "loss",
    faults.GivingBack: "loss",
    faults.WrongShape: "runs",
    faults.NotANumber: "runs",
}

LINEAR = {
    "work": "σ = R C:(U − 1) Rᵀ is the gradient of its energy to second order of the strain alone: 5 % off "
    "at 10 %",
}


@material_conformance(f"neo_hookean({MODULI})")
def test_neo_hookean(check):
    check()


@material_conformance(f"neo_hookean({MODULI}, energy=log)")
def test_neo_hookean_of_the_other_energy(check):
    check()


@material_conformance(f"linear_elastic({MODULI})", expected_failures=LINEAR)
def test_linear_elastic(check):
    check()


@material_conformance(f"j2({MODULI}, yield_stress=2e4, hardening_modulus=1e5)")
def test_j2(check):
    check()


@material_conformance(Sound)
def test_sound(check):
    check()


@pytest.mark.parametrize(
    ("fault", "meant"), FAULTS.items(), ids=lambda value: getattr(value, "__name__", value)
)
def test_fault_is_caught_by_the_check_meant_for_it(fault, meant):
    (outcome,) = examine(subject_of(fault, "material"), [CHECKS[meant]])
    assert outcome.status == "failed"
    assert "Error" not in outcome.message  # the property is broken; the kit did not stumble


def test_every_check_has_a_fault_that_it_catches():
    assert set(CHECKS) == set(FAULTS.values())
