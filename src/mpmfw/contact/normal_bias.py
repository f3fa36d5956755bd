"""Bias of averaged normals to one side: the reason why contact at shared nodes holds sliding back."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np

from mpmfw.kernels import Struct, kernel
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.types import Floats
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import Field, FloatArray
from mpmfw.state.structs import Grid, State

#: Bias, as a coefficient of friction, from which a reader is warned: symmetric impacts and a cylinder that
#: rolls with ``criterion = "position"`` have at most 0.02, blocks and discs that slide in 0.05 to 0.3.
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
    normals.

    Where faces meet n_b = −n_a, and the last is nothing. Its length is J_n times the sine of the angle by
    which the mean of the two differs from either. The impulse on body a is ``scale`` times the row's force.
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


class NormalBias:
    """Follows averaged normals through a run, and warns at its end if they lean to one side.

    At the edge of a contact the two bodies' own normals disagree: the front corner of a block that slides on
    a plane points ahead, a disc sees the plane ahead of it through the wedge between them. A mean normal
    there leans ahead, sliding in counts as approach, and impulses along it brake the body and throw it up.
    Normals that lean ahead and behind alike cancel.

    Parameters
    ----------
    contact, nodes
        The contact, and its detection.
    """

    name = "leaning_normals"
    stage = "contact"
    #: Declarations of the members of :class:`BiasSums`.
    declared: ClassVar[dict[str, Field]] = {
        "total": Field(
            "normal_impulse", ("pair",), "N s m-1", "sum of the normal impulses' sizes", "contact"
        ),
        "normal": Field("mean_normal", ("pair", "axis"), "N s m-1", "sum of the normal impulses", "contact"),
        "lean": Field("lean", ("pair", "axis"), "N s m-1", "sum of J_n (n_a + n_b) / 2", "contact"),
    }

    def __init__(self, contact: Any, nodes: Any) -> None:
        self.contact, self.nodes = contact, nodes

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """Return the declarations of the sums."""
        return list(self.declared.values())

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Allocate the sums."""
        self.state = setup.state
        arrays = {name: setup.allocate(self.name, field) for name, field in self.declared.items()}
        self.sums = BiasSums(**arrays)

    @hookimpl
    def add_pairs(self, state: State) -> None:
        """Begin with zero for bodies that have come near."""
        for name, field in self.declared.items():
            self.sums.set(**{name: state.lengthen(f"{self.name}/{field.name}", len(state.pairs))})

    def restart(self) -> None:
        """Forget the settling."""
        for array in self.sums.members().values():
            array.fill(0.0)

    @hookimpl
    def after_momentum_projection(self, grid: Grid) -> None:
        """Add the impulses that corrected the projected momentum."""
        if not self.nodes.forces:
            self._add(grid, 1.0)

    @hookimpl
    def add_nodal_force(self, grid: Grid, dt: float) -> None:
        """Add the forces of a law of forces, over the step ``dt`` [s]."""
        if self.nodes.forces:
            self._add(grid, dt)

    @hookimpl
    def after_momentum_update(self, grid: Grid) -> None:
        """Add the impulses that corrected the updated momentum."""
        if not self.nodes.forces:
            self._add(grid, 1.0)

    def _add(self, grid: Grid, scale: float) -> None:
        rows = self.contact.rows
        if rows.count:
            add_bias(rows, rows.count, scale, self.nodes.gradient, self.sums, grid.spacing)

    def sideways(self) -> FloatArray:
        """Return the bias across the mean normal over all normal impulses, of every pair (pair,): a
        coefficient of friction."""
        sums = self.sums
        length = np.linalg.norm(sums.normal, axis=1, keepdims=True)
        n = sums.normal / np.where(length > 0.0, length, 1.0)
        across = sums.lean - (sums.lean * n).sum(axis=1, keepdims=True) * n
        return np.asarray(np.linalg.norm(across, axis=1) / np.where(sums.total > 0.0, sums.total, 1.0))

    @hookimpl
    def concerns(self) -> list[str]:
        """Return a warning for every pair whose normals lean by more than :data:`LARGEST`."""
        tries = ['normal = "master" or "specified" for faces']
        if not self.nodes.by_position:
            tries.append('criterion = "position" for round bodies')
        return [
            f"{pair.label}: averaged normals lean to one side by {lean:.2g} of the normal impulse, at "
            "corners and ahead of round "
            f"bodies: this holds sliding back as friction of {lean:.2g} does, and throws up a body that "
            "slides in; "
            f"try {', '.join(tries)}"
            for pair, lean in zip(self.state.pairs, self.sideways(), strict=True)
            if lean > LARGEST
        ]
