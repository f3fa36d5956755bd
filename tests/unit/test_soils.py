"""Soils: strength, dilation and tension in closed form, and the properties of any plastic flow."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from mpmfw_material._frictional import DISTORTED, SEPARATED, frictional_stress
from mpmfw_material._return import norm_square
from mpmfw_material.drucker_prager import DruckerPrager
from mpmfw_material.mohr_coulomb import MohrCoulomb
from support import PlasticPoint

SAND = {
    "youngs_modulus": "2 GPa",
    "poissons_ratio": 0.2,
    "friction_angle": "33 degree",
    "dilation_angle": "8 degree",
    "cohesion": "5 kPa",
}
#: Moduli that grow with the root of pressure, from above the apex (7.7 kPa).
STIFFENS = {"pressure_exponent": 0.5, "reference_pressure": "8 kPa"}
PHI, PSI, COHESION, CONFINEMENT = math.radians(33.0), math.radians(8.0), 5e3, 1e5
FLOW_NUMBER = (1.0 + math.sin(PHI)) / (1.0 - math.sin(PHI))
STRENGTH = FLOW_NUMBER * CONFINEMENT + 2.0 * COHESION * math.sqrt(FLOW_NUMBER)


class Point(PlasticPoint):
    """A point of a soil; its stresses are Kirchhoff's τ [Pa]."""

    def __init__(self, material, dim=3):
        super().__init__(self.write, dim)
        self.material = m = material
        self.opened = np.zeros(1)
        bulk, shear, stiffening = m.elasticity
        self.modulus = np.zeros(1)
        self.constants = bulk, shear, m.surface(), m.options.largest_tension(), m.cone, stiffening

    def write(self, f, flow, stress, spacing):
        """σ at F."""
        frictional_stress(
            0, 1, f, np.ones(1), flow, self.opened, stress, self.modulus, *self.constants, spacing,
            len(spacing),
        )  # fmt: skip

    def tried(self, f):
        """τ at F without keeping anything."""
        opened = self.opened.copy()
        found = super().tried(f)
        self.opened[:] = opened
        return found

    def stress(self, f):
        """τ at F."""
        return super().stress(f) * np.linalg.det(f)


def deformation(strain, shear=0.0):
    f = np.diag(np.exp(np.asarray(strain, dtype=float)))
    f[0, 1] = shear
    return f


def confined(point, pressure):
    """Compress isotropically to ``pressure``; return the logarithmic strain along each axis."""
    power, reference = point.constants[-1]  # K (1 + p / p0)^n over the path
    linear = reference * ((1.0 + pressure / reference) ** (1.0 / (1.0 + power)) - 1.0) if power else pressure
    strain = -linear / (3.0 * point.constants[0])
    point.stress(deformation([strain] * 3))
    return strain


def triaxial(point, sign, plane=False):
    """Shorten (or lengthen) along y under constant pressure at the sides; τ at the end, and all strains.

    With ``plane`` the strain along z stays.
    """
    start = confined(point, CONFINEMENT)
    lateral, strains = start, []
    for axial in start + sign * np.linspace(0.0, 1.5e-3, 61)[1:]:

        def residual(other, axial=axial):
            strain = [other, axial, start if plane else other]
            return float(point.tried(deformation(strain))[0, 0]) + CONFINEMENT

        lateral = brentq(residual, lateral - 2e-3, lateral + 2e-3, xtol=1e-16)
        strains.append([lateral, axial, start if plane else lateral])
        tau = point.stress(deformation(strains[-1]))
    return np.diag(tau), np.array(strains)


def both(fit):
    """Both models, whose moduli are constant or grow with pressure."""
    soils = [MohrCoulomb(**SAND, **more) for more in ({}, STIFFENS)]
    soils += [DruckerPrager(**SAND, **more, fit=fit) for more in ({}, STIFFENS)]
    names = [f"{m.name}, n = {m.options.pressure_exponent}" for m in soils]
    return pytest.mark.parametrize("material", soils, ids=names)


@both("compression")
def test_strength_in_triaxial_compression(material):
    """σ₁ = N_φ σ₃ + 2 c √N_φ, and the volume grows by the angle of dilation."""
    tau, strains = triaxial(Point(material), -1.0)
    assert -tau[1] == pytest.approx(STRENGTH, rel=1e-6)
    rates = strains[-1] - strains[-10]
    if material.name == "mohr_coulomb":
        ratio = -rates.sum() / rates[1]  # dε_v / dε_1 = −2 sin ψ / (1 − sin ψ)
        assert ratio == pytest.approx(2.0 * math.sin(PSI) / (1.0 - math.sin(PSI)), rel=1e-6)


