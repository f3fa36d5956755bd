"""Contact of a body with itself: where two parts of its surface face each other, each has separate nodes.

The window of such a body has every node twice. A node near two parts takes the points and surface nodes of
the nearer part; its second takes those of the other. Mass, forces and velocities of the parts are then those
of two bodies, and contact acts between them. Nodal values have no history: every step divides anew."""

from __future__ import annotations

import math

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.contact.surfaces.one_part import (
    OnePart,
    are_joined,
    dots,
    joined_nodes,
    mark_apart,
    one_part_of,
    remove_joined,
)
from mpmfw.contact.surfaces.outline import distance_to
from mpmfw.errors import SceneError
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.sides import node_normals
from mpmfw.kernels.stencil import entries, read_window
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Table
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import FloatArray, IntArray
from mpmfw.state.structs import Body, Grid, State, Stencil, Surface
from mpmfw.state.surface import closed_surface

#: Largest cosine between the normals of nodes that face each other, and of those that may soon do.
FACING, NEARLY = -0.3, -0.1

#: How far parts may overlap where nodes are divided, and where gaps are measured; and how far beyond the
#: support of a part nodes are divided, in cells.
OVERLAP, DEEPEST, BEYOND = 0.5, 1.0, 0.25

#: Length along the surface, or through the material, within which surface nodes are of one part, in reaches
#: of a part. At the root of a slit both sides hang together: with 3, a folded ring is 3 to 5 % too soft.
ROOT = 4.0

#: How far a surface node may move from the others before facing nodes are listed anew, in cells.
SKIN = 0.25


@device
def face_each_other(
    s: int, t: int, normal: Floats, position: Floats, overlap: Float, spacing: tuple[float, ...]
) -> bool:
    """Return True if each of two surface nodes is before the other, or at most ``overlap`` [m] behind."""
    mine, other, between = 0.0, 0.0, 0.0
    for d in range(len(spacing)):
        way = position[t, d] - position[s, d]
        mine += way * normal[s, d]
        other -= way * normal[t, d]
        between += normal[s, d] * normal[t, d]
    return between < FACING and mine > -overlap and other > -overlap


@kernel
def mark_nodes(
    pairs: Ints, normal: Floats, position: Floats, reach: float, grid: Nodes, field: int, ends: Ints,
    nearest: Floats, spacing: tuple[float, ...],
) -> bool:  # fmt: skip
    """Write the two nearest surface nodes that face each other to ``ends`` (n, 2), the nearer first, of every
    node of the window within ``reach`` [m] of both along each axis, else −1; return True if there is one.

    ``nearest`` (n,) is scratch."""
    dim, inverse_h, found = len(spacing), 1.0 / spacing[0], False
    origin, shape = scratch.vector(spacing), scratch.integers(spacing)
    low, extent, index = scratch.integers(spacing), scratch.integers(spacing), scratch.integers(spacing)
    read_window(grid, field, origin, shape, spacing)
    ends[:] = -1
    nearest[:] = math.inf
    for c in range(len(pairs)):
        s, t, count = pairs[c, 0], pairs[c, 1], 1
        if s > t or not face_each_other(s, t, normal, position, OVERLAP * spacing[0], spacing):
            continue
        for d in range(dim):
            upper, lower = max(position[s, d], position[t, d]), min(position[s, d], position[t, d])
            low[d] = max(math.ceil((upper - reach - origin[d]) * inverse_h), 0)
            extent[d] = min(math.floor((lower + reach - origin[d]) * inverse_h), shape[d] - 1) - low[d] + 1
            count *= max(extent[d], 0)
        for rest in range(count):
            i, mine, other = 0, 0.0, 0.0
            for d in range(dim):
                index[d] = low[d] + rest % extent[d]
                rest //= extent[d]
                i = i * shape[d] + index[d]
                x = origin[d] + index[d] * spacing[0]
                mine += (x - position[s, d]) ** 2
                other += (x - position[t, d]) ** 2
            if mine + other < nearest[i]:
                nearest[i], found = mine + other, True
                ends[i, 0], ends[i, 1] = (s, t) if mine <= other else (t, s)
    return found


