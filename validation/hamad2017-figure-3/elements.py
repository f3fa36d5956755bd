"""Finite elements of the resolution of [H17], and what the figures are drawn of."""

from __future__ import annotations

import functools
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).parents[1] / "finite-elements"))

from drawing import beside_finite_elements, histories
from rings_fem import Collision, collide
from stresses import TIMES, stresses_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mpmfw.validation import CaseRun


@functools.cache
def collision() -> Collision:
    """Rings of four-node quadrilaterals of 2 mm."""
    return collide(2e-3, end=TIMES[-1], times=TIMES)


def stresses() -> dict[str, float]:
    """95th percentile and mean of the von Mises stress [Pa]."""
    found = {}
    for snapshot in collision().snapshots[1:]:
        at = f"{1e3 * snapshot.time:.1f} ms"
        found |= {f"p95 {at}": snapshot.percentile(95.0), f"mean {at}": snapshot.mean}
    return found


def beside(runs: Sequence[CaseRun]) -> Figure:
    """Stresses of the recommended method beside those of the elements."""
    recommended = next(run for run in runs if run.method.recommended)
    return beside_finite_elements(stresses_of(recommended.results), collision())


def over_time(runs: Sequence[CaseRun]) -> Figure:
    """Stresses of every method over those of the fine elements."""
    return histories({run.method: stresses_of(run.results) for run in runs})
