"""Return of stresses to the yield surfaces of soils whose moduli are constant, or grow with pressure.

With the exponent n of Houlsby, Amorosi & Rojas (2005, Géotechnique 55, 383-392), their pressure counted from
−p₀, m = n / (1 − n), K' = (1 − n) K and the linear stress t = K' tr ε 1 + 2 G dev ε the stress is

    τ = p₀ 1 + A (t − p₀ 1),   A = v^m,   v² = (1 − p/p₀)² + K' J₂ / (G p₀²),   p and J₂ those of t.

The energy is p₀² (v^(2 + m) − 1) / ((2 + m) K') + p₀ tr ε. Under a pressure q alone K and G are (1 + q/p₀)^n
times those at 0. Flow has the directions of t, so that t returns as if elasticity were linear."""

from __future__ import annotations

import math

from mpmfw.kernels import device, scratch
from mpmfw.kernels.types import Float, Floats
from mpmfw_material._plastic import SPACE


def norm_square(t: Floats, bulk: float, shear: float, reference: float) -> Float:
    """Return v² of principal stresses t (3, …)."""
    p = (t[0] + t[1] + t[2]) / 3.0
    second = 0.5 * ((t[0] - p) ** 2 + (t[1] - p) ** 2 + (t[2] - p) ** 2)
    return (1.0 - p / reference) ** 2 + bulk * second / (shear * reference**2)


_norm_square = device(norm_square)


@device
def wave_modulus(
    t: Floats, bulk: float, shear: float, stiffening: tuple[float, float], factor: float
) -> Float:
    """Return the largest elastic modulus of plane waves at linear stresses t, by K', G, (m, p₀) and A."""
    power, reference = stiffening
    largest = max((t[0] - reference) ** 2, (t[1] - reference) ** 2, (t[2] - reference) ** 2) / reference**2
    along = power * bulk * largest / _norm_square(t, bulk, shear, reference)
    return factor * (bulk + 4.0 / 3.0 * shear + along)


@device
def closing_volume(
    opened: Float, strain: Floats, bulk: float, shear: float, stiffening: tuple[float, float]
) -> Float:
    """Return the part of the ``opened`` volume (a logarithm) that closes before there is pressure.

    It closes at the tr ε at which shear leaves no mean stress, v² = v^(−2 m) + K' J₂ / (G p₀²): Newton's
    method on the logarithm of that, a convex function of ln v, from below."""
    if opened == 0.0:
        return 0.0
    (power, reference), free = stiffening, 0.0
    volumetric = strain[0] + strain[1] + strain[2]
    if power > 0.0:
        square = strain[0] ** 2 + strain[1] ** 2 + strain[2] ** 2 - volumetric**2 / 3.0
        part = 2.0 * bulk * shear * max(square, 0.0) / reference**2
        log_v = 0.0
        for _ in range(8):
            less = math.expm1(-2.0 * power * log_v)
            slope = 2.0 + 2.0 * power * (1.0 + less) / (1.0 + less + part)
            log_v += (math.log1p(less + part) - 2.0 * log_v) / slope
        free = -reference * math.expm1(-power * log_v) / bulk
    return min(opened, max(free - volumetric, 0.0))


@device
def return_to_cone(tau: Floats, bulk: float, shear: float, surface: tuple[float, float, float]) -> bool:
    """Return principal stresses to √J₂ + η p ≤ k, with the flow of √J₂ + η̄ p; ``surface`` is (η, η̄, k).

    de Souza Neto, Perić & Owen (2008), boxes 8.8 and 8.9: on the cone Δγ = f / (G + K η η̄), else its apex.
    """
    friction, dilation, cohesion = surface
    p = (tau[0] + tau[1] + tau[2]) / 3.0
    root = math.sqrt(0.5 * ((tau[0] - p) ** 2 + (tau[1] - p) ** 2 + (tau[2] - p) ** 2))
    excess = root + friction * p - cohesion
    if excess <= 0.0:
        return False
    slip = excess / (shear + bulk * friction * dilation)
    if shear * slip < root:
        mean, factor = p - bulk * dilation * slip, 1.0 - shear * slip / root
    else:
        mean, factor = cohesion / friction, 0.0
    for a in range(3):
        tau[a] = mean + factor * (tau[a] - p)
    return True


@device
def flow_stress(a: int, plane: tuple[int, int], bulk: float, shear: float, dilation: float) -> Float:
    """(D r)_a for the flow r = (1 + sin ψ) e_i − (1 − sin ψ) e_j of the plane (i, j)."""
    along = (1.0 + dilation if a == plane[0] else 0.0) - (1.0 - dilation if a == plane[1] else 0.0)
    return 2.0 * shear * along + (bulk - 2.0 / 3.0 * shear) * 2.0 * dilation


@device
def fall(
    of: tuple[int, int], by: tuple[int, int], bulk: float, shear: float, friction: float, dilation: float
) -> Float:
    """Fall of the yield function of one plane per unit of flow on another: n · D r, symmetric."""
    return (1.0 + friction) * flow_stress(of[0], by, bulk, shear, dilation) - (1.0 - friction) * flow_stress(
        of[1], by, bulk, shear, dilation
    )


