"""The conformance kit on contact laws: the bundled ones pass, and each planted fault is caught by the check
meant for it.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from pydantic import BaseModel, Field

import mpmfw.plugin.discovery
from faulty_plugins.contact import frame, keeping, momentum, several, slip, springs, units
from faulty_plugins.contact.plain import PlainContact
from mpmfw.api import ContactStrategy, SceneError, hookimpl
from mpmfw_contact.adhesion import Adhesion
from mpmfw_contact.bardenhagen import Bardenhagen
from mpmfw_contact.hamad2017 import Hamad2017
from mpmfw_contact.penalty import Penalty
from mpmfw_testing import checks_of, contact_conformance, examine, subject_of
from mpmfw_testing.contact.meeting import Meeting
from mpmfw_testing.contact.motion import simulate

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
    frame.NineEntries: "shapes",
    frame.Flat: "three-dimensions",
    units.SpeedTolerance: "similarity",
    units.LengthTolerance: "similarity",
    units.UnsharedMass: "three-bodies",
    units.OneFriction: "three-bodies",
    units.SeesOutputs: "outputs",
    several.LastFriction: "three-bodies",
    several.FirstBodysFriction: "three-bodies",
    several.CentreLine: "slip-on-the-cone",
    several.StaleNormal: "met-again",
    several.FullBuffer: "many-contacts",
    several.EightPairs: "many-contacts",
    several.OneTouch: "met-again",
    several.PlanarFriction: "three-dimensions",
    several.AbsoluteSpeed: "moving-frame",
    several.DrainsEnergy: "moment-balance",
    several.TwentiethPerStep: "pushes-apart",
    several.WritesStress: "changes-nothing-else",
    several.Remembers: "no-growth",
    springs.FirstPairHistory: "three-bodies",
    springs.OthersLength: "refinement",
    springs.PerPoint: "refinement",
    springs.FadesPerStep: "step-length",
    several.EveryOtherStep: "step-length",
    several.LightIsNothing: "unequal",
    springs.DashpotWithoutTime: "similarity",
    springs.ForgetsAtOutputs: "outputs",
    springs.ShallowReach: "met-again",
    springs.FullRows: "many-contacts",
    keeping.IgnoredOption: "options",
    keeping.IgnoredWithinBounds: "options",
    keeping.IgnoredBehindRefusals: "options",
    keeping.TooLongStep: "time-step",
    keeping.WearsOut: "used-twice",
    keeping.CountsElsewhere: "saved",
    keeping.CountsByIterator: "saved",
    keeping.ForgetsSprings: "restart",
    keeping.RemembersWork: "restart",
    keeping.WorkOfOneInterval: "reports",
    keeping.Closed: "sent",
}
#: Faults that pass, and why; the score counts them as missed.
MISSED = {
    springs.HalfTheWork: "the slip of a face is not measured: sound laws report half to all of friction "
    "times the bodies' slip",
}
#: Checks whose violations have nothing to show: two runs with the same motion.
WITHOUT_PICTURE = {"options", "outputs", "changes-nothing-else", "no-growth", "sent"}
#: Of a scene with one body the host does not call the law: no law can break this, so that no fault can be
#: planted.
OF_THE_HOST = {"one-body"}

STICKS = "one velocity field for all bodies: they stick where they meet, in every direction"
ROUNDED = "one window spans all bodies, so that sums run in another order: equal to rounding only"
LACKS_NONE = {
    "pushes-apart": f"{STICKS}, and discs that meet in a point are hardly slowed",
    "no-adhesion": STICKS,
    "coulomb-cone": STICKS,
    "frictionless": STICKS,
    "unequal": f"{STICKS}, and discs that meet in a point are hardly slowed",
    "three-bodies": "the common field strains the bodies at once, as in energy",
    "met-again": f"{STICKS}, and discs that meet in a point are hardly slowed",
    "energy": "the common field strains the bodies at once, and FLIP slows their points only by the forces "
    "that follow",
    "shift": "how many nodes the bodies share, and so how firmly they stick, depends on where they lie",
    "rotation": "how many nodes the bodies share, and so how firmly they stick, depends on how they lie",
    "asleep-apart": ROUNDED,
    "bystander": ROUNDED,
    "shapes": f"{STICKS}, and discs that meet in a point are hardly slowed",
    "three-dimensions": "what bodies of one velocity field exchange is internal force: contact itself does nothing",  # noqa: E501
}
THROWN = "a node near a corner is behind the line of a far face too (eq. 10), a cell deep, and is thrown out along the near one"  # noqa: E501
LAYER = "the interface layer has inertia and momentum of its own beside the material points'"
LACKS_HAMAD_2017 = {
    **dict.fromkeys(
        (
            "coulomb-cone",
            "slip-on-the-cone",
            "sticking",
            "frictionless",
            "time-step",
            "three-bodies",
            "step-length",
        ),
        THROWN,
    ),
    **dict.fromkeys(
        ("equal-and-opposite", "moment-balance", "pushes-apart", "no-adhesion", "asleep-apart", "bystander"),
        LAYER,
    ),
    **dict.fromkeys(("shapes", "reports"), LAYER),
    "refinement": "a node bears by the penetration of its segment's ends: four times as many nodes give 20 % "
    "more",
}
#: Without its layer; equal blocks, of which each is slave once with half its area, then stay within the cone.
LACKS_THIN = {
    name: why for name, why in LACKS_HAMAD_2017.items() if LAYER not in why and name != "coulomb-cone"
}
ORDER = "rows that say nearly the same share a force by their order, and within the tolerance"
LACKS_LCP = {
    "relabelling": ORDER,
    "rotation": f"{ORDER}: a quarter turn is felt by 2e-4",
}
LACKS_NAIRN = {
    "relabelling": "sums in another order decide whether a normal has turned by less than what ends its "
    "regression",
}
PULLS = "surfaces attract each other"
LACKS_PULLING = {
    "pushes-apart": f"{PULLS}, and pull where they part",
    "no-adhesion": f"{PULLS}, which is what it forbids",
    "coulomb-cone": f"{PULLS}, and their friction has that load as well (Derjaguin)",
    "three-bodies": f"{PULLS}, and bodies gain the motion that the attraction gives them, from its energy",
    "similarity": "the traction is a stress, which the check leaves alone where it changes the units",
    "unequal": f"{PULLS}, and a light body swings on a heavy one (0.51 of the approach; none with 1/100 of "
    "the traction)",
    "step-length": f"{PULLS}, and steps of another length meet other gaps (0.32; below 0.1 with 1/10 of the traction)",  # noqa: E501
}
LACKS_IMPULSE = {"relabelling": "a row that neither approaches nor parts takes part or not by rounding: 6e-9"}
BUMPS = "spheres in the hollows of others: the surface is a row of bumps"
LACKS_PARTICLES = {
    "no-adhesion": f"{BUMPS}, which overlap where the bodies just touch, and push",
    "coulomb-cone": f"{BUMPS}, whose normals are not that of the face",
    "frictionless": f"{BUMPS}, which hold along the face",
    "moment-balance": "friction acts on the points, and leaves a moment of the radii",
    "sticking": "friction is that of the moment, also where it turns the slip round",
    "step-length": "the force is the overlap over the square of the step",
}
LACKS_SEPARATE = {
    "unequal": "no interaction: the bodies pass through each other",
    "pushes-apart": "no interaction: the bodies pass through each other",
    "met-again": "no interaction: the bodies pass through each other",
    "many-contacts": "no interaction: the bodies pass through each other",
    "shapes": "no interaction: the bodies pass through each other, with any shape function",
    "three-dimensions": "no interaction: the bodies pass through each other, in space as well",
}


@pytest.fixture(autouse=True, scope="module")
def _entry_points_are_read_once():
    """Nothing is installed while these tests run; reading it anew for every simulation takes most of their
    time.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            mpmfw.plugin.discovery, "entry_points", functools.cache(mpmfw.plugin.discovery.entry_points)
        )
        yield


