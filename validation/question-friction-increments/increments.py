"""What a literal increment of friction does, beside a viscous friction of the same size."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from questions import CYLINDER_MASS, GRAVITY
from rolling import DISTANCE, NO_SLIP, SLIP, errors
from viscous import displacement_after, viscosity

from mpmfw.results.references import scene_of

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.validation import CaseRun

TILTS = {"no slip": math.pi / 4.0, "slip": math.pi / 3.0}
MODULUS, CELL, SEGMENT = 10e6, 0.4, 0.1  #: M of the cylinder [Pa], h [m], length of a segment [m]


def viscous(run: xr.DataTree, roll: str) -> dict[str, float]:
    """Return the error under ``viscous`` friction of the same size, and how far it is ``apart`` [%]."""
    series = run["series"].to_dataset()
    width = float(series["contact_count"][1:].mean()) * SEGMENT
    drag = viscosity(MODULUS, width, CELL, time_step_of(run))
    end = (SLIP if roll == "slip" else NO_SLIP).end
    moved = displacement_after(end, drag, CYLINDER_MASS, GRAVITY, TILTS[roll])
    error = 100.0 * (moved / DISTANCE - 1.0)
    return {"viscous": error, "apart": errors(run, roll)["displacement"] - error}


def time_step_of(run: xr.DataTree) -> float:
    """Mean time step [s]."""
    return float(run["series"]["time_step"][1:].mean())


def on_slope(run: xr.DataTree) -> dict[str, float]:
    """Fitted acceleration at 60° [m/s²], and that of a ``rigid`` cylinder: g (sin θ − μ cos θ) if it slips,
    tan θ > 3 μ, else 2 g sin θ / 3."""
    friction = float(scene_of(run.attrs)["contact"]["pairs"][0]["friction"])
    fitted = SLIP.solution.acceleration * (1.0 + errors(run, "slip")["acceleration"] / 100.0)
    tilt = TILTS["slip"]
    slips = math.sin(tilt) - friction * math.cos(tilt)
    return {"fitted": fitted, "rigid": round(GRAVITY * max(slips, 2.0 * math.sin(tilt) / 3.0), 3)}


def scatter(runs: Sequence[CaseRun]) -> float:
    """Range of the return map's errors of the displacement over the time steps [%]."""
    found = list(_by_step(runs, "").values())
    return max(found) - min(found)


def growth(runs: Sequence[CaseRun]) -> float:
    """Least growth of the literal law's displacement as the step is halved [%]."""
    found = [error for _, error in sorted(_by_step(runs, "literal").items())]
    return min(fine - coarse for fine, coarse in itertools.pairwise(found))


def _by_step(runs: Sequence[CaseRun], law: str) -> dict[float, float]:
    """Errors of the displacement by the fraction of the stability limit [%]."""
    return {
        float(run.method.set["time.safety"]): run.of(errors, "displacement", roll=run.runs)
        for run in runs
        if _law(run) == law
    }


def _law(run: CaseRun) -> str:
    return "literal" if run.method.label.startswith("literal") else ""
