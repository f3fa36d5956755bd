"""Material points that are deformed by hand, between points of another body."""

from __future__ import annotations

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body, State
from mpmfw.state.windows import make_grid
from mpmfw_testing.bench import points_at_rest, set_up
from mpmfw_testing.check import Inapplicable
from mpmfw_testing.subject import Subject

#: Points of another body before and behind those of the material.
OTHERS = 2
#: Stress that the others are given [Pa]: who writes there is seen.
MARK = 12345.678
#: Length of a step [s], for materials whose stress depends on the rate.
STEP = 1e-5


class Bench:
    """Points of a material under deformations that are given.

    Parameters
    ----------
    subject
        The material under test.
    dim
        Number of space dimensions.
    count
        Number of points.
    """

    def __init__(self, subject: Subject, dim: int, count: int) -> None:
        total = count + 2 * OTHERS
        self.dim, self.own = dim, slice(OTHERS, OTHERS + count)
        self.material = subject.make()
        self.material.slices = (self.own,)
        position = np.random.default_rng(1).uniform(1.0, 2.0, (total, dim))
        self.particles = points_at_rest(position, np.ones(total), [0, total], MARK)
        origin = np.zeros(dim)
        grid = make_grid(1.0, origin, origin + 4.0, 1)
        k, g = float(self.material.bulk_modulus), float(self.material.shear_modulus)
        ranges = (slice(0, OTHERS), self.own, slice(self.own.stop, total))
        bodies = tuple(
            Body(f"body {i}", i, own, 0, 1.0, k, g, (0.0,) * dim, (1.0,) * dim, ())
            for i, own in enumerate(ranges)
        )
        self.state = State(self.particles, grid, bodies, ())
        self.setup, self.hook = set_up(self.material, self.state)

    @property
    def modulus(self) -> float:
        """K + 4 G / 3 [Pa]."""
        return float(self.material.bulk_modulus + 4.0 * self.material.shear_modulus / 3.0)

    def deform(self, deformation_gradient: FloatArray) -> FloatArray:
        """Cauchy stress of the points (n, dim, dim) [Pa] after a step to F (n, dim, dim)."""
        p = self.particles
        p.deformation_gradient[self.own] = deformation_gradient
        p.volume[self.own] = p.initial_volume[self.own] * np.linalg.det(deformation_gradient)
        self.hook.update_stress(particles=p, dt=STEP)
        return p.stress[self.own].copy()

    def energy(self) -> FloatArray:
        """Stored energy of the points, (n,) [J/m^3]."""
        return np.array(self.material.energy_of_points(self.particles, self.own), dtype=float)

    def dissipated(self) -> FloatArray:
        """Energy that the points have lost, (n,) [J/m^3]."""
        return np.array(self.material.dissipated_by_points(self.particles, self.own), dtype=float)

    def full_stress(self) -> FloatArray:
        """Full stress of the points, (n, 3, 3) [Pa]."""
        return np.asarray(self.material.stress_of_points(self.particles, self.own), dtype=float)


def path(dim: int, count: int, size: float, steps: int, seed: int = 0) -> FloatArray:
    """Deformations (steps + 1, n, dim, dim) with stretch and shear of ``size``, and back, turning."""
    rng = np.random.default_rng(seed)
    direction, spin = rng.uniform(-1.0, 1.0, (2, count, dim, dim))
    spin = 0.5 * (spin - np.swapaxes(spin, 1, 2))
    time = np.linspace(0.0, 1.0, steps + 1)
    strain = size * np.sin(3.0 * time)[:, None, None, None] * direction
    return np.asarray(rotation(time[:, None, None, None] * spin) @ (np.eye(dim) + strain))


def rotation(spin: FloatArray) -> FloatArray:
    """Cayley's rotation (1 − W/2)⁻¹ (1 + W/2) of antisymmetric W (…, dim, dim)."""
    one = np.eye(spin.shape[-1])
    return np.asarray(np.linalg.solve(one - 0.5 * spin, one + 0.5 * spin))


def dims_of(subject: Subject) -> tuple[int, ...]:
    """Dimensions that the material works in."""
    found = tuple(getattr(subject.make(), "dimensions", (2, 3)))
    if not found:
        raise Inapplicable("the material says that it works in no dimension")
    return found
