"""The conformance kit of shape functions: bundled functions pass, and every planted fault is caught by the
check that is meant for it."""

from __future__ import annotations

import pytest

from faulty_plugins.shape import contract, domains, gradients, sound, support, surfaces, weights
from mpmfw_testing import checks_of, examine, shape_conformance, subject_of

#: What a bundled shape function cannot pass, and why.
LINEAR = {
    "divergence-theorem": "∇N jumps at cell faces, so that Σ V ∇N is a quadrature of first order: 13 % off with four "  # noqa: E501
    "points a cell edge. massless_boundary is declared for this, and surfaces are mapped by mass"
}
GIMP = {
    "constant-stress-deformed": "uGIMP keeps its squares by definition (Bardenhagen & Kober 2004): after a deformation "  # noqa: E501
    "they overlap and leave gaps. CPDI is what follows F"
}

CK = {
    "translation": "nodes belong in turn to one grid and to the other: weights repeat after two cells, which "
    "are one of "
    "the paper's"
}

#: The check that is meant for each fault.
FAULTS = {
    weights.NotNormalised: "partition-of-unity",
    weights.NotNormalisedIn3D: "partition-of-unity",
    weights.HalfCellOff: "linear-reproduction",
    weights.Interpolating: "non-negative",
    weights.WrongPiece: "continuity",
    weights.AlternatingCells: "translation",
    weights.UndeclaredSpread: "regular-spread",
    gradients.WrongSign: "gradient-sums",
    gradients.PerCell: "gradient-sums",
    gradients.GradientOfLinear: "gradient-is-derivative",
    support.OneField: "own-field",
    support.NeverOutside: "support-inside",
    support.OffByOneAtTheEnd: "support-inside",
    support.WrongIndex: "support-inside",
    support.SurfaceNeverOutside: "surface-inside",
    support.ReachAtTheStart: "reach",
    support.TabulatedInCompany: "independence",
    domains.LeakyFaces: "constant-stress",
    domains.FrozenDomains: "constant-stress-deformed",
    domains.TransposedDeformation: "constant-stress-deformed",
    domains.CornersLeftBehind: "deformed-sums",
    domains.CornersMean: "irregular-domains",
    surfaces.LinearSurface: "divergence-theorem",
    surfaces.SurfaceNotNormalised: "surface-sums",
    surfaces.UndeclaredBoundary: "boundary-mass",
    surfaces.SurfaceWithGradients: "structure",
    contract.LongNodes: "structure",
    contract.Descending: "structure",
    contract.Remembering: "repeatable",
    contract.KeepsElsewhere: "saved",
    contract.Clamping: "changes-nothing-else",
    contract.Hoarding: "no-growth",
    contract.Deaf: "options",
    contract.DeafToOrder: "options",
    contract.DeafBehindRefusals: "options",
    contract.Flatland: "dimensions",
    contract.Closed: "sent",
}

#: Checks whose violations have nothing to show: attributes, layouts of arrays, two equal tables.
WITHOUT_PICTURE = {"sent", "dimensions", "options", "structure"}

CHECKS = {check.name: check for check in checks_of("shape")}


@shape_conformance("linear", expected_failures=LINEAR, pictures=None)
def test_linear(check):
    check()


@shape_conformance("gimp", expected_failures=GIMP, pictures=None)
def test_gimp(check):
    check()


@shape_conformance("cpdi", pictures=None)
def test_cpdi(check):
    check()


@shape_conformance("cpdi2", pictures=None)
def test_cpdi2(check):
    check()


@shape_conformance("bspline", pictures=None)
def test_bspline(check):
    check()


@shape_conformance("cubic_bspline", pictures=None)
def test_cubic_bspline(check):
    check()


@shape_conformance("ck", expected_failures=CK, pictures=None)
def test_ck(check):
    check()


def test_what_the_faults_are_planted_in_is_sound():
    outcomes = examine(subject_of(sound.Sound, "shape"), list(CHECKS.values()))
    assert [outcome.report for outcome in outcomes if outcome.wrong] == []


@pytest.mark.parametrize(
    ("fault", "meant"), FAULTS.items(), ids=lambda value: getattr(value, "__name__", value)
)
def test_fault_is_caught_by_the_check_meant_for_it(fault, meant, tmp_path):
    (outcome,) = examine(subject_of(fault, "shape"), [CHECKS[meant]], pictures=tmp_path)
    assert outcome.status == "failed"
    assert "Error" not in outcome.message  # the property is broken; the kit did not stumble
    assert (outcome.picture is None) == (meant in WITHOUT_PICTURE), outcome.report
    assert outcome.picture is None or outcome.picture.stat().st_size > 1000
    if fault is weights.NotNormalisedIn3D:
        assert outcome.counterexample["dim"] == 3


def test_values_that_are_all_refused_acquit_no_option():
    (outcome,) = examine(subject_of(contract.DeafBehindRefusals, "shape"), [CHECKS["options"]])
    assert "every value made up for 'order' is refused or the default" in outcome.message


def test_an_error_of_the_plugin_is_shown_with_its_place():
    (outcome,) = examine(subject_of(contract.Stumbling, "shape"), [CHECKS["runs"]])
    assert outcome.status == "failed"
    assert "no weights" in outcome.report
    assert "contract.py" in outcome.report


def test_every_check_has_a_fault_that_it_catches():
    assert set(CHECKS) == {*FAULTS.values(), "runs"}
