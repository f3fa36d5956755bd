"""Bias of averaged normals to one side, which holds sliding back at shared nodes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from mpmfw.kernels import Struct, kernel
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
    normal: Floats  #: (pair, dim) Σ J_n n
    lean: Floats  #: (pair, dim) Σ J_n (n_a + n_b) / 2


@kernel
def add_bias(
    rows: Rows, count: int, scale: float, gradient: Floats, sums: BiasSums, spacing: tuple[float, ...]
) -> None:
    """Add J_n, J_n n and J_n (n_a + n_b) / 2 of every shared node, n_a and n_b the two bodies' own outward
    normals: the last is 0 where faces meet. The impulse on body a is ``scale`` times the row's force.
    """
    dim = len(spacing)
    for c in range(count):
        i, j, p, normal_impulse = rows.dof[2 * c], rows.dof[2 * c + 1], rows.pair[c], 0.0
        square_a, square_b = 0.0, 0.0
        for d in range(dim):
            normal_impulse += scale * rows.force[c, d] * rows.normal[c, d]
            square_a += gradient[i, d] ** 2
            square_b += gradient[j, d] ** 2
        if normal_impulse > 0.0 and square_a > 0.0 and square_b > 0.0:
            sums.total[p] += normal_impulse
            for d in range(dim):
                both = gradient[i, d] / math.sqrt(square_a) + gradient[j, d] / math.sqrt(square_b)
                sums.normal[p, d] -= normal_impulse * rows.normal[c, d]
                sums.lean[p, d] += 0.5 * normal_impulse * both


#: Declarations of the members of :class:`BiasSums`.
_DECLARED = {
    "total": Field("normal_impulse", ("pair",), "N s m-1", "sum of the normal impulses' sizes", "contact"),
    "normal": Field("mean_normal", ("pair", "axis"), "N s m-1", "sum of the normal impulses", "contact"),
    "lean": Field("lean", ("pair", "axis"), "N s m-1", "sum of J_n (n_a + n_b) / 2", "contact"),
}


class NormalBias:
    """Bias of the averaged normals of a contact, called ``owner``, over a run.

    At the edge of a contact the bodies' own normals disagree: the front corner of a sliding block points
    ahead. A mean normal there leans ahead, sliding in counts as approach, and impulses brake the body and
    throw it up. Normals that lean ahead and behind alike cancel.
    """

    def __init__(self, setup: Setup, owner: str) -> None:
        self.owner = owner
        self.sums = BiasSums(**{name: setup.allocate(owner, field) for name, field in _DECLARED.items()})

    def add_pairs(self, state: State) -> None:
        """Begin with zero for bodies that have come near."""
        for name, field in _DECLARED.items():
            self.sums.set(**{name: state.lengthen(f"{self.owner}/{field.name}", len(state.pairs))})

    def add(
        self, rows: Rows, count: int, scale: float, gradient: FloatArray, spacing: tuple[float, ...]
    ) -> None:
        """Add what ``scale`` times the forces of ``count`` rows does, with the nodes' volume gradients."""
        add_bias(rows, count, scale, gradient, self.sums, spacing)

    def restart(self) -> None:
        for array in self.sums.members().values():
            array.fill(0.0)

    def sideways(self) -> FloatArray:
        """Return the bias across the mean normal over the normal impulses (pair,): a friction."""
        sums = self.sums
        length = np.linalg.norm(sums.normal, axis=1, keepdims=True)
        n = sums.normal / np.where(length > 0.0, length, 1.0)
        across = sums.lean - (sums.lean * n).sum(axis=1, keepdims=True) * n
        return np.asarray(np.linalg.norm(across, axis=1) / np.where(sums.total > 0.0, sums.total, 1.0))

    def remarks(self, pairs: Sequence[Pair], advice: str) -> list[str]:
        """Return a warning, with ``advice``, for every pair beyond :data:`LARGEST`."""
        return [
            f"{pair.label}: averaged normals lean to one side by {lean:.2g} of the normal impulse, at "
            f"corners and ahead of round bodies: this holds sliding back as friction of {lean:.2g} does, and "
            f"throws up a body that slides in; try {advice}"
            for pair, lean in zip(pairs, self.sideways(), strict=True)
            if lean > LARGEST
        ]
