"""Frictionless contact of two outlines by penalty springs from nodes to segments, both ways.

Each node of one outline that lies inside the other is drawn to the closest point of that outline by a spring;
both outlines take each part once, with half of the stiffness (two passes). The force is the exact gradient of
the springs' energy, because the closest point is stationary under a shift along its segment. No friction: the
problem is its own mirror image, so that neither ring can slide along the other."""

from typing import NamedTuple

import numpy as np

from mpmfw.kernels import kernel
from rings_fem.mesh import Floats, Integers


class Outline(NamedTuple):
    """Closed boundary of a body, counter-clockwise."""

    nodes: Integers  #: (n_outline,)
    stiffness: Floats  #: (n_outline,) of the spring of each node [N/m per m of thickness]


def outline_of(points: Floats, nodes: Integers, modulus_per_length: float) -> Outline:
    """Give each node half of ``modulus_per_length`` [Pa/m] times its tributary length."""
    ahead = np.linalg.norm(points[np.roll(nodes, -1)] - points[nodes], axis=1)
    return Outline(nodes, 0.5 * modulus_per_length * 0.5 * (ahead + np.roll(ahead, 1)))


@kernel
def side(points: Floats, nodes: Integers, k: int, dx: float, dy: float) -> float:
    """(dx, dy) along the outward normal of segment k, times its length; positive outside."""
    a, b = nodes[k], nodes[(k + 1) % len(nodes)]
    outward: float = (points[b, 1] - points[a, 1]) * dx - (points[b, 0] - points[a, 0]) * dy
    return outward


@kernel
def closest(points: Floats, nodes: Integers, x: float, y: float) -> tuple[int, float]:
    """Closest segment k of an outline to (x, y), and the place 0 ≤ ξ ≤ 1 on it."""
    segment, place, least = 0, 0.0, np.inf
    for k in range(len(nodes)):
        a, b = nodes[k], nodes[(k + 1) % len(nodes)]
        tx, ty = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        dx, dy = x - points[a, 0], y - points[a, 1]
        xi = min(max((dx * tx + dy * ty) / (tx * tx + ty * ty), 0.0), 1.0)
        dx, dy = dx - xi * tx, dy - xi * ty
        if dx * dx + dy * dy < least:
            segment, place, least = k, xi, dx * dx + dy * dy
    return segment, place


@kernel
def inside(points: Floats, nodes: Integers, k: int, xi: float, dx: float, dy: float) -> bool:
    """Return True if a point at (dx, dy) from its closest point on segment k is inside the outline."""
    outward = side(points, nodes, k, dx, dy)
    if xi == 0.0:  # a corner: one segment alone may see the point on its wrong side
        outward += side(points, nodes, k - 1, dx, dy)
    elif xi == 1.0:
        outward += side(points, nodes, (k + 1) % len(nodes), dx, dy)
    return outward < 0.0


@kernel
def box(points: Floats, nodes: Integers) -> tuple[float, float, float, float]:
    """Return least and greatest x, least and greatest y of an outline [m]."""
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    for node in nodes:
        left, right = min(left, points[node, 0]), max(right, points[node, 0])
        bottom, top = min(bottom, points[node, 1]), max(top, points[node, 1])
    return left, right, bottom, top


@kernel
def add_one_pass(points: Floats, slave: Outline, master: Outline, force: Floats) -> float:
    """Push the slave's nodes out of the master; returns the springs' energy [J/m]."""
    energy = 0.0
    left, right, bottom, top = box(points, master.nodes)
    for s in range(len(slave.nodes)):
        node = slave.nodes[s]
        x, y = points[node, 0], points[node, 1]
        if x < left or x > right or y < bottom or y > top:
            continue
        k, xi = closest(points, master.nodes, x, y)
        first, second = master.nodes[k], master.nodes[(k + 1) % len(master.nodes)]
        dx = x - (1.0 - xi) * points[first, 0] - xi * points[second, 0]
        dy = y - (1.0 - xi) * points[first, 1] - xi * points[second, 1]
        if not inside(points, master.nodes, k, xi, dx, dy):
            continue
        for axis, pull in ((0, -slave.stiffness[s] * dx), (1, -slave.stiffness[s] * dy)):
            force[node, axis] += pull
            force[first, axis] -= (1.0 - xi) * pull
            force[second, axis] -= xi * pull
        energy += 0.5 * slave.stiffness[s] * (dx * dx + dy * dy)
    return energy


@kernel
def add_contact_force(points: Floats, left: Outline, right: Outline, force: Floats) -> float:
    """Add the contact forces of both passes [N/m] to (n_nodes, 2) ``force``; returns their energy [J/m]."""
    return add_one_pass(points, left, right, force) + add_one_pass(points, right, left, force)
