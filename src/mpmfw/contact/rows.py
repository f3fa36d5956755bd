"""Rows: the places where two bodies may touch, whichever way they were found."""

from __future__ import annotations

import numpy as np

from mpmfw.fields import AnyArray, FloatArray, IntArray
from mpmfw.kernels.contact import add_row_forces, couplings, match_rows, relative_motion, relative_velocity
from mpmfw.state import Grid

#: Arrays of every row: name, further dimensions, type.
_ROW = (
    ("pair", 0, "i8"),
    ("identity", 0, "i8"),
    ("before", 0, "i8"),
    ("sign", 0, "f8"),
    ("gap", 0, "f8"),
    ("area", 0, "f8"),
    ("whole", 0, "f8"),
    ("normal", 1, "f8"),
    ("motion", 1, "f8"),
    ("force", 1, "f8"),
)


class ContactRows:
    """The rows of one step. Arrays have room for more than ``count`` rows, the first ``count`` are meant.

    A row has two sides. B v is the velocity of its first side as seen from its second, ``normal`` points from the second to the
    first: along it the gap grows, and the force on the first side pushes apart. Rows ascend by ``identity``; those of one
    identity are one place that meets two facets alike.

    Parameters
    ----------
    dim
        Number of space dimensions.
    couples, tilts
        Whether a tangential force acts with a couple across the gap, and whether the normal is varied with the facet.
    own
        Arrays of the law, by name: the number of their further dimensions, each ``dim`` long. They are the history of the
        next step, which finds them by :attr:`before`.
    """

    count: int
    pair: IntArray  #: (n,) index of the pair
    identity: IntArray  #: (n,) which place against which body: the key of the row's history
    before: IntArray  #: (n,) first row of the last step with this identity; −1 without one
    sign: FloatArray  #: (n,) 1 where the first side is the pair's first body, else −1
    gap: FloatArray  #: (n,) signed, negative where the bodies overlap [m]; 0 where none is measured
    area: FloatArray  #: (n,) tributary area across the normal [m^(dim−1)]
    whole: FloatArray  #: (n,) tributary area of the place, whatever its direction [m^(dim−1)]
    normal: FloatArray  #: (n, dim) unit vector
    motion: FloatArray  #: (n, dim) B v Δt over the last step [m]
    force: FloatArray  #: (n, dim) on the first side, the law's [N m^(dim−3)]; an impulse law's impulse
    start: IntArray  #: (n + 1,) entries of row c are ``start[c]:start[c + 1]``
    dof: IntArray  #: (m,) flat grid node
    weight: FloatArray  #: (m,) weight in B; the sum over a row is 0
    couple: FloatArray  #: (m, dim) vector c in the tangent plane: a force f acts along the normal by c·f; (0, dim) without
    tilt: FloatArray  #: (m, dim) by which a normal force of 1 acts along the facet; (0, dim) without

    def __init__(
        self, dim: int, *, couples: bool, tilts: bool = False, own: dict[str, int] | None = None
    ) -> None:
        self.dim, self.count = dim, 0
        self.own: dict[str, AnyArray] = {}
        self._own = own or {}
        self._couples, self._tilts = couples, tilts
        self.make_room(64, 1024)

    def make_room(self, rows: int, entries: int) -> None:
        """Arrays for so many ``rows`` and ``entries``; what was in them is lost."""
        for name, more, kind in _ROW:
            setattr(self, name, np.zeros((rows, *(self.dim,) * more), dtype=kind))
        self.own = {name: np.zeros((rows, *(self.dim,) * more)) for name, more in self._own.items()}
        self.start = np.zeros(rows + 1, dtype=np.int64)
        self.dof, self.weight = np.zeros(entries, dtype=np.int64), np.zeros(entries)
        self.couple = np.zeros((entries if self._couples else 0, self.dim))
        self.tilt = np.zeros((entries if self._tilts else 0, self.dim))

    def arrays(self) -> dict[str, AnyArray]:
        """All arrays with room for anything, by name."""
        names = [*(name for name, _, _ in _ROW), "start", "dof", "weight", "couple", "tilt"]
        return {name: getattr(self, name) for name in names if len(getattr(self, name))} | self.own

    def match(self, old: ContactRows) -> None:
        """Fill :attr:`before` with the rows of the last step, ``old``."""
        match_rows(0, self.count, self.identity, old.count, old.identity, self.before)

    def velocity(
        self, node_velocity: FloatArray, scale: float, out: FloatArray, spacing: tuple[float, ...]
    ) -> None:
        """``scale`` B v, into ``out`` (n, dim) [m/s] times the scale.

        ``node_velocity`` is (n_nodes, dim) [m/s], ``spacing`` the cell size h, once for each dimension.
        """
        relative_motion(
            0, self.count, self.start, self.dof, self.weight, self.couple, self.normal, node_velocity, scale, out, spacing
        )  # fmt: skip

    def momentary_velocity(self, grid: Grid, out: FloatArray) -> None:
        """B v of the grid's present momentum, into ``out`` (n, dim) [m/s]."""
        relative_velocity(
            0, self.count, self.start, self.dof, self.weight, self.couple, self.normal,
            grid.mass, grid.momentum, out, grid.spacing,
        )  # fmt: skip

    def add_to(self, nodal: FloatArray, spacing: tuple[float, ...]) -> None:
        """Bᵀ f of :attr:`force`, added to ``nodal``: the grid's forces, or its momenta where it is an impulse (n_nodes, dim).

        ``spacing`` is the cell size h [m], once for each dimension.
        """
        add_row_forces(
            0, self.count, self.start, self.dof, self.weight, self.couple, self.tilt, self.normal, self.force, nodal, spacing
        )  # fmt: skip

    def couplings(self, stiffness: FloatArray, grid: Grid, scratch: FloatArray, out: FloatArray) -> float:
        """Row sums of |B| M⁻¹ |B|ᵀ K into ``out`` (n,), and the largest of them.

        ``stiffness`` K is (n,) [N/m^2] in 2D; ``scratch`` (n_nodes,) is zero on entry and on return.
        """
        bound: float = couplings(
            0, self.count, self.start, self.dof, self.weight, stiffness, grid.mass, scratch, out
        )
        return bound
