"""Outlines and arrays on which the kernels of penalty contact can be called alone."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mpmfw.kernels.contact import add_records, match_rows
from mpmfw.kernels.pair_table import pair_table as pair_of_bodies
from mpmfw.kernels.polyline import bounding_boxes, signed_distance
from mpmfw_contact import _springs
from mpmfw_contact.surfaces import search
from mpmfw_contact.surfaces.assembly import assemble
from mpmfw_contact.surfaces.detection import SurfaceRows


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


@dataclass
class Found:
    """Candidates of the search, (n, slots)."""

    master: np.ndarray
    segment: np.ndarray
    coordinate: np.ndarray
    gap: np.ndarray
    normal: np.ndarray
    count: int


def empty_candidates(n, slots):
    """No candidate at all."""
    whole, real = np.full((n, slots), -1), np.zeros((n, slots))
    return Found(whole.copy(), whole.copy(), real.copy(), real.copy(), np.zeros((n, slots, 2)), 0)


def near_boxes(loops, radius):
    """What of every body may be within the radius of another: two corners of boxes, (n_bodies, 2) each."""
    first = np.searchsorted(loops.body, np.arange(loops.n_bodies + 1))
    lower, upper, *near = np.empty((4, loops.n_bodies, 2))
    bounding_boxes(first, loops.position, lower, upper)
    search.near_boxes(*np.triu_indices(loops.n_bodies, 1), lower, upper, radius, *near)
    return near


def find(loops, *, h=0.25, radius=None, literal=False, slots=3, lower=(-3.0, -3.0), nodes=(25, 25)):
    """The three steps of the search, on a background grid of cells h."""
    size = nodes[0] * nodes[1]
    owner, shared, head, head_stamp = (np.zeros(size, dtype=np.int64) for _ in range(4))
    link, link_segment = (np.zeros(64 * len(loops.body), dtype=np.int32) for _ in range(2))
    where = (np.array(lower), (h, h), np.array(nodes))
    found = empty_candidates(len(loops.body), slots)
    radius = h if radius is None else radius
    near = near_boxes(loops, radius)
    if not search.mark_shared_nodes(
        1, loops.n_bodies, loops.position, loops.following, loops.body, *near, *where, owner, shared
    ):
        return found
    lists = (shared, head, head_stamp, link, link_segment)
    entries = search.list_segments(1, loops.position, loops.following, loops.body, *near, *where, *lists)
    assert entries <= len(link)
    alike = np.zeros(loops.n_bodies, dtype=np.int64)
    loop = (loops.position, loops.following, loops.previous, loops.body, alike)
    out = (found.master, found.segment, found.coordinate, found.gap, found.normal)
    found.count = search.find_pairs(1, radius, literal, *loop, *near, *where, *lists, *out)
    return found


@dataclass
class Law:
    """What the pair force is told of the law."""

    stiffness: float = 1e4
    damping: float = 0.0
    friction: float = 0.3
    tangential_ratio: float = 1.0
    keep_q: bool = False
    dt: float = 1e-3


@dataclass
class Result:
    """Forces on the nodes and the pair's records."""

    force: np.ndarray
    tangential: np.ndarray
    impulse: np.ndarray
    friction_work: np.ndarray
    damping_work: np.ndarray
    energy: np.ndarray
    count: np.ndarray


def pair_table(n_bodies):
    """The table of all pairs' indices, and the pairs' first bodies."""
    first, second = np.triu_indices(n_bodies, 1)
    return pair_of_bodies(first, second), first


@dataclass
class History:
    """What the last step left to the law: rows' identities, gaps, normals and tangential forces."""

    identity: np.ndarray
    gap: np.ndarray
    normal: np.ndarray
    tangential: np.ndarray


def rows_of(loops, found, *, across=False, ties=True, friction=True, tilts=False, passes=1.0, table=None):
    """Rows of the candidates; without a table the grid's nodes are the surface's own."""
    n = len(loops.body)
    own = dict.fromkeys(("bears", "rest", "k", "tangent_k"), 0) | {"tangential": 1, "moved": 1}
    rows = SurfaceRows(2, couples=friction, tilts=tilts, own=own)
    rows.make_room(2 * found.segment.size, 400 * n)
    table = (np.arange(n + 1), np.arange(n, dtype=np.int32), np.ones(n)) if table is None else table
    pair_of, first = pair_table(loops.n_bodies)
    facet = np.stack([np.arange(n), loops.following], axis=1)
    length = np.linalg.norm(loops.position[loops.following] - loops.position, axis=1)
    tributary = 0.5 * (length + length[loops.previous])
    rows.count = assemble(
        passes, across, ties, found.master, found.segment, found.coordinate, found.gap, found.normal,
        loops.position, loops.displacement, tributary, loops.following, loops.previous, loops.body, facet,
        pair_of, first, *table, loops.n_bodies,
        rows.pair, rows.identity, rows.sign, rows.gap, rows.area, rows.whole, rows.normal, rows.motion,
        rows.start, rows.dof, rows.weight, rows.couple, rows.tilt,
        rows.slave, rows.facet, rows.share, rows.turn, rows.lean,
    )  # fmt: skip
    assert rows.count >= 0
    return rows


