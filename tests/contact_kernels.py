"""Outlines and arrays on which the kernels of penalty contact can be called alone."""

from dataclasses import dataclass, field

import numpy as np

from mpmfw.contact.springs import SpringArrays, add_friction
from mpmfw.contact.surfaces import search
from mpmfw.contact.surfaces.assembly import assemble
from mpmfw.contact.surfaces.near_facets import VerletList
from mpmfw.contact.surfaces.outline import Candidates
from mpmfw.contact.surfaces.surface_rows import SurfaceRows
from mpmfw.geometry.layout import neighbours_of, stars_of, tributaries_of
from mpmfw.kernels.contact import Records, match_rows
from mpmfw.kernels.contact import pair_table as pair_of_bodies
from mpmfw.kernels.surfaces import signed_distance
from mpmfw.state.structs import Surface
from mpmfw_contact.hamad2017 import find_penetrated
from mpmfw_contact.penalty import spring_forces
from support import as_table

#: Tells kernels that they work in the plane.
PLANE = (1.0, 1.0)


@dataclass
class Loops:
    """Closed polylines, one a body, with all that the kernels ask of a surface."""

    position: np.ndarray  # (n, 2)
    following: np.ndarray
    previous: np.ndarray
    body: np.ndarray
    displacement: np.ndarray = field(init=False)

    def __post_init__(self):
        self.displacement = np.zeros_like(self.position)

    @property
    def n_bodies(self):
        return int(self.body.max()) + 1

    @property
    def body_first(self):
        return np.searchsorted(self.body, np.arange(self.n_bodies + 1))

    @property
    def outline(self):
        """All that as kernels take it, with the facets and every node's tributary length."""
        facets = np.stack([np.arange(len(self.body)), self.following], axis=1)
        first, star = stars_of(facets, len(self.body))
        return Surface(
            position=self.position,
            displacement=self.displacement,
            tributary=tributaries_of(self.position, facets),
            body=self.body,
            body_first=self.body_first,
            facet_first=self.body_first,
            facets=facets,
            neighbours=neighbours_of(facets),
            star_first=first,
            star=star,
        )


def join(loops):
    """Counter-clockwise loops, (m, 2) each, as one surface."""
    following, previous, body, start = [], [], [], 0
    for index, loop in enumerate(loops):
        own = np.arange(len(loop))
        following.append(start + np.roll(own, -1))
        previous.append(start + np.roll(own, 1))
        body.append(np.full(len(loop), index))
        start += len(loop)
    position = np.concatenate([np.array(loop, dtype=float) for loop in loops])
    return Loops(position, *(np.concatenate(a).astype(np.int64) for a in (following, previous, body)))


