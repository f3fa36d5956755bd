"""Rolling under a viscous friction: what [H17]'s increments of one step amount to.

f_t = −k_t Δg_t of one step is −k_t Δt v for a slip velocity v: a dashpot with c = k_t Δt at every slave node.
Over a contact of width w the slave nodes' k_t = κ M l_trib / h add up to κ M w / h.

A rigid cylinder, I = m R²/2, under F = c v: m ẍ = m g sin θ − F and I ω̇ = F R, so that v = ẋ − R ω obeys
v̇ = g sin θ − 3 c v / m, and ẍ = (2/3) g sin θ + v̇/3. From rest, with τ = m/(3c),

    x = g sin θ t²/3 + s/3,  s = g sin θ τ (t − τ (1 − e^(−t/τ))) the distance slipped.
"""

from __future__ import annotations

import math


def viscosity(modulus: float, width: float, cell_size: float, time_step: float) -> float:
    """c = κ M w Δt / h for κ = 1 [N s/m per metre of thickness]."""
    return modulus * width * time_step / cell_size


def displacement_after(time: float, drag: float, mass: float, gravity: float, tilt: float) -> float:
    """Of the centre along the plane [m], from rest, for a drag c [N s/m/m] and a mass [kg/m]."""
    pull = gravity * math.sin(tilt)
    decay = mass / (3.0 * drag)
    slipped = pull * decay * (time - decay * -math.expm1(-time / decay))
    return pull * time**2 / 3.0 + slipped / 3.0
