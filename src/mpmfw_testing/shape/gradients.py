"""Checks of the gradients ∇φ of one point."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.searching import hypothesis, ladder
from mpmfw_testing.shape.cases import AXES, MIDDLE, of_one_point, require, search_dimensions, two_points
from mpmfw_testing.shape.placement import Placement
from mpmfw_testing.shape.sums import dense, gradient_errors
from mpmfw_testing.subject import Subject

#: Step of the finite difference [cells].
STEP = 1e-5


@of_one_point
def gradient_sums(placed: Placement) -> None:
    """Σ ∇φ = 0 and Σ x_i ⊗ ∇φ = 1, in every dimension. h |Σ ∇φ| and |Σ x_i ⊗ ∇φ − 1| are at most 1e-10.

    They are the gradients of Σ φ = 1 and of Σ φ x_i = x. Domains of a tenth of a cell multiply rounding by 10
    and more, whence the bound. With the first, a uniform velocity strains nothing and internal forces add up
    to zero; with the second, a uniform velocity gradient is read as it is, and a gradient's sign and its 1/h
    are right.
    """
    constant, linear = gradient_errors(placed.table(), 1, placed.particles.position[1], placed.grid)
    require(constant, 1e-10, "the gradients do not add up to zero: h |Σ ∇φ|", placed, 1)
    require(linear, 1e-10, "a linear field has the wrong gradient: |Σ x_i ⊗ ∇φ − 1|", placed, 1)


def gradient_is_derivative(subject: Subject) -> None:
    """Within one cell ∇φ is the derivative of φ as the point moves, its domain with it. h |∇φ − dφ/dx_p| ≤
    1e-4, by central differences of 1e-5 h, the domain moving along with its point.

    The domain is a square or cube within one cell. There the mean over the domain of ∇N (GIMP), the gradient
    of the function between the domain's corners (CPDI, CPDI2) and the gradient at the point (linear
    functions, splines) all are the derivative of the weight: N has no term above the first in any one
    coordinate, and what the corners leave out of it is odd in two coordinates, so that it cancels. Across
    cells CPDI's gradient is another one by design, tied to forces by ``constant-stress`` alone. The bound
    allows for a kink of ∇φ, which a difference smears over its step: 1e-5 times a second derivative of up to
    3 per cell².
    """

    def trial(dim: int, case: dict[str, Any]) -> None:
        edge = float(case["edge [cells]"])
        centre = np.full(dim, float(MIDDLE))
        for axis in range(dim):
            centre[axis] += edge / 2.0 + (1.0 - edge) * case[f"place along {AXES[axis]}"]
        placed = two_points(subject, centre, edge)
        gradient = dense(placed.table(), 1, placed.grid)[1]
        for axis in range(dim):
            difference = _difference(subject, centre, edge, axis)
            error = float(np.abs(difference - gradient[..., axis]).max())
            message = "the gradient is not the derivative of the weight: h |∇φ − dφ/dx_p|"
            require(error, 1e-4, message, placed, 1, derivative=f"d/d{AXES[axis]}")

    def cases(dim: int) -> dict[str, Any]:
        draw = hypothesis().strategies
        places = {f"place along {axis}": ladder(0.2, 0.8, 13) for axis in AXES[:dim]}
        return {**places, "edge [cells]": draw.sampled_from((0.5, 0.25, 0.1))}

    search_dimensions(subject, cases, trial, examples=8)


def _difference(subject: Subject, centre: FloatArray, edge: float, axis: int) -> FloatArray:
    """dφ/dx along one axis on the whole grid [1/cell], the domain moving along."""
    weights = []
    for side in (-STEP, STEP):
        moved = centre.copy()
        moved[axis] += side
        placed = two_points(subject, moved, edge)
        weights.append(dense(placed.table(), 1, placed.grid)[0])
    difference: FloatArray = (weights[1] - weights[0]) / (2.0 * STEP)
    return difference


#: In the order in which they are run.
CHECKS = (gradient_sums, gradient_is_derivative)
