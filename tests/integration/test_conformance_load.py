"""The conformance kit of loads: bundled ones pass, and every planted fault is caught by the check that is
meant for it.
"""

from __future__ import annotations

import pytest

from faulty_plugins.load.faults import FAULTS, Sound, SoundWind
from mpmfw_testing import checks_of, examine, load_conformance, subject_of

CHECKS = {check.name: check for check in checks_of("load")}


@load_conformance("drag(rate=2, medium=[[0, 1, 0], [1, 0, 3]])")
def test_drag(check):
    check()


@load_conformance("body_force(force=[3, -2])")
def test_body_force(check):
    check()


@load_conformance("point_force(at=[0.1, 0.2], force=[3, -2])")
def test_point_force(check):
    check()


@load_conformance(Sound)
def test_sound(check):
    check()


@load_conformance(SoundWind)
def test_sound_wind(check):
    check()


@pytest.mark.parametrize(
    ("fault", "meant"), FAULTS.items(), ids=lambda value: getattr(value, "__name__", value)
)
def test_fault_is_caught_by_the_check_meant_for_it(fault, meant):
    (outcome,) = examine(subject_of(fault, "load"), [CHECKS[meant]])
    assert outcome.status == "failed"


def test_every_check_has_a_fault_that_it_catches():
    assert set(CHECKS) == set(FAULTS.values())
