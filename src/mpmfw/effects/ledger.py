"""Energy ledger: the energy balance, measured where energy changes.

Between the projection and the gather a node's momentum changes from m v⁰ to m v¹ by impulses. The work of an
impulse is its product with (v⁰ + v¹) / 2; all works add up to the change of the grid's kinetic energy
exactly. The transfer loses the difference between the energy of the material points and the grid's. The
residual is the work of the internal forces less the strain energy: the error of the strain's integration in
time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from mpmfw.effects import series
from mpmfw.effects.ledger_works import EnergyGuard, HalfStep, add_change, grid_energy, impulse_work
from mpmfw.plugin.hooks import Observer
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Effect, Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Grid, State

#: Steps between two looks at the strain energy by what stops a run whose energy grows.
CHECK_EVERY = 20

#: Error of the strain's integration, relative to the energy put in, above which a run warns.
LARGE_RESIDUAL = 0.2

#: Hooks that change nodal momenta or forces, and the term that such a change counts to; a load names its own.
TERMS = {
    "after_momentum_projection": "contact",
    "add_nodal_force": "contact",
    "after_momentum_update": "contact",
    "correct_inertia": "inertia",
    "constrain_momentum": "external",
}


MEANINGS = {
    "gravity_work": "work of gravity on all bodies since time zero",
    "external_work": "work of loads and prescribed sides on all bodies since time zero",
    "contact_work": "work of contact on all bodies since time zero (spring energy taken up is negative)",
    "inertia_work": "kinetic energy that the inertia corrections added on the grid since time zero",
    "transfer_dissipation": "kinetic and affine energy lost between material points and grid since time zero",
    "energy_residual": "kinetic, affine and strain energy that no other term of the ledger accounts for",
    "contact_residual": "work of contact since time zero that its springs, friction and dashpots do not "
    "account for",
    "half_step_work": "part of energy_residual without error in time: work of the internal forces on what "
    "the transfer takes from the velocity half a step on, negative where it is lost",
    "contact_half_step_work": "part of contact_residual without error in time: work of contact on what the "
    "transfer takes from the velocity",
}

#: Works that a contact with springs reports, as ``State.arrays`` of each pair [J/m].
SPRING_RECORDS = ("energy", "frictional_work", "damping_work", "spring_work")


def motion_energy(state: State) -> float:
    """Return the kinetic and affine energy of the material points [J/m]."""
    return series.kinetic_energy_of(state) + float(series.affine_energies(state).sum())


class EnergyLedger(Observer):
    """Terms of the energy balance as series, and the end of a run whose energy grows without reason.

    It is off while a scene settles. ``terms`` are the works that something in the scene does; others have no
    series. The work of a contact that records all of :data:`SPRING_RECORDS` is ``accounted``, and has a
    residual. With update stress last, ``half_steps``, velocities are half a step behind positions."""

    name = "energy_ledger"
    stage = "output"
    observes = tuple(TERMS)
    moments: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "after_momentum_projection": ("begin", "after"),
        "add_nodal_force": ("begin", "after"),
        "after_momentum_update": ("begin", "after"),
        "correct_inertia": ("after",),
        "constrain_momentum": ("after", "end"),
    }
    history = (
        "running", "work", "gained", "dissipated", "contact_before", "loaded", "motion", "start", "lost",
        "half_step", "guard", "driven", "unbalanced", "put_in",
    )  # fmt: skip
    force: FloatArray  #: (n_nodes, dim) [N/m], as it was at the last look
    internal: FloatArray  #: (n_nodes, dim) [N/m], the internal forces
    momentum: FloatArray  #: (n_nodes, dim) [N s/m], as it was at the last look
    room: dict[str, FloatArray]  #: for the impulses of each term

    def __init__(self, setup: Setup, terms: list[str]) -> None:
        contact: Any = setup.contact
        self.strain: series.StrainEnergies = setup.plugin("body_series").strain
        self.damping: Any = setup.plugin("material_damping")
        self.state, self.terms = setup.state, terms
        self.reaction: Any = setup.plugin("reaction")  #: None without rigid bodies
        self.strategy, self.contact = contact, "" if contact is None else str(contact.name)
        self.accounted, self.half_steps = "spring_work" in setup.contact_fields, setup.scheme == "usl"
        self.tells_motion = self.half_steps and self.accounted and hasattr(contact, "work_over_last_step")
        self.nothing, unit = series.negligible_energy(setup.state), series.energy_unit(setup.state)
        #: None where the scene allows unstable runs.
        self.guard: EnergyGuard | None = None
        if not setup.allow_unstable:
            self.guard = EnergyGuard(self.nothing, setup.remedies, unit)
        self.motion = self.start = self.lost = 0.0
        self.momentum = np.zeros((0, 0))
        self._forget()

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts | str:
        contact, unstable = setup.contact, setup.allow_unstable
        if contact is not None and contact.adds_mass:
            # Its inertia is on the nodes and on no material point: every term would be that of two bodies.
            return f"contact '{contact.name}' adds inertia to the nodes"
        stops = "runs on whatever it shows" if unstable else "stops within 20 steps where energy grows"
        reason = f"output.ledger; works and transfer measured in every step; {stops}"
        terms, none = _terms(setup), "nothing in the scene does any"
        lines = [Effect(f"ledger: {t} work", bool(by), ", ".join(by) or none) for t, by in terms.items()]
        return Acts(reason, [cls(setup, [term for term, by in terms.items() if by])], lines)

    def _forget(self) -> None:
        self.work = dict.fromkeys(("gravity", "external", "contact", "inertia"), 0.0)
        self.half_step = HalfStep() if self.half_steps else None
        self.gained = self.dissipated = self.contact_before = self.unbalanced = self.put_in = 0.0
        self.driven = 0.0 if self.reaction is None else float(self.reaction.work)
        #: energy of the contact springs at the start; None until a step has told
        self.loaded: float | None = None

    def _restart(self, state: State) -> None:
        self.running = True
        self._forget()
        self.motion = motion_energy(state)
        self.start = self.motion + float(self.strain.of(state).sum())
        self.lost = self._lost_by_materials(state)
        if self.guard is not None:
            self.guard.restart(self.start)

    def _lost_by_materials(self, state: State) -> float:
        """Return what plastic flow and damping have taken so far [J/m]."""
        flow = float(self.strain.dissipated(state).sum()) if self.strain.dissipates else 0.0
        return flow if self.damping is None else flow + float(self.damping.dissipated(state).sum())

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The works that there are, what the transfer loses, and the residual."""
        names = [*(f"{term}_work" for term in self.terms), "transfer_dissipation", "energy_residual"]
        names += ["contact_residual"] if self.accounted else []
        names += ["half_step_work"] if self.half_steps else []
        names += ["contact_half_step_work"] if self.tells_motion else []
        return [Field(name, (), "J m-1", MEANINGS[name], "series", output=True) for name in names]

    def before(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:  # noqa: ARG002
        if hook == "after_momentum_projection":
            self.projected, self.impulse = grid_energy(grid.mass, grid.momentum), dict[str, FloatArray]()
            if self.momentum.shape != grid.momentum.shape:
                self.momentum, self.force, self.internal = (np.empty_like(grid.momentum) for _ in range(3))
                self.room = {term: np.empty_like(grid.momentum) for term in self.work}
            np.copyto(self.momentum, grid.momentum)
            self.forced = self.balanced = False
        elif hook == "add_nodal_force":
            np.copyto(self.force, grid.force)
            np.copyto(self.internal, grid.force)
            self.dt = dt
        else:
            np.copyto(self.momentum, grid.momentum)
            self.forced = True

    def after(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:  # noqa: ARG002
        """Count the change that an implementation made; after the last one, balance the grid.

        USF calls ``constrain_momentum`` before there are forces as well, MUSL after the points have moved."""
        if plugin is not None:
            self._count(hook, plugin, grid)
        elif self.forced and not self.balanced:
            self._balance_grid(grid)

    def _count(self, hook: str, plugin: Any, grid: Grid) -> None:
        """Add the change since the last look to its term, (n_nodes, dim) [N s/m]."""
        term, forces = TERMS[hook], hook == "add_nodal_force"
        if forces:
            term = getattr(plugin, "ledger_term", (term,))[0]
        elif self.balanced:
            return
        elif plugin is self.state.rigid:
            term = "external"
            if not plugin.holds:  # a projection to rigid motion does no work
                np.copyto(self.momentum, grid.momentum)
                return
        impulse = self.impulse.get(term)
        if impulse is None:
            impulse = self.room[term]
            impulse.fill(0.0)
        changes = (grid.force, self.force, self.dt) if forces else (grid.momentum, self.momentum, 1.0)
        if add_change(*changes, impulse) or forces:
            self.impulse[term] = impulse

    def _balance_grid(self, grid: Grid) -> None:
        self.balanced = True
        self.moved = grid_energy(grid.mass, grid.momentum)
        self.contact_before = self.work["contact"]
        if self.half_step is not None:
            if self.tells_motion and (impulse := self.impulse.get("contact")) is not None:
                self.half_step.add_contact(grid, self.dt, impulse, self.strategy.work_over_last_step())
            self.half_step.add(grid, self.state.particles, self.dt, self.internal)
        for term, impulse in self.impulse.items():
            self.work[term] += impulse_work(impulse, grid.mass, grid.start_velocity, grid.momentum)
        if self.reaction is not None:  # prescribed bodies take what contact does to them, and give it
            driven, self.driven = self.reaction.work - self.driven, self.reaction.work
            self.work["contact"] -= driven
            self.work["external"] += driven

    @hookimpl
    def end_step(self, state: State) -> None:
        """Add the grid's gain; the guard looks."""
        turned = 0.0 if self.state.rigid is None else self.state.rigid.turned
        self.gained += self.moved - self.projected + turned
        self.work["external"] += turned
        springs = state.arrays.get(f"{self.contact}/energy")
        held = 0.0 if springs is None else float(springs.sum())
        if self.loaded is None:  # the first forces are those of the first positions
            self.loaded = held
        if self.guard is not None:
            self.guard.loaded = self.loaded
            external = self.work["gravity"] + self.work["external"]
            self.guard.update(external, held, self.work["contact"] - self.contact_before)
            if self.guard.grown(self.moved) or state.steps % CHECK_EVERY == 0:
                self._balance(state)

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Return the series; at the first output everything starts at zero."""
        if interval == 0.0:
            self._restart(state)
        residual = self._balance(state)
        values = {f"{term}_work": self.work[term] for term in self.terms}
        values |= {"transfer_dissipation": self.dissipated, "energy_residual": residual}
        if self.accounted:  # the work of contact that no record accounts for
            known = sum(float(state.arrays[f"{self.contact}/{name}"].sum()) for name in SPRING_RECORDS)
            work = self.contact_before + known  # none before the first step
            values["contact_residual"] = 0.0 if self.loaded is None else work - self.loaded
        if self.half_step is not None:
            self.half_step.look(state.grid, state.particles)
            values["half_step_work"] = self.half_step.strain
            if self.tells_motion:
                values["contact_half_step_work"] = self.half_step.contact
        self.unbalanced = max(self.unbalanced, abs(residual - values.get("half_step_work", 0.0)))
        put_in = self.start + sum(max(0.0, work) for work in self.work.values())
        self.put_in = max(self.put_in, put_in)
        return {name: np.asarray(np.float64(value)) for name, value in values.items()}

    @hookimpl
    def concerns(self) -> list[str]:
        """Return that the error of the strain's integration is large."""
        if self.unbalanced <= max(LARGE_RESIDUAL * self.put_in, self.nothing) or not self.put_in:
            return []
        share = f"{self.unbalanced / self.put_in:.0%} of the energy put in"
        return [f"energy_residual: {share} has no account; try smaller cells, or another shape function"]

    def _balance(self, state: State) -> float:
        """Return the energy that no term accounts for [J/m]."""
        motion = motion_energy(state)
        self.dissipated = self.motion + self.gained - motion
        energy = motion + float(self.strain.of(state).sum())
        lost = self._lost_by_materials(state) - self.lost
        residual = energy - self.start - sum(self.work.values()) + self.dissipated + lost
        if self.guard is not None and self.guard.grown(energy):
            found = {**self.work, "transfer": -self.dissipated, "strain": residual}
            terms = {name: found[name] for name in ("contact", "inertia", "transfer", "strain")}
            raise self.guard.error(energy, terms, state.time)
        return residual


def _terms(setup: Setup) -> dict[str, list[str]]:
    """Return the works that can occur in this scene, and what does each."""
    terms: dict[str, list[str]] = {"gravity": [], "external": [], "contact": [], "inertia": []}
    for plugin in setup.plugins:
        if (does := getattr(plugin, "ledger_term", None)) is not None:
            term, text = does
            terms[term].append(text)
    if setup.contact is not None:  # its work counts by the place where it is done
        for term in dict.fromkeys(term for hook, term in TERMS.items() if hasattr(setup.contact, hook)):
            terms[term].append(f"contact '{setup.contact.name}'")
    return terms
