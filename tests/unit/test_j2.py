"""Plasticity: closed forms at small strain, and what holds at any."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from mpmfw_material.j2 import J2, j2_stress
from mpmfw_material.neo_hookean import NeoHookean
from support import PlasticPoint

BULK, SHEAR, YIELD = 160e9, 80e9, 400e6
YOUNG = 9.0 * BULK * SHEAR / (3.0 * BULK + SHEAR)


def j2_point(hardening=0.0, dim=3, exponent=1.0, rate=0.0, times=0.0):
    """A point of J2."""
    flows = hardening, exponent, rate, times

    def update(f, flow, stress, spacing):
        j2_stress(0, 1, f, flow, stress, BULK, SHEAR, YIELD, *flows, spacing)

    return PlasticPoint(update, dim)


def sheared(gamma):
    f = np.eye(3)
    f[0, 1] = gamma
    return f


def test_below_the_yield_stress_it_is_neo_hookean():
    point, elastic = j2_point(), NeoHookean(bulk_modulus=BULK, shear_modulus=SHEAR)
    f = np.eye(3) + 1e-3 * np.random.default_rng(1).normal(size=(3, 3))
    np.testing.assert_allclose(point.stress(f), elastic.cauchy_stress(f[None])[0], rtol=1e-9, atol=1e-3)
    assert point.strain == point.work == 0.0


@pytest.mark.parametrize("dim", [2, 3])
def test_it_yields_in_shear_at_the_yield_stress_over_root_three(dim):
    point, limit = j2_point(dim=dim), YIELD / math.sqrt(3.0)
    assert point.stress(sheared(0.999 * limit / SHEAR))[0, 1] == pytest.approx(0.999 * limit, rel=1e-4)
    assert point.strain == 0.0
    assert point.stress(sheared(3.0 * limit / SHEAR))[0, 1] == pytest.approx(limit, rel=1e-3)
    assert point.strain == pytest.approx(2.0 * limit / SHEAR / math.sqrt(3.0), rel=1e-2)


def pulled(point, stretches):
    """σ along a bar whose sides are free, at each stretch."""
    found, side = [], 1.0
    for stretch in stretches:

        def lateral(other, along=stretch):
            return float(point.tried(np.diag([along, other, other]))[1, 1])

        side = brentq(lateral, 0.9 * side, 1.1 * side, xtol=1e-14)
        found.append(float(point.stress(np.diag([stretch, side, side]))[0, 0]))
    return found


def test_a_bar_hardens_with_the_tangent_modulus():
    """σ = σ_y + E H / (E + H) (ε − σ_y / E) past yield; unloading is elastic."""
    hardening = 20e9
    point, tangent = j2_point(hardening), YOUNG * hardening / (YOUNG + hardening)
    strains = np.linspace(0.0, 0.006, 61)
    stresses = pulled(point, 1.0 + strains)
    for strain, stress in zip(strains, stresses, strict=True):
        expected = YOUNG * strain if strain < YIELD / YOUNG else YIELD + tangent * (strain - YIELD / YOUNG)
        assert stress == pytest.approx(expected, rel=0.01, abs=1.0)
    (unloaded,) = pulled(point, [1.0 + strains[-1] - 0.001])
    assert stresses[-1] - unloaded == pytest.approx(0.001 * YOUNG, rel=0.01)


@pytest.mark.parametrize("speed", [1e-2, 10.0, 1e4])
def test_a_bar_hardens_by_its_strain_and_rate(speed):
    """Johnson & Cook: τ = (σ_y + B α^n) (1 + C ln(rate / ε̇₀)), and the work is ∫ τ dα; below ε̇₀ the rate has
    no effect. Tolerances are the elastic strain: J departs from 1 by it, and α by Simo's flow rule."""
    exponent, factor, reference, strains = 0.3, 0.02, 0.1, np.linspace(0.0, 0.2, 201)
    times = speed / (reference * strains[1])
    point = j2_point(500e6, exponent=exponent, rate=factor, times=times)
    work, flowed, stresses = [], [], []
    for strain in strains:
        stresses += pulled(point, [math.exp(strain)])
        work.append(point.work), flowed.append(point.strain)
    flowed, stresses = np.array(flowed), np.array(stresses)
    known = 1.0 + factor * max(math.log(speed / reference), 0.0)
    expected = (YIELD + 500e6 * flowed**exponent) * known
    np.testing.assert_allclose(stresses[20:], expected[20:], rtol=5e-3)
    np.testing.assert_allclose(flowed[20:], strains[20:] - stresses[20:] / YOUNG, rtol=5e-3)
    total = known * (YIELD * flowed[-1] + 500e6 * flowed[-1] ** (1.0 + exponent) / (1.0 + exponent))
    assert work[-1] == pytest.approx(total, rel=5e-3)