def history_of(loops, found, old_master=None, old_tangential=None):
    """Rows of a last step with the same normals: bodies touched and tangential forces along e_t, (n, slots) each."""
    if old_master is None:
        return History(np.zeros(0, dtype=int), np.zeros(0), np.zeros((0, 2)), np.zeros((0, 2)))
    kept = []
    for s, j in zip(*np.nonzero(old_master >= 0), strict=True):
        slot = np.flatnonzero((found.segment[s] >= 0) & (found.master[s] == old_master[s, j]))
        e = found.normal[s, slot[0]] if len(slot) else np.array([1.0, 0.0])
        kept.append(
            (s * loops.n_bodies + old_master[s, j], e, old_tangential[s, j] * np.array([-e[1], e[0]]))
        )
    kept.sort(key=lambda each: each[0])
    normal, tangential = (np.array([each[k] for each in kept]).reshape(-1, 2) for k in (1, 2))
    return History(
        np.array([each[0] for each in kept], dtype=int), np.full(len(kept), -1.0), normal, tangential
    )


def forces(loops, found, law, old_master=None, old_tangential=None):
    """The law's forces, alike for all nodes and pairs, on the surface nodes."""
    n, slots = found.segment.shape
    _, first = pair_table(loops.n_bodies)
    rows = rows_of(loops, found, tilts=law.keep_q)
    old = history_of(loops, found, old_master, old_tangential)
    rows.before[:] = -1
    match_rows(0, rows.count, rows.identity, len(old.identity), old.identity, rows.before)
    k = rows.own["k"]
    k[: rows.count] = law.stiffness * rows.area[: rows.count] / whole_of(rows)
    result = Result(
        np.zeros((n, 2)), np.zeros((n, slots)), np.zeros((len(first), 2)), *np.zeros((4, len(first)))
    )
    _springs.spring_forces(
        rows.count, rows.pair, rows.identity, rows.before, rows.gap, rows.normal, rows.motion,
        k, np.zeros(len(k)), k, law.damping / law.stiffness, np.full(len(first), law.friction), law.tangential_ratio, np.inf,
        len(old.identity), old.identity, old.gap, old.normal, rows.own["tangential"], old.tangential,
        rows.force, result.energy, result.friction_work, result.damping_work, np.zeros(len(first)),
    )  # fmt: skip
    rows.add_to(result.force, (1.0, 1.0))
    add_records(
        0, rows.count, rows.pair, rows.identity, rows.sign, rows.force, law.dt, result.impulse, result.count, (1.0, 1.0)
    )  # fmt: skip
    for c in range(rows.count):
        if rows.gap[c] < 0.0:
            s, e = rows.slave[c], rows.normal[c]
            j = np.flatnonzero(
                (found.segment[s] >= 0) & (found.master[s] == rows.identity[c] % loops.n_bodies)
            )[0]
            result.tangential[s, j] += rows.own["tangential"][c] @ (-e[1], e[0])
    return result


def whole_of(rows):
    """Area of the whole place that every row belongs to."""
    identity = rows.identity[: rows.count]
    return np.array([rows.whole[: rows.count][identity == each].sum() for each in identity])


class OneNode:
    """The tip of a triangle (node 0) on the top of a flat body at y = 0, moved by hand, with its friction
    history."""

    def __init__(self, law, x=0.05, y=0.01):
        tip = np.array([[x, y], [x + 0.2, y + 1.0], [x - 0.2, y + 1.0]])
        self.loops = join([tip, flat(-2.0, 2.0, -1.0, 0.0, 16)])
        self.law = law
        self.old_master, self.old_tangential = np.full((len(self.loops.body), 1), -1), None
        self.work = 0.0

    def move(self, dx, dy):
        """Move the triangle; return the normal and the tangential force on its tip."""
        loops = self.loops
        loops.displacement[:3] = (dx, dy)
        loops.position[:3] += (dx, dy)
        found = empty_candidates(len(loops.body), 1)
        best = np.inf
        for m in np.flatnonzero(loops.body == 1):
            gap, xi, *normal = signed_distance(
                *loops.position[0], m, loops.position, loops.following, loops.previous
            )
            if abs(gap) < best:
                best = abs(gap)
                found.master[0, 0], found.segment[0, 0], found.coordinate[0, 0] = 1, m, xi
                found.gap[0, 0], found.normal[0, 0] = gap, normal
        result = forces(loops, found, self.law, self.old_master, self.old_tangential)
        self.old_master, self.old_tangential = found.master, result.tangential
        self.work += result.friction_work[0]
        return result.force[0, 1], result.force[0, 0]
