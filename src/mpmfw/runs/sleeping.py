"""Sleep of bodies at rest: the active simulation, of the other bodies, takes the steps.

Bodies whose windows of the grid share a node sleep and wake together, so that inactive bodies do not act on
active ones. An inactive body keeps its velocity and its springs."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mpmfw.errors import SceneError
from mpmfw.plugin.checks import bundled, described
from mpmfw.plugin.load import BodyLoad, LoadedFacets, SurfaceLoad
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.runs.build import build_some
from mpmfw.state.fields import AnyArray, FloatArray, IntArray
from mpmfw.state.history import IndexMap, NotSaved, copy_history
from mpmfw.state.structs import State
from mpmfw.state.windows import fitted_windows, overlapping, set_windows, update_pairs
from mpmfw.step.schemes import SCHEMES, Length
from mpmfw.step.timestep import Clock
from mpmfw.step.transfer import Transfer

#: Steps between two looks for bodies at rest.
LOOK_EVERY = 20

#: Times that a free body takes to fall past the speed bound, after which it is at rest: at the top of its
#: flight it is slower for two of them.
FALLS = 4.0

#: Largest ratio of a saved active simulation's nodes to today's: bodies may have drawn together since.
SPARE = 16.0

#: Records of pairs that grow with time while bodies rest on each other.
IMPULSES = ("impulse", "friction_impulse")


def from_setup(setup: Setup) -> Acts:
    """Return the conditions of sleep; refuse plug-ins that need all bodies."""
    settings, contact, output = setup.scene.sleep, setup.contact, setup.scene.output
    assert settings is not None
    measured = [key for key in ("ledger", "stability", "contact_moment") if getattr(output, key)]
    foreign = [plugin for plugin in setup.plugins if not bundled(type(plugin))]
    if contact is None or contact.velocity_fields != "per_body":
        problem = "expected a contact with a velocity field for each body, which can leave one of them out"
    elif not contact.leaves_bodies_out:
        able = "bardenhagen, or penalty without master and interface_thickness"
        problem = f"contact '{contact.label}' cannot leave bodies out; expected one that can, such as {able}"
    elif measured:
        problem = f"output.{measured[0]} measures all bodies in every step; expected a scene without it"
    elif setup.named["boundaries"]:
        problem = "the motion of [boundaries] is not known beforehand; expected sides"
    elif foreign:
        problem = f"{described(foreign[0])} does not support inactive bodies; expected bundled plug-ins"
    else:
        when = f"below {settings.strain:g} of the wave speed for {settings.crossings:g} crossings"
        return Acts(f"[sleep]: {when}")
    raise SceneError(problem, key="sleep")


class Sleep:
    """Inactive bodies of the simulation ``full``, and the steps of the others."""

    history = (
        "moved", "slept", "inactive", "lower", "upper", "counted", "rates", "looked", "impulses", "windows",
    )  # fmt: skip

    def __init__(self, full: Any, setup: Setup) -> None:
        settings: Any = setup.scene.sleep
        contact: Any = setup.contact
        bodies, dim = setup.state.bodies, setup.scene.dim
        self.full, self.setup, self.scheme = full, setup, SCHEMES[setup.scheme]
        self.active: Any = None  #: simulation of the bodies that move, if these are some and not all
        waves = np.array([body.wave_speed for body in bodies])
        longest = np.array([np.subtract(body.upper, body.lower).max() for body in bodies])
        self.bound: FloatArray = settings.strain * waves  #: (n_bodies,) [m/s]
        self.patience: FloatArray = settings.crossings * longest / waves  #: (n_bodies,) [s]
        self.moved, self.slept = np.zeros((2, len(bodies)))  #: when bodies last moved, and fell asleep [s]
        self.inactive = np.zeros(len(bodies), dtype=bool)
        self.lower, self.upper = np.zeros((2, *setup.state.grid.window_lower.shape), np.int64)
        self.rates = {name: np.zeros((0, dim)) for name in IMPULSES}  #: forces between inactive bodies [N]
        self.counted = 0.0  #: time up to which impulses of inactive pairs are counted [s]
        self.looked = np.nan  #: time of the last look [s], and impulses then:
        self.impulses = {name: np.zeros((0, dim)) for name in IMPULSES}
        #: Of the active simulation, when its state was copied last.
        self.windows: dict[str, IntArray] = {k: np.zeros((0, dim), np.int64) for k in ("lower", "shape")}
        self.frame = -1  #: of the windows that were compared last
        self._records = {name: f"{contact.name}/{name}" for name in IMPULSES}
        self._loads = [each for each in setup.plugins if isinstance(each, BodyLoad | SurfaceLoad)]
        self._gravity = setup.plugin("gravity")
        self._sides = setup.plugin("constraint")
        tables = [each.table for each in (self._gravity,) if each]
        tables += self._sides.tables if self._sides else []
        self._forces_change = bool(self._loads or any(len(table.times) > 1 for table in tables))

    @property
    def running(self) -> Any:
        """The simulation that takes the steps."""
        return self.full if self.active is None else self.active

    def step(self, state: State, hook: Any, transfer: Transfer, clock: Clock, length: Length) -> float:
        """Take one time step of the active bodies, of all while the scene settles."""
        if not self.full.started:
            return self.scheme(state, hook, transfer, clock, length)
        if self.inactive.any():
            self._wake(state.time)
        if self.inactive.all():
            return length()
        running = self.running.state
        running.time, running.steps, running.dt = state.time, state.steps, state.dt
        dt = running.dt = self.scheme(running, self.running.hook, transfer, clock, length)
        if state.steps % LOOK_EVERY == 0:
            self._look(state.time + dt)
        return dt

    def _look(self, time: float) -> None:
        """Deactivate bodies that rest, unless one near them moves."""
        running, awake = self.running, np.flatnonzero(~self.inactive)
        state = running.state
        v = state.particles.velocity
        square = np.maximum.reduceat(np.einsum("pd,pd->p", v, v), state.particles.first[:-1])
        self.moved[awake[square > self.bound[awake] ** 2]] = time
        since, before, none = time - self.looked, self.impulses, np.zeros((0, state.grid.dim))
        self.looked = time
        self.impulses = {name: state.arrays.get(key, none).copy() for name, key in self._records.items()}
        rested = time - self.moved[awake] >= self.patience[awake]
        if np.isnan(since) or not rested.any():
            return
        self.gather(time)
        for k in np.flatnonzero(rested):  # a body that gravity or a load turns back is slow for a while
            body = int(awake[k])
            free = self._forces(body, time)[1] * (time - self.moved[body])
            rested[k] = free == 0.0 or free >= FALLS * self.bound[body]
        lower, shape = fitted_windows(state, running.hook)
        upper = lower + shape - 1
        sleepy = ~_reached(~rested, *overlapping(lower, upper))
        if not sleepy.any():
            return
        fallen = awake[sleepy]
        self.lower[fallen], self.upper[fallen] = lower[sleepy], upper[sleepy]
        self.inactive[fallen], self.slept[fallen] = True, time
        pairs = IndexMap.between(state, self.full.state).pair
        for name, impulse in self.impulses.items():
            rate = np.zeros((len(self.full.state.pairs), state.grid.dim))
            rate[: len(self.rates[name])] = self.rates[name]
            gained = impulse.copy()
            gained[: len(before[name])] -= before[name]
            rate[pairs] = gained / since
            self.rates[name] = rate
        self._divide()

    def _wake(self, time: float) -> None:
        """Wake bodies that are disturbed, and all that are near them."""
        woken, sleepers = np.zeros_like(self.inactive), np.flatnonzero(self.inactive)
        for body in sleepers.tolist() if self._forces_change else ():
            then, now = (self._forces(body, at)[0] for at in (float(self.slept[body]), time))
            alike = (np.array_equal(*each, equal_nan=True) for each in zip(then, now, strict=True))
            woken[body] = not all(alike)
        grid = self.running.state.grid
        if self.active is not None and grid.frame != self.frame:
            self.frame = grid.frame
            for lower, shape in zip(grid.window_lower, grid.window_shape, strict=True):
                apart = (self.lower >= lower + shape) | (lower > self.upper)
                woken |= self.inactive & ~apart.any(axis=1)
        if woken.any():
            near = overlapping(self.lower[sleepers], self.upper[sleepers])
            woken[sleepers] = _reached(woken[sleepers], *near)
            self.gather(time)
            self.inactive[woken], self.moved[woken] = False, time
            self._divide()

    def _forces(self, body: int, time: float) -> tuple[list[AnyArray], float]:
        """Return gravity [m/s²], loads [N or Pa] and velocities of sides [m/s]; and the acceleration of the
        first two [m/s²]."""
        state, own = self.full.state, self.full.state.bodies[body]
        mass = float(state.particles.mass[own.particles].sum())
        values: list[AnyArray] = [] if self._gravity is None else [self._gravity.at(time)]
        total = mass * sum(values, np.zeros(state.grid.dim))
        for load in (load for load in self._loads if own in load.bodies):
            if isinstance(load, BodyLoad):
                values.append(load.forces(state.particles, own.particles, time))
                total += values[-1].sum(axis=0)
            else:
                on = state.tracked_surface.facets_of(body)
                which = load.facets[(load.facets >= on.start) & (load.facets < on.stop)]
                facets = LoadedFacets(state, which)
                values.append(load.traction(facets, time))
                total += facets.area @ values[-1]
        if self._sides is not None:
            sides = zip(self._sides.bodies, self._sides.tables, strict=True)
            values += [table.at(time) for each, table in sides if each is own]
        return values, float(np.linalg.norm(total)) / mass

    def gather(self, time: float) -> None:
        """Copy the active bodies' state back; count impulses of the others."""
        full = self.full.state
        for name, rate in self.rates.items():
            full.arrays[self._records[name]][: len(rate)] += (time - self.counted) * rate
        self.counted = time
        if self.active is None:
            return
        grid = self.active.state.grid
        self.windows = {"lower": grid.window_lower.copy(), "shape": grid.window_shape.copy()}
        if full.near is not None:
            ends = IndexMap.between(self.active.state, full).body[self.active.state.pair_bodies]
            if full.near.add(full, *ends.T):
                self.full.hook.add_pairs(state=full)
        _hand_over(self.active, self.full)

    def _divide(self) -> None:
        """Build the active simulation anew; keep forces of sleeping pairs."""
        ends = self.full.state.pair_bodies
        asleep = self.inactive[ends[:, 0]] & self.inactive[ends[:, 1]]
        self.rates = {name: np.where(asleep[: len(r), None], r, 0.0) for name, r in self.rates.items()}
        self.looked = np.nan
        self._build(None)

    def _build(self, windows: dict[str, IntArray] | None) -> None:
        """Build the active simulation, if it has some bodies and not all."""
        full, awake = self.full, np.flatnonzero(~self.inactive).tolist()
        self.active, self.frame = None, -1
        if 0 < len(awake) < len(self.inactive):
            self.active = type(full).of(build_some(self.setup, awake), full.clock, full.threads)
            self.active.started = True
            _hand_over(full, self.active)
        state, hook = self.running.state, self.running.hook
        lower, shape = fitted_windows(state, hook)
        most = SPARE * float(np.prod(shape, axis=1).sum())
        if windows is not None:
            lower, shape = windows["lower"], windows["shape"]
        set_windows(state.grid, lower, shape, most)
        update_pairs(state, hook)
        if self.active is not None:
            _hand_over(full, self.active)  # once more: now it lists the pairs

    def restored(self) -> None:
        """Build the active simulation."""
        if any(len(rate) > len(self.full.state.pairs) for rate in self.rates.values()):
            raise NotSaved("more pairs slept than there are")
        if self.inactive.any() and not self.inactive.all():
            self._build(self.windows)


def _reached(start: AnyArray, first: IntArray, second: IntArray) -> AnyArray:
    """Return ``start`` (n,), extended by all that pairs join to it."""
    joined = coo_array((np.ones(len(first)), (first, second)), shape=(len(start), len(start)))
    group = connected_components(joined, directed=False)[1]
    return np.isin(group, group[start])


def _hand_over(giver: Any, taker: Any) -> None:
    index_map = IndexMap.between(giver.state, taker.state)
    copy_history(taker.state, giver.state, index_map)
    for name, plugin in taker.registry.plugins.items():
        other = giver.registry.plugins.get(name)
        if other is not None and hasattr(plugin, "copy_history"):
            plugin.copy_history(other, index_map)
