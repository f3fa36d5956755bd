"""Outlines and arrays on which the kernels of penalty contact can be called alone."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mpmfw.kernels.polyline import signed_distance
from mpmfw_contact.penalty import pair_force, search
from mpmfw_contact.penalty.pair_table import pair_table as pair_of_bodies


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


def find(loops, *, h=0.25, radius=None, literal=False, slots=3, lower=(-3.0, -3.0), nodes=(25, 25)):
    """The three steps of the search, on a background grid of cells h."""
    size = nodes[0] * nodes[1]
    owner, shared, head, head_stamp = (np.zeros(size, dtype=np.int64) for _ in range(4))
    link, link_segment = (np.zeros(64 * len(loops.body), dtype=np.int32) for _ in range(2))
    where = (np.array(lower), (h, h), np.array(nodes))
    found = empty_candidates(len(loops.body), slots)
    if not search.mark_shared_nodes(
        1, loops.n_bodies, loops.position, loops.following, loops.body, *where, owner, shared
    ):
        return found
    lists = (shared, head, head_stamp, link, link_segment)
    entries = search.list_segments(1, loops.position, loops.following, *where, *lists)
    assert entries <= len(link)
    alike = np.zeros(loops.n_bodies, dtype=np.int64)
    loop = (loops.position, loops.following, loops.previous, loops.body, alike)
    out = (found.master, found.segment, found.coordinate, found.gap, found.normal)
    found.count = search.find_pairs(1, h if radius is None else radius, literal, *loop, *where, *lists, *out)
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


def forces(loops, found, law, old_master=None, old_tangential=None):
    """Call the kernel with the law alike for all nodes and pairs."""
    n, slots = found.segment.shape
    pair_of, first = pair_table(loops.n_bodies)
    result = Result(
        np.zeros((n, 2)), np.zeros((n, slots)), np.zeros((len(first), 2)), *np.zeros((4, len(first)))
    )
    pair_force.contact_forces(
        slots,
        found.master,
        found.segment,
        found.coordinate,
        found.gap,
        np.zeros((0, slots)),
        found.normal,
        np.full((n, slots), -1) if old_master is None else old_master,
        result.tangential,
        np.zeros((n, slots)) if old_tangential is None else old_tangential,
        loops.body,
        pair_of,
        first,
        loops.position,
        loops.displacement,
        loops.following,
        loops.previous,
        np.full((n, slots), law.stiffness),
        np.full((n, slots), law.damping),
        np.full(len(first), law.friction),
        law.tangential_ratio,
        law.keep_q,
        np.inf,
        law.dt,
        np.zeros((2, 4, 3, 2)),
        result.force,
        result.impulse,
        result.friction_work,
        result.damping_work,
        result.energy,
        result.count,
    )
    return result


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
