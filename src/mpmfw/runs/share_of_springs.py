"""Part of a given displacement that contact springs take: of driven sides, or of an overlap at the start."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.state.fields import FloatArray

if TYPE_CHECKING:
    from mpmfw.runs.simulation import Simulation


def driven_speed(simulation: Simulation) -> FloatArray:
    """Largest speed of driven sides along each axis (dim,) [m/s]; 0 where none is driven."""
    speed = np.zeros(simulation.scene.dim)
    for body in simulation.scene.bodies.values():
        for side in body.sides:
            for axis, value in enumerate(side.velocity or ()):
                speed[axis] = max(speed[axis], 0.0 if isinstance(value, str) else abs(float(value)))
    return speed


def share_of_springs(simulation: Simulation, axis: int | None) -> float:
    """Estimate the part of a given displacement that contact springs take, in series with the bodies.

    Under a unit of pressure springs give by h / (κ M), and a body by its length over M. A pair counts if its
    bodies' boxes are less than a cell apart and, with an ``axis``, lie one after the other along it. 0 where
    contact has no springs."""
    state, h = simulation.state, simulation.scene.grid.cell_size
    law: Any = getattr(simulation.contact, "law", None)
    springs = law.compliance() if hasattr(law, "compliance") else None
    if springs is None:
        return 0.0
    lower, upper = (np.array([getattr(body, end) for body in state.bodies]) for end in ("lower", "upper"))
    of_springs, loaded = 0.0, set()
    for pair, compliance in zip(state.pairs, springs, strict=True):
        both = [pair.first, pair.second]
        gap = lower[both].max(0) - upper[both].min(0)  # negative where boxes overlap
        if gap.max() < h and (axis is None or gap[axis] > -h):
            of_springs += float(compliance)
            loaded |= set(both)
    length = np.ptp(np.stack([lower, upper]), axis=0)
    along = length.min(1) if axis is None else length[:, axis]
    of_bodies = sum(along[b] / state.bodies[b].p_wave_modulus for b in loaded)
    return of_springs / (of_springs + of_bodies) if loaded else 0.0
