"""Rows of grid nodes against rigid bodies: distance and normal are those of the rigid surface itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from mpmfw.contact.rows import ContactRows
from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.facets import read_point
from mpmfw.kernels.surfaces import BLOCK, block_boxes, closest_facet, signed_distance
from mpmfw.kernels.types import Faceted, Floats
from mpmfw.state.fields import FloatArray, IntArray
from mpmfw.state.structs import Grid, Pair, State
from mpmfw.state.surface import outer_facets

#: Distance from a rigid surface up to which nodes touch [cells]: of a node a cell away a body at the surface
#: has next to nothing.
NEAR = 1.0 - 1e-6


@kernel
def measure_distances(
    points: Floats, first: int, last: int, surface: Faceted, distance: Floats, normal: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Signed distance of ``points`` (n, dim) from the closed surface of the facets ``first:last``, into
    ``distance`` (n,), and its outward normal there, into ``normal`` (n, dim)."""
    boxes = np.empty(((last - first) // BLOCK + 1, 2, len(spacing)))
    block_boxes(first, last, 0, surface, boxes, spacing)
    x, share, n = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    closest = first
    for p in range(len(points)):
        read_point(p, points, x, spacing)
        closest = closest_facet(x, math.inf, closest, first, last, 0, surface, boxes, spacing)
        distance[p] = signed_distance(x, closest, surface, share, n, spacing)
        for d in range(len(spacing)):
            normal[p, d] = n[d]


class NearRigid:
    """Nodes of one body that deforms which lie within a cell of a rigid body's surface."""

    def __init__(self, pair: Pair, body: int, facets: slice, nodes: IntArray) -> None:
        self.pair, self.body, self.facets, self.nodes = pair, body, facets, nodes


class RigidSurfaces:
    """The rigid bodies of a scene as contact at grid nodes takes them."""

    def __init__(self, state: State) -> None:
        self.state, self.surface = state, state.tracked_surface
        outer = outer_facets(self.surface, state.grid)
        #: outer facets of all bodies, as ranges without a gap
        self.ranges = np.split(outer, np.flatnonzero(np.diff(outer) > 1) + 1)

    def measure(self, points: FloatArray, facets: slice) -> tuple[FloatArray, FloatArray]:
        """Return distance (n,) [m] and normal (n, dim) of points (n, dim) from a body's surface."""
        distance, normal = np.full(len(points), np.inf), np.empty_like(points)
        for each in self.ranges:
            first, last = max(facets.start, each[0]), min(facets.stop, each[-1] + 1)
            if first < last:
                d, n = np.empty(len(points)), np.empty_like(points)
                measure_distances(points, first, last, self.surface, d, n, self.state.grid.spacing)
                nearer = np.abs(d) < np.abs(distance)
                distance[nearer], normal[nearer] = d[nearer], n[nearer]
        if self.state.grid.axisymmetric:  # on the axis both halves meet
            self.state.grid.turn_to_axis(points, normal)
        return distance, normal

    def find(self, grid: Grid, least_mass: float, acts_on: Callable[[Pair], bool] | None) -> list[NearRigid]:
        """Return the nodes with more mass than ``least_mass`` that are near rigid bodies, by pair that
        ``acts_on`` selects."""
        found, reach, surface = [], NEAR * grid.cell_size, self.surface
        first_rigid = len(self.state.soft_bodies)
        for pair in self.state.pairs:
            if (
                pair.first >= first_rigid
                or pair.second < first_rigid
                or not (acts_on is None or acts_on(pair))
            ):
                continue
            own = grid.field_nodes(self.state.bodies[pair.first].field)
            box, x = surface.position[surface.of(pair.second)], grid.position[own]
            within = (x > box.min(axis=0) - reach) & (x < box.max(axis=0) + reach)
            nodes = own.start + np.flatnonzero(within.all(axis=1) & (grid.mass[own] > least_mass))
            facets = surface.facets_of(pair.second)
            nodes = nodes[self.measure(grid.position[nodes], facets)[0] < reach]
            if len(nodes):
                found.append(NearRigid(pair, pair.second - first_rigid, facets, nodes))
        return found

    def write(
        self, near: NearRigid, grid: Grid, rows: ContactRows, mean: FloatArray, beyond: float, area: Any
    ) -> None:
        """Append rows; gaps are those of the nodes' ``mean`` positions (n_nodes, dim), less ``beyond`` [m].

        Without mean positions gaps are 0. ``area`` is a function of nodes (n,) and normals (n, dim).
        """
        nodes, n, c, dim = near.nodes, len(near.nodes), rows.count, grid.dim
        distance, normal = self.measure((mean if len(mean) else grid.position)[nodes], near.facets)
        weight, part = self.state.rigid.weights_at(near.body, grid.position[nodes]), slice(c, c + n)
        points = self.state.rigid.own(grid.start_velocity)[near.body]
        rows.pair[part], rows.sign[part], rows.normal[part] = near.pair.index, 1.0, normal
        field = self.state.bodies[near.pair.first].field
        at = np.unravel_index(nodes - grid.offset[field], grid.window_shape[field])
        node = np.ravel_multi_index(tuple(np.array(at) + grid.window_lower[field, :, None]), grid.nodes)
        behind = len(self.state.pairs) + near.pair.index  # behind the identities of all shared nodes
        rows.identity[part] = behind * int(np.prod(grid.nodes)) + node
        rows.gap[part] = distance - beyond if len(mean) else 0.0
        rows.area[part], rows.tributary_area[part] = area(nodes, normal), grid.cell_size ** (dim - 1)
        rows.motion[part] = self.state.dt * (grid.start_velocity[nodes] - weight @ points)
        begin, width = int(rows.start[c]), dim + 2
        rows.start[c : c + n + 1] = begin + width * np.arange(n + 1)
        entries = slice(begin, begin + width * n)
        first = len(grid.mass) - (len(self.state.rigid.bodies) - near.body) * (dim + 1)
        dofs = np.column_stack([nodes, np.broadcast_to(first + np.arange(dim + 1), (n, dim + 1))])
        rows.dof[entries] = dofs.ravel()
        rows.weight[entries] = np.column_stack([np.ones(n), -weight]).ravel()
        rows.count += n
