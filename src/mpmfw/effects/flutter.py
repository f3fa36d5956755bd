"""A note on bodies that flutter near the limit of friction: they slide although friction could hold them.

The normal force between them swings, and they slip whenever it is low. Over the outputs the friction force is then less than μ
times the normal force, though the bodies slide as a whole.
"""

from __future__ import annotations

import numpy as np

from mpmfw.fields import AnyArray, FloatArray
from mpmfw.hookspecs import hookimpl
from mpmfw.state import State

#: Successive outputs over which bodies slide.
OUTPUTS = 6

#: Friction over μ times the normal force below which they flutter, and least swing of the normal force, as a share of its mean.
SHARE, SPREAD = 0.98, 0.01

#: Times that the normal force turns among these outputs; in an impact it turns once.
TURNS = 3

#: Share of the bodies' motion along their surfaces that must be slip; of bodies that roll little is.
SLIP = 0.5

#: Way between two outputs, over the cell size, below which bodies do not slide.
CREEP = 1e-4


class Flutter:
    """Compares friction with its limit while bodies slide, from the records of a contact.

    Parameters
    ----------
    owner
        Name of the contact, whose records are in ``State.arrays``.
    """

    name = "flutter"
    stage = "output"

    def __init__(self, owner: str) -> None:
        self.records = tuple(f"{owner}/{name}" for name in ("impulse", "friction_impulse", "frictional_work"))
        self.last: list[FloatArray] = []
        self.window: list[FloatArray] = []  #: of the last outputs: normal and friction impulse, (2, pair)
        self.found: dict[str, tuple[float, float, float]] = {}  #: by pair: share, spread, time [s]

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Note pairs that flutter at an output; there are no series."""
        now = [state.arrays[name].copy() for name in self.records] + [_centres(state)]
        last, self.last = self.last, now
        if interval == 0.0 or len(last[0]) != len(now[0]):
            self.window = []
            return {}
        impulse, friction, work, way = (after - before for after, before in zip(now, last, strict=True))
        normal = impulse - friction
        bearing, held = (np.linalg.norm(each, axis=1) for each in (normal, friction))
        first, second = np.array([(pair.first, pair.second) for pair in state.pairs]).T
        relative = way[first] - way[second]
        across = np.einsum("pd,pd->p", relative, normal) / np.maximum(bearing, 1e-300)
        along = np.sqrt(np.maximum(np.einsum("pd,pd->p", relative, relative) - across**2, 0.0))
        slides = (along > CREEP * state.grid.cell_size) & (bearing > 0.0)
        slides &= work * interval > SLIP * along * held
        self.window = [*self.window, np.where(slides, (bearing / interval, held / interval), np.nan)]
        self.window = self.window[-OUTPUTS:]
        if len(self.window) == OUTPUTS:
            self._judge(state)
        return {}

    def _judge(self, state: State) -> None:
        """Compare the means over the window, which are NaN of pairs that did not slide throughout."""
        forces = np.array(self.window)  # (output, 2, pair)
        normal, held = forces.mean(axis=0)
        mu = np.array([pair.mu for pair in state.pairs])
        share = held / np.where(mu > 0.0, mu * normal, np.nan)
        spread = forces[:, 0].std(axis=0) / normal
        change = np.diff(forces[:, 0], axis=0)
        turns = (change[1:] * change[:-1] < -((SPREAD * normal) ** 2)).sum(axis=0)
        for index in np.flatnonzero((share < SHARE) & (turns >= TURNS)):
            label, found = state.pairs[index].label, (float(share[index]), float(spread[index]), state.time)
            self.found[label] = min(self.found.get(label, found), found)

    @hookimpl
    def concerns(self) -> list[str]:
        """Pairs that fluttered."""
        return [
            f"{label}: the bodies flutter at the limit of friction at {time:.4g} s: the normal force swings by "
            f"{100.0 * spread:.2g} %, and they slide although friction is {share:.2g} of its limit; damping stops it"
            for label, (share, spread, time) in self.found.items()
        ]


def _centres(state: State) -> FloatArray:
    """Centres of mass of all bodies, (body, dim) [m]."""
    p = state.particles
    starts = [body.particles.start for body in state.bodies]
    return np.asarray(
        np.add.reduceat(p.mass[:, None] * p.position, starts) / np.add.reduceat(p.mass, starts)[:, None]
    )
