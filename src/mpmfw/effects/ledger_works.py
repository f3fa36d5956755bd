"""Works of the ledger: of impulses on the grid, and of forces half a step apart from the velocity; the end
of a run whose energy grows without reason.

With update stress last a step is a leapfrog: a force f^n at the positions x^n takes the velocity from half a
step before to half a step after, and the positions move with the latter. Over the displacement Δt v^n of a
step the mean of the forces at both of its ends does the work that springs and strain take up (Belytschko, Liu
& Moran, Nonlinear finite elements, box 6.1), and the ledger's impulse times mean velocity, which is that of
the grid's kinetic energy, does not. Summed over the steps they differ by

    Σ Δt f^n·(v0^n − v^(n−1)) / 2 − Δt f^N·v^(N−1) / 2.

The last term is of the half step that positions are ahead. The sum is of what the transfer took from the
velocity between two steps: dissipation, and no error in time.

v^(n−1) is the field with which the material moved, where that is now; velocities of the grid's nodes would be
off by Δt v·∇v. Of strain it is the points' gradient, L (1 + Δt L)⁻¹; of contact, how far the rows came."""

from __future__ import annotations

from collections.abc import Mapping

from mpmfw.errors import SimulationError
from mpmfw.kernels import kernel
from mpmfw.kernels.types import Floats, Points
from mpmfw.state.structs import Grid, Particles

#: Growth, as a share of the energy at the start and what was put in since, past which a run is stopped.
GROWTH_LIMIT = 0.5

#: Where energy may come from: its name, and what helps, by the names of :attr:`Setup.remedies` or in words.
CAUSES = {
    "contact": ("contact", ("step", "contact")),
    "inertia": ("the inertia correction", ("step", "rotation = 'lumped'")),
    "transfer": ("the transfer between points and grid", ("another stepping.transfer", "shape")),
    "strain": ("the strain's integration in time", ("step", "scheme")),
}


@kernel
def grid_energy(mass: Floats, momentum: Floats) -> float:
    """Σ |(m v)_i|² / (2 m_i) over nodes with mass."""
    total = 0.0
    for i in range(len(mass)):
        if mass[i] > 0.0:
            square = 0.0
            for d in range(momentum.shape[1]):
                square += momentum[i, d] * momentum[i, d]
            total += 0.5 * square / mass[i]
    return total


@kernel
def add_change(now: Floats, last: Floats, scale: float, impulse: Floats) -> bool:
    """I_i += ``scale`` (now − last) of momenta, or of forces with Δt, and last = now; return whether there is
    a change."""
    changed = False
    for i in range(len(now)):
        for d in range(now.shape[1]):
            if now[i, d] != last[i, d]:
                impulse[i, d] += scale * (now[i, d] - last[i, d])
                last[i, d] = now[i, d]
                changed = True
    return changed


@kernel
def impulse_work(impulse: Floats, mass: Floats, start_velocity: Floats, momentum: Floats) -> float:
    """Σ I_i·(v_i⁰ + v_i¹) / 2 over nodes with mass; ``momentum`` is m v¹."""
    total = 0.0
    for i in range(len(mass)):
        if mass[i] > 0.0:
            for d in range(momentum.shape[1]):
                total += 0.5 * impulse[i, d] * (start_velocity[i, d] + momentum[i, d] / mass[i])
    return total


@kernel
def power_at_start(force: Floats, mass: Floats, start_velocity: Floats) -> float:
    """Σ f_i·v_i⁰ over nodes with mass, and those whose motion is prescribed."""
    total = 0.0
    for i in range(len(mass)):
        if mass[i] != 0.0:
            for d in range(force.shape[1]):
                total += force[i, d] * start_velocity[i, d]
    return total


@kernel
def stress_power(volume: Floats, points: Points, dt: float, spacing: tuple[float, ...]) -> float:
    """−Σ V σ:(L − Δt L²) over material points: the power of the internal forces on the motion of the last
    step, L (1 + Δt L)⁻¹ to the second order. V has the thickness."""
    dim = len(spacing)
    total = 0.0
    for p in range(len(volume)):
        power = 0.0
        for d in range(dim):
            for e in range(dim):
                moved = points.velocity_gradient[p, d, e]
                for a in range(dim):
                    moved -= dt * points.velocity_gradient[p, d, a] * points.velocity_gradient[p, a, e]
                power += points.stress[p, d, e] * moved
        total -= volume[p] * power
    return total


