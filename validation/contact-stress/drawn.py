"""What the figures of the case are drawn of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from figures import convergence_figure, interface_figure
from measures import Points, points_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mpmfw.validation import CaseRun


def interface(runs: Sequence[CaseRun]) -> Figure:
    """Stresses along the interface, of the first run of each method."""
    return interface_figure({str(run.method): points_of(run.results) for run in reversed(runs)})


def convergence(runs: Sequence[CaseRun]) -> Figure:
    """Errors over the cell size, by method."""
    curves: dict[str, list[Points]] = {}
    for run in runs:
        curves.setdefault(str(run.method), []).append(points_of(run.results))
    return convergence_figure(curves)
