"""Rows on surfaces, and their operator B as a product: of surface nodes in rows, and of grid nodes in surface
nodes, N_i(x_s).

Written out, a row has 60 entries in space, most of them those of its neighbours. Laws of forces need none:
their forces and motions pass by the surface nodes, each of which meets the grid once.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.contact.rows import ContactRows
from mpmfw.contact.surfaces.assembly import Places, write_motion
from mpmfw.kernels import Struct, device, kernel, scratch
from mpmfw.kernels.arithmetic import add_scaled_row
from mpmfw.kernels.contact import Rows, acts
from mpmfw.kernels.facets import dot, read_point
from mpmfw.kernels.stencil import entries
from mpmfw.kernels.types import Float, Floats, Ints, Table
from mpmfw.state.fields import AnyArray, FloatArray
from mpmfw.state.structs import Grid, Surface

#: What a visited place has at least, so that it is not 0.
TINY = float(np.finfo(np.float64).tiny)


class NodeSums(Struct):
    """Scratch of surface nodes, zero between two kernels."""

    vector: Floats  #: (n_s, dim)
    number: Floats  #: (n_s,)


@device
def node_of(c: int, a: int, facets: Ints, places: Places) -> tuple[int, Float]:
    """Return surface node ``a`` of row c and its weight: the slave with 1, then the corners with −ξ."""
    if a == 0:
        return places.slave[c], 1.0
    return facets[places.facet[c], a - 1], -places.share[c, a - 1]


@kernel
def spread_forces(
    rows: Rows, count: int, facets: Ints, places: Places, sums: NodeSums, table: Table, node_force: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """f_i += Bᵀ f of all rows: f_s = f on the slave, −ξ f + (c·f) n + (f·n) t on a corner with couple c and
    tilt t, then f_i += Σ N_i(x_s) f_s."""
    dim, turn, lean = len(spacing), places.turn, places.lean
    force, normal, own = scratch.vector(spacing), scratch.vector(spacing), scratch.matrix((0.0,), spacing)
    for c in range(count):
        if not acts(c, rows):
            continue
        read_point(c, rows.force, force, spacing)
        read_point(c, rows.normal, normal, spacing)
        along = dot(force, normal, spacing)
        for a in range(dim + 1):
            (s, weight), turned = node_of(c, a, facets, places), 0.0
            if a > 0 and len(turn) > 0:
                turned = dot(turn[c, a - 1], force, spacing)
            for d in range(dim):
                sums.vector[s, d] += weight * force[d] + turned * normal[d]
                if a > 0 and len(lean) > 0:
                    sums.vector[s, d] += along * lean[c, a - 1, d]
    for c in range(count):
        for a in range(dim + 1):
            s, _ = node_of(c, a, facets, places)
            for d in range(dim):
                own[0, d], sums.vector[s, d] = sums.vector[s, d], 0.0
            if dot(own[0], own[0], spacing) != 0.0:  # NaN must not be lost
                for k in entries(table.row, s):
                    add_scaled_row(node_force, table.nodes[k], table.weight[k], own, 0, spacing)


@kernel
def move_rows(
    rows: Rows, count: int, facets: Ints, places: Places, sums: NodeSums, table: Table, velocity: Floats,
    scale: float, out: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """``scale`` B v of every row, into ``out`` (n, dim), by ``scale`` v_s = ``scale`` Σ N_i(x_s) v_i."""
    dim, own = len(spacing), scratch.matrix((0.0,), spacing)
    for c in range(count):
        for a in range(dim + 1):
            s, _ = node_of(c, a, facets, places)
            if sums.number[s] == 0.0:
                for d in range(dim):
                    own[0, d] = 0.0
                for k in entries(table.row, s):
                    add_scaled_row(own, 0, table.weight[k], velocity, table.nodes[k], spacing)
                for d in range(dim):
                    sums.vector[s, d] = scale * own[0, d]
                sums.number[s] = 1.0
        write_motion(c, sums.vector, facets, rows, places, out, spacing)
    for c in range(count):
        for a in range(dim + 1):
            s, _ = node_of(c, a, facets, places)
            sums.number[s] = 0.0
            for d in range(dim):
                sums.vector[s, d] = 0.0


@kernel
def bound_couplings(
    count: int, facets: Ints, places: Places, sums: NodeSums, table: Table, stiffness: Floats,
    node_mass: Floats, node_sum: Floats, out: Floats,
) -> float:  # fmt: skip
    """Row sums of :func:`mpmfw.kernels.contact.couplings` with |b_ci| = Σ_s |b_cs| N_i(x_s), the same where
    the sides of a row share no grid node; and the largest."""
    sides, load = places.share.shape[1] + 1, sums.number
    for c in range(count):
        for a in range(sides):
            s, weight = node_of(c, a, facets, places)
            load[s] += stiffness[c] * abs(weight)
    for c in range(count):
        for a in range(sides):
            s, _ = node_of(c, a, facets, places)
            own = load[s]
            if own != 0.0:
                for k in entries(table.row, s):
                    node_sum[table.nodes[k]] += own * abs(table.weight[k])
                load[s] = 0.0
    largest = 0.0
    for c in range(count):
        out[c] = 0.0
        for a in range(sides):
            s, weight = node_of(c, a, facets, places)
            if load[s] == 0.0:
                total = TINY
                for k in entries(table.row, s):
                    i = table.nodes[k]
                    if node_mass[i] > 0.0:
                        total += abs(table.weight[k]) * node_sum[i] / node_mass[i]
                load[s] = total
            out[c] += abs(weight) * load[s]
        largest = max(largest, out[c])
    for c in range(count):
        for a in range(sides):
            s, _ = node_of(c, a, facets, places)
            if load[s] != 0.0:
                for k in entries(table.row, s):
                    node_sum[table.nodes[k]] = 0.0
                load[s] = 0.0
    return largest


class SurfaceRows(ContactRows):
    """Rows with their places on the surfaces."""

    places: Places
    n_bodies: int  #: identity is that of the node times this and the other body's index
    surface: Surface | None = None  #: by which forces and motions pass; None where B has entries

    def use_factors(self, surface: Surface) -> None:
        """Let forces and motions pass by the nodes of ``surface``; entries of B are NaN, one a row, so that
        what reads them nevertheless cannot go on."""
        self.surface = surface
        self.weight[:] = np.nan
        self.sums = NodeSums(vector=np.zeros_like(surface.position), number=np.zeros(surface.count))

    def motion_of(
        self, velocity: FloatArray, scale: float, out: FloatArray, spacing: tuple[float, ...]
    ) -> None:
        on = self.surface
        if on is None:
            super().motion_of(velocity, scale, out, spacing)
        else:
            move_rows(
                self, self.count, on.facets, self.places, self.sums, on.table, velocity, scale, out, spacing
            )

    def add_to(self, nodal: FloatArray, spacing: tuple[float, ...]) -> None:
        on = self.surface
        if on is None:
            super().add_to(nodal, spacing)
        else:
            spread_forces(self, self.count, on.facets, self.places, self.sums, on.table, nodal, spacing)

    def couplings(self, stiffness: FloatArray, grid: Grid, out: FloatArray) -> float:
        on = self.surface
        if on is None:
            return super().couplings(stiffness, grid, out)
        return bound_couplings(
            self.count, on.facets, self.places, self.sums, on.table, stiffness, grid.mass,
            self.sum_of(grid), out,
        )  # fmt: skip

    def make_room(self, rows: int, entries: int) -> None:
        super().make_room(rows, entries)
        dim = self.dim
        if self.surface is not None:
            self.weight[:] = np.nan
        self.places = Places(
            slave=np.zeros(rows, dtype=np.int64),
            facet=np.zeros(rows, dtype=np.int64),
            share=np.zeros((rows, dim)),
            turn=np.zeros((rows if len(self.couple) else 0, dim, dim)),
            lean=np.zeros((rows if len(self.tilt) else 0, dim, dim)),
        )

    def of_rows(self) -> dict[str, AnyArray]:
        """Return those, and the places as ``at/NAME``."""
        return super().of_rows() | {f"at/{name}": array for name, array in self.places.members().items()}

    def renumber(self, history: dict[str, AnyArray], own: ContactRows, index_map: Any) -> None:
        """Renumber nodes, facets, and the identity that is made of node and body, too."""
        super().renumber(history, own, index_map)
        assert isinstance(own, SurfaceRows)
        node, body = np.divmod(history["identity"], self.n_bodies)
        history["identity"] = index_map.surface_node[node] * own.n_bodies + index_map.body[body]
        history["at/slave"] = index_map.surface_node[history["at/slave"]]
        history["at/facet"] = index_map.facet[history["at/facet"]]