class HalfStep:
    """Both sums [J/m]: of the internal forces, ``strain``, up to the positions of the last :meth:`look`,
    and of contact, up to the positions that its forces were found at, which are a step old.
    """

    history = ("strain", "contact", "_strain", "_contact", "dt", "_power")

    def __init__(self) -> None:
        self.strain = self.contact = self._strain = self._contact = 0.0
        self.dt = 0.0
        #: of the present stress on the motion of the last step [W/m], if it is known
        self._power: float | None = None

    def add(self, grid: Grid, particles: Particles, dt: float, internal: Floats) -> None:
        """Add a step of ``dt`` [s] with internal forces (n_nodes, dim) [N/m]."""
        if self.dt > 0.0:
            taken = power_at_start(internal, grid.mass, grid.start_velocity)
            self._strain += 0.5 * dt * (taken - self._power_of_motion(grid, particles))
        self.dt, self._power = dt, None

    def add_contact(self, grid: Grid, dt: float, impulse: Floats, moved: float) -> None:
        """Contact's impulse in a step that :meth:`add` has not seen yet, (n_nodes, dim) [N s/m].

        ``moved`` is the work [J/m] of its forces on how far their rows came in the last one.
        """
        self.contact = self._contact - 0.5 * moved
        if self.dt > 0.0:
            taken = power_at_start(impulse, grid.mass, grid.start_velocity)
            self._contact += 0.5 * (taken - moved * dt / self.dt)

    def look(self, grid: Grid, particles: Particles) -> None:
        """Take the sums up to the positions after a step."""
        self.strain = self._strain
        if self.dt > 0.0:
            self.strain -= 0.5 * self.dt * self._power_of_motion(grid, particles)

    def _power_of_motion(self, grid: Grid, particles: Particles) -> float:
        """Power [W/m] of the stress on the motion of the last step."""
        if self._power is None:
            volume, points = particles.times_thickness(particles.volume), particles.in_space
            self._power = float(stress_power(volume, points, self.dt, grid.tensor_spacing))
        return self._power


class EnergyGuard:
    """Bound on the energy of the bodies in ``unit``; ``nothing`` counts as none."""

    history = ("start", "given", "input", "loaded", "fallen", "depth")

    def __init__(self, nothing: float, remedies: Mapping[str, str], unit: str = "J/m") -> None:
        self.nothing, self.remedies, self.unit = nothing, remedies, unit
        self.restart(0.0)

    def restart(self, start: float) -> None:
        """Begin with bodies that have the energy ``start`` [J/m]."""
        self.start = start
        self.given = self.input = 0.0
        self.loaded: float | None = None  #: energy of the contact springs at the start, once a step has told
        self.fallen = self.depth = 0.0

    def update(self, work: float, energy: float, last_work: float) -> None:
        """Take the ``work`` of gravity and loads, whose maximum stays allowed, the ``energy`` of contact as
        the step began, negative where bodies stick together, and its last work [J/m].

        Springs that only push hold no less than nothing, and their energy may as well have been given
        back."""
        self.given, self.input = work, max(self.input, work)
        self.fallen = max(last_work - energy, -energy) if energy < 0.0 else 0.0
        self.depth = max(self.depth, -energy)

    @property
    def released(self) -> float:
        """Energy that springs and adhesion may have given so far [J/m]."""
        return (self.loaded or 0.0) + self.fallen

    @property
    def allowed(self) -> float:
        """Energy of bodies and springs at the start, and what was put in [J/m]."""
        return self.start + max(self.loaded or 0.0, 0.0) + self.depth + self.input + self.nothing

    def growth(self, energy: float) -> float:
        """Energy beyond what there was, and what contact and loads gave [J/m]."""
        return energy - self.start - self.released - self.given

    def grown(self, energy: float) -> bool:
        """Return True if the growth is too much or NaN."""
        return not self.growth(energy) <= GROWTH_LIMIT * self.allowed

    def error(self, energy: float, terms: dict[str, float], time: float) -> SimulationError:
        """Return what stops the run at an ``energy`` of the bodies [J/m], with the likely cause.

        ``terms`` [J/m] came from ``contact``, ``inertia``, ``transfer`` and ``strain`` since the start."""
        amounts = {**terms, "contact": terms["contact"] - self.released}
        largest = max(amounts, key=lambda term: amounts[term])
        cause, ways = CAUSES[largest]
        absent = {"step", "scheme", "contact", "shape"} - self.remedies.keys()
        advice = ", or ".join(self.remedies.get(way, way) for way in ways if way not in absent)
        return SimulationError(
            f"the energy grew by {self.growth(energy):.4g} {self.unit} without reason, past {GROWTH_LIMIT:g} "
            f"of the {self.allowed:.4g} {self.unit} that there were and were put in; likely cause: {cause}, "
            f"which added {amounts[largest]:.4g} {self.unit}",
            time=time,
            advice=f"{advice}; allow_unstable = true lets the run go on",
        )
