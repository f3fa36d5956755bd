"""What the figures of the case are drawn of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from figures import convergence_figure, pressure_figure
from pressure import Profile, from_forces, from_stress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mpmfw.validation import CaseRun


def pressures(runs: Sequence[CaseRun]) -> Figure:
    """Pressure over the contact, of penalty contact by its forces."""
    return pressure_figure(_profiles(runs))


def convergence(runs: Sequence[CaseRun]) -> Figure:
    """Errors over the cell size."""
    return convergence_figure(_profiles(runs))


def _profiles(runs: Sequence[CaseRun]) -> dict[tuple[str, float], Profile]:
    """By method and cell size [m]."""
    return {
        (str(run.method), run.scene.grid.cell_size): (
            from_forces(run.results) if run.method.contact == "penalty" else from_stress(run.results)
        )
        for run in runs
    }
