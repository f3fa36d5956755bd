"""Maw, Barber and Fawcett's elastic sphere: tangential compliance and partial slip through the impact.

The problem of Hertz and Mindlin is solved by the method of dimensionality reduction (V. L. Popov, M. Heß,
*Method of Dimensionality Reduction in Contact Mechanics and Friction*, 2015): of a row of springs that do not
see each other, E* dx along the normal and G* dx along the plane, under a parabola x² / R, force, approach and
partial slip are those of the sphere, whatever the history. What is left does not depend on stiffness, mass or
speed: R, m, E* and the approach are one here."""

import functools
import math

import numpy as np

#: Springs on each side of the middle, and steps of the time of contact.
SPRINGS, STEPS = 400, 4000
#: v_n and the time of contact with R, m, E* and the approach one: 8/15 E* R^½ δ^(5/2) = m v_n² / 2, t =
#: 2.9432 δ / v_n
SPEED = math.sqrt(16.0 / 15.0)
CONTACT_TIME = 2.9432 / SPEED
#: 1 + m R² / I of a solid sphere: an impulse T at the contact changes its velocity there by 3.5 T / m.
LEVER = 3.5


def ratio(poisson: float) -> float:
    """G* / E* = 2 (1 − ν) / (2 − ν)"""
    return 2.0 * (1.0 - poisson) / (2.0 - poisson)


def sliding_from(poisson: float) -> float:
    """ψ1 = 4 χ − 1 from which on the sphere slides throughout, with χ = 7/4 of the ratio above."""
    return 2.0 * ratio(poisson) * LEVER - 1.0


def psi(slope: float, poisson: float) -> float:
    """ψ1 of the velocity of the point of contact along the plane over μ v_n."""
    return ratio(poisson) * slope


@functools.cache
def rebound(slope: float, poisson: float, springs: int = SPRINGS, steps: int = STEPS) -> float:
    """Return the velocity of the point of contact after the impact, over ``slope`` times μ v_n."""
    x = (np.arange(springs) + 0.5) / springs * 1.02
    each, dt, stiff = 2.0 * (x[1] - x[0]), CONTACT_TIME / steps, ratio(poisson)
    depth, velocity, sliding = 0.0, SPEED, slope * SPEED
    drawn = np.zeros(springs)  # over μ, as is sliding
    while depth >= 0.0:
        depth += 0.5 * dt * velocity
        pressed = np.maximum(depth - x**2, 0.0)
        bound = pressed / stiff
        drawn = np.clip(drawn + sliding * dt, -bound, bound)
        velocity -= dt * each * float(pressed.sum())
        sliding -= dt * each * stiff * float(drawn.sum()) * LEVER
        depth += 0.5 * dt * velocity
    return sliding / (slope * SPEED)


def sliding_limit(poisson: float = 0.3) -> float:
    """Return the departure from sliding throughout, ψ2 = ψ1 − 4 χ, at ψ1 = 4 χ, beyond the limit."""
    slope = (sliding_from(poisson) + 1.0) / ratio(poisson)
    return psi(slope, poisson) * rebound(slope, poisson)


def refined() -> float:
    """By how much half as many springs and steps change what is left at 45° with μ = 0.3."""
    return abs(rebound(1.0 / 0.3, 0.3, SPRINGS // 2, STEPS // 2) - rebound(1.0 / 0.3, 0.3))
