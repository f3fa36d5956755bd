"""Treatments of rotational inertia beside each other, and what the figure of the case is drawn of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from rolling import errors

if TYPE_CHECKING:
    from mpmfw.state.fields import FloatArray
    from mpmfw.validation import CaseRun


def gained(runs: Sequence[CaseRun], rotation: str) -> float:
    """Acceleration of a treatment less that of the lumped inertia [%], means over the offsets."""
    return float(np.mean(_errors(runs, rotation, "acceleration"))) - float(
        np.mean(_errors(runs, "lumped", "acceleration"))
    )


def mended(runs: Sequence[CaseRun], rotation: str, name: str) -> float:
    """Largest error of a treatment over that of the lumped inertia."""
    own, lumped = (float(np.max(np.abs(_errors(runs, how, name)))) for how in (rotation, "lumped"))
    return own / lumped


def apart(runs: Sequence[CaseRun], name: str) -> float:
    """Largest difference of the local spin correction from the exact one [%]."""
    found = np.subtract(_errors(runs, "spin", name), _errors(runs, "exact", name))
    return float(found[np.argmax(np.abs(found))])


def _errors(runs: Sequence[CaseRun], rotation: str, name: str) -> FloatArray:
    """Of a treatment at all offsets [%]; NaN if none of its runs ended."""
    own = [_error(run, name) for run in runs if (run.method.label or "spin") == rotation]
    return np.array(own or [np.nan])


def _error(run: CaseRun, name: str) -> float:
    return run.of(errors, name, roll=run.runs.partition(",")[0])
