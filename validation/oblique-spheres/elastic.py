"""Maw, Barber and Fawcett's elastic sphere: tangential compliance and partial slip through the impact.

The problem of Hertz and Mindlin is solved by the method of dimensionality reduction (V. L. Popov, M. Heß, *Method of
Dimensionality Reduction in Contact Mechanics and Friction*, 2015): of a row of springs that do not see each other, E* dx along
the normal and G* dx along the plane, under a parabola x² / R, force, approach and partial slip are those of the sphere,
whatever the history.
"""

from __future__ import annotations

import functools
import math

import numpy as np
from thrown import APPROACH, CONTACT_TIME, E_STAR, FRICTION, MASS, POISSON, RADIUS, SPEED

#: Springs on each side of the middle, and steps of the time of contact.
SPRINGS, STEPS = 400, 4000
#: G* / E* = 2 (1 − ν) / (2 − ν)
RATIO = 2.0 * (1.0 - POISSON) / (2.0 - POISSON)
#: χ of Maw, Barber and Fawcett: of ψ1 = (1 − ν) v_t 2 / (μ (2 − ν) v_n) from 4 χ − 1 on the sphere slides throughout.
CHI = 0.5 * RATIO * 3.5


def psi(slope: float) -> float:
    """ψ1 of v_t / v_n."""
    return RATIO * slope / FRICTION


@functools.cache
def rebound(slope: float, springs: int = SPRINGS, steps: int = STEPS) -> float:
    """Velocity of the point of contact along the plane after the impact, over v_t, of a sphere with v_t / v_n = ``slope``."""
    x = (np.arange(springs) + 0.5) / springs * 1.02 * math.sqrt(RADIUS * APPROACH)
    each, dt = 2.0 * E_STAR * (x[1] - x[0]), CONTACT_TIME / steps
    depth, velocity, sliding = 0.0, SPEED, slope * SPEED
    drawn = np.zeros(springs)
    while depth >= 0.0:
        depth += 0.5 * dt * velocity
        pressed = np.maximum(depth - x**2 / RADIUS, 0.0)
        bound = FRICTION * pressed / RATIO
        drawn = np.clip(drawn + sliding * dt, -bound, bound)
        velocity -= dt * each * float(pressed.sum()) / MASS
        sliding -= dt * each * RATIO * float(drawn.sum()) * 3.5 / MASS
        depth += 0.5 * dt * velocity
    return sliding / (slope * SPEED)


def sliding_limit() -> float:
    """Departure of the solution from that of sliding throughout, ψ2 = ψ1 − 4 χ, at ψ1 = 4 χ, beyond the limit."""
    slope = 4.0 * CHI * FRICTION / RATIO
    return psi(slope) * rebound(slope)


def refined() -> float:
    """By how much half as many springs and steps change what is left at 45°, over v_t."""
    return abs(rebound(1.0, SPRINGS // 2, STEPS // 2) - rebound(1.0))
