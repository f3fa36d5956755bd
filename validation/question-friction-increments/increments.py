"""A literal increment of friction beside a viscous friction of the same size.

Rolling under a viscous friction: f_t = −k_t Δg_t of one step is −k_t Δt v, a dashpot with c = k_t Δt.
Over a contact of width w the slave nodes' k_t = κ M l_trib / h add up to κ M w / h.

A rigid cylinder, I = m R²/2, under F = c v: m ẍ = m g sin θ − F and I ω̇ = F R, so that v = ẋ − R ω obeys
v̇ = g sin θ − 3 c v / m, and ẍ = (2/3) g sin θ + v̇/3. From rest, with τ = m/(3c),

    x = g sin θ t²/3 + s/3,  s = g sin θ τ (t − τ (1 − e^(−t/τ))) the distance slipped.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from questions import CYLINDER_MASS, GRAVITY
from rolling import DISTANCE, NO_SLIP, SLIP, errors

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


def viscosity(modulus: float, width: float, cell_size: float, time_step: float) -> float:
    """c = κ M w Δt / h for κ = 1 [N s/m per metre of thickness]."""
    return modulus * width * time_step / cell_size


def displacement_after(time: float, drag: float, mass: float, gravity: float, tilt: float) -> float:
    """Of the centre along the plane [m], from rest, for a drag c [N s/m/m] and a mass [kg/m]."""
    pull = gravity * math.sin(tilt)
    decay = mass / (3.0 * drag)
    slipped = pull * decay * (time - decay * -math.expm1(-time / decay))
    return pull * time**2 / 3.0 + slipped / 3.0


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
