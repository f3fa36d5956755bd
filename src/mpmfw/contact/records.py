"""Records that every contact strategy keeps for each pair: impulse, work, energy, count."""

from __future__ import annotations

import numpy as np

from mpmfw.kernels.contact import Records
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import CONTACT_SERIES, AnyArray, Field
from mpmfw.state.structs import State

_DECLARED = (
    Field("impulse", ("pair", "axis"), "N s m-1", "impulse on the pair's first body", "contact"),
    Field("friction_impulse", ("pair", "axis"), "N s m-1", "its part along the surface", "contact"),
    Field("frictional_work", ("pair",), "J m-1", "energy dissipated by friction", "contact"),
    Field("damping_work", ("pair",), "J m-1", "energy dissipated by dashpots", "contact"),
    Field("energy", ("pair",), "J m-1", "energy stored in contact springs", "contact"),
    Field("count", ("pair",), "1", "nodes in contact", "contact"),
)

#: Records whose mean rates are the forces of the series.
_IMPULSES = ("impulse", "friction_impulse")


class PairRecords(Records):
    """Accumulators of all pairs, written by kernels, which take them as one argument, and read at outputs.

    They are impulse, friction_impulse, frictional_work, damping_work, energy and count
    (:class:`mpmfw.kernels.contact.Records`). Work and impulse are those since time zero; ``restart`` forgets
    what happened while the scene settled.
    """

    history = ("_last",)

    def __init__(self, setup: Setup, owner: str) -> None:
        super().__init__(**{field.name: setup.allocate(owner, field) for field in _DECLARED})
        self._last = {name: np.zeros_like(self.impulse) for name in _IMPULSES}
        self._owner = owner

    def add_pairs(self, state: State) -> None:
        """Rows for the pairs that were added to the state's: nothing has acted between them so far."""
        rows = len(state.pairs)
        self.set(**{name: state.lengthen(f"{self._owner}/{name}", rows) for name in self.member_names})
        self._last = {
            name: np.concatenate([last, getattr(self, name)[len(last) :]])
            for name, last in self._last.items()
        }

    def restart(self) -> None:
        """Set the accumulators to zero."""
        for array in (self.impulse, self.friction_impulse, self.frictional_work, self.damping_work):
            array.fill(0.0)
        for last in self._last.values():
            last.fill(0.0)

    @staticmethod
    def declarations() -> list[Field]:
        """The series made from the records."""
        return list(CONTACT_SERIES)

    def series(self, interval: float) -> dict[str, AnyArray]:
        """Values at an output; the force is the mean over the ``interval`` [s] since the last one."""
        now = {name: getattr(self, name).copy() for name in _IMPULSES}
        contact_force, friction_force = (
            (now[name] - self._last[name]) / interval if interval > 0.0 else np.zeros_like(now[name])
            for name in _IMPULSES
        )
        self._last = now
        return {
            "contact_force": contact_force,
            "friction_force": friction_force,
            "contact_count": self.count.copy(),
            "frictional_work": self.frictional_work.copy(),
            "contact_energy": self.energy.copy(),
            "damping_work": self.damping_work.copy(),
        }
