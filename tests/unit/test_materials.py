"""Materials in closed form; the conformance kit asks them for work, moduli, objectivity and plane strain."""

from types import SimpleNamespace

import numpy as np
import pytest

from mpmfw_material.linear_elastic import LinearElastic
from mpmfw_material.neo_hookean import NeoHookean

BULK, SHEAR = 5e6, 3e6
LAME = BULK - 2.0 / 3.0 * SHEAR
MODULI = {"bulk_modulus": BULK, "shear_modulus": SHEAR}
STRETCH = 1.3


def split(a):
    """Stress and energy of a stretch a: K/2 ((J² − 1)/2 − ln J) and G/2 (J^(−2/3) tr C − 3)."""
    stress = 0.5 * BULK * (a - 1.0 / a) + 2.0 / 3.0 * SHEAR * a ** (-5.0 / 3.0) * (a * a - 1.0)
    volume = 0.5 * BULK * (0.5 * (a * a - 1.0) - np.log(a))
    return stress, volume + 0.5 * SHEAR * (a ** (-2.0 / 3.0) * (a * a + 2.0) - 3.0)


def log(a):
    """The same of λ/2 (ln J)² − G ln J + G/2 (tr C − 3)."""
    stress = (LAME * np.log(a) + SHEAR * (a * a - 1.0)) / a
    return stress, 0.5 * LAME * np.log(a) ** 2 - SHEAR * np.log(a) + 0.5 * SHEAR * (a * a - 1.0)


def linear(a):
    """The same of Hooke's law between stress and stretch less 1."""
    return (LAME + 2.0 * SHEAR) * (a - 1.0), 0.5 * (LAME + 2.0 * SHEAR) * (a - 1.0) ** 2


def stress_of(material, f):
    """Cauchy stress as the hook ``update_stress`` stores it, of two bodies of the material."""
    n, dim = f.shape[:2]
    points = SimpleNamespace(
        deformation_gradient=np.ascontiguousarray(f), stress=np.zeros((n, dim, dim)), threads=None
    )
    material.setup(SimpleNamespace(state=SimpleNamespace(grid=SimpleNamespace(tensor_spacing=(1.0,) * dim))))
    material.slices = (slice(0, n // 2), slice(n // 2, n))
    material.update_stress(points)
    return points.stress


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize(
    ("material", "expected"),
    [
        (NeoHookean(**MODULI, energy="split"), split),
        (NeoHookean(**MODULI, energy="log"), log),
        (LinearElastic(**MODULI), linear),
    ],
    ids=["split", "log", "linear"],
)
def test_stress_and_energy_of_a_uniaxial_stretch(material, expected, dim):
    """Also turned; in the plane as in space."""
    turn = np.eye(dim)
    turn[:2, :2] = [[0.6, -0.8], [0.8, 0.6]]
    stretched = np.eye(dim)
    stretched[0, 0] = STRETCH
    f = np.array([stretched, turn @ stretched])
    stress, energy = expected(STRETCH)
    found = stress_of(material, f)
    assert found[0, 0, 0] == pytest.approx(stress, rel=1e-12)
    np.testing.assert_allclose(found[1], turn @ found[0] @ turn.T, rtol=1e-12, atol=1e-9 * BULK)
    np.testing.assert_allclose(material.energy_density(f), energy, rtol=1e-12)
