"""Coulomb friction between the block's lower face and the plane's upper one, in two independent forms.

Each lower node meets the segment of the plane below it. The faces stay flat and level to a thousandth, so
that the normal is y and the tangent x: gap and slip are linear in the displacements, with the same weights
(1, -(1 - ξ), -ξ).

- Springs: f_n = -k g for g < 0, and a spring along the face whose force is returned to Coulomb's cone (return
  mapping; Wriggers 2006, Computational contact mechanics, chapter 10).
- Impulses: velocities are projected so that v_n ≥ 0 and |q| ≤ μ p at the end of the step, without any
  stiffness and with plastic impact (Moreau 1988; Jean 1999, Comput. Methods Appl. Mech. Eng. 177, 235-257),
  by Gauss-Seidel sweeps.
"""

import numpy as np
from rings_fem.mesh import Floats, Integers

from mpmfw.kernels import kernel

SWEEPS = 200  #: of Gauss-Seidel, at most
ENOUGH = 1e-10  #: change of the velocities in a sweep, over the largest velocity, at which they end


@kernel
def segment_below(points: Floats, top: Integers, x: float) -> tuple[int, float]:
    """Segment k of the upper face below x, and the place 0 ≤ ξ ≤ 1 on it."""
    low, high = 0, len(top) - 1
    while high - low > 1:
        middle = (low + high) // 2
        if points[top[middle], 0] <= x:
            low = middle
        else:
            high = middle
    a, b = points[top[low], 0], points[top[low + 1], 0]
    return low, min(max((x - a) / (b - a), 0.0), 1.0)


@kernel
def relative(values: Floats, node: int, first: int, second: int, xi: float, axis: int) -> float:
    """Value of the node less that of the place ξ of the segment."""
    difference: float = values[node, axis] - (1.0 - xi) * values[first, axis] - xi * values[second, axis]
    return difference


@kernel
def add_springs(
    points: Floats,
    velocity: Floats,
    bottom: Integers,
    top: Integers,
    stiffness: Floats,
    friction: float,
    step: float,
    tangential: Floats,
    force: Floats,
) -> tuple[float, float]:
    """Add the springs' forces [N/m] to (n_nodes, 2) ``force``; ``tangential`` (n_bottom,) is kept from step
    to step.

    Returns N on the block and T against its motion [N/m].
    """
    normal, along = 0.0, 0.0
    for i in range(len(bottom)):
        node = bottom[i]
        k, xi = segment_below(points, top, points[node, 0])
        first, second = top[k], top[k + 1]
        gap = relative(points, node, first, second, xi, 1)
        if gap >= 0.0:
            tangential[i] = 0.0
            continue
        f_n = -stiffness[i] * gap
        trial = tangential[i] - stiffness[i] * step * relative(velocity, node, first, second, xi, 0)
        f_t = min(max(trial, -friction * f_n), friction * f_n)
        tangential[i] = f_t
        for axis, f in ((0, f_t), (1, f_n)):
            force[node, axis] += f
            force[first, axis] -= (1.0 - xi) * f
            force[second, axis] -= xi * f
        normal += f_n
        along -= f_t
    return normal, along


@kernel
def project(
    points: Floats,
    velocity: Floats,
    bottom: Integers,
    top: Integers,
    inverse_mass: Floats,
    friction: float,
    step: float,
    impulse: Floats,
) -> tuple[float, float]:
    """Change the velocities by contact impulses, which (n_bottom, 2) ``impulse`` keeps as the next step's
    first guess.

    A node at the gap g > 0 may approach by g in the step, one in contact not at all. Returns as
    :func:`add_springs`."""
    for i in range(len(bottom)):
        node = bottom[i]
        k, xi = segment_below(points, top, points[node, 0])
        push(velocity, inverse_mass, node, top[k], top[k + 1], xi, impulse[i, 0], impulse[i, 1])
    largest = np.abs(velocity).max()
    for _ in range(SWEEPS):
        change = 0.0
        for i in range(len(bottom)):
            node = bottom[i]
            k, xi = segment_below(points, top, points[node, 0])
            first, second = top[k], top[k + 1]
            gap = max(relative(points, node, first, second, xi, 1), 0.0)
            give = (
                inverse_mass[node]
                + (1.0 - xi) * (1.0 - xi) * inverse_mass[first]
                + xi * xi * inverse_mass[second]
            )
            approach = relative(velocity, node, first, second, xi, 1) + gap / step
            p = max(impulse[i, 1] - approach / give, 0.0)
            trial = impulse[i, 0] - relative(velocity, node, first, second, xi, 0) / give
            q = min(max(trial, -friction * p), friction * p)
            dq, dp = q - impulse[i, 0], p - impulse[i, 1]
            push(velocity, inverse_mass, node, first, second, xi, dq, dp)
            impulse[i, 0], impulse[i, 1] = q, p
            change = max(change, give * (abs(dq) + abs(dp)))
        if change <= ENOUGH * largest:
            break
    return impulse[:, 1].sum() / step, -impulse[:, 0].sum() / step


@kernel
def push(
    velocity: Floats,
    inverse_mass: Floats,
    node: int,
    first: int,
    second: int,
    xi: float,
    q: float,
    p: float,
) -> None:
    """Give the node the impulse (q, p) [N s/m], and the segment the opposite one."""
    for axis, part in ((0, q), (1, p)):
        velocity[node, axis] += part * inverse_mass[node]
        velocity[first, axis] -= (1.0 - xi) * part * inverse_mass[first]
        velocity[second, axis] -= xi * part * inverse_mass[second]
