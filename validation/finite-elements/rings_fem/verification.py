"""Elements, contact and time integration against closed forms and finite differences."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq
from scipy.special import jv, yv

from rings_fem.contact import Outline, add_contact_force, outline_of
from rings_fem.element import BULK, DILATATIONAL, SHEAR, add_internal_force, cauchy_stress, solid_of
from rings_fem.explicit import KINETIC, STRAIN, Motion, Pair, advance, measure, update_forces
from rings_fem.mesh import INNER, OUTER, Floats, Mesh, block, ring

#: Deformation gradients of the patch test: stretch, compression and shear of finite size.
HOMOGENEOUS = (((1.3, 0.4), (-0.2, 0.8)), ((0.7, 0.0), (0.5, 1.1)), ((1.02, -0.6), (0.3, 1.4)))


def distorted(seed: int = 1) -> Mesh:
    """Unit square of 4 × 4 elements whose inner nodes are moved by up to a fifth of an element."""
    mesh = block(4, 4)
    shift = np.random.default_rng(seed).uniform(-0.05, 0.05, mesh.points.shape)
    shift[mesh.outline] = 0.0
    return mesh._replace(points=mesh.points + shift)


def homogeneous(gradient: Floats) -> tuple[float, Floats]:
    """Energy density [J/m³] and (3, 3) Cauchy stress [Pa] of the solid under F (2, 2), in closed form."""
    b, j = np.eye(3), float(np.linalg.det(gradient))
    b[:2, :2] = gradient @ gradient.T
    trace = float(np.trace(b))
    density = BULK / 2 * ((j**2 - 1) / 2 - np.log(j)) + SHEAR / 2 * (j ** (-2 / 3) * trace - 3)
    stress = SHEAR * j ** (-5 / 3) * (b - trace / 3 * np.eye(3)) + BULK / 2 * (j - 1 / j) * np.eye(3)
    return density, stress


def patch_test(gradient: Floats) -> dict[str, float]:
    """Apply x = F X, F (2, 2), to a distorted mesh; the exact answer is the constant stress of F.

    Returns the largest force on an inner node over the largest on the boundary, and relative errors of
    Cauchy stress, resultant on the right edge and strain energy."""
    mesh = distorted()
    solid, points = solid_of(mesh), mesh.points @ gradient.T
    force = np.zeros_like(points)
    energy = add_internal_force(points, solid, force)
    density, sigma = homogeneous(gradient)
    exact = np.array([sigma[0, 0], sigma[1, 1], sigma[2, 2], sigma[0, 1]])
    traction = np.linalg.det(gradient) * sigma[:2, :2] @ np.linalg.inv(gradient).T @ [1.0, 0.0]
    inner = np.setdiff1d(np.arange(len(points)), mesh.outline)
    # Σ f ⊗ X = -P V; its first column is the traction on the right edge, and corners need not be shared out.
    resultant = -(force * mesh.points[:, :1]).sum(axis=0)
    return {
        "force on inner nodes over that on the boundary": np.abs(force[inner]).max() / np.abs(force).max(),
        "Cauchy stress": np.abs(cauchy_stress(points, solid) - exact).max() / np.abs(exact).max(),
        "resultant on an edge": np.abs(resultant - traction).max() / np.abs(traction).max(),
        "strain energy": abs(energy / density - 1.0),
    }


def rotation_error(angle: float) -> float:
    """Largest nodal force of a rigid rotation by ``angle`` [rad], relative to K times an element's edge."""
    mesh = distorted()
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    force = np.zeros_like(mesh.points)
    add_internal_force(mesh.points @ turn.T + [0.3, -0.7], solid_of(mesh), force)
    return float(np.abs(force).max() / (0.25 * BULK))


def _gradient_error(potential: Callable[[Floats, Floats], float], points: Floats, step: float) -> float:
    """Largest |f + dE/dx| over all coordinates, relative to the largest |f|; central differences."""
    force, unused, slope = np.zeros_like(points), np.zeros_like(points), np.zeros_like(points)
    potential(points, force)
    for index in np.ndindex(points.shape):
        moved = points.copy()
        moved[index] = points[index] + step
        above = potential(moved, unused)
        moved[index] = points[index] - step
        slope[index] = (above - potential(moved, unused)) / (2.0 * step)
    return float(np.abs(force + slope).max() / np.abs(force).max())


