"""The verdict on a run: ``ok``, or ``suspect`` with the reasons.

Energy and surfaces are judged at outputs and at the end, surfaces also between them, as often as bodies can
move a cell, or through half a thin body, towards each other. Settling is not judged."""

from __future__ import annotations

import numpy as np

from mpmfw.effects.series import StrainEnergies, energy_unit, kinetic_energy_of, negligible_energy
from mpmfw.kernels.sides import find_inside, least_own_gaps, node_normals
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import AnyArray, FloatArray
from mpmfw.state.structs import State, Surface
from mpmfw.state.surface import closed_surface, make_surface

#: Penetration beyond that of the start, over the cell size, that gives a warning, and that is suspect.
DEEP, TOO_DEEP = 0.15, 0.5

#: Suspect growth of the energy, as a share of that at the start and the most that was put in.
GROWTH = 0.1

#: Fewest steps between two looks at energy, at bodies' surfaces, and at surfaces close to themselves. A look
#: takes about 0.1 ms, a quarter of a step of 800 points.
ENERGY_EVERY, SIDES_EVERY, OWN_EVERY = 200, 100, 400

#: Most steps between two looks at surfaces: bodies may gain speed.
SIDES_LATEST = 500


class Verdict:
    """Judges a run by its energy and, where contact keeps bodies apart (``watched``), by its surfaces.

    Gravity and plug-ins with an attribute ``work`` [J/m] that act so far do the work."""

    name = "verdict"
    stage = "output"
    history = (
        "inside", "running", "due", "latest_sides", "next_energy", "next_sides", "next_own", "nothing",
        "start", "first_work", "gravity_work", "most", "loaded", "released", "moment", "pull", "deepest",
        "deepest_at", "passed", "grown", "grown_share", "grown_at", "closed", "closed_at",
    )  # fmt: skip

    def __init__(self, setup: Setup, watched: bool) -> None:
        self.watched, self.state = watched, setup.state
        self.strain: StrainEnergies = setup.plugin("body_series").strain
        self.gravity = setup.plugin("gravity")
        self.working = [
            each for each in setup.plugins if hasattr(each, "ledger_term") and hasattr(each, "work")
        ]
        self.springs = "" if setup.contact is None else f"{setup.contact.name}/energy"
        self.outlines, h, dim = Outlines(setup.state), setup.cell_size, setup.dim
        self.stride = min(h, 0.5 * min(body.width for body in setup.bodies))
        self.inside = np.full(self.outlines.surface.count, -1)
        self.overlap = np.zeros(0)  #: (pair,) deepest node at the start [m]
        self.overlap = self._depths(setup.state)[0]
        #: Whether the energy at the start is known; not that of an overlap which has not settled.
        self.start_is_known = setup.scene.settle is not None or not (self.overlap > 0.05 * h).any()
        #: Velocities' time less that of the strain, in steps.
        self.half_step = 0.5 if setup.scheme == "usf" else -0.5
        self.running, self.due = False, 0.0
        self.next_energy = self.next_sides = self.latest_sides = self.next_own = 0
        self.nothing = self.start = self.first_work = self.gravity_work = self.most = 0.0
        #: Most that contact could give, of springs loaded at the start or that pull [J/m].
        self.released = 0.0
        #: Energy of the contact springs at the start; None until a step has found it.
        self.loaded: float | None = None
        self.moment, self.pull = np.zeros(dim), np.zeros(dim)
        self.deepest: dict[str, float] = {}  #: by pair: depth over cell size
        self.deepest_at: dict[str, float] = {}  #: and its time [s]
        self.passed: dict[str, float] = {}  #: by pair: time [s]
        #: Excess of energy [J/m], over the energy there was, time [s].
        self.grown = self.grown_share = self.grown_at = 0.0
        self.closed: dict[str, float] = {}  #: by body: own gap over cell size
        self.closed_at: dict[str, float] = {}  #: and its time [s]

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        return Acts("", [cls(setup, setup.contact is not None and setup.contact.keeps_apart)])

    def _begin(self, state: State) -> None:
        self.running, self.inside[:] = True, -1
        self.next_energy = self.next_sides = self.next_own = 0
        self.nothing = negligible_energy(state)
        self.start = kinetic_energy_of(state) + float(self.strain.of(state).sum())
        self.loaded = None
        self.first_work = float(sum(plugin.work for plugin in self.working))
        self.gravity_work = self.most = self.released = 0.0
        self.moment = _moment(state)
        self.pull = 0.0 * self.pull if self.gravity is None else self.gravity.at(state.time)

    def _add_gravity_work(self, state: State, pull: FloatArray) -> None:
        """Add the work of gravity, whose mean since the last call is ``pull``."""
        moment = _moment(state)
        self.gravity_work += float(pull @ (moment - self.moment))
        self.moment = moment

    def _held(self, state: State) -> float:
        """Energy of the contact springs [J/m]."""
        return float(state.arrays[self.springs].sum()) if self.springs in state.arrays else 0.0

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Judge energy and surfaces at an output; there are no series."""
        if interval == 0.0:
            self._begin(state)
        if state.steps >= self.next_energy:
            self._judge_energy(state)
        if self.watched and state.steps >= self.next_sides:
            self._judge_sides(state)
        if state.steps >= self.next_own:
            self._judge_own_gaps(state)
        return {}

    @hookimpl
    def end_step(self, state: State) -> None:
        """Look at the surfaces if bodies may have moved too far since the last look."""
        if self.loaded is None:  # the first forces are those of the first positions
            self.loaded = self._held(state)
        if self.gravity is not None and len(self.gravity.table.times) > 1:
            self._add_gravity_work(state, self.gravity.table.mean(state.time, state.dt))
        if self.watched and (state.time >= self.due or state.steps >= self.latest_sides):
            self._judge_sides(state)

    def _judge_own_gaps(self, state: State) -> None:
        self.next_own = state.steps + OWN_EVERY
        apart = {pair.first for pair in state.pairs if pair.first == pair.second}
        for body, gap in zip(state.bodies, self.outlines.own_gaps(state) / state.grid.cell_size, strict=True):
            if body.index not in apart and gap < self.closed.get(body.name, 1.0):
                self.closed[body.name], self.closed_at[body.name] = float(gap), state.time

    def _energy(self, state: State) -> float:
        """Kinetic and strain energy [J/m], both of the middle of a step.

        The strain energy changes by Δt Σ V σ:L in a step: in bodies two cells wide half of this is a fifth of
        all energy."""
        p = state.particles.in_space
        volume = p.times_thickness(p.volume)
        power = np.einsum("p,pij,pij->", volume, p.stress, p.velocity_gradient)  # threads of BLAS wait
        strain = float(self.strain.of(state).sum()) + self.half_step * state.dt * float(power)
        return kinetic_energy_of(state) + strain

    def _judge_energy(self, state: State) -> None:
        self.next_energy = state.steps + ENERGY_EVERY
        if self.gravity is not None:
            now = self.gravity.at(state.time)
            self._add_gravity_work(state, 0.5 * (now + self.pull))
            self.pull = now
        if self.loaded is None or not self.start_is_known:
            return
        work = self.gravity_work + sum(plugin.work for plugin in self.working) - self.first_work
        self.most = max(self.most, float(work))
        given = max(self.loaded, 0.0) + max(-self._held(state), 0.0)
        self.released = max(self.released, given)
        there = self.start + self.most + self.released
        excess = self._energy(state) - self.start - given - work
        if excess > max(GROWTH * there + self.nothing, self.grown):
            self.grown, self.grown_at = float(excess), state.time
            self.grown_share = float(excess / there) if there > 0.0 else np.inf

    def _depths(self, state: State) -> tuple[FloatArray, AnyArray]:
        """Deepest node [m], and nodes that went through, beyond the start."""
        depth, passed = self.outlines.inside(state, self.inside)
        if state.self_contact is not None:
            depth = np.maximum(depth, -state.self_contact.gaps(state.pair_bodies))
        depth[: len(self.overlap)] -= self.overlap
        return depth, passed

    def _judge_sides(self, state: State) -> None:
        depth, passed = self._depths(state)
        h = state.grid.cell_size
        # Lists: a look at two bodies would take twice as long with arrays
        for pair, deep, gone in zip(state.pairs, depth.tolist(), passed.tolist(), strict=True):
            if deep > DEEP * h and deep / h >= self.deepest.get(pair.label, DEEP):
                self.deepest[pair.label], self.deepest_at[pair.label] = deep / h, state.time
            if gone:
                self.passed.setdefault(pair.label, state.time)
        self.next_sides = state.steps + SIDES_EVERY
        self.latest_sides = state.steps + SIDES_LATEST
        # at most, of approach; over the axis of the points NumPy takes twenty times as long
        fastest = float(np.linalg.norm([np.ptp(component) for component in state.particles.velocity.T]))
        fastest += 0.0 if state.rigid is None else state.rigid.fastest
        self.due = state.time + (self.stride / fastest if fastest > 0.0 else np.inf)

    @property
    def reasons(self) -> list[str]:
        """Why the run is suspect; empty where it is not."""
        reasons = [f"{label}: surfaces changed sides at {time:.4g} s" for label, time in self.passed.items()]
        reasons += [
            f"{label}: penetration of {cells:.3g} cells at {self.deepest_at[label]:.4g} s"
            for label, cells in self.deepest.items()
            if cells > TOO_DEEP
        ]
        if self.grown > 0.0:
            unit = energy_unit(self.state)
            reasons.append(
                f"energy of {self.grown:.3g} {unit} without a source at {self.grown_at:.4g} s, "
                f"{self.grown_share:.2g} of what there was and was put in"
            )
        return reasons

    @property
    def status(self) -> str:
        """``ok``, or ``suspect: …``, after a last look."""
        if self.running and self.watched:
            self._judge_sides(self.state)
        if self.running:
            self._judge_energy(self.state)
            self._judge_own_gaps(self.state)
        reasons = self.reasons
        more = f"; and {len(reasons) - 3} more" if len(reasons) > 3 else ""
        return "suspect: " + "; ".join(reasons[:3]) + more if reasons else "ok"

    @hookimpl
    def concerns(self) -> list[str]:
        """Return reasons, deep penetration, and surfaces close to themselves."""
        reasons = "; ".join(self.reasons)
        warnings = [f"suspect: {reasons}; try smaller steps, smaller cells or a stiffer contact"]
        return [
            *(warnings if reasons else []),
            *(
                f"{label}: the bodies penetrate by {cells:.2g} cells at time {self.deepest_at[label]:.4g} s, "
                f"more than {DEEP:g}; try a stiffer contact, or smaller cells"
                for label, cells in sorted(self.deepest.items(), key=lambda item: -item[1])
                if cells <= TOO_DEEP
            ),
            *(
                f"{name}: parts of its own surface are {cells:.2g} cells apart at time "
                f"{self.closed_at[name]:.4g} s; within a cell they stick together; see self_contact"
                for name, cells in self.closed.items()
            ),
        ]


def _moment(state: State) -> FloatArray:
    """Σ m x of the material points and of free rigid bodies (dim,) [kg]."""
    moment = np.asarray(np.einsum("p,pd->d", state.particles.mass, state.particles.position))
    return moment if state.rigid is None else moment + state.rigid.mass @ state.rigid.centre


class Outlines:
    """Tracked surfaces, or nodes that follow the nearest point."""

    def __init__(self, state: State) -> None:
        self.tracked = state.surface is not None
        self.surface: Surface = state.surface or make_surface(state.bodies, 1, "output")
        if not self.tracked:
            from scipy.spatial import cKDTree

            self.carrier = np.zeros(self.surface.count, dtype=np.int64)  #: nearest point of the own body
            for body in state.soft_bodies:
                points, own = cKDTree(state.particles.position[body.particles]), self.surface.of(body.index)
                self.carrier[own] = body.particles.start + points.query(self.surface.position[own])[1]
            self.offset = self.surface.position - state.particles.position[self.carrier]
        self.start, self.start_normal = self.surface.position.copy(), self._normals(self.surface, state)

    def _now(self, state: State) -> Surface:
        p = state.particles
        if not self.tracked:
            turned = np.einsum("sij,sj->si", p.deformation_gradient[self.carrier], self.offset)
            self.surface.position[:] = p.position[self.carrier] + turned
        return closed_surface(self.surface)

    def _normals(self, surface: Surface, state: State) -> FloatArray:
        normal = np.zeros_like(surface.position)
        node_normals(surface, normal, state.grid.spacing)
        return normal

    def inside(self, state: State, inside: AnyArray) -> tuple[FloatArray, AnyArray]:
        """Deepest node [m], and nodes that went through, of every pair."""
        surface, (first, second) = self._now(state), np.ascontiguousarray(state.pair_bodies.T)
        depth, passed = np.zeros(len(first)), np.zeros(len(first), dtype=np.int64)
        find_inside(
            first, second, surface.body_first, surface.facet_first, surface, inside, depth, passed,
            state.grid.spacing,
        )  # fmt: skip
        return depth, passed

    def own_gaps(self, state: State) -> FloatArray:
        """Least gap (body,) [m] between parts of a body's own surface."""
        surface, gaps = self._now(state), np.zeros(len(state.bodies))
        x = surface.position
        order = np.lexsort((x[:, 0], surface.body))
        least_own_gaps(
            surface.body_first, order, self.start, self.start_normal, x, self._normals(surface, state), gaps,
            state.grid.spacing
        )  # fmt: skip
        return gaps
