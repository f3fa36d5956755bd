"""Bodies at rest sleep: the steps are those of the bodies awake, a simulation of their own, until something
disturbs the others.

Whoever is near sleeps and wakes together, so that what sleeps acts on nobody: near are bodies whose windows
of the grid share a node, as between two layings of the windows nobody leaves its own. A body asleep stays as
it is, its velocity and its springs included, and goes on from there: nothing is lost when it wakes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.plugin.checks import bundled, described
from mpmfw.plugin.load import BodyLoad, LoadedFacets, SurfaceLoad
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.runs.build import build_some
from mpmfw.state.clock import Clock
from mpmfw.state.fields import AnyArray, FloatArray, IntArray
from mpmfw.state.history import NotSaved
from mpmfw.state.numbers import Numbers, take_over
from mpmfw.state.pairs import list_near, overlapping
from mpmfw.state.structs import Body, State
from mpmfw.state.windows import lay_windows, set_windows, windows_round
from mpmfw.step import SCHEMES
from mpmfw.step.transfer import Transfer

#: Steps between two looks at who is at rest.
LOOK_EVERY = 20

#: Times that a body which nothing holds takes to fall past the bound, after which it is at rest: one at the
#: top of its flight is slower than the bound for two of them.
FALLS = 4.0

#: How many times the nodes that windows have now those of a saved part may have: bodies may have drawn
#: together since.
SPARE = 16.0

#: Records of pairs that grow with time while bodies rest on each other.
IMPULSES = ("impulse", "friction_impulse")


def from_setup(setup: Setup) -> Acts:
    """Return when bodies fall asleep; refuse effects that bodies cannot sleep beside.

    Raises
    ------
    SceneError
        There is some of it.
    """
    contact, output = setup.contact, setup.scene.output
    if contact is None or contact.velocity_fields != "per_body":
        raise SceneError(
            "sleep: expected a contact with a velocity field for each body, in which one of them can be left "
            "out"
        )
    if not contact.leaves_bodies_out:
        raise SceneError(
            f"sleep: contact '{contact.label}' cannot leave bodies out; expected one that can, such as "
            "bardenhagen, or penalty "
            "without master and interface_thickness"
        )
    for key in ("ledger", "stability"):
        if getattr(output, key):
            raise SceneError(f"sleep: output.{key} measures all bodies in every step; expected {key} = false")
    if output.contact_moment is not None:
        raise SceneError("sleep: output.contact_moment measures all bodies in every step; expected none")
    if setup.named["boundaries"]:
        raise SceneError("sleep: the motion of [boundaries] is not known beforehand; expected sides")
    for plugin in setup.plugins:
        if not bundled(type(plugin)):
            raise SceneError(f"sleep: {described(plugin)} would not know who is awake; expected bundled ones")
    asked = setup.scene.sleep
    assert asked is not None
    return Acts(f"[sleep]: below {asked.strain:g} of the wave speed for {asked.crossings:g} crossings")


class Sleep:
    """Who sleeps, and the steps of all others.

    Parameters
    ----------
    whole
        The simulation of all bodies, before its first step.
    setup
        Of all bodies.
    """

    def __init__(self, whole: Any, setup: Setup) -> None:
        asked = setup.scene.sleep
        assert asked is not None
        self.whole, self.setup = whole, setup
        self.part: Any = None  #: simulation of the bodies awake; None if these are all or none
        self.scheme = SCHEMES[setup.scheme]
        bodies = setup.state.bodies
        waves = np.array([body.wave_speed for body in bodies])
        longest = np.array([np.subtract(body.upper, body.lower).max() for body in bodies])
        self.bound: FloatArray = asked.strain * waves  #: (n_bodies,) [m/s]
        self.patience: FloatArray = asked.crossings * longest / waves  #: (n_bodies,) [s]
        self.moved = np.zeros(len(bodies))  #: last time at which a body was seen to move [s]
        self.asleep, self.sleepers = np.zeros(len(bodies), dtype=bool), 0
        self.lower, self.upper = (np.zeros_like(setup.state.grid.window_lower) for _ in range(2))
        self.pulls: dict[int, list[AnyArray]] = {}  #: gravity and loads under which a body fell asleep
        self.rates = {name: np.zeros((0, setup.scene.dim)) for name in IMPULSES}
        self.counted = 0.0  #: time up to which impulses of pairs asleep are counted [s]
        self.slept = np.zeros(len(bodies))  #: when a body fell asleep [s]
        self.seen: tuple[float, dict[str, FloatArray]] | None = None  #: time and impulses of the last look
        self.frame = 0  #: of the windows that were compared last
        self._loads = [
            plugin
            for _, plugin in whole.manager.list_name_plugin()
            if isinstance(plugin, BodyLoad | SurfaceLoad)
        ]
        self._gravity = whole.manager.get_plugin("gravity")
        self._gravity_changes = self._gravity is not None and len(self._gravity.table.times) > 1
        self._contact = "" if setup.contact is None else setup.contact.name

    # -- the steps
    # ---------------------------------------------------------------------------------------------------

    @property
    def running(self) -> Any:
        """The simulation that takes the steps."""
        return self.whole if self.part is None else self.part

    def step(
        self, state: State, hook: Any, transfer: Transfer, clock: Clock, length: Callable[[], float]
    ) -> float:
        """One time step of the bodies awake, called as those of :data:`mpmfw.step.SCHEMES`; of all while the
        scene settles."""
        if not self.whole.started:
            return self.scheme(state, hook, transfer, clock, length)
        if self.sleepers:
            self._wake(state.time)
        if self.sleepers == len(self.asleep):
            return length()
        running = self.running
        own = running.state
        own.time, own.steps, own.dt = state.time, state.steps, state.dt
        dt = own.dt = self.scheme(own, running.hook, transfer, clock, length)
        if state.steps % LOOK_EVERY == 0:
            self._look(state.time + dt)
        return dt

    def _look(self, time: float) -> None:
        """Who has been at rest for long enough falls asleep, unless somebody near has not."""
        state = self.running.state
        awake = np.flatnonzero(~self.asleep)
        v = state.particles.velocity
        square = np.maximum.reduceat(np.einsum("pd,pd->p", v, v), state.particles.first[:-1])
        self.moved[awake[square > self.bound[awake] ** 2]] = time
        last, self.seen = self.seen, (time, self._impulses())
        rested = time - self.moved[awake] >= self.patience[awake]
        if last is None or not rested.any():
            return
        self.gather(time)
        rested[rested] = [self._would_have_moved(body, time) for body in awake[rested].tolist()]
        lower, upper = self._windows_now()
        sleepy = ~_reached(~rested, *overlapping(lower, upper))
        if sleepy.any():
            which = awake[sleepy]
            self.lower[which], self.upper[which] = lower[sleepy], upper[sleepy]
            self._fall_asleep(which, time, last)

    def _would_have_moved(self, body: int, time: float) -> bool:
        """Whether gravity and loads had the time to move a body past the bound if nothing held it, or there
        are none.
        """
        acceleration = self._pull(body, time)[1]
        rest = time - self.moved[body]
        return bool(acceleration == 0.0 or rest * acceleration >= FALLS * self.bound[body])

    def _windows_now(self) -> tuple[IntArray, IntArray]:
        """First and last node of the windows of the bodies awake, if they were laid now."""
        state, hook = self.running.state, self.running.hook
        reach = hook.particle_reach(particles=state.particles)
        lower, shape = windows_round(state.grid, state.particles, reach, state.surface)
        return lower, lower + shape - 1

    # -- falling asleep and waking
    # -------------------------------------------------------------------------------------

    def _fall_asleep(self, which: IntArray, time: float, last: tuple[float, dict[str, FloatArray]]) -> None:
        """Leave bodies out from now on; ``last`` are impulses some steps ago, from which their forces on each
        other follow.
        """
        whole, now = self.whole.state, self._impulses()
        number = Numbers.between(self.running.state, whole).pair
        self.asleep[which] = True
        for name in self.rates:
            rate, before = np.zeros((len(whole.pairs), whole.grid.dim)), np.zeros_like(now[name])
            rate[: len(self.rates[name])] = self.rates[name]
            before[: len(last[1][name])] = last[1][name]
            rate[number] = (now[name] - before) / (time - last[0])
            self.rates[name] = self._between_sleepers(rate)
        self.slept[which] = time
        self._remember_pulls()
        self._divide()

    def _remember_pulls(self) -> None:
        """What acted on every body when it fell asleep: it has not moved since."""
        self.pulls = {b: self._pull(b, float(self.slept[b]))[0] for b in np.flatnonzero(self.asleep).tolist()}

    def _between_sleepers(self, rate: FloatArray) -> FloatArray:
        """The rates (n_pairs, dim), zero but for pairs of which both sleep."""
        pairs = self.whole.state.pairs[: len(rate)]
        both = np.array([self.asleep[pair.first] and self.asleep[pair.second] for pair in pairs], dtype=bool)
        return np.where(both[:, None], rate, 0.0)

    def _wake(self, time: float) -> None:
        """Wake who is disturbed, and all that are near them."""
        woken = np.zeros_like(self.asleep)
        if self._loads or self._gravity_changes:
            for body, before in self.pulls.items():
                now, _ = self._pull(body, time)
                woken[body] = not all(np.array_equal(*each) for each in zip(before, now, strict=True))
        grid = self.running.state.grid
        if self.part is not None and grid.frame != self.frame:
            self.frame = grid.frame
            for lower, shape in zip(grid.window_lower, grid.window_shape, strict=True):
                apart = (self.lower >= lower + shape) | (lower > self.upper)
                woken |= self.asleep & ~apart.any(axis=1)
        if not woken.any():
            return
        sleepers = np.flatnonzero(self.asleep)
        woken[sleepers] = _reached(woken[sleepers], *overlapping(self.lower[sleepers], self.upper[sleepers]))
        self.gather(time)
        self.asleep[woken], self.moved[woken] = False, time
        self._remember_pulls()
        self.rates = {name: self._between_sleepers(rate) for name, rate in self.rates.items()}
        self._divide()

    def _pull(self, body: int, time: float) -> tuple[list[AnyArray], float]:
        """Gravity [m/s²] and every load's forces [N] or tractions [Pa] on a body, and the acceleration of all
        of them [m/s²].
        """
        state = self.whole.state
        own = state.bodies[body]
        mass = float(state.particles.mass[own.particles].sum())
        found, total = [], np.zeros(state.grid.dim)
        if self._gravity is not None:
            found.append(self._gravity.at(time))
            total += mass * found[0]
        for load in self._loads:
            if own in load.bodies:
                values, force = _force_of(load, state, own, time)
                found.append(values)
                total += force
        return found, float(np.linalg.norm(total)) / mass

    # -- the whole and its part
    # ----------------------------------------------------------------------------------------

    def gather(self, time: float) -> None:
        """Let the simulation of all bodies know where they are at ``time`` [s], and what has acted between
        them.
        """
        whole = self.whole.state
        for name, rate in self.rates.items():
            self.whole.state.arrays[f"{self._contact}/{name}"][: len(rate)] += (time - self.counted) * rate
        self.counted = time
        if self.part is None:
            return
        if whole.near is not None:
            index = {body.name: body.index for body in whole.bodies}
            ours = self.part.state
            ends = [
                [index[ours.bodies[getattr(pair, end)].name] for pair in ours.pairs]
                for end in ("first", "second")
            ]
            if whole.near.add(whole, *(np.array(end, dtype=np.int64) for end in ends)):
                self.whole.hook.add_pairs(state=whole)
        _hand_over(self.part, self.whole)

    def _divide(self, windows: tuple[IntArray, IntArray] | None = None) -> None:
        """Make the simulation of the bodies awake; ``windows`` are those that it is to have, where it had
        them before.
        """
        whole = self.whole
        awake = np.flatnonzero(~self.asleep)
        self.part, self.seen, self.sleepers = None, None, len(self.asleep) - len(awake)
        if 0 < len(awake) < len(self.asleep):
            self.part = type(whole).of(build_some(self.setup, awake.tolist()), whole.clock, whole.threads)
            self.part.started = True
            _hand_over(whole, self.part)
        running = self.running
        grid, reach = running.state.grid, running.hook.particle_reach(particles=running.state.particles)
        if windows is None:
            lay_windows(grid, running.state.particles, reach, running.state.surface)
        else:
            _, shape = windows_round(grid, running.state.particles, reach, running.state.surface)
            set_windows(grid, *windows, most=SPARE * float(np.prod(shape, axis=1).sum()))
        list_near(running.state, running.hook)
        if self.part is not None:
            _hand_over(whole, self.part)  # once more: now it lists the pairs
        self.frame = grid.frame

    def _impulses(self) -> dict[str, FloatArray]:
        """Those of the pairs of the simulation that runs, up to now; one body alone has none."""
        state = self.running.state
        none = np.zeros((0, state.grid.dim))
        return {name: state.arrays.get(f"{self._contact}/{name}", none).copy() for name in IMPULSES}

    # -- how it is kept
    # -----------------------------------------------------------------------------------------------

    history = ("moved", "slept", "asleep", "lower", "upper", "counted", "rates", "of_part")

    @property
    def of_part(self) -> dict[str, AnyArray]:
        """What is known of the part beside the values of its bodies, which are the whole's once they are
        gathered.
        """
        grid = self.running.state.grid
        fields = grid.n_fields if self.part is not None else 0
        time, impulses = self.seen or (None, {name: np.zeros((0, grid.dim)) for name in IMPULSES})
        return {
            "window_lower": grid.window_lower[:fields],
            "window_shape": grid.window_shape[:fields],
            "compared": np.full(min(fields, 1), grid.frame == self.frame),
            "seen": np.array([] if time is None else [time]),
            **impulses,
        }

    @of_part.setter
    def of_part(self, values: dict[str, AnyArray]) -> None:
        self._saved = values

    def restored(self) -> None:
        """Make the part as it was, after the values of the whole were restored.

        Raises
        ------
        NotSaved
            The values are not those of the bodies.
        """
        self.sleepers = int(np.count_nonzero(self.asleep))
        self._remember_pulls()
        saved = self._saved
        if any(len(rate) > len(self.whole.state.pairs) for rate in self.rates.values()):
            raise NotSaved("more pairs slept than there are")
        if not len(saved["compared"]):
            self.seen = self._seen_in(saved)
            return
        self._divide((saved["window_lower"], saved["window_shape"]))
        self.seen = self._seen_in(saved)
        self.frame -= not saved["compared"][0]

    def _seen_in(self, saved: dict[str, AnyArray]) -> tuple[float, dict[str, FloatArray]] | None:
        """Time and impulses of the last look."""
        return (float(saved["seen"][0]), {n: saved[n] for n in IMPULSES}) if len(saved["seen"]) else None


def _reached(start: AnyArray, first: IntArray, second: IntArray) -> AnyArray:
    """Who is among ``start`` (n,), or joined to one who is by pairs of ``first`` and ``second``: (n,) of
    truth values.
    """
    found = np.array(start, dtype=bool)
    while True:
        either = found[first] | found[second]
        if (found[first] == either).all() and (found[second] == either).all():
            return found
        found[first[either]] = found[second[either]] = True


def _force_of(load: Any, state: State, body: Body, time: float) -> tuple[AnyArray, FloatArray]:
    """A load's forces on a body's points [N], or tractions on its facets [Pa], and their sum [N]."""
    if isinstance(load, BodyLoad):
        force = load.forces(state.particles, body.particles, time)
        return force, force.sum(axis=0)
    assert state.surface is not None
    own = state.surface.facets_of(body.index)
    facets = LoadedFacets(state, load.facets[(load.facets >= own.start) & (load.facets < own.stop)])
    traction = load.traction(facets, time)
    return traction, facets.area @ traction


def _hand_over(giver: Any, taker: Any) -> None:
    """Let one simulation know what the other does of the bodies that they share."""
    numbers = Numbers.between(giver.state, taker.state)
    take_over(taker.state, giver.state, numbers)
    for name, plugin in taker.manager.list_name_plugin():
        other = giver.manager.get_plugin(name)
        if other is not None and hasattr(plugin, "take_over"):
            plugin.take_over(other, numbers)