def internal_gradient_error(seed: int = 2) -> float:
    """Internal force against differences of the strain energy, in a random finite deformation."""
    mesh = distorted()
    solid, random = solid_of(mesh), np.random.default_rng(seed)
    points = mesh.points @ np.array(HOMOGENEOUS[0]).T + random.uniform(-0.03, 0.03, mesh.points.shape)
    return _gradient_error(lambda x, f: add_internal_force(x, solid, f), points, 1e-6)


def overlapping() -> tuple[Floats, Outline, Outline]:
    """Two rings of coarse quadrilaterals, unequally turned, that overlap by 3 mm."""
    left, right = ring(5e-3, -OUTER, 0.2), ring(5e-3, OUTER - 3e-3, 0.37)
    points = np.concatenate([left.points, right.points])
    nodes = right.outline + len(left.points)
    return points, outline_of(points, left.outline, 1e10), outline_of(points, nodes, 1e10)


def contact_gradient_error() -> float:
    """Contact force against differences of the springs' energy, between two overlapping rings."""
    points, left, right = overlapping()
    return _gradient_error(lambda x, f: add_contact_force(x, left, right, f), points, 1e-8)


def contact_balance_error() -> float:
    """Return resultant and moment of the contact forces over the largest, where rings overlap."""
    points, left, right = overlapping()
    force = np.zeros_like(points)
    add_contact_force(points, left, right, force)
    moment = (points[:, 0] * force[:, 1] - points[:, 1] * force[:, 0]).sum() / OUTER
    return float(max(np.abs(force.sum(axis=0)).max(), abs(moment)) / np.abs(force).max())


def breathing_frequency() -> tuple[float, Callable[[Floats], Floats]]:
    """Lowest radially symmetric vibration of a ring, linear elastic, plane strain.

    The radial displacement is u = J1(kr) + c Y1(kr) with k = ω/c_d; σ_rr = (λ + 2μ) u' + λ u/r vanishes at
    both radii (e.g. Graff 1975, Wave motion in elastic solids, section 4.5).

    Returns
    -------
    ω [rad/s], u(r)
    """
    lame = BULK - 2.0 * SHEAR / 3.0

    def stress(bessel: Callable[[float, float], float], k: float, r: float) -> float:
        slope = k * (bessel(0, k * r) - bessel(1, k * r) / (k * r))
        return (lame + 2 * SHEAR) * slope + lame * bessel(1, k * r) / r

    def determinant(k: float) -> float:
        return stress(jv, k, INNER) * stress(yv, k, OUTER) - stress(jv, k, OUTER) * stress(yv, k, INNER)

    # a thin ring of the mean radius vibrates at k = sqrt(E'/(λ + 2μ))/R
    plate = 4.0 * SHEAR * (BULK + SHEAR / 3.0) / (BULK + 4.0 * SHEAR / 3.0)
    thin = np.sqrt(plate / (lame + 2.0 * SHEAR)) / (0.5 * (INNER + OUTER))
    k = float(brentq(determinant, 0.8 * thin, 1.2 * thin, xtol=1e-12))
    ratio = -stress(jv, k, INNER) / stress(yv, k, INNER)
    return k * DILATATIONAL, lambda r: np.asarray(jv(1, k * r) + ratio * yv(1, k * r))


def breathing_error(size: float) -> float:
    """Error of the frequency of a ring that vibrates in its breathing mode, relative.

    K - W is proportional to cos 2ωt; it crosses zero twice in each half period.
    """
    exact, mode = breathing_frequency()
    mesh = ring(size)
    solid, none = solid_of(mesh), Outline(np.empty(0, np.int64), np.empty(0))
    radius = np.linalg.norm(mesh.points, axis=1)
    shape = mode(radius) / np.abs(mode(radius)).max()
    velocity = 0.01 * (shape / radius)[:, None] * mesh.points
    motion, pair = Motion(mesh.points.copy(), velocity, np.zeros_like(velocity)), Pair(none, none, 0)
    step = 0.2 * size / DILATATIONAL
    history = np.zeros((int(6.0 * np.pi / exact / step), 6))
    update_forces(motion, solid, pair, history[0])
    measure(motion, solid, pair, history[0])
    advance(motion, solid, pair, step, history[1:])
    wave = history[:, KINETIC] - history[:, STRAIN]
    before = np.flatnonzero(np.diff(np.sign(wave)))
    zeros = step * (before + wave[before] / (wave[before] - wave[before + 1]))
    return float(0.5 * np.pi * (len(zeros) - 1) / (zeros[-1] - zeros[0]) / exact - 1.0)
