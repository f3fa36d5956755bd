"""Spinning disc: angular momentum over one turn, and the inertia that answers a torque.

Every transfer with every scheme, every shape function, every treatment of rotational inertia. The torque is
known from the material points alone.
"""
# cost: 22

import math

import numpy as np
from common import PointForces, over

from mpmfw.runs.simulation import Simulation
from mpmfw.validation import RECOMMENDED, SHAPES, Runs, methods


def about_centre(particles):
    """Return positions [m] and velocities [m/s] of the points relative to those of the centre of mass."""
    share = particles.mass / particles.mass.sum()
    return particles.position - share @ particles.position, particles.velocity - share @ particles.velocity


def moment(particles, vectors, lever):
    """Return Σ m r × w."""
    return float(particles.mass @ (lever[:, 0] * vectors[:, 1] - lever[:, 1] * vectors[:, 0]))


class Torque(PointForces):
    """α e_z × r_p at the points at least ``inner`` [m] from the centre of mass, α = 20 rad/s².

    Without the points within ``inner`` the body shears as well as turns.
    """

    def __init__(self, inner):
        self.inner, self.impulse = inner, 0.0

    def acceleration(self, state, dt):
        """Add Σ m r × a over the step to the impulse [kg m²/s/m] as well."""
        p = state.particles
        lever, _ = about_centre(p)
        a = 20.0 * np.stack([-lever[:, 1], lever[:, 0]], axis=1)
        a *= ((lever**2).sum(axis=1) >= self.inner**2)[:, None]
        a -= p.mass @ a / p.mass.sum()
        self.impulse += dt * moment(p, a, lever)
        return a


def errors(scene):
    """Return relative errors of the inertia under a torque on the ``disc``, and on its ``rim`` alone."""
    return {name: effective_inertia(scene, inner) - 1.0 for name, inner in (("disc", 0.0), ("rim", 0.7))}


def effective_inertia(scene, inner, end=0.1):
    """Return I of ∫ τ dt = I ω, least squares over all steps until ``end`` [s], over m R² / 2.

    ω = Σ m r × v / Σ m |r|² over the points: how fast the material turns, whatever inertia the grid gives it.
    """
    sim, torque, rows = Simulation(scene), Torque(inner), []
    sim.start()
    p = sim.state.particles
    with sim.extra_plugin(torque):
        while sim.state.time < end:
            sim.step(sim.stable_step())
            lever, velocity = about_centre(p)
            rows.append((torque.impulse, moment(p, velocity, lever) / float(p.mass @ (lever**2).sum(axis=1))))
    impulse, spin = np.array(rows).T
    disc = 0.5 * math.pi * 1000.0  # ρ π R⁴ / 2 with R = 1 m, of the scene
    return float(impulse @ impulse / (impulse @ spin) / disc)


def change(tree):
    """Return the change of angular momentum over one turn [%]."""
    momentum = tree["series"]["angular_momentum"].isel(body=0, rotation=0).values
    return 100.0 * float(momentum[-1] / momentum[0] - 1.0)


def stepping(transfer, scheme, **further):
    """Return a transfer and a scheme, with further options."""
    options = {"transfer": transfer, "scheme": scheme, **further}
    return {f"stepping.{key}": value for key, value in options.items()}


ROTATION = over("bodies.disc.rotation", "rotation {}", ("exact", "lumped"))
TRANSFERS = ("flip", "pic", "apic", "tpic", "aflip")
STEPPING = {
    **{f"{one}, {scheme}": stepping(one, scheme) for one in TRANSFERS for scheme in ("usl", "musl", "usf")},
    "aflip, usl, C not transported": stepping("aflip", "usl", transported=False),
    "flip, usl, 5 % pic": stepping("flip", "usl", pic_fraction=0.05),
}
PLAIN = [*methods([""], RECOMMENDED, when="quick"), *methods([""], SHAPES, when="full")]
inertia = Runs(
    "inertia",
    methods=[*PLAIN, *methods([""], ["gimp", "cpdi", "cpdi2", "bspline"], ROTATION, when="full")],
    set={"bodies.disc.angular_velocity": 0.0},
    by=errors,
)


@Runs("turn", methods=[*PLAIN, *methods([""], settings={**STEPPING, **ROTATION}, when="full")])
def test_turn(run):
    run.gate("angular momentum, change per turn", run.of(change), 0.0, 0.05, "%")


@inertia
def test_inertia(run):
    for where, key in (("the disc", "disc"), ("its rim", "rim")):
        error = 100.0 * run.results[key]
        run.gate(f"inertia under a torque on {where}, error", error, 0.0, 0.5, "%")
