"""Materials against their own energies, Hooke's law and objectivity."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mpmfw_material.linear_elastic import LinearElastic
from mpmfw_material.neo_hookean import NeoHookean

BULK, SHEAR = 5e6, 3e6
MODULI = {"bulk_modulus": BULK, "shear_modulus": SHEAR}
MATERIALS = {
    "split": NeoHookean(**MODULI, energy="split"),
    "log": NeoHookean(**MODULI, energy="log"),
    "linear": LinearElastic(**MODULI),
}
ALL = pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS)
NEO_HOOKEAN = pytest.mark.parametrize(
    "material", [MATERIALS["split"], MATERIALS["log"]], ids=["split", "log"]
)
DIMS = pytest.mark.parametrize("dim", [2, 3])


def deformations(dim: int, size: float = 0.3, count: int = 20) -> np.ndarray:
    """Random F = 1 + A with det F > 0."""
    f = np.eye(dim) + np.random.default_rng(3).uniform(-size, size, (count, dim, dim))
    assert (np.linalg.det(f) > 0.1).all()
    return f


def rotations(dim: int, count: int = 20) -> np.ndarray:
    """Random rotations, large ones too."""
    q, r = np.linalg.qr(np.random.default_rng(4).normal(size=(count, dim, dim)))
    q = q * np.sign(np.einsum("nii->ni", r))[:, None, :]
    q[:, :, 0] *= np.linalg.det(q)[:, None]
    return q


def stress_of(material: Any, f: np.ndarray) -> np.ndarray:
    """Cauchy stress as the hook ``update_stress`` stores it."""
    n, dim = f.shape[:2]
    particles = SimpleNamespace(
        deformation_gradient=np.ascontiguousarray(f), stress=np.zeros((n, dim, dim)), threads=None
    )
    material.setup(SimpleNamespace(state=SimpleNamespace(grid=SimpleNamespace(spacing=(1.0,) * dim))))
    material.slices = (slice(0, n // 2), slice(n // 2, n))  # two bodies of the material
    material.update_stress(particles)
    return particles.stress


@NEO_HOOKEAN
@DIMS
def test_first_piola_stress_is_the_gradient_of_the_energy(material: Any, dim: int) -> None:
    f, step = deformations(dim), 1e-6
    piola = np.zeros_like(f)
    for i in range(dim):
        for j in range(dim):
            shift = np.zeros((dim, dim))
            shift[i, j] = step
            piola[:, i, j] = (material.energy_density(f + shift) - material.energy_density(f - shift)) / (
                2 * step
            )
    jacobian = np.linalg.det(f)[:, None, None]
    expected = piola @ np.swapaxes(f, 1, 2) / jacobian  # σ = P Fᵀ / J
    np.testing.assert_allclose(stress_of(material, f), expected, rtol=0, atol=1e-6 * np.abs(expected).max())


@ALL
@DIMS
def test_small_strain_is_hookes_law(material: Any, dim: int) -> None:
    assert (material.bulk_modulus, material.shear_modulus) == (BULK, SHEAR)
    gradient = 1e-6 * deformations(dim) - 1e-6 * np.eye(dim)
    strain = 0.5 * (gradient + np.swapaxes(gradient, 1, 2))
    trace = np.einsum("nii->n", strain)[:, None, None]
    hooke = (BULK - 2 * SHEAR / 3) * trace * np.eye(dim) + 2 * SHEAR * strain
    # terms of second order: the strain, 1e-6, times some units
    np.testing.assert_allclose(
        stress_of(material, np.eye(dim) + gradient), hooke, atol=1e-5 * np.abs(hooke).max()
    )


@DIMS
def test_linear_elastic_stress_is_linear_in_the_stretch(dim: int) -> None:
    material, q = MATERIALS["linear"], rotations(dim)
    stretch = deformations(dim, 0.1)
    stretch = 0.5 * (stretch + np.swapaxes(stretch, 1, 2))
    one = np.eye(dim)
    small = stress_of(material, q @ (one + 0.5 * (stretch - one)))
    np.testing.assert_allclose(stress_of(material, q @ stretch), 2.0 * small, rtol=0, atol=1e-11 * BULK)


def test_linear_elastic_uniaxial_strain() -> None:
    f = np.array([np.diag([1.1, 1.0])])
    stress = MATERIALS["linear"].cauchy_stress(f)[0]
    lame = BULK - 2 * SHEAR / 3
    np.testing.assert_allclose(stress, 0.1 * np.diag([BULK + 4 * SHEAR / 3, lame, lame]), atol=1e-9 * BULK)


@ALL
@DIMS
def test_energy_is_positive(material: Any, dim: int) -> None:
    assert (material.energy_density(deformations(dim)) > 0.0).all()
