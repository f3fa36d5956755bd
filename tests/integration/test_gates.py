"""The shipped scenes against closed forms and the finite-element reference, at the stated tolerances."""

import warnings

import numpy as np
import pytest
from scipy.spatial import cKDTree

import mpmfw
from mpmfw.errors import ResultsWarning
from mpmfw.report.table import gap_measures, rings_measures, rolling_measures
from mpmfw.results.analysis import energy_kept
from mpmfw.results.references import reference_of


def measured(scene, contact, shape="cpdi", **keys):
    """Results and measures of one run; ``keys`` are set over the scene's, dots written as ``__``."""
    chosen = {"output.particles": False, **{key.replace("__", "."): value for key, value in keys.items()}}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultsWarning)  # single-field contact does not settle
        tree = mpmfw.run(scene, contact=contact, shape=shape, set=chosen)
    run, reference = tree["series"].to_dataset(), reference_of(tree.attrs)
    measures = rings_measures if scene == "colliding-rings" else rolling_measures
    gap = run["min_gap"].isel(pair=0).values / tree.attrs["cell_size"]
    return tree, {**measures(run, reference), **gap_measures(gap)}


@pytest.fixture(scope="module")
def slip():
    return {
        contact: measured("rolling-cylinder-slip", contact)[1]
        for contact in ("penalty", "bardenhagen", "none")
    }


@pytest.fixture(scope="module")
def no_slip():
    scene = "rolling-cylinder-no-slip"
    return {contact: measured(scene, contact)[1] for contact in ("penalty", "bardenhagen", "none")}


@pytest.fixture(scope="module")
def rings():
    return measured("colliding-rings", "penalty")


@pytest.fixture(scope="module")
def stiff_rings():
    """The rings with springs four times as stiff as the scene's."""
    return measured("colliding-rings", "penalty", contact__penalty__kappa=1.0)


def missed(measure):
    """A gate that cannot be held at this cell size; it turns red when it is, so that nobody overlooks it."""
    return pytest.mark.xfail(reason=f"measured: {measure}", strict=True)


def within(name, value, least, most):
    assert least <= value <= most, f"{name}: {value:.5g} is not in [{least:g}, {most:g}]"


@pytest.mark.parametrize(
    ("name", "tolerance"), [("displacement_error", 2.0), ("acceleration_error", 0.2), ("spin_error", 5.0)]
)
def test_penalty_rolls_with_slip(slip, name, tolerance):
    within(name, slip["penalty"][name], -tolerance, tolerance)


@pytest.mark.parametrize(("name", "tolerance"), [("displacement_error", 0.5), ("spin_error", 5.0)])
def test_penalty_rolls_without_slip(no_slip, name, tolerance):
    within(name, no_slip["penalty"][name], -tolerance, tolerance)


@pytest.mark.parametrize("case", ["slip", "no_slip"])
def test_penalty_hardly_penetrates(request, case):
    within("mean penetration / h", request.getfixturevalue(case)["penalty"]["penetration"], 0.0, 0.03)


@pytest.mark.parametrize("case", ["slip", "no_slip"])
def test_classical_contact_opens_a_gap_and_is_late(request, case):
    classical = request.getfixturevalue(case)["bardenhagen"]
    within("end gap / h", classical["gap"], 0.5, 1.1)
    within("displacement_error", classical["displacement_error"], -100.0, -3.0)


@pytest.mark.parametrize("case", ["slip", "no_slip"])
def test_a_single_field_sticks(request, case):
    within("displacement_error", request.getfixturevalue(case)["none"]["displacement_error"], -101.0, -98.0)


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [
        ("impulse_error", -1.5, 1.5),
        ("impulse_curve_error", 0.0, 5.0),
        ("energy_curve_error", 0.0, 8.0),
        ("force_error_100us", 0.0, 0.45),
        ("force_error_200us", 0.0, 0.20),
        ("first_contact", 0.0667 - 0.0383, 0.0667 + 0.0383),
        ("separation", 2.971 - 0.06, 2.971 + 0.06),
        pytest.param("largest_penetration", 0.0, 0.15, marks=missed("0.29 with kappa = 0.25; 0.10 with 1")),
    ],
)
def test_penalty_rings_collide_as_the_finite_elements(rings, name, least, most):
    within(name, rings[1][name], least, most)


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [
        ("impulse_error", -1.5, 1.5),
        pytest.param("impulse_curve_error", 0.0, 5.0, marks=missed("5.7 %")),
        ("force_error_100us", 0.0, 0.45),
        pytest.param("force_error_200us", 0.0, 0.20, marks=missed("0.25")),
        ("separation", 2.971 - 0.06, 2.971 + 0.06),
        ("largest_penetration", 0.0, 0.15),
    ],
)
def test_stiffer_springs_trade_force_for_penetration(stiff_rings, name, least, most):
    within(name, stiff_rings[1][name], least, most)


def test_rings_keep_momentum(rings):
    momentum = rings[0]["series/linear_momentum"]
    drift = np.abs((momentum - momentum.isel(time=0)).sum("body")).max()
    within("drift of linear momentum", float(drift / np.abs(momentum.isel(time=0)).max()), 0.0, 1e-12)


def test_rings_keep_energy(rings):
    kept = energy_kept(rings[0]["series"].to_dataset())
    within("least energy kept", kept.min(), 0.88, 1.005)
    within("most energy kept", kept.max(), 0.88, 1.005)


def test_rings_stay_mirror_images(rings):
    tree, _ = rings
    left = tree["surface/left/position"].values
    right = tree["surface/right/position"].values * np.array([-1.0, 1.0])
    apart, partner = cKDTree(left[0]).query(right[0])
    assert len(partner) > 100
    assert apart.max() < 1e-9  # each node has its image
    error = np.linalg.norm(left[:, partner] - right, axis=2).max() / tree.attrs["cell_size"]
    within("mirror error / h", error, 0.0, 0.01)
