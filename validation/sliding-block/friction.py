"""Friction and normal force of a block that slides down an incline.

Of a rigid block under Coulomb friction (any textbook of mechanics) N = m g cos θ and T = μ N.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

TILT, FRICTION, GRAVITY = math.radians(30.0), 0.3, 10.0  # [rad], [1], [m/s²]
NORMAL_FORCE = 1000.0 * 0.6 * 0.3 * GRAVITY * math.cos(TILT)  # [N/m]
#: The share of the motion that is judged: the start, when the tilt is sudden, is left out.
FROM = 0.2


def forces(run: xr.DataTree) -> dict[str, float | None]:
    """``friction``, error of the mean T / (μ N), and ``normal``, mean N over the closed form's; none without
    a contact force: what one velocity field exchanges is not told from internal force."""
    series = run["series"].to_dataset()
    if "contact_force" not in series:
        return {"friction": None, "normal": None}
    time = series["time"].values
    force = series["contact_force"].sel(pair="block-plane")[time > FROM * time[-1]].mean("time")
    tangential, normal = -float(force.sel(axis="x")), float(force.sel(axis="y"))
    return {"friction": tangential / (FRICTION * normal) - 1.0, "normal": normal / NORMAL_FORCE}
