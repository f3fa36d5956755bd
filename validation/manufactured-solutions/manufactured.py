"""Two motions of a Neo-Hookean solid, and the body forces with which they satisfy the equation of motion.

Kamojjala, Brannon, Sadeghirad & Guilkey (2015): Verification tests in solid mechanics. Engineering with
Computers 31, 193–213. Theirs are for another stored energy; the body forces here follow from W = K/2 [(J² −
1)/2 − ln J] + G/2 [J^(−2/3) tr b − 3], plane strain, by hand: b = ü − Div P / ρ0. Nothing of the product's
stress is used."""

import math
from typing import NamedTuple

import numpy as np

from mpmfw.state.fields import FloatArray

BULK, SHEAR, DENSITY = 1.0, 0.5, 1.0  # Pa, Pa, kg/m³: as in the scenes
WAVE = math.sqrt((BULK + 4.0 * SHEAR / 3.0) / DENSITY)  # m/s


class AxisAligned(NamedTuple):
    """u_x = A sin 2πX sin ωt, u_y = A sin 2πY sin(ωt + π) in the unit square.

    F is diagonal, so that the walls see neither normal displacement nor shear.
    """

    amplitude: float = 0.05  #: m; stretches to 1 ± 0.31
    rate: float = math.pi * WAVE  #: ω [rad/s], a standing wave of about the solid's own
    end: float = 0.75 * 2.0 / WAVE  #: s, three quarters of a period, the displacement at its largest

    def _signs(self) -> FloatArray:
        return self.amplitude * np.array([1.0, -1.0])

    def position(self, start: FloatArray, time: float) -> FloatArray:
        """x = X + u."""
        return start + self._signs() * math.sin(self.rate * time) * np.sin(2.0 * math.pi * start)

    def velocity(self, start: FloatArray, time: float) -> FloatArray:
        """u̇."""
        return self._signs() * self.rate * math.cos(self.rate * time) * np.sin(2.0 * math.pi * start)

    def body_force(self, start: FloatArray, time: float) -> FloatArray:
        """ü − ∂P_aa/∂F_aa ∂F_aa/∂X_a / ρ0: P_aa depends on X_a through F_aa alone."""
        swing = self._signs() * math.sin(self.rate * time)
        wave = np.sin(2.0 * math.pi * start)
        stretch = 1.0 + swing * 2.0 * math.pi * np.cos(2.0 * math.pi * start)
        bending = -swing * (2.0 * math.pi) ** 2 * wave
        return -(self.rate**2) * swing * wave - stiffness(stretch, stretch[:, ::-1]) * bending / DENSITY


def stiffness(f: FloatArray, g: FloatArray) -> FloatArray:
    """∂P_11/∂F_11 for F = diag(f, g, 1) [Pa].

    W = K/2 [(f²g² − 1)/2 − ln fg] + G/2 [(fg)^(−2/3) (f² + g² + 1) − 3], differentiated twice by f.
    """
    volumetric = 0.5 * BULK * (g**2 + 1.0 / f**2)
    # (fg)^(-2/3) (f² + s) with s = g² + 1: g^(-2/3) (f^(4/3) + s f^(-2/3))
    s = g**2 + 1.0
    isochoric = g ** (-2.0 / 3.0) * (4.0 / 9.0 * f ** (-2.0 / 3.0) + 10.0 / 9.0 * s * f ** (-8.0 / 3.0))
    return np.asarray(volumetric + 0.5 * SHEAR * isochoric)


class Vortex(NamedTuple):
    """θ = Θ + α, r = R, α = A sin ωt (1 − 16 (R − 1)²)² in the ring 3/4 ≤ R ≤ 5/4.

    J = 1 and b − 1 has only the shear γ = R ∂α/∂R: σ_rr = −G γ²/3, σ_θθ = 2 G γ²/3, σ_rθ = G γ. α and γ
    vanish on both edges, which are free."""

    amplitude: float = 0.1  #: A [rad]; γ up to 0.7
    rate: float = math.pi  #: ω [rad/s]
    end: float = 0.5  #: s, a quarter of a period

    def _shape(self, radius: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(1 − 16 s²)² and its first two derivatives, s = R − 1."""
        s = radius - 1.0
        q = 1.0 - 16.0 * s**2
        return q**2, -64.0 * s * q, -64.0 * q + 2048.0 * s**2

    def position(self, start: FloatArray, time: float) -> FloatArray:
        """X turned by α."""
        radius, angle = np.hypot(*start.T), np.arctan2(start[:, 1], start[:, 0])
        angle = angle + self.amplitude * math.sin(self.rate * time) * self._shape(radius)[0]
        return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def velocity(self, start: FloatArray, time: float) -> FloatArray:
        """α̇ e_z × x."""
        spin = self.amplitude * self.rate * math.cos(self.rate * time)
        x = self.position(start, time)
        alpha = spin * self._shape(np.hypot(*start.T))[0]
        return alpha[:, None] * np.stack([-x[:, 1], x[:, 0]], axis=1)

    def body_force(self, start: FloatArray, time: float) -> FloatArray:
        """Acceleration less div σ / ρ, in polar components at x.

        a_r = −R α̇², a_θ = R α̈; div σ = (∂σ_rr/∂r + (σ_rr − σ_θθ)/r, ∂σ_rθ/∂r + 2 σ_rθ/r).
        """
        r = np.hypot(*start.T)
        shape, slope, curvature = self._shape(r)
        swing, spin = (
            self.amplitude * math.sin(self.rate * time),
            self.amplitude * self.rate * math.cos(self.rate * time),
        )
        gamma, gamma_r = swing * r * slope, swing * (slope + r * curvature)
        radial = -SHEAR * (2.0 / 3.0 * gamma * gamma_r + gamma**2 / r)
        hoop = SHEAR * (gamma_r + 2.0 * gamma / r)
        b_r = -r * (spin * shape) ** 2 - radial / DENSITY
        b_t = -r * self.rate**2 * swing * shape - hoop / DENSITY
        e_r = self.position(start, time) / r[:, None]
        e_t = np.stack([-e_r[:, 1], e_r[:, 0]], axis=1)
        return b_r[:, None] * e_r + b_t[:, None] * e_t


#: x(X, t) (n, 2) [m], its velocity [m/s] and the body force per mass [m/s²] that drives it.
Motion = AxisAligned | Vortex