@device
def return_to_pyramid(tau: Floats, bulk: float, shear: float, surface: tuple[float, float, float]) -> bool:
    """Return principal stresses to f = (1 + sin φ) τ_i − (1 − sin φ) τ_j − 2 c cos φ ≤ 0 of all planes.

    ``surface`` is (sin φ, sin ψ, 2 c cos φ). With τ₁ ≥ τ₂ ≥ τ₃ flow is on the plane (1, 3); on the edge with
    (1, 2) or (2, 3), if the order changes otherwise; or at the apex c cot φ. de Souza Neto, Perić & Owen
    (2008), boxes 8.4 to 8.7.
    """
    friction, dilation, cohesion = surface
    i, k = 0, 0
    for a in range(1, 3):
        i = a if tau[a] > tau[i] else i
        k = a if tau[a] <= tau[k] else k
    j = 3 - i - k
    main = (1.0 + friction) * tau[i] - (1.0 - friction) * tau[k] - cohesion
    if main <= 0.0:
        return False
    own = fall((i, k), (i, k), bulk, shear, friction, dilation)
    trial = scratch.vector(SPACE)
    for a in range(3):
        trial[a] = tau[a]
        tau[a] -= main / own * flow_stress(a, (i, k), bulk, shear, dilation)
    if tau[i] >= tau[j] >= tau[k]:
        return True
    beside = (i, j) if tau[j] < tau[k] else (j, k)
    other = (1.0 + friction) * trial[beside[0]] - (1.0 - friction) * trial[beside[1]] - cohesion
    both = fall((i, k), beside, bulk, shear, friction, dilation)
    scale = 1.0 / (own * own - both * both)
    for a in range(3):
        tau[a] = trial[a] - scale * (
            (own * main - both * other) * flow_stress(a, (i, k), bulk, shear, dilation)
            + (own * other - both * main) * flow_stress(a, beside, bulk, shear, dilation)
        )
    if tau[i] < tau[k]:
        for a in range(3):
            tau[a] = 0.5 * cohesion / friction
    return True


@device
def return_stress(
    tau: Floats, bulk: float, shear: float, surface: tuple[float, float, float], tension: float, cone: bool
) -> bool:
    """Return trial stresses ``tau`` to the yield surface and to a mean tension of at most ``tension``.

    Return True if they flow. At the cut-off the volume flows freely: the mean is that tension, and the other
    surface takes what is left as if K were 0.
    """
    trial = scratch.vector(SPACE)
    for a in range(3):
        trial[a] = tau[a]
    flows = (
        return_to_cone(tau, bulk, shear, surface) if cone else return_to_pyramid(tau, bulk, shear, surface)
    )
    if tau[0] + tau[1] + tau[2] <= 3.0 * tension:
        return flows
    mean = (trial[0] + trial[1] + trial[2]) / 3.0
    for a in range(3):
        tau[a] = trial[a] - mean + tension
    if cone:
        return_to_cone(tau, 0.0, shear, surface)
    else:
        return_to_pyramid(tau, 0.0, shear, surface)
    return True


@device
def return_stiffened(
    t: Floats, bulk: float, shear: float, surface: tuple[float, float, float], tension: float, cone: bool,
    stiffening: tuple[float, float],
) -> tuple[bool, float]:  # fmt: skip
    """Return linear trial stresses t to the surface; return whether they flow, and A.

    ``stiffening`` is (m, p₀). In t strength and tension are those given over A, and 1 − 1/A times those of an
    apex at p₀. The root of v^m/A = 1 lies between 1/A = 0 and that at the apex; false position finds it
    (after Illinois)."""
    power, reference = stiffening
    if power == 0.0:
        return return_stress(t, bulk, shear, surface, tension, cone), 1.0
    trial = scratch.vector(SPACE)
    for a in range(3):
        trial[a] = t[a]
    friction, dilation, cohesion = surface
    farthest = (friction if cone else 2.0 * friction) * reference
    low, left, high, right = 0.0, -1.0, (1.0 - tension / reference) ** (-power / (1.0 + power)), 0.0
    part, flows, side = min(_norm_square(t, bulk, shear, reference) ** (-0.5 * power), high), True, 0
    for _ in range(60):
        for a in range(3):
            t[a] = trial[a]
        strength = part * cohesion + (1.0 - part) * farthest
        cut = part * tension + (1.0 - part) * reference
        flows = return_stress(t, bulk, shear, (friction, dilation, strength), cut, cone)
        error = part * _norm_square(t, bulk, shear, reference) ** (0.5 * power) - 1.0
        elastic = side == 0 and not flows  # at the first 1/A, that of the trial
        if elastic or abs(error) <= 1e-14 * (1.0 + power) or (part == high and error < 0.0):
            break
        if error > 0.0:
            left *= 0.5 if side == 1 else 1.0
            high, right, side = part, error, 1
        else:
            right *= 0.5 if side == -1 else 1.0
            low, left, side = part, error, -1
        part = high - right * (high - low) / (right - left)
    return flows, 1.0 / part