@both("extension")
def test_strength_in_triaxial_extension(material):
    """The sides are the larger pressure: σ₃ = (σ₁ − 2 c √N_φ) / N_φ."""
    tau, _ = triaxial(Point(material), 1.0)
    assert -tau[1] == pytest.approx(
        (CONFINEMENT - 2.0 * COHESION * math.sqrt(FLOW_NUMBER)) / FLOW_NUMBER, rel=1e-6
    )


@pytest.mark.parametrize("dilation", ["0 degree", "8 degree", "33 degree"])
@pytest.mark.parametrize("model", [MohrCoulomb, DruckerPrager], ids=lambda m: m.name)
def test_strength_in_plane_strain(model, dilation):
    point = Point(model(**{**SAND, "dilation_angle": dilation}))
    tau, _ = triaxial(point, -1.0, plane=True)
    assert -tau[1] == pytest.approx(STRENGTH, rel=1e-3)


@pytest.mark.parametrize("exponent", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("pressure", [0.0, 1e4, 1e6])
def test_moduli_grow_with_a_power_of_pressure(exponent, pressure):
    """K and G are (1 + p/p₀)^n times those without pressure, by central differences."""
    reference = 2e4
    soil = MohrCoulomb(**SAND, pressure_exponent=exponent, reference_pressure=reference)
    point, change = Point(soil), 1e-8
    start = confined(point, pressure)
    assert point.tried(deformation([start] * 3)) == pytest.approx(-pressure * np.eye(3), abs=1e-5)
    factor = (1.0 + pressure / reference) ** exponent
    waves = factor * (soil.bulk_modulus + 4.0 / 3.0 * soil.shear_modulus)
    assert point.modulus[0] == pytest.approx(waves, rel=1e-6)

    def slope(rate):
        low, high = (point.tried(deformation(start + side * change * np.array(rate))) for side in (-1, 1))
        return (high - low) / (2.0 * change)

    assert np.trace(slope([1, 1, 1])) / 9.0 == pytest.approx(factor * soil.bulk_modulus, rel=1e-6)
    assert slope([1, -1, 0])[0, 0] / 2.0 == pytest.approx(factor * soil.shear_modulus, rel=1e-6)


def test_elasticity_under_pressure_is_that_published_and_gains_nothing_in_a_cycle():
    """Houlsby, Amorosi & Rojas (2005), equations 9 to 11, in an oedometer: with x = 1 + k (1 − n) ε_v and
    v² = x² + 3 g k (1 − n) ε_s² p + p₀ = p₀ x v^(n/(1−n)) and q = 3 g p₀ ε_s v^(n/(1−n)); ∮ τ dε = 0."""
    n, reference = 0.6, 2e4
    more = {"pressure_exponent": n, "reference_pressure": reference, "friction_angle": "85 degree"}
    point = Point(MohrCoulomb(**{**SAND, **more}))
    k, g = (modulus / reference for modulus in (point.material.bulk_modulus, point.material.shear_modulus))
    axial = 1e-4
    x = 1.0 + k * (1.0 - n) * axial
    v = math.sqrt(x**2 + 3.0 * g * k * (1.0 - n) * (2.0 / 3.0 * axial) ** 2)
    p, q = reference * (x * v ** (n / (1.0 - n)) - 1.0), 2.0 * g * reference * axial * v ** (n / (1.0 - n))
    tau = point.stress(deformation([0.0, -axial, 0.0]))
    assert -np.diag(tau) == pytest.approx([p - q / 3.0, p + 2.0 / 3.0 * q, p - q / 3.0], rel=1e-9)
    angle = np.linspace(0.0, 2.0 * np.pi, 101)[:-1, None] + np.array([0.0, 2.0, 4.5])
    path = axial * ([-1.0, -1.0, -1.0] + 0.3 * np.cos(angle))
    rate = -0.3 * axial * np.sin(angle)
    power = [np.diag(point.stress(deformation(e))) @ r for e, r in zip(path, rate, strict=True)]
    assert point.work == 0.0
    assert abs(np.mean(power)) < 1e-11 * np.abs(power).max()


@pytest.mark.parametrize("exponent", [0.5, 0.9])
def test_returned_stress_is_that_of_the_strain_kept(exponent):
    """Also where moduli grow so fast that the surface in t recedes while t returns along its normal."""
    more = {"friction_angle": 0.8, "dilation_angle": 0.8, "reference_pressure": 1e5, "cohesion": 0.0}
    more |= {"youngs_modulus": 5e7, "poissons_ratio": 0.3, "pressure_exponent": exponent}
    point = Point(MohrCoulomb(**{**SAND, **more}))
    bulk, shear, (power, reference) = point.material.elasticity
    for k in range(20):
        f = deformation(-3e-4 + 6e-5 * k * np.array([1.0, 1.0, -0.5]))
        tau = np.diag(point.stress(f))
        strain = 0.5 * np.log(np.diag(f @ point.flow.metric[0] @ f.T))
        t = (bulk - 2.0 / 3.0 * shear) * strain.sum() + 2.0 * shear * strain
        factor = norm_square(t, bulk, shear, reference) ** (0.5 * power)
        assert tau == pytest.approx(reference + factor * (t - reference), abs=1e-5)


@pytest.mark.parametrize("model", [MohrCoulomb, DruckerPrager], ids=lambda m: m.name)
def test_tension_is_cut_off(model):
    """Expansion ends at the apex c cot φ or the cut-off; sand without cohesion bears none."""
    cases = [
        ({}, COHESION / math.tan(PHI)),
        ({"tension": 2e3}, 2e3),
        ({"cohesion": 0.0}, 0.0),
        (STIFFENS, COHESION / math.tan(PHI)),
        ({"tension": 2e3, **STIFFENS}, 2e3),
    ]
    for options, expected in cases:
        point = Point(model(**{**SAND, **options}))
        for strain in (1e-3, 5e-3):
            tau = point.stress(deformation([strain, 1.2 * strain, 0.9 * strain]))
        assert np.trace(tau) / 3.0 == pytest.approx(expected, abs=1e-6)
        elastic = 0.5 * np.linalg.slogdet(point.flow.metric[0])[1] + 3.1 * strain
        assert point.opened[0] == pytest.approx(3.1 * strain - elastic, rel=1e-9)
        if not options.get("tension"):
            np.testing.assert_allclose(tau, expected * np.eye(3), atol=1e-6)
    sheared = Point(model(**SAND, tension=2e3)).stress(deformation([1e-3, 0.0, 0.0], 1e-3))
    assert np.trace(sheared) / 3.0 == pytest.approx(2e3)
    assert abs(sheared[0, 1]) > 1e2


@pytest.mark.parametrize("model", [MohrCoulomb, DruckerPrager], ids=lambda m: m.name)
def test_what_tension_has_opened_closes_before_there_is_pressure(model):
    """Sand that was torn apart bears nothing until it has its volume again, and then as before."""
    point = Point(model(**{**SAND, "cohesion": 0.0}))
    for strain in (1e-3, 4e-3, 1e-3, 2e-3, 0.5e-3):
        assert abs(point.stress(deformation([strain] * 3))).max() < 1e-6
    pressure = -np.diag(point.stress(deformation([-1e-5] * 3)))
    np.testing.assert_allclose(pressure, 3e-5 * point.material.bulk_modulus, rtol=1e-9)


def moved(point, f, rate, steps):
    """F and τ after steps of F ← (1 + rate) F, which the point may restart; rate (dim, dim)."""
    stress, move = np.empty_like(f[None]), np.eye(len(f)) + rate
    for _ in range(steps):
        f = np.ascontiguousarray(move @ f)
        point.update(f[None], point.flow, stress, point.spacing)
    return f, stress[0] * np.linalg.det(f)


@pytest.mark.parametrize("model", [MohrCoulomb, DruckerPrager], ids=lambda m: m.name)
@pytest.mark.parametrize("dim", [2, 3])
def test_points_that_no_longer_touch_open_no_further(model, dim):
    """SEPARATED: a lone point that swells by 10 000 loses half its volume, and then there is pressure."""
    point = Point(model(**{**SAND, "cohesion": 0.0, "dilation_angle": 0.0}), dim)
    turn = np.zeros((dim, dim))
    turn[0, 1] = 1e-3
    f, tau = moved(point, np.eye(dim), 1e-3 * np.eye(dim) + turn, 5000)
    assert np.linalg.det(f) == pytest.approx(math.exp(SEPARATED), rel=0.01)
    assert np.abs(tau).max() < 1e-6
    squeeze = -np.diag([1e-3, *[0.0] * (dim - 1)])
    assert np.abs(moved(point, f, squeeze, 600)[1]).max() < 1e-6
    assert moved(point, f, squeeze, 720)[1][0, 0] < -1e5


@pytest.mark.parametrize("model", [MohrCoulomb, DruckerPrager], ids=lambda m: m.name)
@pytest.mark.parametrize("dim", [2, 3])
def test_shear_without_end_loses_no_digits(model, dim):
    """DISTORTED: at γ = 10 000 the stress is that at γ = 50; else it is off by γ⁴ times round-off."""
    point = Point(model(**{**SAND, "dilation_angle": 0.0}), dim)
    f = np.ascontiguousarray(deformation([-1e-4] * 3)[:dim, :dim])
    point.update(f[None], point.flow, np.empty((1, dim, dim)), point.spacing)
    rate = np.zeros((dim, dim))
    rate[0, 1] = 1.0
    f, early = moved(point, f, rate, 50)
    f, late = moved(point, f, rate, 9950)
    np.testing.assert_allclose(late, early, rtol=1e-6, atol=1e-6 * np.abs(early).max())
    assert np.abs(f).max() < 2.0 * math.sqrt(DISTORTED)


@pytest.mark.parametrize("model", [MohrCoulomb, DruckerPrager], ids=lambda m: m.name)
@pytest.mark.parametrize("more", [{}, STIFFENS], ids=["constant", "stiffening"])
def test_a_cut_off_at_zero_keeps_all_that_opened_with_shear(model, more):
    """Cohesion leaves shear at the cut-off, and neither that nor round-off of its mean closes what opened."""
    soil = {"youngs_modulus": 1.06e7, "poissons_ratio": 0.32, "dilation_angle": 0.0, "tension": 0.0}
    point = Point(model(**{**SAND, **soil, **more}))

    def mean(volume, part=1.0):
        strain = volume / 3.0 + 0.02 * part * np.array([1.0, -1.0, 0.0])
        return float(np.trace(point.stress(deformation(strain)))) / 3.0

    for part in np.linspace(0.0, 1.0, 200):
        assert mean(0.01 * part, part) == pytest.approx(0.0, abs=1e-3)
    assert point.opened[0] == pytest.approx(-0.5 * np.linalg.slogdet(point.flow.metric[0])[1], rel=1e-9)
    for volume in np.linspace(0.01, 2e-4, 200):
        assert mean(volume) == pytest.approx(0.0, abs=1e-3)
    pressure = -mean(-0.002)
    assert pressure > 1e4
    assert more or pressure == pytest.approx(0.002 * point.material.bulk_modulus, rel=1e-9)


@pytest.mark.parametrize("exponent", [0.1, 0.5, 0.9499])
def test_shear_swells_what_has_opened_without_pressure(exponent):
    """The elastic part closes as far as shear alone swells it, however small or large."""
    own = {"pressure_exponent": exponent, "reference_pressure": 1e4, "tension": 0.0, "cohesion": 1e9}
    for shear in np.geomspace(1e-6, 3e-3, 30):
        point = Point(MohrCoulomb(**{**SAND, "youngs_modulus": 1e7, **own}))
        point.opened[:] = 1.0
        assert np.trace(point.stress(deformation([shear, -shear, 0.0]))) == pytest.approx(0.0, abs=1e-6)
        assert point.opened[0] < 1.0


def excess(material, tau):
    """Yield function of a stress over the moduli; at most round-off is admissible."""
    friction, _, cohesion = material.surface()
    values = np.linalg.eigvalsh(tau)
    p = values.mean()
    if material.cone:
        found = math.sqrt(0.5 * float(((values - p) ** 2).sum())) + friction * p - cohesion
    else:
        found = (1.0 + friction) * values[2] - (1.0 - friction) * values[0] - cohesion
    return float(found) / material.shear_modulus


strains = st.lists(st.floats(-0.05, 0.05), min_size=9, max_size=9)


@pytest.mark.parametrize("model", [MohrCoulomb, DruckerPrager], ids=lambda m: m.name)
@pytest.mark.parametrize("more", [{}, STIFFENS], ids=["constant", "stiffening"])
@given(first=strains, second=strains, turn=st.integers(0, 1000))
def test_any_path_stays_on_the_surface_dissipates_and_turns_with_its_observer(
    model, more, first, second, turn
):
    material = model(**SAND, **more)
    q = Rotation.random(random_state=turn).as_matrix()
    plain, turned, work = Point(material), Point(material), 0.0
    for step in (first, second):
        f = np.eye(3) + np.reshape(step, (3, 3))
        tau = plain.stress(f)
        assert excess(material, tau) < 1e-12
        assert plain.flow.work[0] >= work - 1e-17 * material.bulk_modulus  # round-off of K ε
        work = float(plain.flow.work[0])
        np.testing.assert_allclose(turned.stress(q @ f), q @ tau @ q.T, atol=1e-9 * material.bulk_modulus)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"dilation_angle": "40 degree"}, "dilation_angle"),
        ({"tension": 8e3}, "tension: expected at most"),
        ({"friction_angle": 0.0, "cohesion": 0.0}, "cohesion"),
        ({"pressure_exponent": 0.5}, "expected both or neither"),
        ({"reference_pressure": 1e4}, "expected both or neither"),
        ({**STIFFENS, "reference_pressure": 7e3}, "above the largest mean tension"),
        ({**STIFFENS, "pressure_exponent": 0.97}, "less than 0.95"),  # roots overflow under large strain
        ({**STIFFENS, "friction_angle": 0.0, "cohesion": 1e3}, "expected a cut-off where φ is zero"),
    ],
)
def test_soils_without_sense_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        MohrCoulomb(**{**SAND, "dilation_angle": 0.0, **options})
