"""Small motions about steady sliding: their eigenvalues say whether it is stable, without any time
integration.

While every node of the lower face slides forwards, the friction of each is μ times its own normal force. With
g = N u the gaps and s = T u the slips of the small displacement u, springs k give the forces

    f = -[K + Nᵀ k N - μ Tᵀ k N] u,

a stiffness that is not symmetric. Two modes of neighbouring frequencies may then couple: u ~ exp((σ + iω) t)
with σ > 0, flutter (Martins, Guimarães & Faria 1995, J. Vib. Acoust. 117, 445-451). Without springs the gaps
are held at zero by multipliers, which are the limit of k to infinity."""

from typing import NamedTuple

import numpy as np
from rings_fem.element import Solid
from rings_fem.mesh import Floats
from scipy.linalg import eigvals

from slider_fem.bodies import GRAVITY, Incline
from slider_fem.contact import segment_below

#: Springs this much stiffer stand for rigid contact where a static problem is solved.
RIGID = 1e4


class Sliding(NamedTuple):
    """Equilibrium of the block that slides steadily, in its own frame."""

    displacement: Floats  #: (2 n_nodes,) [m]
    pressed: Floats  #: (n_bottom,) whether the node bears


def stiffness_matrix(solid: Solid, n_nodes: int) -> Floats:
    """K (2 n_nodes, 2 n_nodes) of the undeformed elements [N/m per m]: of the linearized energy

    W = Σ_e { V_e K/2 tr² + Σ_q w_q G [ε : ε - tr²/3] }, where in the bulk's part tr is the element's mean.
    """
    matrix = np.zeros((2 * n_nodes, 2 * n_nodes))
    volume = solid.weights.sum(1)
    mean = np.einsum("eq,eqai->eai", solid.weights, solid.gradients) / volume[:, None, None]
    local = solid.bulk * np.einsum("e,eai,ebj->eaibj", volume, mean, mean)
    w, g = solid.shear * solid.weights, solid.gradients
    local += np.einsum("eq,eqak,eqbk,ij->eaibj", w, g, g, np.eye(2))
    local += np.einsum("eq,eqaj,eqbi->eaibj", w, g, g)
    local -= 2.0 / 3.0 * np.einsum("eq,eqai,eqbj->eaibj", w, g, g)
    rows = (2 * solid.elements[:, :, None] + np.arange(2)).reshape(len(local), 8)
    np.add.at(matrix, (rows[:, :, None], rows[:, None, :]), local.reshape(-1, 8, 8))
    return matrix


def contact_matrix(bodies: Incline, axis: int) -> Floats:
    """(n_bottom, 2 n_nodes): gap (axis 1) or slip (axis 0) of each lower node by the displacements."""
    matrix = np.zeros((len(bodies.bottom), 2 * len(bodies.points)))
    for i, node in enumerate(bodies.bottom):
        k, xi = segment_below(bodies.points, bodies.top, bodies.points[node, 0])
        matrix[i, 2 * node + axis] = 1.0
        matrix[i, 2 * bodies.top[k] + axis] = xi - 1.0
        matrix[i, 2 * bodies.top[k + 1] + axis] = -xi
    return matrix


def slide_steadily(bodies: Incline, friction: float, *, rigid_contact: bool = False) -> Sliding:
    """Find the equilibrium of the block that slides, in the frame that goes with it; nodes that would pull
    are let go.

    Gravity is that at zero tilt: the block's part along the plane only accelerates it, and its part across
    scales all forces."""
    free = np.repeat(bodies.free > 0.0, 2)
    matrix = _bulk(bodies)
    gaps, slips = contact_matrix(bodies, 1), contact_matrix(bodies, 0)
    springs = bodies.stiffness * (RIGID if rigid_contact else 1.0)
    weight = bodies.mass * bodies.free * GRAVITY
    load = np.zeros(len(free))
    load[1::2] = -weight
    # d'Alembert: friction stands against it
    load[0 : 2 * bodies.n_block : 2] = friction * weight[: bodies.n_block]
    centre = np.zeros(len(free))  # the block as a whole may not move along the plane
    centre[0 : 2 * bodies.n_block : 2] = bodies.mass[: bodies.n_block]
    pressed = np.ones(len(bodies.bottom), dtype=bool)
    while True:
        k = np.where(pressed, springs, 0.0)[:, None]
        system = matrix + gaps.T @ (k * gaps) - friction * slips.T @ (k * gaps)
        bordered = np.block([[system, centre[:, None]], [centre[None], np.zeros((1, 1))]])
        kept = np.append(free, True)
        u = np.zeros(len(kept))
        u[kept] = np.linalg.solve(bordered[np.ix_(kept, kept)], np.append(load, 0.0)[kept])
        bears = gaps @ u[:-1] < 0.0
        if np.array_equal(bears, pressed):
            return Sliding(u[:-1], pressed)
        pressed = bears & pressed if (bears & pressed).sum() < pressed.sum() else bears


def rest(bodies: Incline, *, rigid_contact: bool) -> Floats:
    """(n_nodes, 2) positions of both bodies at rest under gravity at zero tilt, without friction [m]."""
    settled = slide_steadily(bodies, 0.0, rigid_contact=rigid_contact).displacement.reshape(-1, 2)
    points = bodies.points + settled
    if rigid_contact:  # what the stiff springs still give
        gaps = contact_matrix(bodies, 1) @ settled.ravel()
        points[bodies.bottom, 1] -= gaps
    return np.asarray(points)


def growth(
    bodies: Incline,
    friction: float,
    *,
    rigid_contact: bool = False,
    pressed: Floats,
) -> Floats:
    """Growth rates σ [1/s] and frequencies ω/2π [Hz] of the growing small motions, (n, 2), the lowest
    frequency first.

    ``rigid_contact`` holds the gaps at zero instead of springs. ``pressed`` are the lower nodes that bear.
    """
    bulk = _bulk(bodies)
    gaps, slips = contact_matrix(bodies, 1)[pressed], contact_matrix(bodies, 0)[pressed]
    pull = gaps - friction * slips
    kept = np.repeat(bodies.free > 0.0, 2)
    mass = np.repeat(bodies.mass, 2)[kept]
    bulk, gaps, pull = (
        bulk[np.ix_(kept, kept)] / mass[:, None],
        gaps[:, kept],
        pull[:, kept].T / mass[:, None],
    )
    if rigid_contact:
        # Multipliers λ = -(G B)⁻¹ G a keep the gaps' acceleration at zero; what stays is A = [1 - B (G B)⁻¹
        # G] K/m on the null space of G.
        project = np.eye(len(mass)) - pull @ np.linalg.solve(gaps @ pull, gaps)
        _, _, right = np.linalg.svd(gaps)
        null = right[len(gaps) :].T
        stiff = null.T @ project @ bulk @ null
    else:
        stiff = bulk + pull @ (bodies.stiffness[pressed][:, None] * gaps)
    root = np.sqrt(-eigvals(stiff) + 0j)
    found = np.concatenate([root, -root])
    grows = found[(found.real > 1e-3 * np.abs(found).max() * 1e-3) & (found.imag > 0.0)]
    order = np.argsort(grows.imag)
    return np.column_stack([grows.real[order], grows.imag[order] / (2.0 * np.pi)])


def _bulk(bodies: Incline) -> Floats:
    n = len(bodies.points)
    return stiffness_matrix(bodies.block, n) + stiffness_matrix(bodies.plane, n)
