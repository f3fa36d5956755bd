"""The law of [H17]: eq. 9 on every segment, and the reading of its friction."""

import numpy as np
import pytest

from contact_kernels import find, flat, join, no_records, pair_table, rows_of, star
from contact_scenes import impact
from mpmfw.contact.springs import add_friction
from mpmfw.errors import SceneError
from mpmfw.kernels import struct
from mpmfw.kernels.contact import match_rows
from mpmfw.runs.simulation import Simulation
from mpmfw_contact.hamad2017 import add_literal_friction, linear_springs

K, MU = 1e4, 0.3
SLOTS = 8


class Surfaces:
    """Overlapping outlines under the law, moved by hand, with its friction history."""

    def __init__(self, loops, *, literal=False, friction=MU, ratio=1.0):
        self.loops, self.literal, self.friction, self.ratio = loops, literal, friction, ratio
        self.old, self.tangential = None, np.zeros((len(loops.body), SLOTS))
        self.work = self.energy = 0.0

    def force(self):
        """Forces on all nodes (n, 2), and the candidates; tangential forces of every row are kept."""
        loops = self.loops
        found = find(loops, literal=True, slots=SLOTS)
        rows = rows_of(loops, found, ties=-np.inf, tilts=True)
        old = rows_of(loops, found, ties=-np.inf, tilts=True) if self.old is None else self.old
        old_count = 0 if self.old is None else old.count
        match_rows(rows, rows.count, old, old_count)
        own, old_own = (each.members() for each in (rows.own, old.own))
        if self.literal:
            own["tangential"] = np.zeros((0, 2))
        own["k"][:] = own["effective_area"][:] = K
        own["entered"][:] = 1.0
        own = struct(**own)
        records = no_records(len(pair_table(loops.n_bodies)[1]))
        rows.friction[:] = self.friction
        linear_springs(rows, rows.count, own, self.ratio, records)
        add_friction(rows, rows.count, own, old, old_count, struct(**old_own), records, np.zeros(0))
        if self.literal:
            add_literal_friction(rows, rows.count, own, records)
        force = np.zeros_like(loops.position)
        rows.add_to(force, (1.0, 1.0))
        self.old, self.tangential = rows, np.zeros((len(loops.body), SLOTS))
        for s in range(len(loops.body)):
            for j, c in enumerate(np.flatnonzero(rows.places.slave[: rows.count] == s)):
                e = rows.normal[c]
                self.tangential[s, j] = rows.own.tangential[c] @ (-e[1], e[0])
        self.energy, self.work = records.energy[0], self.work + records.frictional_work[0]
        return force, found


class Tip(Surfaces):
    """The tip of a triangle, node 0, a millimetre below the top of a flat body at y = 0."""

    def __init__(self, x=0.05, **law):
        tip = np.array([[x, -0.001], [x + 0.2, 1.0], [x - 0.2, 1.0]])
        super().__init__(join([tip, flat(-2.0, 2.0, -1.0, 0.0, 16)]), **law)

    def move(self, dx, dy=0.0):
        """Move the triangle; return the normal and the tangential force on its tip."""
        self.loops.displacement[:3] = (dx, dy)
        self.loops.position[:3] += (dx, dy)
        force, _ = self.force()
        return force[0, 1], force[0, 0]


def test_forces_are_eq_9_of_every_segment_that_eq_10_names():
    rng = np.random.default_rng(4)
    loops = join([star(rng, (-0.93, 0.1), 1.0), star(rng, (0.93, -0.1), 1.0)])
    loops.displacement[:] = 1e-3 * rng.normal(size=loops.displacement.shape)
    actual, found = Surfaces(loops, literal=True, ratio=0.7).force()
    expected = np.zeros_like(actual)
    x, u = loops.position, loops.displacement
    for s, j in zip(*np.nonzero(found.facet >= 0), strict=True):
        m = found.facet[s, j]
        nodes = [s, m, loops.following[m]]
        t = x[nodes[2]] - x[m]
        length = np.hypot(*t)
        e_t = t / length
        e_n = np.array([e_t[1], -e_t[0]])
        g_n, xi = (x[s] - x[m]) @ e_n, (x[s] - x[m]) @ e_t / length
        weights, ends = np.array([1.0, xi - 1.0, -xi]), np.array([0.0, -1.0, 1.0])
        c_n = np.outer(weights, e_n) - g_n / length * np.outer(ends, e_t)
        c_t = np.outer(weights, e_t) + g_n / length * np.outer(ends, e_n)
        g_t = (c_t * u[nodes]).sum()
        expected[nodes] -= K * g_n * c_n + 0.7 * K * g_t * c_t
    assert (found.facet >= 0).sum() > 3
    np.testing.assert_allclose(actual, expected, atol=1e-12 * np.abs(expected).max())


def test_literal_friction_leaves_the_cone_and_ignores_the_value_of_mu():
    forces = [Tip(literal=True, friction=friction).move(0.01)[1] for friction in (0.05, 0.9)]
    assert forces[0] == forces[1] == pytest.approx(-K * 0.01)
    assert Tip(literal=True, friction=0.0).move(0.01)[1] == 0.0


def test_a_node_above_the_end_of_two_segments_shares_what_it_carried():
    """Each segment repels it in full (eq. 10); what friction had built up is not counted twice."""
    tip = Tip(x=0.2499)
    tip.move(5e-5)
    before = tip.tangential[0].sum()
    tip.loops.position[0, 0] = 0.25
    tip.loops.displacement[:] = 0.0
    _, found = tip.force()
    assert (found.facet[0] >= 0).sum() == 2
    assert before == pytest.approx(K * 5e-5)
    assert tip.tangential[0, :2] == pytest.approx(0.5 * before)


def test_a_layer_thicker_than_a_cell_is_refused():
    with pytest.raises(SceneError, match=r"interface_thickness: 0.2 m is thicker than a cell"):
        Simulation(impact(gap=0.5, speed=0.0, slide=0.0), contact="hamad2017(interface_thickness=0.2)")
