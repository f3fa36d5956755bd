"""Manufactured solutions: the order at which the steps without contact converge in space and in time.

Kamojjala, Brannon, Sadeghirad & Guilkey (2015): Verification tests in solid mechanics. Engineering with
Computers 31, 193–213. Theirs are for another stored energy; the body forces here follow from W = K/2 [(J² −
1)/2 − ln J] + G/2 [J^(−2/3) tr b − 3], plane strain, by hand: b = ü − Div P / ρ0. Nothing of the product's
stress is used."""
# cost: 45

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from common import PointForces

from mpmfw.errors import SimulationError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.validation import RECOMMENDED, SHAPES, full, methods

BULK, SHEAR, DENSITY = 1.0, 0.5, 1.0  # Pa, Pa, kg/m³: as in the scenes
WAVE = math.sqrt((BULK + 4.0 * SHEAR / 3.0) / DENSITY)  # m/s


class AxisAligned(NamedTuple):
    """u_x = A sin 2πX sin ωt, u_y = A sin 2πY sin(ωt + π) in the unit square.

    F is diagonal, so that the walls see neither normal displacement nor shear.
    """

    amplitude: float = 0.05  #: m; stretches to 1 ± 0.31
    rate: float = math.pi * WAVE  #: ω [rad/s], a standing wave of about the solid's own
    end: float = 0.75 * 2.0 / WAVE  #: s, three quarters of a period, the displacement at its largest

    def _signs(self):
        return self.amplitude * np.array([1.0, -1.0])

    def position(self, start, time):
        """x = X + u."""
        return start + self._signs() * math.sin(self.rate * time) * np.sin(2.0 * math.pi * start)

    def velocity(self, start, time):
        """u̇."""
        return self._signs() * self.rate * math.cos(self.rate * time) * np.sin(2.0 * math.pi * start)

    def body_force(self, start, time):
        """ü − ∂P_aa/∂F_aa ∂F_aa/∂X_a / ρ0: P_aa depends on X_a through F_aa alone."""
        swing = self._signs() * math.sin(self.rate * time)
        wave = np.sin(2.0 * math.pi * start)
        stretch = 1.0 + swing * 2.0 * math.pi * np.cos(2.0 * math.pi * start)
        bending = -swing * (2.0 * math.pi) ** 2 * wave
        return -(self.rate**2) * swing * wave - stiffness(stretch, stretch[:, ::-1]) * bending / DENSITY


def stiffness(f, g):
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

    def _shape(self, radius):
        """(1 − 16 s²)² and its first two derivatives, s = R − 1."""
        s = radius - 1.0
        q = 1.0 - 16.0 * s**2
        return q**2, -64.0 * s * q, -64.0 * q + 2048.0 * s**2

    def position(self, start, time):
        """X turned by α."""
        radius, angle = np.hypot(*start.T), np.arctan2(start[:, 1], start[:, 0])
        angle = angle + self.amplitude * math.sin(self.rate * time) * self._shape(radius)[0]
        return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def velocity(self, start, time):
        """α̇ e_z × x."""
        spin = self.amplitude * self.rate * math.cos(self.rate * time)
        x = self.position(start, time)
        alpha = spin * self._shape(np.hypot(*start.T))[0]
        return alpha[:, None] * np.stack([-x[:, 1], x[:, 0]], axis=1)

    def body_force(self, start, time):
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


FOLDER = Path(__file__).parent


class BodyForce(PointForces):
    """b(X_p, t) of a motion, at points that start at X_p (n, 2) [m]."""

    def __init__(self, motion, start):
        self.motion, self.start = motion, start

    def acceleration(self, state, dt):  # noqa: ARG002
        """Return b."""
        return self.motion.body_force(self.start, state.time)


