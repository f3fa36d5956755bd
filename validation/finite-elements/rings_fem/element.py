"""Four-node quadrilaterals of a nearly incompressible Neo-Hookean solid, total Lagrangian, plane strain.

The volume change is averaged over each element (mean dilatation: Nagtegaal, Parks & Rice 1974; in this
three-field form Simo, Taylor & Pister 1985), in the energy itself:

    W_h = Σ_e { V_e K/2 [(θ² - 1)/2 - ln θ] + Σ_q w_q G/2 [J_q^(-2/3) tr b_q - 3] },   θ = Σ_q w_q J_q / V_e

with tr b = F:F + 1 in plane strain. The nodal force is the exact gradient of W_h, so that energy is conserved
but for the error of the time integration."""

from typing import NamedTuple

import numpy as np

from mpmfw.kernels import kernel
from rings_fem.mesh import Floats, Integers, Mesh

BULK, SHEAR, DENSITY = 121.7e6, 26.1e6, 1010.0  #: of the rings [Pa], [Pa], [kg/m³]
DILATATIONAL = float(np.sqrt((BULK + 4.0 * SHEAR / 3.0) / DENSITY))  #: speed of sound [m/s]


class Solid(NamedTuple):
    """What the element loop reads; nothing of it changes with the motion."""

    elements: Integers  #: (n_elements, 4)
    gradients: Floats  #: (n_elements, 4, 4, 2) ∂N/∂X: element, quadrature point, node, axis [1/m]
    weights: Floats  #: (n_elements, 4) reference volume of each quadrature point [m²]
    mass: Floats  #: (n_nodes,) lumped by row sum [kg/m]
    bulk: float  #: K [Pa]
    shear: float  #: G [Pa]


def solid_of(mesh: Mesh, bulk: float = BULK, shear: float = SHEAR, density: float = DENSITY) -> Solid:
    """Evaluate shape functions at the 2 × 2 Gauss points of the reference configuration."""
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    gauss = corners / np.sqrt(3.0)
    shape = 0.25 * (1.0 + gauss[:, None, 0] * corners[:, 0]) * (1.0 + gauss[:, None, 1] * corners[:, 1])
    slope = 0.25 * corners * (1.0 + gauss[:, None, ::-1] * corners[:, ::-1])
    jacobian = np.einsum("eai,qaj->eqij", mesh.points[mesh.elements], slope)
    weights = np.linalg.det(jacobian)
    gradients = np.einsum("qaj,eqji->eqai", slope, np.linalg.inv(jacobian))
    share = density * np.einsum("qa,eq->ea", shape, weights).ravel()
    mass = np.bincount(mesh.elements.ravel(), share, minlength=len(mesh.points))
    return Solid(mesh.elements, np.ascontiguousarray(gradients), weights, mass, bulk, shear)


@kernel
def deform(points: Floats, solid: Solid, e: int, gradient: Floats) -> float:
    """Fill F11, F12, F21, F22 at the quadrature points, (4, 4), and return θ, the mean of det F."""
    volume, reference = 0.0, 0.0
    for q in range(4):
        f11, f12, f21, f22 = 0.0, 0.0, 0.0, 0.0
        for a in range(4):
            node = solid.elements[e, a]
            x, y = points[node, 0], points[node, 1]
            gx, gy = solid.gradients[e, q, a, 0], solid.gradients[e, q, a, 1]
            f11 += x * gx
            f12 += x * gy
            f21 += y * gx
            f22 += y * gy
        gradient[q, 0], gradient[q, 1], gradient[q, 2], gradient[q, 3] = f11, f12, f21, f22
        volume += solid.weights[e, q] * (f11 * f22 - f12 * f21)
        reference += solid.weights[e, q]
    return volume / reference


@kernel
def add_internal_force(points: Floats, solid: Solid, force: Floats) -> float:
    """Add -∂W_h/∂x at ``points`` [m] to ``force`` [N/m], (n_nodes, 2) each, and return W_h [J/m]."""
    energy, gradient = 0.0, np.empty((4, 4))
    for e in range(len(solid.elements)):
        theta = deform(points, solid, e, gradient)
        pressure = 0.5 * solid.bulk * (theta - 1.0 / theta)  # U'(θ), tension positive
        volume = 0.0
        for q in range(4):
            w = solid.weights[e, q]
            f11, f12, f21, f22 = gradient[q, 0], gradient[q, 1], gradient[q, 2], gradient[q, 3]
            j = f11 * f22 - f12 * f21
            trace = f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + 1.0
            shear = solid.shear * j ** (-2.0 / 3.0)
            # P = G J^(-2/3) [F - (tr b/3) F^-T] + U'(θ) J F^-T, and J F^-T = ((F22, -F21), (-F12, F11))
            spherical = pressure - shear * trace / (3.0 * j)
            p11, p12 = w * (shear * f11 + spherical * f22), w * (shear * f12 - spherical * f21)
            p21, p22 = w * (shear * f21 - spherical * f12), w * (shear * f22 + spherical * f11)
            for a in range(4):
                node = solid.elements[e, a]
                gx, gy = solid.gradients[e, q, a, 0], solid.gradients[e, q, a, 1]
                force[node, 0] -= p11 * gx + p12 * gy
                force[node, 1] -= p21 * gx + p22 * gy
            energy += 0.5 * w * (shear * trace - 3.0 * solid.shear)
            volume += w
        energy += 0.5 * solid.bulk * volume * (0.5 * (theta * theta - 1.0) - np.log(theta))
    return energy


@kernel
def cauchy_stress(points: Floats, solid: Solid) -> Floats:
    """Return σ = G J^(-5/3) (b - tr b/3 I) + U'(θ) I at the quadrature points [Pa].

    The components of (n_elements, 4, 4) are σ_xx, σ_yy, σ_zz, σ_xy.
    """
    stress, gradient = np.empty((len(solid.elements), 4, 4)), np.empty((4, 4))
    for e in range(len(solid.elements)):
        theta = deform(points, solid, e, gradient)
        pressure = 0.5 * solid.bulk * (theta - 1.0 / theta)
        for q in range(4):
            f11, f12, f21, f22 = gradient[q, 0], gradient[q, 1], gradient[q, 2], gradient[q, 3]
            b11, b22, b12 = f11 * f11 + f12 * f12, f21 * f21 + f22 * f22, f11 * f21 + f12 * f22
            shear = solid.shear * (f11 * f22 - f12 * f21) ** (-5.0 / 3.0)
            third = (b11 + b22 + 1.0) / 3.0
            stress[e, q, 0] = shear * (b11 - third) + pressure
            stress[e, q, 1] = shear * (b22 - third) + pressure
            stress[e, q, 2] = shear * (1.0 - third) + pressure
            stress[e, q, 3] = shear * b12
    return stress


def von_mises(stress: Floats) -> Floats:
    """Von Mises stress of (…, 4) components xx, yy, zz, xy [Pa]; shape (…)."""
    xx, yy, zz, xy = np.moveaxis(stress, -1, 0)
    return np.asarray(
        np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy**2), dtype=np.float64
    )