@contact_conformance("penalty", pictures=None)
def test_penalty_conforms(check):
    check()


@contact_conformance("hamad2017", expected_failures=LACKS_HAMAD_2017, pictures=None)
def test_hamad2017_as_published_lacks_what_is_listed(check):
    check()


@contact_conformance(lambda: Hamad2017(interface_thickness=0.0), expected_failures=LACKS_THIN, pictures=None)
def test_hamad2017_without_its_layer_lacks_what_eq_10_costs(check):
    check()


@contact_conformance("bardenhagen", pictures=None)
def test_bardenhagen_conforms(check):
    check()


@contact_conformance("lcp", expected_failures=LACKS_LCP, pictures=None)
def test_lcp_lacks_what_its_tolerance_leaves(check):
    check()


@contact_conformance("hybrid", pictures=None)
def test_hybrid_conforms(check):
    check()


@contact_conformance("barrier", pictures=None)
def test_barrier_conforms(check):
    check()


@contact_conformance("midplane", pictures=None)
def test_midplane_conforms(check):
    check()


@contact_conformance("adhesion", pictures=None)
def test_adhesion_without_traction_conforms(check):
    check()


@contact_conformance(lambda: Adhesion(traction=5e3), expected_failures=LACKS_PULLING, pictures=None)
def test_adhesion_lacks_what_pulling_costs(check):
    check()


@contact_conformance("impulse", expected_failures=LACKS_IMPULSE, pictures=None)
def test_impulses_lack_what_rounding_decides(check):
    check()


