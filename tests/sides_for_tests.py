"""A side of a body, as the kernels of prescribed sides take it."""

from __future__ import annotations

import numpy as np

from mpmfw.effects.side_rows import PlaneSides


def upper_side(place: float, columns: int) -> PlaneSides:
    """The side y = ``place`` of a body below it, in a field of so many columns of 8 nodes, one a metre."""
    wide = np.full((1, 2), np.inf)
    return PlaneSides(
        normal=np.array([[0.0, 1.0]]),
        place=np.array([place]),
        box_lower=-wide,
        box_upper=wide,
        alone=np.array([1]),
        cell_mass=np.ones(1),
        point=np.array([0, 1]),
        shift=np.zeros(1),
        share=np.ones(1),
        column=np.array([[0, 8 * columns, 1, 8, 1]]),
        lower=np.zeros(2),
        grids=np.array([1]),
    )
