"""Measures against motions whose answer is known."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from mpmfw.report.table import gap_measures
from mpmfw.results import analysis
from mpmfw.results.references import RingsReference, RollingReference, reference_of
from mpmfw.results.stored_scene import cell_size
from mpmfw.scene.loading import shipped_scenes

SLIP = (np.radians(60.0), 0.286, 10.0, 1.6)
NO_SLIP = (np.radians(45.0), 0.495, 10.0, 1.6)


def test_rolling_solutions_of_the_paper():
    slip, rolls = analysis.rolling_solution(*SLIP), analysis.rolling_solution(*NO_SLIP)
    assert slip.slips
    assert not rolls.slips
    # eq. 13 rounds 0.286 to 2/7
    assert slip.displacement(2.0) == pytest.approx(2.5 * (np.sqrt(3.0) - 2.0 / 7.0) * 4.0, rel=2e-4)
    assert rolls.displacement(2.0) == pytest.approx(5.0 * np.sqrt(2.0) / 3.0 * 4.0)
    assert slip.angular_acceleration == pytest.approx(-1.786, rel=2e-3)
    assert rolls.angular_acceleration == pytest.approx(-2.946, rel=1e-3)
    assert slip.time_to(10.0) == pytest.approx(1.663, abs=1e-3)
    assert rolls.time_to(10.0) == pytest.approx(2.060, abs=1e-3)


@given(st.floats(0.05, 1.5), st.floats(0.1, 5.0))
def test_at_the_limit_of_slip_both_solutions_agree(tilt, radius):
    friction = np.tan(tilt) / 3.0
    below = analysis.rolling_solution(tilt, friction * (1.0 - 1e-9), 10.0, radius)
    above = analysis.rolling_solution(tilt, friction * (1.0 + 1e-9), 10.0, radius)
    assert below.slips
    assert not above.slips
    assert below.acceleration == pytest.approx(above.acceleration, rel=1e-6)
    assert below.angular_acceleration == pytest.approx(above.angular_acceleration, rel=1e-6)


@given(st.floats(-9.0, 9.0), st.floats(-3.0, 3.0), st.floats(-1.0, 1.0))
def test_fitted_acceleration_is_that_of_a_parabola(a, v0, d0):
    time = np.linspace(0.0, 2.0, 101)
    series = d0 + v0 * time + 0.5 * a * time**2
    series[time < 0.39] += 1.0  # what came before does not count
    assert analysis.fitted_acceleration(time, series, 0.4, 2.0) == pytest.approx(a, abs=1e-8)


def test_a_run_that_ended_early_has_no_figures():
    time = np.linspace(0.0, 2.0, 101)
    series = np.where(time < 1.0, 3.5 * time**2, np.nan)
    assert np.isnan(analysis.fitted_acceleration(time, series, 0.3, 1.7))
    assert np.isnan(analysis.value_at(time, series, 1.7))


def test_impulse_is_exact_for_means_over_intervals():
    time = np.array([0.0, 1.0, 3.0, 4.0])
    force = np.array([99.0, 2.0, 5.0, 1.0])  # the first belongs to no interval
    np.testing.assert_allclose(analysis.impulse(time, force), [0.0, 2.0, 12.0, 13.0])
    both = analysis.impulse(time, np.stack([force, -force], axis=1))
    np.testing.assert_allclose(both[:, 1], [0.0, -2.0, -12.0, -13.0])


def test_running_average_keeps_a_constant_and_the_impulse():
    time = np.linspace(0.0, 1.0, 101)
    mean = analysis.running_average(time, np.full(101, 3.0), 0.2)
    np.testing.assert_allclose(mean[10:], 3.0)
    assert mean[0] == pytest.approx(1.5)  # no force before the first output: half the window is empty
    force = np.where((time > 0.4) & (time < 0.6), 1.0, 0.0)
    smooth = analysis.running_average(time, force, 0.1)
    assert np.trapezoid(smooth, time) == pytest.approx(analysis.impulse(time, force)[-1], rel=1e-3)


def test_contact_phases():
    time = np.linspace(0.0, 1.0, 11)
    force = np.array([0, 0, 3, 2, 0, 0, 0, 5, 1, 0, 0], dtype=float)
    phases = analysis.contact_phases(time, force)
    assert (phases.first, phases.gap_start, phases.gap_end, phases.separation) == pytest.approx(
        (0.1, 0.3, 0.6, 0.8)
    )
    assert np.isnan(analysis.contact_phases(time, np.ones(11)).separation)
    assert np.isnan(analysis.contact_phases(time, np.zeros(11)).first)


def test_shipped_scenes_are_recognised():
    texts = {name: {"scene": text} for name, text in shipped_scenes().items()}
    for name, case in (("rolling-cylinder-slip", SLIP), ("rolling-cylinder-no-slip", NO_SLIP)):
        reference = reference_of(texts[name])
        assert isinstance(reference, RollingReference)
        assert reference.body == "cylinder"
        assert reference.solution == analysis.rolling_solution(*case)
        assert cell_size(xr.Dataset(attrs=texts[name])) == 0.4
    sphere = reference_of(texts["rolling-sphere-slip"])
    known = analysis.rolling_solution(np.radians(60.0), 0.286, 10.0, 1.6, inertia=0.4)
    assert (sphere.body, sphere.solution.slips) == ("sphere", True)
    assert sphere.solution.acceleration == pytest.approx(known.acceleration, rel=1e-7)
    assert analysis.rolling_solution(np.pi / 4, 0.495, 10.0, 1.6, inertia=0.4).acceleration == pytest.approx(
        10.0 / np.sqrt(2.0) * 5 / 7
    )
    assert reference_of(texts["colliding-rings"]) == RingsReference("left", "right")
    assert cell_size(xr.Dataset(attrs=texts["colliding-rings"])) == pytest.approx(0.002)


def test_other_scenes_have_no_reference():
    rings = shipped_scenes()["colliding-rings"]
    assert reference_of({"scene": rings.replace("121.7 MPa", "100 MPa")}) is None
    for old, new in [
        ("[-30, 0]", "[30, 0]"),
        ("[30, 0]", "[30, 1]"),
        ("[materials.rubber]", '[materials.rubber]\nenergy = "log"'),
        ("[bodies.right]", '[bodies.right]\nsides = [{ side = "right", fixed = true }]'),
        ("[output]", "[gravity]\nvector = [0, -9.81]\n[output]"),
    ]:
        assert old in rings
        assert reference_of({"scene": rings.replace(old, new)}) is None
    assert reference_of(
        {"scene": rings.replace("[materials.rubber]", '[materials.rubber]\nenergy = "split"')}
    )
    assert reference_of({"scene": "no scene ["}) is None
    assert reference_of({}) is None
    assert np.isnan(cell_size(xr.Dataset()))


def test_penetration_is_the_depth_over_the_outputs():
    measures = gap_measures(np.array([0.2, -0.1, np.nan, -0.3, 0.4]))
    assert measures == pytest.approx({"gap": 0.4, "penetration": 0.1, "largest_penetration": 0.3})
    assert all(np.isnan(value) for value in gap_measures(np.full(3, np.nan)).values())


def test_energy_kept_adds_what_contact_stores_and_dissipates():
    run = xr.Dataset(
        {
            "kinetic_energy": (("time", "body"), [[6.0, 4.0], [3.0, 2.0], [np.nan, np.nan]]),
            "strain_energy": (("time", "body"), [[0.0, 0.0], [1.0, 1.0], [np.nan, np.nan]]),
            "frictional_work": (("time", "pair"), [[0.0], [2.0], [np.nan]]),
            "contact_energy": (("time", "pair"), np.full((3, 1), np.nan)),  # another method's
        }
    )
    np.testing.assert_allclose(analysis.energy_kept(run), [1.0, 0.9, np.nan])