def turned(points, angle):
    """Points (n, 2) turned about the origin [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points, dtype=float) @ np.array([[c, s], [-s, c]])


def star(rng, centre, radius, n=24, roughness=0.15):
    """A star-shaped loop of uneven segments round a centre."""
    angle = np.sort(rng.random(n)) * 2.0 * np.pi if roughness else np.arange(n) * 2.0 * np.pi / n
    angle = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False) + 0.5 * (angle - angle.mean()) / n
    r = radius * (1.0 + roughness * rng.uniform(-1.0, 1.0, n))
    return np.array(centre) + np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)


def flat(x0, x1, y0, y1, n):
    """A rectangle with n segments along its top and bottom."""
    x = np.linspace(x0, x1, n + 1)
    bottom, top = np.stack([x, np.full(n + 1, y0)], 1), np.stack([x[::-1], np.full(n + 1, y1)], 1)
    return np.concatenate([bottom, top])


class Found(Candidates):
    """Candidates of the search, (n, slots), how many there are, and where they lie."""

    count = 0

    def locate(self, loops):
        """Write body, barycentric coordinates and normal of every candidate."""
        n, slots = self.facet.shape
        self.master = np.where(self.facet >= 0, loops.body[self.facet], -1)
        self.share, self.normal = np.zeros((n, slots, 2)), np.zeros((n, slots, 2))
        for s, j in zip(*np.nonzero(self.facet >= 0), strict=True):
            place = self.share[s, j], self.normal[s, j]
            signed_distance(loops.position[s], self.facet[s, j], loops.outline, *place, PLANE)
        return self


def empty_candidates(n, slots):
    """No candidate at all."""
    return Found(facet=np.full((n, slots), -1), gap=np.full((n, slots), np.inf))


def lists_of(loops, radius):
    """The lists of the search, without an entry."""
    n, n_bodies = len(loops.body), loops.n_bodies
    lists = VerletList(
        np.arange(n)[:, np.newaxis], loops.outline.body_first, loops.outline, radius, (radius, radius)
    )
    lists.list_pairs(np.stack(np.triu_indices(n_bodies, 1), axis=1), np.zeros(n_bodies, dtype=np.int64))
    return lists


def find(loops, *, h=0.25, radius=None, literal=False, slots=3):
    """Candidates of the search among all bodies."""
    found, radius = empty_candidates(len(loops.body), slots), h if radius is None else radius
    lists = lists_of(loops, radius)
    if lists.update():
        if literal:
            found.count = find_penetrated(radius, loops.outline, lists.near, found, (h, h))
        else:
            found.count = search.find_candidates(
                radius, loops.outline, lists.near, found, np.zeros(3), (h, h)
            )
    return found.locate(loops)


@dataclass
class Law:
    """What the pair force is told of the law."""

    stiffness: float = 1e4
    damping: float = 0.0
    friction: float = 0.3
    tangential_ratio: float = 1.0
    keep_q: bool = False
    pull: float = 0.0  #: beside the spring's force, which friction goes by as well [N/m]


def pair_table(n_bodies):
    """The table of all pairs' indices, and the pairs' first bodies."""
    first, second = np.triu_indices(n_bodies, 1)
    return pair_of_bodies(first, second), first


def rows_of(loops, found, *, across=False, ties=0.0, friction=True, tilts=False, passes=1.0, table=None):
    """Rows of the candidates; without a table the grid's nodes are the surface's own."""
    n = len(loops.body)
    own = dict.fromkeys((*SpringArrays.member_names, "rest"), 0) | {"tangential": 1, "moved": 1}
    rows = SurfaceRows(2, couples=friction, tilts=tilts, own=own)
    rows.allocate_friction(cohesion=False)
    rows.make_room(2 * found.facet.size, 400 * n)
    table = (np.arange(n + 1), np.arange(n, dtype=np.int32), np.ones(n)) if table is None else table
    table = as_table(*table)
    rows.count = assemble(
        np.arange(loops.n_bodies) if passes == 1.0 else np.zeros(loops.n_bodies, dtype=np.int64),
        across,
        ties,
        found,
        loops.outline,
        *pair_table(loops.n_bodies),
        table,
        np.zeros(table.nodes.max() + 1, dtype=np.int64),
        rows,
        rows.places,
        PLANE,
    )
    assert rows.count >= 0
    return rows


def history_of(loops, found, old_master=None, old_tangential=None):
    """Rows of a last step with the same normals: bodies touched and forces along e_t, (n, slots) each."""
    old = rows_of(loops, empty_candidates(len(loops.body), 1))
    kept = []
    for s, j in zip(*np.nonzero([] if old_master is None else old_master >= 0), strict=True):
        slot = np.flatnonzero((found.facet[s] >= 0) & (found.master[s] == old_master[s, j]))
        e = found.normal[s, slot[0]] if len(slot) else np.array([1.0, 0.0])
        kept.append(
            (s * loops.n_bodies + old_master[s, j], e, old_tangential[s, j] * np.array([-e[1], e[0]]))
        )
    old.make_room(len(kept) + 1, 1)
    old.count, old.gap[:], old.own.k_t[:] = len(kept), -1.0, 1.0
    for c, each in enumerate(sorted(kept, key=lambda each: each[0])):
        old.identity[c], old.normal[c], old.own.tangential[c] = each
    return old


def no_records(n_pairs):
    """Records of pairs to which nothing has happened."""
    sums = {name: np.zeros(n_pairs) for name in Records.member_names}
    vectors = {name: np.zeros((n_pairs, 2)) for name in ("impulse", "friction_impulse")}
    return Records(**{**sums, **vectors})


def forces(loops, found, law, old_master=None, old_tangential=None):
    """The law's forces on the surface nodes, tangential forces along e_t, and the pairs' frictional work."""
    n, slots = found.facet.shape
    n_pairs = len(pair_table(loops.n_bodies)[1])
    rows = rows_of(loops, found, tilts=law.keep_q)
    old = history_of(loops, found, old_master, old_tangential)
    match_rows(rows, rows.count, old, old.count)
    own, m, records = rows.own, rows.count, no_records(n_pairs)
    own.k[:m] = own.effective_area[:m] = law.stiffness * rows.area[:m] / whole_of(rows)
    rows.friction[:m] = law.friction
    own.entered[:m] = 1.0
    spring_forces(rows, m, own, old, law.tangential_ratio, law.damping / law.stiffness, np.inf, records)
    own.pull[:m] = law.pull
    add_friction(rows, m, own, old, old.count, old.own, records, np.zeros(n_pairs))
    force, tangential = np.zeros((n, 2)), np.zeros((n, slots))
    rows.add_to(force, (1.0, 1.0))
    for c in range(m):
        if rows.gap[c] < 0.0:
            s, e = rows.places.slave[c], rows.normal[c]
            j = np.flatnonzero(
                (found.facet[s] >= 0) & (found.master[s] == rows.identity[c] % loops.n_bodies)
            )[0]
            tangential[s, j] += own.tangential[c] @ (-e[1], e[0])
    return force, tangential, records.frictional_work


def whole_of(rows):
    """Area of the whole place that every row belongs to."""
    identity = rows.identity[: rows.count]
    return np.array([rows.tributary_area[: rows.count][identity == each].sum() for each in identity])
