"""A literal increment of friction beside a viscous friction of the same size.

Rolling under a viscous friction: f_t = −k_t Δg_t of one step is −k_t Δt v, a dashpot with c = k_t Δt.
Over a contact of width w the slave nodes' k_t = κ M l_trib / h add up to κ M w / h.

A rigid cylinder, I = m R²/2, under F = c v: m ẍ = m g sin θ − F and I ω̇ = F R, so that v = ẋ − R ω obeys
v̇ = g sin θ − 3 c v / m, and ẍ = (2/3) g sin θ + v̇/3. From rest, with τ = m/(3c),

    x = g sin θ t²/3 + s/3,  s = g sin θ τ (t − τ (1 − e^(−t/τ))) the distance slipped.
"""

import math

import xarray as xr
from rolling import DISTANCE, GRAVITY, NO_SLIP, RADIUS, SLIP, errors

from mpmfw.validation import RunSet

TILTS = {"no slip": math.pi / 4.0, "slip": math.pi / 3.0}
MODULUS, CELL, SEGMENT = 10e6, 0.4, 0.1  #: M of the cylinder [Pa], h [m], length of a segment [m]
MASS = 1000.0 * math.pi * RADIUS**2  #: of the cylinder [kg/m]


def viscous(run: xr.DataTree, roll: str) -> dict[str, float]:
    """Return the error under ``viscous`` friction of the same size, and how far it is ``apart`` [%]."""
    series, pull = run["series"].to_dataset(), GRAVITY * math.sin(TILTS[roll])
    width, time_step = (float(series[name][1:].mean()) for name in ("contact_count", "time_step"))
    drag = MODULUS * width * SEGMENT * time_step / CELL  # κ = 1 [N s/m per metre of thickness]
    time = (SLIP if roll == "slip" else NO_SLIP).end
    decay = MASS / (3.0 * drag)
    slipped = pull * decay * (time - decay * -math.expm1(-time / decay))
    error = 100.0 * ((pull * time**2 / 3.0 + slipped / 3.0) / DISTANCE - 1.0)
    return {"viscous": error, "apart": errors(run, roll)["displacement"] - error}


def by_step(runs: RunSet, literal: bool) -> list[float]:
    """Return errors of the displacement of one law [%], from the smallest time step to the largest."""
    own = [run for run in runs if run.method.label.startswith("literal") == literal]
    own.sort(key=lambda run: run.method.set["time.safety"])
    return [run.of(errors, "displacement", roll=run.runs) for run in own]
