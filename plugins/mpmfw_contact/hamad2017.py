"""[H17] by its equations: springs between surface nodes and every segment that they penetrate.

Source: F. Hamad, S. Giridharan, C. Moormann (2017), A penalty function method for modelling frictional contact in MPM,
Procedia Engineering 175, 116-123. What it leaves open is friction: μ is in none of its equations, and the tangential gap of
eq. 3 counts from the previous step. Here those gaps are read as increments, as explicit finite-element codes have them, to
whose practice [H17] refers: they add up while the contact lasts, and |f_t| ≤ μ f_n. That is an assumption of this module.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from pydantic import Field

from mpmfw.api import Length, Pair, hookimpl
from mpmfw.kernels import device, kernel
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw_contact.penalty.options import SurfaceOptions
from mpmfw_contact.penalty.pair_force import add_forces, relative_motion, return_to_cone, rows_of
from mpmfw_contact.penalty.pair_table import pair_index
from mpmfw_contact.penalty.strategy import SurfaceSprings


@device
def carried_force(
    s: int, touched: int, segment: Ints, body: Ints, old_master: Ints, old_tangential: Floats
) -> Float:
    """Tangential force that node s had with body ``touched`` [N/m], over the segments that it meets there now."""
    total, met = 0.0, 0
    for i in range(segment.shape[1]):
        if old_master[s, i] == touched:
            total += old_tangential[s, i]
        if segment[s, i] >= 0 and body[segment[s, i]] == touched:
            met += 1
    return total / met


@kernel
def pair_forces(
    master: Ints, segment: Ints, coordinate: Floats, gap: Floats, normal: Floats, stiffness: Floats,
    old_master: Ints, tangential: Floats, old_tangential: Floats,
    body: Ints, position: Floats, displacement: Floats, following: Ints,
    pair_of: Ints, pair_first: Ints, friction: Floats, tangential_ratio: float, dt: float,
    rows: Floats, force: Floats, impulse: Floats, frictional_work: Floats, energy: Floats, count: Floats,
) -> None:  # fmt: skip
    """f = −(ω_n g_n C_n + ω_t g_t C_t) of every node and every segment that it penetrates (eq. 9), added to ``force``.

    ``tangential`` (n_s, slots) [N/m] without nodes is the literal friction: g_t of this step alone, and no cap. ``rows`` is
    scratch, (4, 3, 2). Arrays are those of :func:`mpmfw_contact.penalty.pair_force.contact_forces`.
    """
    energy[:] = 0.0
    count[:] = 0.0
    for s in range(len(body)):
        for j in range(segment.shape[1]):
            m = segment[s, j]
            master[s, j] = body[m] if m >= 0 else -1
            if len(tangential) > 0:
                tangential[s, j] = 0.0
            if m < 0:
                continue
            g_n, xi, k = gap[s, j], coordinate[s, j], stiffness[s, j]
            pair = pair_index(pair_of, body[s], body[m])
            k_t = tangential_ratio * k
            rows_of(m, xi, g_n, normal[s, j, 0], normal[s, j, 1], True, position, following, rows)  # eq. 7, 8
            g_t = relative_motion(rows[1], s, m, following[m], displacement)  # eq. 3: since the previous step
            f_n, f_t = -k * g_n, 0.0
            energy[pair] += 0.5 * k * g_n * g_n
            count[pair] += 1.0
            if len(tangential) > 0:
                carried = carried_force(s, body[m], segment, body, old_master, old_tangential)
                f_t, lost, kept = return_to_cone(carried - k_t * g_t, friction[pair] * f_n, k_t)
                tangential[s, j] = f_t
                frictional_work[pair] += lost
                energy[pair] += kept
            elif friction[pair] > 0.0:
                f_t = -k_t * g_t
                frictional_work[pair] += k_t * g_t * g_t
            scale = dt if body[s] == pair_first[pair] else -dt
            add_forces(f_n, f_t, s, m, following, rows, force, impulse[pair], scale)


class Hamad2017Options(SurfaceOptions):
    """Those of springs between surfaces, with [H17]'s layer, and the reading of its friction."""

    interface_thickness: Length = Field(
        0.001, ge=0, description="thickness of the surface layer that carries mass ([H17] 3.1)"
    )
    friction_law: Literal["coulomb", "literal"] = Field(
        "coulomb",
        description="coulomb: g_t of the steps add up, |f_t| <= mu f_n; literal: g_t of one step, which ignores mu's value",
    )


class Hamad2017(SurfaceSprings):
    """One body of a pair is master; its segments repel every node that they find behind them (eq. 10), by eq. 7-11."""

    name = "hamad2017"
    Options = Hamad2017Options
    options: Hamad2017Options
    every_segment = True

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.scratch = np.zeros((4, 3, 2))

    @property
    def keeps_friction(self) -> bool:
        """Whether tangential gaps add up."""
        return self.options.friction_law == "coulomb"

    def unused(self, pairs: Sequence[Pair]) -> list[str]:
        """The value of μ under literal friction."""
        frictional = [pair.label for pair in pairs if pair.friction > 0.0]
        if self.keeps_friction or not frictional:
            return []
        return [
            f"value of friction of {', '.join(frictional)}: contact 'hamad2017' with friction_law = 'literal' ignores it"
        ]

    @hookimpl
    def concerns(self) -> list[str]:
        """The same, for the results."""
        return self.unused(self.state.pairs)

    def _forces(self, dt: float) -> None:
        """Eq. 9 on surface nodes and segment ends."""
        c, s, r, laws = self.candidates, self.surface, self.records, self.laws
        self.force.fill(0.0)
        pair_forces(
            c.master, c.segment, c.coordinate, c.gap, c.normal, c.stiffness,
            c.old_master, c.tangential, c.old_tangential,
            s.body, s.position, s.displacement, s.next,
            laws.pair_of, laws.first, laws.friction, self.options.tangential_ratio, dt,
            self.scratch, self.force, r.impulse, r.frictional_work, r.energy, r.count,
        )  # fmt: skip
