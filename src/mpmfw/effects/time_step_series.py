"""Series of the time step: its length, the limit, and who sets the limit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import AnyArray, Field
from mpmfw.state.structs import State

_MEAN = "mean length of the steps since the last output"
_OWNER = "who sets the limit: index into the attribute time_step_owners of the root"
TIME_STEP_FIELDS = [
    Field("time_step", (), "s", _MEAN, "series", output=True, missing=True),
    Field("time_step_limit", (), "s", "stable time step at the output", "series", output=True),
    Field("time_step_owner", (), "1", _OWNER, "series", output=True),
]


class TimeStepSeries:
    """Series of the time step, from ``limits``: every stable step [s] with its owner, without the safety
    factor.
    """

    name = "time_step_series"
    stage = "output"
    history = ("owners", "last")

    def __init__(self, limits: Callable[[], list[tuple[float, str]]]) -> None:
        self.limits = limits
        self.owners: dict[str, float] = {}  #: their numbers, in the order in which they first set the limit
        self.last = 0

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Record the limits of the run, and the contact's series of stability."""
        monitors = [] if setup.contact is None else setup.contact.monitors()
        return Acts("output.stability = true", [cls(setup.limits), *monitors])

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The three series."""
        return TIME_STEP_FIELDS

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Values at this output; an owner is numbered when it first sets the limit."""
        limit, owner = min(self.limits())
        number = self.owners.setdefault(owner, float(len(self.owners)))
        steps, self.last = state.steps - self.last, state.steps
        mean = interval / steps if steps > 0 and interval > 0.0 else np.nan
        values = {"time_step": mean, "time_step_limit": limit, "time_step_owner": number}
        return {name: np.asarray(float(value)) for name, value in values.items()}
