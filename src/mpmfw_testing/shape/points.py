"""Checks of the weights φ and gradients ∇φ of one point."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Inapplicable, within
from mpmfw_testing.searching import ladder
from mpmfw_testing.shape.cases import (
    AXES,
    MIDDLE,
    of_one_point,
    one_point,
    points,
    position,
    sampled,
    searched,
    two_points,
)
from mpmfw_testing.shape.placement import Placement
from mpmfw_testing.shape.sums import dense, entries_of, gradient_errors, linear_error, offsets, unity_error
from mpmfw_testing.subject import Subject

#: Rounding of sums of at most 64 products of order 1.
ROUNDING = 1e-12
#: Step of the finite difference [cells].
STEP = 1e-5


@of_one_point
def partition_of_unity(placed: Placement) -> None:
    """The weights of a point add up to 1, in every dimension. |Σ φ − 1| ≤ 1e-12: rounding alone; a part of a
    point's mass would otherwise be lost or made."""
    within(unity_error(placed.table(), 1), ROUNDING, "the weights of a point do not add up to 1: |Σ φ − 1|")


@of_one_point
def linear_reproduction(placed: Placement) -> None:
    """The weights' centroid is the point: Σ φ x_i = x_p, the centroid of its domain. |Σ φ x_i − x_p| ≤ 1e-12
    h: rounding alone.

    For a function that is averaged over a domain x_p is the domain's centroid, where layouts put points.
    Without it a linear velocity is read wrongly, and angular momentum changes with every transfer.
    """
    error = linear_error(placed.table(), 1, placed.particles.position[1], placed.grid)
    within(error, ROUNDING, "the weights' centroid is not the point: |Σ φ x_i − x_p| in cells")


@of_one_point
def non_negative(placed: Placement) -> None:
    """No weight is negative, so that lumped masses are positive. φ ≥ −1e-15, rounding alone: a negative
    weight can make a node's lumped mass zero or negative."""
    table = placed.table()
    within(-table.weight[entries_of(table, 1)].min(), 1e-15, "a weight is negative: −φ")


@searched(
    lambda dim: {
        **points(dim),
        "across": sampled(AXES[:dim]),
        "crosses": sampled(("point", "front face", "rear face")),
    },
    examples=20,
)
def continuity(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """Weights are continuous as a point or its domain crosses a face. |φ(x + ε) − φ(x − ε)| ≤ 1e-7 for ε =
    1e-9 h: a slope of up to 50 per cell passes, a jump does not.

    The point itself, or a face of its domain, crosses from one cell into the next.
    """
    side = {"point": 0.0, "front face": -0.5, "rear face": 0.5}[case["crosses"]]
    centre, axis = position(case, dim), AXES.index(case["across"])
    centre[axis] = MIDDLE + side * case["edge [cells]"]
    before, after = _moved_weights(subject, centre, case["edge [cells]"], axis, 1e-9)
    within(np.abs(after - before).max(), 1e-7, "a weight jumps as the point goes from one cell to the next")


def _moved_weights(
    subject: Subject, centre: FloatArray, edge: float, axis: int, by: float
) -> tuple[FloatArray, FloatArray]:
    """Return the weights on the whole grid of a point moved back and forth along an axis [cells]."""
    found = []
    for side in (-by, by):
        placed = two_points(subject, centre + side * np.eye(len(centre))[axis], edge)
        found.append(dense(placed.table(), 1, placed.grid)[0])
    return found[0], found[1]


@searched()
def regular_spread(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """Σ φ q qᵀ, q = x_i − x_p, can be inverted, or singular_spread is declared. The smallest eigenvalue of
    D_p = Σ φ q qᵀ, q = x_i − x_p, is at least 0.01 h².

    Affine transfers multiply by D⁻¹. A D that vanishes somewhere must be declared with ``singular_spread``,
    so that ∇φ is taken instead. A domain of a tenth of a cell leaves 0.025 h² with GIMP. Where ``spread`` is
    declared, D is h² times it.
    """
    if subject.make().singular_spread:
        raise Inapplicable("singular_spread is declared: affine transfers take Σ v ∇φᵀ")
    placed = one_point(subject, case, dim)
    table = placed.table()
    q = offsets(table, 1, placed.particles.position[1], placed.grid)
    tensor = (table.weight[entries_of(table, 1), None] * q).T @ q
    least = np.linalg.eigvalsh(0.5 * (tensor + tensor.T)).min()
    declared = subject.make().spread
    if declared is not None:
        within(abs(tensor - declared * np.eye(dim)).max(), 1e-12, "D_p is not h² times the declared spread")
    text = "D_p is singular, or nearly: −(least eigenvalue) in h²; is singular_spread to be declared?"
    within(-least, -0.01, text)


@of_one_point
def gradient_sums(placed: Placement) -> None:
    """Σ ∇φ = 0 and Σ x_i ⊗ ∇φ = 1, in every dimension. h |Σ ∇φ| and |Σ x_i ⊗ ∇φ − 1| are at most 1e-10.

    With the first, a uniform velocity strains nothing and internal forces add up to zero; with the second, a
    uniform velocity gradient is read correctly. Domains of a tenth of a cell multiply rounding by 10 and
    more, whence the bound.
    """
    constant, linear = gradient_errors(placed.table(), 1, placed.particles.position[1], placed.grid)
    within(constant, 1e-10, "the gradients do not add up to zero: h |Σ ∇φ|")
    within(linear, 1e-10, "a linear field has the wrong gradient: |Σ x_i ⊗ ∇φ − 1|")


@searched(
    lambda dim: {
        **{f"place along {axis}": ladder(0.2, 0.8, 13) for axis in AXES[:dim]},
        "edge [cells]": sampled((0.5, 0.25, 0.1)),
    },
    examples=8,
)
def gradient_is_derivative(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """Within one cell ∇φ is the derivative of φ as the point moves, its domain with it. h |∇φ − dφ/dx_p| ≤
    1e-4, by central differences of 1e-5 h, the domain moving along with its point.

    Within one cell the mean of ∇N over the domain (GIMP), the gradient of the function between the domain's
    corners (CPDI, CPDI2) and the gradient at the point (linear functions, splines) all are the derivative of
    the weight. Across cells CPDI's gradient is another one by design, tied to forces by ``constant-stress``.
    The bound allows for a kink of ∇φ, which a difference smears over its step.
    """
    edge = float(case["edge [cells]"])
    place = np.array([case[f"place along {axis}"] for axis in AXES[:dim]])
    centre = MIDDLE + edge / 2.0 + (1.0 - edge) * place
    placed = two_points(subject, centre, edge)
    gradient = dense(placed.table(), 1, placed.grid)[1]
    for axis in range(dim):
        before, after = _moved_weights(subject, centre, edge, axis, STEP)
        error = np.abs((after - before) / (2.0 * STEP) - gradient[..., axis]).max()
        text = "the gradient is not the derivative of the weight: h |∇φ − dφ/dx_p|"
        within(error, 1e-4, text, {"derivative": f"d/d{AXES[axis]}"})


#: In the order in which they are run.
CHECKS = (
    partition_of_unity, linear_reproduction, non_negative, continuity, regular_spread,
    gradient_sums, gradient_is_derivative,
)  # fmt: skip
