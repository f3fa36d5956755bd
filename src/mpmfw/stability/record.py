"""What a run's invariants are at every step, positions and velocities taken at the same time.

A step leaves velocities half a step behind positions. Their energies added as they stand swing by a part ω Δt
to either side, in every mode, which is no gain and no loss. At the time of the positions the kinetic energy
is Σ m v·v' / 2, v and v' of the steps before and after: with it a linear system keeps its energy exactly at
any stable step. Where these steps have different lengths the positions' time lies nearer to the velocities of
the shorter one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mpmfw.results import Frame
from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import FloatArray

#: Energy ratio past which a run is not followed any further.
HOPELESS = 1e3

#: Energy that does not count, as a share of what would strain all bodies by 1: rounding of bodies at rest.
NOTHING = 1e-14


class Hopeless(Exception):
    """A run whose energy is no number or beyond all bounds."""


class Record:
    """Sums over the bodies at every step; called with the frames of a run.

    Parameters
    ----------
    simulation
        What runs, with ``output.ledger`` and ``output.energy``.
    """

    def __init__(self, simulation: Simulation) -> None:
        self.state = simulation.state
        particles = simulation.state.particles
        volume = particles.through(particles.initial_volume)
        stiffness = [body.bulk_modulus + body.shear_modulus for body in simulation.state.bodies]
        volumes = [volume[body.particles].sum() for body in simulation.state.bodies]
        self.nothing = NOTHING * float(np.dot(volumes, stiffness))
        self.energy: list[float] = []  # ratios, with dissipation
        self.stored = 1.0
        self.momentum: list[FloatArray] = []
        self.gap = self.contact_steps = self.limit = np.inf
        self.touched = False
        self.input = self.first = self.first_given = 0.0
        self.length = self.at_positions = 0.0
        self.halves = (0.0, 0.0)
        self.velocity = np.zeros_like(self.state.particles.velocity)

    def __call__(self, frame: Frame) -> None:
        """Take note of a step.

        Raises
        ------
        Hopeless
            There is no use in going on.
        """
        series, particles = frame.series, self.state.particles
        at_positions = _total(series, ("strain_energy",))
        halves = _total(series, ("affine_energy",)), _total(series, ("gravity_work", "external_work"))
        if self.momentum:
            kinetic = self._kinetic()
            affine, given = (0.5 * (a + b) for a, b in zip(self.halves, halves, strict=True))
            stored = kinetic + self.at_positions + affine + _total(series, ("contact_energy",))
            self._weigh(
                stored,
                _total(series, ("frictional_work", "damping_work", "spring_work", "material_dissipation")),
                given,
            )
        self.length = self.state.dt
        self.velocity, self.at_positions, self.halves = particles.velocity.copy(), at_positions, halves
        self.momentum.append(np.array(series["linear_momentum"]))
        self.gap = min(self.gap, _least(series, "min_gap"))
        if len(self.momentum) > 1:
            self.limit = min(self.limit, _least(series, "time_step_limit"))
            self.contact_steps = min(self.contact_steps, _least(series, "steps_per_contact"))
        self.touched |= bool(np.any(np.asarray(series.get("contact_count", 0.0)) > 0.0))

    def _kinetic(self) -> float:
        """Kinetic energy at the time of the last positions, between the last two steps' velocities [J/m]."""
        mass, before, after = self.state.particles.mass, self.velocity, self.state.particles.velocity
        uneven = (self.length - self.state.dt) / (self.length + self.state.dt) if self.energy else 0.0
        both = float(mass @ (before * after).sum(axis=1))
        gained = float(mass @ ((after + before) * (after - before)).sum(axis=1))
        return 0.5 * both + 0.25 * uneven * gained

    def _weigh(self, stored: float, dissipated: float, given: float) -> None:
        """Energy ratios of this step; those of the first are 1."""
        if not self.energy:
            self.first, self.first_given = stored + dissipated, given
        given -= self.first_given
        self.input = max(self.input, given)
        scale = max(self.first + self.input, self.nothing)
        grown = stored - self.first - given
        with_dissipation, without = (
            1.0 if abs(g) <= self.nothing else 1.0 + g / scale for g in (grown + dissipated, grown)
        )
        self.energy.append(with_dissipation)
        self.stored = max(self.stored, without)
        if not with_dissipation < HOPELESS:
            raise Hopeless


def _total(series: Mapping[str, object], names: tuple[str, ...]) -> float:
    return sum(float(np.sum(np.asarray(series[name]))) for name in names if name in series)


def _least(series: Mapping[str, object], name: str) -> float:
    """Least number of a series; infinite if there is none."""
    values = np.asarray(series.get(name, np.nan), dtype=float)
    return float(np.nanmin(values)) if np.isfinite(values).any() else np.inf
