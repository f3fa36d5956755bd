"""Warning about flutter near the limit of friction: bodies slide although friction could hold them.

The normal force oscillates, and they slip whenever it is low. At most outputs the friction force is then
below μ times the normal force, although the bodies slide as a whole."""

from __future__ import annotations

import numpy as np

from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import AnyArray
from mpmfw.state.structs import State

#: Successive outputs over which bodies slide.
OUTPUTS = 6

#: Friction over μ times the normal force below which they flutter, and least swing of the normal force, as a
#: share of its mean.
SHARE, SPREAD = 0.98, 0.01

#: Times that the normal force turns among these outputs; in an impact it turns once.
TURNS = 3

#: Share of the bodies' motion along their surfaces that must be slip; of bodies that roll little is.
SLIP = 0.5

#: Way between two outputs, over the cell size, below which bodies do not slide.
CREEP = 1e-4


class Flutter:
    """Compares friction with its limit while bodies slide."""

    name = "flutter"
    stage = "output"
    history = ("last", "centres", "window", "found", "spread", "found_at")

    def __init__(self, owner: str, dim: int) -> None:
        self.records = tuple(f"{owner}/{name}" for name in ("impulse", "friction_impulse", "frictional_work"))
        self.last = np.zeros((0, 2 * dim + 1))  #: the records at the last output, (pair, …)
        self.centres = np.zeros((0, dim))  #: centres of mass then, (body, dim) [m]
        #: normal and friction force at the last outputs, NaN without sliding
        self.window = np.zeros((0, OUTPUTS, 2))
        self.found: dict[str, float] = {}  #: by pair: least median of friction over its limit
        self.spread: dict[str, float] = {}  #: spread of the normal force then
        self.found_at: dict[str, float] = {}  #: time [s]

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        assert setup.contact is not None
        return Acts("", [cls(setup.contact.name, setup.dim)])

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Note pairs that flutter at an output; there are no series."""
        dim, pairs, known = state.grid.dim, len(state.pairs), len(self.centres) > 0
        now = np.column_stack([state.arrays[name] for name in self.records])
        last, centres = self.last, state.centres_of_mass
        way, self.centres = centres - self.centres if known else centres, centres
        self.last = now
        if len(last) != pairs:
            self.window = np.full((pairs, OUTPUTS, 2), np.nan)
        if len(last) != pairs or not known or interval == 0.0 or pairs == 0:
            return {}
        friction, work = now[:, dim : 2 * dim] - last[:, dim : 2 * dim], now[:, -1] - last[:, -1]
        push = now[:, :dim] - last[:, :dim] - friction
        bearing, held = (np.linalg.norm(each, axis=1) for each in (push, friction))
        first, second = state.pair_bodies.T
        relative = way[first] - way[second]
        across = np.einsum("pd,pd->p", relative, push) / np.maximum(bearing, 1e-300)
        along = np.sqrt(np.maximum(np.einsum("pd,pd->p", relative, relative) - across**2, 0.0))
        slides = (along > CREEP * state.grid.cell_size) & (bearing > 0.0)
        slides &= work * interval > SLIP * along * held
        forces = np.where(slides[:, None], np.column_stack([bearing, held]) / interval, np.nan)
        self.window = np.concatenate([self.window[:, 1:], forces[:, None]], axis=1)
        forces = self.window  # medians are NaN of pairs that did not slide throughout
        normal = forces[:, :, 0].mean(axis=1)
        mu = np.array([[pair.mu] for pair in state.pairs])
        share = np.median(forces[:, :, 1] / np.where(mu > 0.0, mu * forces[:, :, 0], np.nan), axis=1)
        change = np.diff(forces[:, :, 0], axis=1)
        turns = (change[:, 1:] * change[:, :-1] < -((SPREAD * normal[:, None]) ** 2)).sum(axis=1)
        for index in np.flatnonzero((share < SHARE) & (turns >= TURNS)):
            label = state.pairs[index].label
            if share[index] < self.found.get(label, SHARE):
                self.found[label], self.found_at[label] = float(share[index]), state.time
                self.spread[label] = float(forces[index, :, 0].std() / normal[index])
        return {}

    @hookimpl
    def concerns(self) -> list[str]:
        return [
            f"{label}: the bodies flutter at the limit of friction at {self.found_at[label]:.4g} s: the "
            f"normal force swings by {100.0 * self.spread[label]:.0f} %, and they slide although friction is "
            f"{share:.2g} of its limit; damping stops it"
            for label, share in self.found.items()
        ]
