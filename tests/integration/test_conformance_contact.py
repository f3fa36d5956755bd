"""The conformance kit on contact laws: the bundled ones pass, and each planted fault is caught by the check meant for it."""

from __future__ import annotations

import functools

import pytest

import mpmfw.discovery
from faulty_plugins.contact import frame, keeping, momentum, slip
from faulty_plugins.contact.plain import PlainContact
from mpmfw.api import SceneError, hookimpl
from mpmfw.testing import contact_checks, contact_conformance, examine, subject_of
from mpmfw_contact.penalty import Penalty

#: Each fault, and the check that is meant for it.
FAULTS = {
    momentum.UnequalImpulse: "equal-and-opposite",
    momentum.MissingMoment: "moment-balance",
    momentum.ReversedNormal: "pushes-apart",
    momentum.Adhesion: "no-adhesion",
    momentum.MassRatio: "energy",
    momentum.ForceAtDistance: "asleep-apart",
    momentum.DampsEverybody: "bystander",
    momentum.Misreported: "reports",
    slip.NoCone: "coulomb-cone",
    slip.NoFriction: "slip-on-the-cone",
    slip.KineticOnly: "sticking",
    slip.AlwaysFriction: "frictionless",
    frame.FirstIsMaster: "relabelling",
    frame.MiddleIsLighter: "relabelling",
    frame.FeelsOrigin: "shift",
    frame.AlongAxes: "rotation",
    frame.SixteenEntries: "shapes",
    frame.Flat: "three-dimensions",
    keeping.IgnoredOption: "options",
    keeping.IgnoredWithinBounds: "options",
    keeping.IgnoredBehindRefusals: "options",
    keeping.TooLongStep: "time-step",
    keeping.WearsOut: "used-twice",
    keeping.ForgetsSprings: "restart",
    keeping.RemembersWork: "restart",
}
#: Of a scene with one body the host does not call the law: no law can break this, so that no fault can be planted.
OF_THE_HOST = {"one-body"}

STICKS = "one velocity field for all bodies: they stick where they meet, in every direction"
ROUNDED = "one window spans all bodies, so that sums run in another order: equal to rounding only"
LACKS_NONE = {
    "pushes-apart": f"{STICKS}, and discs that meet in a point are hardly slowed",
    "no-adhesion": STICKS,
    "coulomb-cone": STICKS,
    "frictionless": STICKS,
    "energy": "the common field strains the bodies at once, and FLIP slows their points only by the forces that follow",
    "shift": "how many nodes the bodies share, and so how firmly they stick, depends on where they lie",
    "rotation": "how many nodes the bodies share, and so how firmly they stick, depends on how they lie",
    "asleep-apart": ROUNDED,
    "bystander": ROUNDED,
    "shapes": f"{STICKS}, and discs that meet in a point are hardly slowed",
    "three-dimensions": "what bodies of one velocity field exchange is internal force: contact itself does nothing",
}
LACKS_SEPARATE = {
    "pushes-apart": "no interaction: the bodies pass through each other",
    "shapes": "no interaction: the bodies pass through each other, with any shape function",
    "three-dimensions": "no interaction: the bodies pass through each other, in space as well",
}


@pytest.fixture(autouse=True, scope="module")
def _entry_points_are_read_once():
    """Nothing is installed while these tests run; reading it anew for every simulation takes most of their time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mpmfw.discovery, "entry_points", functools.cache(mpmfw.discovery.entry_points))
        yield


@contact_conformance("penalty", pictures=None)
def test_penalty_conforms(check):
    check()


@contact_conformance("bardenhagen", pictures=None)
def test_bardenhagen_conforms(check):
    check()


@contact_conformance("none", expected_failures=LACKS_NONE, pictures=None)
def test_none_sticks_and_nothing_else(check):
    check()


@contact_conformance("separate", expected_failures=LACKS_SEPARATE, pictures=None)
def test_separate_does_not_act_and_nothing_else(check):
    check()


def outcome(plugin, name, **options):
    """What comes of one check."""
    chosen = [check for check in contact_checks() if check.name == name]
    return examine(subject_of(plugin, "contact", options), chosen)[0]


@pytest.mark.parametrize(("fault", "name"), FAULTS.items(), ids=lambda value: getattr(value, "name", value))
def test_every_fault_is_caught_by_the_check_meant_for_it(fault, name):
    found = outcome(fault, name)
    assert found.status == "failed", found.report
    assert "Error" not in found.message or fault in (keeping.TooLongStep, frame.SixteenEntries), found.report
    assert found.counterexample


#: Checks for which a fault was planted in the plain law.
PLAIN = sorted(name for fault, name in FAULTS.items() if issubclass(fault, PlainContact))


@pytest.mark.parametrize("name", PLAIN)
def test_the_law_without_the_fault_passes_the_same_check(name):
    found = outcome(PlainContact, name)
    assert found.status == ("not applicable" if name == "options" else "passed"), found.report


@pytest.mark.parametrize("law", ["penalty", "bardenhagen"])
def test_bundled_laws_refuse_no_shape_function(law):
    found = outcome(law, "shapes")
    assert (found.status, found.message) == ("passed", ""), found.report


class RefusesLinear(PlainContact):
    """Says that it does not work with linear functions."""

    name = "refuses-linear"

    @hookimpl
    def setup(self, setup):
        if setup.shape == "linear":
            raise SceneError("refuses-linear: needs gradients that are continuous, expected another shape")
        PlainContact.setup(self, setup)


def test_a_refused_shape_function_is_noted():
    found = outcome(RefusesLinear, "shapes")
    assert (found.status, found.message) == ("passed", "refuses: linear"), found.report


def test_values_that_are_all_refused_acquit_no_option():
    found = outcome(keeping.IgnoredBehindRefusals, "options")
    assert "every value made up for 'grade' is refused or the default" in found.message
    found = outcome(keeping.IgnoredWithinBounds, "options")
    assert "has no effect" in found.message
    assert 5.0 <= found.counterexample["value"] <= 6.0


def test_stiff_springs_with_their_true_limit_are_stable():
    found = outcome(Penalty, "time-step", kappa=10.0)
    assert found.status == "passed", found.report


def test_every_check_has_a_fault_planted_for_it():
    assert set(FAULTS.values()) | OF_THE_HOST == {check.name for check in contact_checks()}
