"""Kernels of contact at shared grid nodes, for any number of dimensions, bodies and pairs."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.types import Floats, Indices, Ints


class Contacts(NamedTuple):
    """Nodes shared by the two bodies of a pair."""

    pair: Ints  #: (n,) index of the pair
    node_a: Ints  #: (n,) flat node of the first body's field
    node_b: Ints  #: (n,) flat node of the second body's field
    normal: Floats  #: (n, dim) unit normal out of the first body; 0 where the bodies do not touch
    impulse: Floats  #: (n, dim) impulse on the first body, 0 where the two do not approach [N s/m]
    work: Floats  #: (n,) work of friction [J/m]


def empty_contacts(capacity: int, dim: int) -> Contacts:
    """Room for ``capacity`` shared nodes."""
    pair, a, b = (np.zeros(capacity, dtype=np.int64) for _ in range(3))
    return Contacts(pair, a, b, np.zeros((capacity, dim)), np.zeros((capacity, dim)), np.zeros(capacity))


@kernel
def find_shared_nodes(
    first: Ints,
    second: Ints,
    window_lower: Ints,
    window_shape: Ints,
    offset: Ints,
    node_mass: Floats,
    pair: Ints,
    node_a: Ints,
    node_b: Ints,
) -> int:
    """List the nodes where both bodies of a pair have mass; return how many there are, stored or not.

    Only the intersection of the two windows is visited: bodies apart cost a comparison.
    """
    dim = window_lower.shape[1]
    count = 0
    for c in range(len(first)):
        a, b = first[c], second[c]
        total = 1
        for d in range(dim):
            low = max(window_lower[a, d], window_lower[b, d])
            high = min(window_lower[a, d] + window_shape[a, d], window_lower[b, d] + window_shape[b, d])
            total *= max(high - low, 0)
        for flat in range(total):
            rest = flat
            i, j, stride_a, stride_b = 0, 0, 1, 1
            for reverse in range(dim):
                d = dim - 1 - reverse
                low = max(window_lower[a, d], window_lower[b, d])
                high = min(window_lower[a, d] + window_shape[a, d], window_lower[b, d] + window_shape[b, d])
                index = low + rest % (high - low)
                rest //= high - low
                i += (index - window_lower[a, d]) * stride_a
                j += (index - window_lower[b, d]) * stride_b
                stride_a *= window_shape[a, d]
                stride_b *= window_shape[b, d]
            i, j = offset[a] + i, offset[b] + j
            if node_mass[i] > 0.0 and node_mass[j] > 0.0:
                if count < len(pair):
                    pair[count], node_a[count], node_b[count] = c, i, j
                count += 1
    return count


@kernel
def project_volume_gradient(
    row: Ints, nodes: Indices, gradient: Floats, volume: Floats, out: Floats, spacing: tuple[float, ...]
) -> None:
    """Σ_p V_p ∇φ_ip, which points out of the body."""
    dim = len(spacing)
    out[:] = 0.0
    for p in range(len(volume)):
        for k in range(row[p], row[p + 1]):
            for d in range(dim):
                out[nodes[k], d] += volume[p] * gradient[k, d]


@kernel
def project_position(
    row: Ints,
    nodes: Indices,
    weight: Floats,
    mass: Floats,
    position: Floats,
    node_mass: Floats,
    out: Floats,
    spacing: tuple[float, ...],
) -> None:
    """Σ_p φ_ip m_p x_p / m_i."""
    dim = len(spacing)
    out[:] = 0.0
    for p in range(len(mass)):
        for k in range(row[p], row[p + 1]):
            for d in range(dim):
                out[nodes[k], d] += weight[k] * mass[p] * position[p, d]
    for i in range(len(node_mass)):
        if node_mass[i] > 0.0:
            for d in range(dim):
                out[i, d] /= node_mass[i]


@kernel
def pair_normals(
    count: int,
    pair: Ints,
    node_a: Ints,
    node_b: Ints,
    weight_first: Floats,
    weight_second: Floats,
    given: Floats,
    gradient: Floats,
    mean: Floats,
    cut_off: float,
    normal: Floats,
    spacing: tuple[float, ...],
) -> None:
    """n ∝ w_a g_a − w_b g_b, or the given one; 0 where the extrapolated separation exceeds the cut-off."""
    dim = len(spacing)
    for c in range(count):
        i, j = node_a[c], node_b[c]
        square = 0.0
        for d in range(dim):
            n = given[d]
            if len(gradient) > 0:
                n = weight_first[pair[c]] * gradient[i, d] - weight_second[pair[c]] * gradient[j, d]
            normal[c, d] = n
            square += n * n
        length = math.sqrt(square)
        separation = 0.0
        for d in range(dim):
            normal[c, d] = normal[c, d] / length if length > 0.0 else 0.0
            if len(mean) > 0:
                separation += (mean[j, d] - mean[i, d]) * normal[c, d]
        if separation >= cut_off:
            for d in range(dim):
                normal[c, d] = 0.0


@kernel
def correct_momentum(
    count: int,
    pair: Ints,
    node_a: Ints,
    node_b: Ints,
    normal: Floats,
    impulse: Floats,
    work: Floats,
    projected: bool,
    friction: Floats,
    node_mass: Floats,
    node_momentum: Floats,
    sharers: Floats,
    spacing: tuple[float, ...],
) -> None:
    """Take away approach and, within Coulomb's cone, slip at shared nodes.

    With Δv = v_a − v_b and the reduced mass m of the masses that a and b spend on this pair: J_n = m Δv·n if positive,
    J_t = min(μ J_n, m |Δv_t|), and (m v)_a −= J_n n + J_t t, (m v)_b += the same.

    The work of J_t is its product with the slip: with the mean of before and after where the momentum is as
    ``projected``, and with what is left at the end of the step where it is updated, since J_t then acts beside the forces
    of the step. Bodies that stick have no slip left, and friction does no work.
    """
    dim = len(spacing)
    slip = scratch.vector(spacing)
    for c in range(count):
        sharers[node_a[c]] = 0.0
        sharers[node_b[c]] = 0.0
    for c in range(count):  # who takes part: all decided before anything moves
        i, j = node_a[c], node_b[c]
        approach = 0.0
        for d in range(dim):
            approach += (node_momentum[i, d] / node_mass[i] - node_momentum[j, d] / node_mass[j]) * normal[
                c, d
            ]
        impulse[c, 0] = approach
        if approach > 0.0:
            sharers[i] += 1.0
            sharers[j] += 1.0
    for c in range(count):
        i, j = node_a[c], node_b[c]
        approach = impulse[c, 0]
        work[c] = 0.0
        for d in range(dim):
            impulse[c, d] = 0.0
        if approach > 0.0:
            m_a, m_b = node_mass[i] / sharers[i], node_mass[j] / sharers[j]
            m = m_a * m_b / (m_a + m_b)
            square = 0.0
            for d in range(dim):
                relative = node_momentum[i, d] / node_mass[i] - node_momentum[j, d] / node_mass[j]
                slip[d] = relative - approach * normal[c, d]
                square += slip[d] * slip[d]
            speed = math.sqrt(square)
            tangential = min(friction[pair[c]] * m * approach, m * speed)
            for d in range(dim):
                direction = slip[d] / speed if speed > 0.0 else 0.0
                impulse[c, d] = -m * approach * normal[c, d] - tangential * direction
            left = speed - tangential / m
            work[c] = tangential * (0.5 * (speed + left) if projected else left)
    for c in range(count):
        for d in range(dim):
            node_momentum[node_a[c], d] += impulse[c, d]
            node_momentum[node_b[c], d] -= impulse[c, d]


@kernel
def record(
    count: int,
    pair: Ints,
    impulse: Floats,
    work: Floats,
    pair_impulse: Floats,
    frictional_work: Floats,
    contact_count: Floats,
    spacing: tuple[float, ...],
) -> None:
    """Add a correction to the pairs' impulses and works, and count the nodes that it touched."""
    dim = len(spacing)
    contact_count[:] = 0.0
    for c in range(count):
        touched = False
        for d in range(dim):
            pair_impulse[pair[c], d] += impulse[c, d]
            touched = touched or impulse[c, d] != 0.0
        frictional_work[pair[c]] += work[c]
        contact_count[pair[c]] += 1.0 if touched else 0.0
