"""The end of a run whose energy grows without reason."""

from __future__ import annotations

from collections.abc import Mapping

from mpmfw.errors import SimulationError

#: Growth, as a share of the energy at the start and what was put in since, past which a run is stopped.
GROWTH_LIMIT = 0.5

#: Where energy may come from: its name, and what helps, by the names of :attr:`Setup.remedies` or in words.
CAUSES = {
    "contact": ("contact", ("step", "contact")),
    "inertia": ("the inertia correction", ("step", "rotation = 'lumped'")),
    "transfer": ("the transfer between points and grid", ("another stepping.transfer", "shape")),
    "strain": ("the strain's integration in time", ("step", "scheme")),
}


class EnergyGuard:
    """Bound on the energy of the bodies; ``nothing`` [J/m] counts as none."""

    history = ("start", "given", "input", "loaded", "fallen", "depth")

    def __init__(self, nothing: float, remedies: Mapping[str, str]) -> None:
        self.nothing, self.remedies = nothing, remedies
        self.restart(0.0)

    def restart(self, start: float) -> None:
        """Begin with bodies that have the energy ``start`` [J/m]."""
        self.start = start
        self.given = self.input = 0.0
        self.loaded: float | None = None  #: energy of the contact springs at the start, once a step has told
        self.fallen = self.depth = 0.0

    def set_external_work(self, work: float) -> None:
        """Set the work of gravity and external loads since the start [J/m]; its maximum stays allowed."""
        self.given, self.input = work, max(self.input, work)

    def set_contact_energy(self, energy: float, last_work: float) -> None:
        """Set the energy of contact where the step began [J/m], negative where bodies stick together, and its
        last work.

        Call it after every step. Springs that only push hold no less than nothing, and their energy may as
        well have been given back."""
        self.fallen = max(last_work - energy, -energy) if energy < 0.0 else 0.0
        self.depth = max(self.depth, -energy)

    @property
    def released(self) -> float:
        """Energy that contact's springs and adhesion may have given to the bodies since the start [J/m]."""
        return (self.loaded or 0.0) + self.fallen

    @property
    def allowed(self) -> float:
        """Energy at the start, that of contact springs included, what was put in, and the most that adhesion
        gave [J/m].
        """
        return self.start + max(self.loaded or 0.0, 0.0) + self.depth + self.input + self.nothing

    def growth(self, energy: float) -> float:
        """Energy of the bodies beyond what they had, springs could give, adhesion gave, and loads gave
        [J/m].
        """
        return energy - self.start - self.released - self.given

    def grown(self, energy: float) -> bool:
        """Return True if the growth is too much or NaN."""
        return not self.growth(energy) <= GROWTH_LIMIT * self.allowed

    def error(self, energy: float, terms: dict[str, float], time: float) -> SimulationError:
        """Return what stops the run, with the likely cause.

        ``energy`` [J/m] is that of the bodies; ``terms`` [J/m] came from ``contact``, ``inertia``,
        ``transfer`` and ``strain`` since the start."""
        amounts = {**terms, "contact": terms["contact"] - self.released}
        largest = max(amounts, key=lambda term: amounts[term])
        cause, ways = CAUSES[largest]
        absent = {"step", "scheme", "contact", "shape"} - self.remedies.keys()
        advice = ", or ".join(self.remedies.get(way, way) for way in ways if way not in absent)
        return SimulationError(
            f"the energy grew by {self.growth(energy):.4g} J/m without reason, past {GROWTH_LIMIT:g} of the "
            f"{self.allowed:.4g} J/m that there were and were put in; likely cause: {cause}, which added "
            f"{amounts[largest]:.4g} J/m",
            time=time,
            advice=f"{advice}; allow_unstable = true lets the run go on",
        )
