"""How far a run is from the one that it is compared with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from rings import force_of, series_of
from rolling import DISTANCE, NO_SLIP, SLIP, motion_of

from mpmfw.results.analysis import impulse
from mpmfw.state.fields import FloatArray

if TYPE_CHECKING:
    from mpmfw.validation import CaseRun


@dataclass(frozen=True)
class Difference:
    """How far a run is from the one it is compared with, over time."""

    time: FloatArray  #: [s]
    values: FloatArray  #: [% of 10 m, or of the total impulse]


def at_end(runs: Sequence[CaseRun], label: str, beside: str) -> float | None:
    """Return the change of displacement after 10 m [%]; None if one of the two did not end."""
    found = _of_rolling(runs, label, beside)
    end = (SLIP if runs and runs[0].runs == "slip" else NO_SLIP).end
    return None if found is None else float(np.interp(end, found.time, found.values))


def largest(runs: Sequence[CaseRun], label: str) -> float | None:
    """Largest change of the impulse curve [%]."""
    found = _of_rings(runs, label)
    return None if found is None else float(np.abs(found.values).max())


def _of_rolling(runs: Sequence[CaseRun], label: str, beside: str) -> Difference | None:
    motions = {run.method.label: motion_of(run.results) for run in runs}
    if label not in motions or beside not in motions:
        return None
    apart = motions[label].displacement - motions[beside].displacement
    return Difference(motions[label].time, 100.0 * apart / DISTANCE)


def _of_rings(runs: Sequence[CaseRun], label: str) -> Difference | None:
    forces = {run.method.label: force_of(series_of(run.results)) for run in runs}
    if label not in forces or "" not in forces:
        return None
    own, other = (impulse(*forces[name]) for name in (label, ""))
    return Difference(forces[label][0], 100.0 * (own - other) / other[-1])
