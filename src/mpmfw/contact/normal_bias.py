"""Bias of normals at shared nodes to one side, which slows sliding down."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from mpmfw.kernels import Struct, kernel, scratch
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.types import Floats
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import Field, FloatArray
from mpmfw.state.structs import Pair, State

#: Bias, as a coefficient of friction, from which a reader is warned: symmetric impacts and rolling by
#: ``criterion = "position"`` have at most 0.02, blocks and discs that slide in 0.05 to 0.3.
LARGEST = 0.05


class BiasSums(Struct):
    """Sums of every pair."""

    total: Floats  #: (pair,) Σ J_n [N s/m]
    lean: Floats  #: (pair,) Σ J_n (n_a + n_b) / 2 along the tangential force


@kernel
def add_bias(
    rows: Rows, count: int, scale: float, gradient: Floats, sums: BiasSums, spacing: tuple[float, ...]
) -> None:
    """Add J_n of every shared node, and J_n (n_a + n_b) / 2 along the pair's tangential force of the step.

    n_a and n_b are the bodies' outward normals: their sum is 0 where faces meet. The tangential force is
    perpendicular to Σ (g_b − g_a). The impulse on body a is ``scale`` times the row's force."""
    dim, c = len(spacing), 0
    face, force, lean = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    while c < count:
        p = rows.pair[c]
        face[:], force[:], lean[:] = 0.0, 0.0, 0.0
        while c < count and rows.pair[c] == p:
            i, j, normal_impulse, square_a, square_b = rows.dof[2 * c], rows.dof[2 * c + 1], 0.0, 0.0, 0.0
            for d in range(dim):
                normal_impulse += scale * rows.force[c, d] * rows.normal[c, d]
                force[d] += scale * rows.force[c, d]
                face[d] += gradient[j, d] - gradient[i, d]
                square_a += gradient[i, d] ** 2
                square_b += gradient[j, d] ** 2
            if normal_impulse > 0.0 and square_a > 0.0 and square_b > 0.0:
                sums.total[p] += normal_impulse
                for d in range(dim):
                    mean = gradient[i, d] / math.sqrt(square_a) + gradient[j, d] / math.sqrt(square_b)
                    lean[d] += 0.5 * normal_impulse * mean
            c += 1
        square, along, tangential, product = 0.0, 0.0, 0.0, 0.0
        for d in range(dim):
            square += face[d] ** 2
            along += face[d] * force[d]
        for d in range(dim):
            across = force[d] - (along * face[d] / square if square > 0.0 else 0.0)
            tangential += across**2
            product += lean[d] * across
        if tangential > 0.0:
            sums.lean[p] += product / math.sqrt(tangential)


#: Declarations of the members of :class:`BiasSums`.
_DECLARED = {
    "total": Field("normal_impulse", ("pair",), "N s m-1", "sum of the normal impulses' sizes", "contact"),
    "lean": Field("lean", ("pair",), "N s m-1", "bias of the normals along the tangential force", "contact"),
}


class NormalBias:
    """Bias of the normals of a contact, called ``owner``, over a run.

    At the edge of a contact the bodies' own normals disagree: at the front corner of a sliding block its
    normal, and any mean with it, leans ahead. Sliding then counts as approach, and impulses slow the body
    down and throw it up. Normals that lean ahead and behind by the same amount cancel.
    """

    def __init__(self, setup: Setup, owner: str) -> None:
        self.owner = owner
        self.sums = BiasSums(**{name: setup.allocate(owner, field) for name, field in _DECLARED.items()})

    def add_pairs(self, state: State) -> None:
        """Add zeros for new pairs of bodies."""
        for name, field in _DECLARED.items():
            self.sums.set(**{name: state.lengthen(f"{self.owner}/{field.name}", len(state.pairs))})

    def add(
        self, rows: Rows, count: int, scale: float, gradient: FloatArray, spacing: tuple[float, ...]
    ) -> None:
        """Add the sums of ``count`` rows, with impulses of ``scale`` times their forces."""
        add_bias(rows, count, scale, gradient, self.sums, spacing)

    def restart(self) -> None:
        for array in self.sums.members().values():
            array.fill(0.0)

    def sideways(self) -> FloatArray:
        """Return the bias (pair,) as a coefficient of friction: its sum over that of the normal impulses."""
        return np.asarray(np.abs(self.sums.lean) / np.where(self.sums.total > 0.0, self.sums.total, 1.0))

    def remarks(self, pairs: Sequence[Pair], advice: str) -> list[str]:
        """Return a warning, with ``advice``, for every pair beyond :data:`LARGEST`."""
        return [
            f"{pair.label}: normals lean to one side by {lean:.2g} of the normal impulse, at "
            f"corners and ahead of round bodies: this holds sliding back as friction of {lean:.2g} does, and "
            f"throws up a body that slides in; try {advice}"
            for pair, lean in zip(pairs, self.sideways(), strict=True)
            if lean > LARGEST
        ]