def test_johnson_and_cook_without_their_numbers_are_linear_hardening():
    """n just below 1 takes the other way to the same stress."""
    linear, other = j2_point(20e9), j2_point(20e9, exponent=1.0 - 1e-12)
    for f in random_path(1):
        np.testing.assert_allclose(other.stress(f), linear.stress(f), rtol=1e-8, atol=1.0)
    assert other.work == pytest.approx(linear.work, rel=1e-9)


def test_a_cycle_of_shear_dissipates_the_area_of_its_loop():
    """Perfect plasticity: a parallelogram of 4 τ_y (γ − τ_y / G) in a stable cycle of ± γ."""
    point, limit, amplitude = j2_point(), YIELD / math.sqrt(3.0), 0.02
    path = amplitude * np.sin(np.linspace(0.0, 6.0 * math.pi, 3001))
    work = [0.0]
    for gamma in path:
        point.stress(sheared(gamma))
        work.append(point.work)
    assert work[-1] - work[-1001] == pytest.approx(4.0 * limit * (amplitude - limit / SHEAR), rel=5e-3)


def random_path(seed):
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=(3, 3))
    return [
        np.eye(3) + 0.05 * math.sin(t) * direction + 0.02 * t * np.eye(3) for t in np.linspace(0.0, 5.0, 60)
    ]


@pytest.mark.parametrize("seed", range(3))
def test_flow_keeps_the_volume_and_the_stress_on_the_cylinder(seed):
    point = j2_point(hardening=5e9)
    for f in random_path(seed):
        before = point.strain
        tau = np.linalg.det(f) * point.stress(f)
        deviator = tau - np.trace(tau) / 3.0 * np.eye(3)
        limit = YIELD + 5e9 * point.strain
        size = math.sqrt(1.5 * np.sum(deviator**2))
        assert size <= limit * (1.0 + 1e-12)
        assert point.strain == before or size == pytest.approx(limit, rel=1e-12)
        assert np.linalg.det(point.flow.metric[0]) == pytest.approx(1.0, abs=1e-12)
    assert point.strain > 0.05


def test_moduli_by_young_and_poisson():
    given = J2(youngs_modulus="200 GPa", poissons_ratio=0.25, yield_stress="400 MPa")
    assert given.bulk_modulus == pytest.approx(200e9 / 1.5)
    assert given.shear_modulus == pytest.approx(80e9)
    again = J2.from_options(given.options)
    assert again.options == given.options


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"youngs_modulus": 2e11}, "'youngs_modulus' goes with 'poissons_ratio', which is missing"),
        ({"youngs_modulus": 2e11, "poissons_ratio": 0.3, "bulk_modulus": 1e11}, "not both"),
        ({"youngs_modulus": 2e11, "poissons_ratio": 0.5}, "poissons_ratio"),
    ],
)
def test_moduli_that_cannot_be_meant_are_refused(options, said):
    make = NeoHookean
    with pytest.raises(ValueError, match=said):
        make(**options)


@pytest.mark.parametrize(
    ("option", "other"), [("hardening_exponent", "hardening_modulus"), ("reference_rate", "rate_factor")]
)
def test_an_option_of_what_is_absent_is_refused(option, other):
    with pytest.raises(ValueError, match=f"'{option}' has no effect without '{other}'"):
        J2(youngs_modulus=2e11, poissons_ratio=0.3, yield_stress=4e8, **{option: 0.5})