def displaced(scene, motion, shape, cell, courant):
    """Positions (n, 2) [m] of the points at the end, and what they should be.

    Velocities of the scheme belong to half steps (a leapfrog), so that points start with the velocity of t =
    −Δt/2."""
    sim = Simulation(load_scene(FOLDER / scene, set={"grid.cell_size": cell, "shape.method": shape}))
    sim.start()
    p = sim.state.particles
    start = p.position.copy()
    steps = math.ceil(motion.end / (courant * cell / WAVE))
    step = motion.end / steps
    p.velocity[...] = motion.velocity(start, -0.5 * step)
    if p.affine is not None:
        p.affine[...] = velocity_gradient(motion, start, -0.5 * step)
    with sim.extra_plugin(BodyForce(motion, start)):
        for _ in range(steps):
            sim.step(step)
    return p.position.copy(), motion.position(start, motion.end)


def velocity_gradient(motion, start, time):
    """∂v/∂X (n, 2, 2) [1/s] by central differences; X is x but for half a step."""
    shift = 1e-5
    columns = [
        (motion.velocity(start + d, time) - motion.velocity(start - d, time)) / (2.0 * shift)
        for d in shift * np.eye(2)
    ]
    return np.stack(columns, axis=2)


MOTIONS = {
    "axis-aligned": ("square.toml", AxisAligned()),
    "vortex": ("ring.toml", Vortex()),
}

#: Expected order in space (axis-aligned, vortex), at a fixed Courant number and with four points a cell.
#: linear: ∇φ jumps where points cross cells, a quadrature error of the stress that no refinement lessens.
#: gimp: domains that do not stretch leave gaps and overlaps in proportion to the strain, which no refinement
#: closes: a part of the error stays, and shows sooner where volumes change.
#: cpdi, cpdi2: bilinear interpolation, and domains that tile the body to second order in h.
#: bspline: a wall that fixes single nodes of a quadratic basis holds the boundary to first order. Without
#: walls 2, until the quadrature by points that lie anyhow among the knots is all that is left.
ORDER = {
    "linear": ("≤ 0", "≤ 0"),
    "gimp": ("1, falls", "2, falls"),
    "cpdi": (2, 2),
    "cpdi2": (2, 2),
    "bspline": (1, "2, falls"),
}
TIME_ORDER = 2  # velocities live at half steps
LEAST = 1.8  # of the recommended methods, where 2 is expected

COURANT, CELLS = 0.3, (32, 64)  # 1; 1/h [1/m]
STEPS = (0.0125, 0.2, 0.1)  # Courant numbers: of the finest step, and of the order in time against it
#: What the transfer between points and grid does depends on the number of steps, and not on their length; at
#: h = 1/16 it hides the truncation in time of the motion above. That of one eight times as fast stands out.
FAST = AxisAligned(rate=8.0 * math.pi * WAVE, end=2.75 * 2.0 / (8.0 * WAVE))


def order(coarse, fine):
    """Return the order by the root mean squares of differences (n, 2) with h or Δt and with half of it."""
    ratio = [float(np.sqrt((apart**2).sum(axis=1).mean())) for apart in (coarse, fine)]
    return math.log2(ratio[0] / ratio[1])


def test_space(case):
    """Judge the order of the errors at h = 1 / cells with a step in proportion."""
    cells = (8, 16) if case.quick else CELLS
    for k, (motion, (scene, exact)) in enumerate(MOTIONS.items()):
        for method in methods([""], RECOMMENDED if case.quick else SHAPES):
            quantity = f"{motion}: order in space, h = 1/{cells[0]} to 1/{cells[1]}"
            with case.timed():
                try:
                    pairs = [displaced(scene, exact, method.shape, 1.0 / count, COURANT) for count in cells]
                except SimulationError as error:
                    case.failed(method, f"{motion}: {error}")
                    continue
            found = order(*(reached - expected for reached, expected in pairs))
            case.gate(quantity, found, ORDER[method.shape][k], (LEAST, math.inf), method=method)


@full
def test_time(case):
    """Judge the order of the differences from a very small step at h = 1/16 [m]."""
    for method in methods([""], RECOMMENDED):
        with case.timed():
            finest, *ends = (displaced("square.toml", FAST, method.shape, 1.0 / 16.0, c)[0] for c in STEPS)
        quantity = f"axis-aligned, fast: order in time, c Δt / h = {STEPS[1]:g} to {STEPS[2]:g}"
        found = order(*(end - finest for end in ends))
        case.gate(quantity, found, TIME_ORDER, (LEAST, math.inf), method=method)
