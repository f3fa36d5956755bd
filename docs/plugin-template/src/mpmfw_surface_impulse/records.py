"""What is recorded of every pair: impulse, work of slip and of impacts, nodes in contact."""

from __future__ import annotations

import numpy as np

from mpmfw.api import CONTACT_SERIES, AnyArray, Field, FloatArray, Setup
from mpmfw.kernels import kernel
from mpmfw.kernels.types import Floats, Ints
from mpmfw_surface_impulse.solver import relative_velocity

#: Mpmfw's series for contact. There are no springs, and in the place of dashpots' work stands the loss of impacts.
IMPACT_WORK = "energy lost where surface nodes stop or stick at once, since time zero"
SERIES = [
    Field(field.name, field.dims, field.unit, IMPACT_WORK, "series", output=True)
    if field.name == "damping_work"
    else field
    for field in CONTACT_SERIES
]


@kernel
def record(
    node: Ints,
    pair: Ints,
    sign: Floats,
    segment: Ints,
    start: Ints,
    grid_node: Ints,
    share: Floats,
    couple: Floats,
    normal: Floats,
    mass: Floats,
    momentum_before: Floats,
    momentum_after: Floats,
    impulse: Floats,
    dt: float,
    pair_impulse: Floats,
    frictional_work: Floats,
    impact_work: Floats,
    count: Floats,
    force: Floats,
) -> None:
    """Add the step's impulses to the records of their pairs, and note the slave nodes' forces λ / Δt [N/m].

    The work of an impulse is its product with the mean of the relative velocities before and after the step,
    ``momentum_before`` being the projected one: the sum over all impulses of the step is then what they change the grid's
    kinetic energy by. Of it, −λ_t u_t at the end is dissipated by slip, and never negative; the rest is lost where nodes stop
    or stick at once.
    """
    for r in range(len(node)):
        lambda_n, lambda_t = impulse[r, 0], impulse[r, 1]
        if segment[r] < 0 or lambda_n == 0.0:
            continue
        low, high, n_x, n_y = start[r], start[r + 1], normal[r, 0], normal[r, 1]
        before = relative_velocity(low, high, n_x, n_y, grid_node, share, couple, mass, momentum_before)
        after = relative_velocity(low, high, n_x, n_y, grid_node, share, couple, mass, momentum_after)
        p = pair[r]
        lost = -0.5 * (lambda_n * (before[0] + after[0]) + lambda_t * (before[1] + after[1]))
        slipped = max(-lambda_t * after[1], 0.0)
        frictional_work[p] += slipped
        impact_work[p] += lost - slipped
        count[p] += 1.0
        on_x, on_y = lambda_n * n_x - lambda_t * n_y, lambda_n * n_y + lambda_t * n_x
        pair_impulse[p, 0] += sign[r] * on_x
        pair_impulse[p, 1] += sign[r] * on_y
        force[node[r], 0] += on_x / dt
        force[node[r], 1] += on_y / dt


class Records:
    """Accumulators of all pairs since time zero."""

    def __init__(self, setup: Setup, owner: str) -> None:
        def own(name: str, dims: tuple[str, ...], unit: str, meaning: str) -> AnyArray:
            return setup.allocate(owner, Field(name, dims, unit, meaning, "contact"))

        pair = ("pair",)
        self.impulse: FloatArray = own(
            "impulse", ("pair", "axis"), "N s m-1", "impulse on the pair's first body"
        )
        self.frictional_work: FloatArray = own("frictional_work", pair, "J m-1", "work lost to friction")
        self.impact_work: FloatArray = own(
            "impact_work", pair, "J m-1", "work lost where nodes stop or stick at once"
        )
        self.count: FloatArray = own("count", pair, "1", "surface nodes with an impulse")
        self._last_impulse = np.zeros_like(self.impulse)

    def restart(self) -> None:
        """Forget what happened while the scene settled."""
        for array in (self.impulse, self.frictional_work, self.impact_work, self._last_impulse):
            array.fill(0.0)

    def series(self, interval: float) -> dict[str, AnyArray]:
        """Values at an output; the force is the mean over the ``interval`` [s] since the last one."""
        change = self.impulse - self._last_impulse
        self._last_impulse = self.impulse.copy()
        return {
            "contact_force": change / interval if interval > 0.0 else np.zeros_like(change),
            "contact_count": self.count.copy(),
            "frictional_work": self.frictional_work.copy(),
            "contact_energy": np.zeros_like(self.count),
            "damping_work": self.impact_work.copy(),
        }