@contact_conformance("particles", expected_failures=LACKS_PARTICLES, pictures=None)
def test_particles_lack_a_smooth_surface_and_friction_that_sticks(check):
    check()


@contact_conformance("nairn", expected_failures=LACKS_NAIRN, pictures=None)
def test_nairn_lacks_what_its_tolerance_leaves(check):
    check()


@contact_conformance("none", expected_failures=LACKS_NONE, pictures=None)
def test_none_sticks_and_nothing_else(check):
    check()


@contact_conformance("separate", expected_failures=LACKS_SEPARATE, pictures=None)
def test_separate_does_not_act_and_nothing_else(check):
    check()


def outcome(plugin, name, pictures=None, **options):
    """What comes of one check."""
    chosen = [check for check in checks_of("contact") if check.name == name]
    return examine(subject_of(plugin, "contact", options), chosen, pictures=pictures)[0]


@pytest.mark.parametrize(("fault", "name"), FAULTS.items(), ids=lambda value: getattr(value, "name", value))
def test_every_fault_is_caught_by_the_check_meant_for_it(fault, name, tmp_path):
    found = outcome(fault, name, tmp_path)
    assert found.status == "failed", found.report
    assert "Error" not in found.message or fault in (keeping.TooLongStep, frame.NineEntries), found.report
    assert found.counterexample
    assert (found.picture is None) == (
        name in WITHOUT_PICTURE or fault in (frame.NineEntries, keeping.CountsByIterator)
    ), found.report
    assert found.picture is None or found.picture.stat().st_size > 1000


#: Checks for which faults were planted in the plain law, each once however many they are.
PLAIN = sorted({name for fault, name in FAULTS.items() if issubclass(fault, PlainContact)})


@pytest.mark.parametrize("name", PLAIN)
def test_the_law_without_the_fault_passes_the_same_check(name):
    found = outcome(PlainContact, name)
    assert found.status == ("not applicable" if name == "options" else "passed"), found.report


@pytest.mark.parametrize("law", ["penalty", "bardenhagen"])
def test_bundled_laws_refuse_no_shape_function(law):
    found = outcome(law, "shapes")
    assert (found.status, found.message) == ("passed", ""), found.report


class RoundedWork(Bardenhagen):
    """From one output to the next the recorded work loses its last bits."""

    name = "rounded-work"
    outputs = 0

    @hookimpl
    def diagnostics(self, state, interval):
        self.outputs += 1
        series = Bardenhagen.diagnostics(self, state, interval)
        series["frictional_work"] = (1.0 - 1e-14 * self.outputs) * series["frictional_work"] - 1e-16
        return series


def test_a_rounding_of_the_recorded_work_is_no_fall():
    motion = simulate(RoundedWork(), Meeting(form="discs", slide=0.5, friction=0.3).mapping(), 40)
    assert np.diff(motion.of("frictional_work")[:, 0]).min() < 0.0
    found = outcome(RoundedWork, "reports")
    assert found.status == "passed", found.report


class Film(ContactStrategy):
    """Does nothing, with an option that it drops, and of which the only example is what it is configured
    with.
    """

    name = "film"

    class Options(BaseModel):
        resistance: float = Field(0.0, ge=0.0, examples=[1e4])


def test_an_option_that_has_the_value_of_its_example_is_compared_with_others():
    found = outcome(Film(resistance=1e4), "options")
    assert found.message == "an option is accepted and has no effect"
    assert found.counterexample["value"] != 1e4


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
    assert found.counterexample["the default"] == "S235"
    found = outcome(keeping.IgnoredBehindRefusals(grade="S355"), "options")
    assert (found.message, found.counterexample["value"]) == (
        "an option is accepted and has no effect",
        "S235",
    )
    found = outcome(keeping.IgnoredWithinBounds, "options")
    assert "has no effect" in found.message
    assert 5.0 <= found.counterexample["value"] <= 6.0


def test_stiff_springs_with_their_true_limit_are_stable():
    found = outcome(Penalty, "time-step", kappa=10.0)
    assert found.status == "passed", found.report


class Stumbling(Bardenhagen):
    """Ends in an error of its own."""

    name = "stumbling"

    @hookimpl
    def after_momentum_update(self, grid):
        raise ZeroDivisionError(f"no impulse on {len(grid.mass)} nodes")


def test_an_error_of_the_law_is_shown_with_its_place():
    found = outcome(Stumbling, "runs")
    assert found.status == "failed"
    assert "no impulse on" in found.report
    assert "test_conformance_contact.py" in found.report


def test_every_check_has_a_fault_planted_for_it():
    assert set(FAULTS.values()) | OF_THE_HOST | {"runs"} == {check.name for check in checks_of("contact")}