@kernel
def divide(
    point: Floats, next_to: Ints, one_part: OnePart, surface: Floats, ends: Ints, begin: int, table: Table,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Move entries of points at marked nodes to the second nodes, of points of the part of the second of the
    node's ``ends``.

    A point is of the part of the surface node ``next_to`` it (n,). Where this is of one part with both ends,
    at the root of a slit, the point stays; where it is with none, the end decides that is nearer in the
    reference state, with the places ``point`` (n, dim) and ``surface`` (n_s, dim) [m]. Node ``begin`` is the
    window's first."""
    for p in range(len(point)):
        for k in entries(table.row, p):
            i = table.nodes[k] - begin
            s, t = ends[i, 0], ends[i, 1]
            if s < 0:
                continue
            of_first, of_second = are_joined(next_to[p], s, one_part), are_joined(next_to[p], t, one_part)
            nearer = 0.0
            for d in range(len(spacing)):
                nearer += (point[p, d] - surface[s, d]) ** 2 - (point[p, d] - surface[t, d]) ** 2
            if not of_first and (of_second or nearer > 0.0):
                table.nodes[k] += len(ends)


@device
def gap_of(s: int, m: int, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Return the signed distance of node s from the locally nearest facet [m], on a way from facet m on which
    the node is inside."""
    share, direction, nearer = scratch.vector(spacing), scratch.vector(spacing), m
    gap = distance_to(s, m, outline, share, direction, spacing)
    while nearer >= 0 and gap < 0.0:
        m, nearer = nearer, -1
        for a in range(len(spacing)):
            t = outline.facets[m, a]
            for k in range(outline.star_first[t], outline.star_first[t + 1]):
                distance = distance_to(s, outline.star[k], outline, share, direction, spacing)
                if abs(distance) < abs(gap):
                    gap, nearer = distance, outline.star[k]
    return gap


@kernel
def least_gap(
    pairs: Ints, outline: Surface, normal: Floats, most: float, spacing: tuple[float, ...]
) -> float:
    """Return the least signed distance of nodes from the part that they face, at most ``most`` [m]; the first
    nodes of ``pairs`` ascend."""
    share, direction = scratch.vector(spacing), scratch.vector(spacing)
    least, gap, facet = most, most, -1
    for c in range(len(pairs)):
        s, t = pairs[c, 0], pairs[c, 1]
        if c > 0 and pairs[c - 1, 0] != s:
            least = min(least, gap_of(pairs[c - 1, 0], facet, outline, spacing) if facet >= 0 else most)
            gap, facet = most, -1
        if not face_each_other(s, t, normal, outline.position, DEEPEST * spacing[0], spacing):
            continue
        for k in range(outline.star_first[t], outline.star_first[t + 1]):
            distance = distance_to(s, outline.star[k], outline, share, direction, spacing)
            if abs(distance) < abs(gap):
                gap, facet = distance, outline.star[k]
    return min(least, gap_of(pairs[-1, 0], facet, outline, spacing)) if facet >= 0 else least


class Facing:
    """Surface nodes of one body that may face each other, and the surface node next to each of its points."""

    def __init__(self, body: Body, state: State, normal: FloatArray, reach: float) -> None:
        surface = state.tracked_surface
        self.body, self.reach, self.own = body, reach, surface.of(body.index)
        self.points = state.particles.position[body.particles].copy()  #: in the reference state
        self.reference = surface.position.copy()
        facets = surface.facets[surface.facets_of(body.index)]
        self.joined = joined_nodes(surface, self.own, facets, normal, ROOT * reach)
        self.one_part = one_part_of(self.joined)
        self.next_to = self.own.start + cKDTree(self.reference[self.own]).query(self.points)[1]
        self.frame = -1

    def list_pairs(self, position: FloatArray, normal: FloatArray, skin: float) -> None:
        """List nodes of two parts that are near each other, both ways."""
        tree = cKDTree(position[self.own])
        pairs = self.own.start + tree.query_pairs(2.0 * self.reach + skin, p=np.inf, output_type="ndarray")
        pairs = pairs[dots(normal[pairs[:, 0]], normal[pairs[:, 1]]) < NEARLY]
        apart = np.zeros(len(pairs), dtype=bool)
        mark_apart(np.ascontiguousarray(pairs), self.one_part, apart)
        pairs = pairs[apart]
        pairs = np.concatenate([pairs, pairs[:, ::-1]])
        self.pairs = np.ascontiguousarray(pairs[np.lexsort(pairs.T[::-1])])

    def divide(self, phi: Stencil, surface: Surface, normal: FloatArray, grid: Grid) -> bool:
        """Divide the nodes between the parts, in the tables of points and surface nodes; return True if there
        are any."""
        if not len(self.pairs):
            return False
        nodes = grid.field_nodes(self.body.field)
        if self.frame != grid.frame:
            self.frame, count = grid.frame, (nodes.stop - nodes.start) // 2
            self.ends, self.nearest = np.zeros((count, 2), dtype=np.int64), np.zeros(count)
        if not mark_nodes(
            self.pairs, normal, surface.position, self.reach, grid, self.body.field, self.ends, self.nearest,
            grid.spacing,
        ):  # fmt: skip
            return False
        own, points = self.own, self.body.particles
        ends = (self.one_part, self.reference, self.ends, nodes.start)
        part = phi.part(points.start, points.stop)
        divide(self.points, self.next_to, *ends, part, grid.spacing)
        part, itself = surface.table.part(own.start, own.stop), np.arange(own.start, own.stop)
        divide(self.reference[own], itself, *ends, part, grid.spacing)
        return True


class SelfContact:
    """Nodes of bodies with ``self_contact``, and what is near what on their surfaces."""

    name = "self_contact"
    history = ("listed_at",)

    def __init__(self, setup: Setup, bodies: list[Body]) -> None:
        self.state, self.skin = setup.state, SKIN * setup.cell_size
        surface, grid = setup.state.tracked_surface, setup.state.grid
        grid.sheets = np.ones(grid.n_fields, dtype=np.int64)
        grid.sheets[[body.field for body in bodies]] = 2
        reach = (0.5 * (setup.shape_function.boundary_degree + 1) + BEYOND) * setup.cell_size
        self.normal = np.zeros_like(surface.position)
        node_normals(surface, self.normal, grid.spacing)
        self.parts = [Facing(body, setup.state, self.normal, reach) for body in bodies]
        self.one_part = one_part_of(csr_array(sum(part.joined for part in self.parts)))
        self.listed_at = surface.position.copy()  #: (n_s, dim) [m]
        self._list()

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Return the second nodes; raise SceneError where contact, shape or an option do not go with them."""
        bodies = [body for body in setup.bodies if setup.scene.bodies[body.name].self_contact]
        assert setup.contact is not None
        itself = [setup.contact.between(body.name, body.name) for body in bodies]
        between = [setup.contact.between(a.name, b.name) for a in bodies for b in setup.bodies]
        found = [(getattr(each, "detection", None), each.label) for each in between]
        at_nodes = [label for each, label in found if "facets" not in getattr(each, "provides", ())]
        others = [one for one in itself if not getattr(getattr(one, "detection", 0), "finds_own", False)]
        if others:
            problem = f"contact '{others[0].label}' finds other bodies alone; expected penalty or lcp"
        elif at_nodes:
            problem = f"contact '{at_nodes[0]}' would miss its second nodes; expected contact on surfaces"
        elif not setup.shape_function.divisible:
            problem = f"shape '{setup.shape}' has nodes that cannot be divided; expected cpdi or gimp"
        elif any(body.name in {each.name for each in setup.averaged_bodies} for body in bodies):
            problem = "averages of cells would join its parts; expected volumetric = 'pointwise'"
        else:
            setup.state.self_contact = made = cls(setup, bodies)
            return Acts(", ".join(body.name for body in bodies), [made])
        raise SceneError(problem, key=f"bodies.{bodies[0].name}.self_contact")

    def _list(self) -> None:
        for part in self.parts:
            part.list_pairs(self.listed_at, self.normal, self.skin)

    def restored(self) -> None:
        """List facing nodes as they were listed last."""
        surface = self.state.tracked_surface
        now = surface.position.copy()
        surface.position[:] = self.listed_at
        node_normals(surface, self.normal, self.state.grid.spacing)
        self._list()
        surface.position[:] = now

    def divide(self, phi: Stencil, grid: Grid) -> Stencil:
        """Divide nodes between the parts of every body, in filled tables; return that of points."""
        surface, divided = self.state.tracked_surface, False
        node_normals(surface, self.normal, grid.spacing)
        for part in self.parts:
            moved = surface.position[part.own] - self.listed_at[part.own]
            if np.abs(moved - moved.mean(axis=0)).max() > 0.5 * self.skin:
                self.listed_at[part.own] = surface.position[part.own]
                part.list_pairs(surface.position, self.normal, self.skin)
            divided = part.divide(phi, surface, self.normal, grid) or divided
        return phi.replace() if divided and phi.factors is not None else phi  # nodes are no products then

    def remove_joined(self, near: NearFacets) -> None:
        """Remove facets that are of one part with the node that they are near."""
        surface = self.state.tracked_surface
        remove_joined(near, surface, self.one_part, np.zeros(surface.count, dtype=np.int64))

    def gaps(self, pairs: IntArray) -> FloatArray:
        """Return the least gap [m] of each of the ``pairs`` (n, 2), infinite for two bodies; of a body with
        itself at most the distance within which nodes are divided."""
        surface, spacing = closed_surface(self.state.tracked_surface), self.state.grid.spacing
        gaps = np.full(len(pairs), np.inf)
        node_normals(surface, self.normal, spacing)
        for part in self.parts:
            both = (pairs == part.body.index).all(axis=1)
            gaps[both] = least_gap(part.pairs, surface, self.normal, 2.0 * part.reach, spacing)
        return gaps
