"""One row of unknowns for each possible contact: its geometry, its entries on the grid, and its impulse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.api import FloatArray, IntArray

_FLOATS = (
    "coordinate",
    "gap",
    "end_coordinate",
    "end_gap",
    "compliance_n",
    "compliance_t",
    "target",
    "friction",
)


@dataclass
class Contacts:
    """Rows as :class:`~mpmfw_surface_impulse.neighbours.Neighbours` found them; those without contact have segment −1."""

    key: IntArray  #: (n_rows,) what identifies a row from search to search, ascending
    node: IntArray  #: (n_rows,) slave node s
    pair: IntArray  #: (n_rows,)
    sign: FloatArray  #: (n_rows,) 1 where the slave is the pair's first body, else −1
    segment: IntArray  #: (n_rows,) first node of the segment; −1 if none
    coordinate: FloatArray  #: (n_rows,) ξ
    gap: FloatArray  #: (n_rows,) g at the start of the step [m]
    normal: FloatArray  #: (n_rows, 2) n
    end_segment: IntArray  #: (n_rows,) the same at the end of the step without contact
    end_coordinate: FloatArray
    end_gap: FloatArray
    end_normal: FloatArray
    compliance_n: (
        FloatArray  #: (n_rows,) W_n: change of the normal relative velocity by a unit impulse [1/kg m]
    )
    compliance_t: FloatArray  #: (n_rows,) W_t
    target: FloatArray  #: (n_rows,) b: the normal relative velocity may be −b at least [m/s]
    friction: FloatArray  #: (n_rows,) μ
    impulse: FloatArray  #: (n_rows, 2) λ_n, λ_t [N s/m]
    start: IntArray  #: (n_rows + 1,) entries of row r are start[r]:start[r + 1]
    grid_node: IntArray  #: (n_entries,)
    share: FloatArray  #: (n_entries,) a_i
    couple: FloatArray  #: (n_entries,) b_i

    @classmethod
    def of(
        cls, key: IntArray, node: IntArray, pair: IntArray, sign: FloatArray, friction: FloatArray
    ) -> Contacts:
        """Rows without contact and without impulse."""
        n = len(node)
        floats = {name: np.zeros(n) for name in _FLOATS}
        floats["friction"] = friction
        none = np.full(n, -1, dtype=np.int64)
        return cls(
            key=key,
            node=node,
            pair=pair,
            sign=sign,
            segment=none,
            end_segment=none.copy(),
            normal=np.zeros((n, 2)),
            end_normal=np.zeros((n, 2)),
            impulse=np.zeros((n, 2)),
            start=np.zeros(n + 1, dtype=np.int64),
            grid_node=np.zeros(0, dtype=np.int64),
            share=np.zeros(0),
            couple=np.zeros(0),
            **floats,
        )

    def __len__(self) -> int:
        return len(self.node)

    def take_impulses(self, old: Contacts) -> None:
        """Rows that ``old`` has as well start from its impulses."""
        if len(old) and len(self):
            at = np.minimum(np.searchsorted(old.key, self.key), len(old) - 1)
            self.impulse[:] = np.where((old.key[at] == self.key)[:, None], old.impulse[at], 0.0)

    def make_room(self, entries: int) -> None:
        """Room for so many entries."""
        if len(self.grid_node) < entries:
            self.grid_node = np.zeros(entries, dtype=np.int64)
            self.share, self.couple = np.zeros(entries), np.zeros(entries)
