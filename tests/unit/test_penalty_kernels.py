"""Search, forces, map and frequency of penalty contact against plain NumPy."""

import itertools

import numpy as np
import pytest
import shapely

from contact_kernels import PLANE, Law, empty_candidates, find, flat, forces, join, rows_of, star
from mpmfw.kernels.sides import minimum_gap

H = 0.25


def scenes():
    """Outlines that overlap a little, touch, or come near: stars, discs near a flat, three bodies."""
    rng = np.random.default_rng(5)
    for shift in (0.85, 0.93, 1.0, 1.15, 1.8):
        yield f"stars {shift}", [star(rng, (-shift, 0.1), 1.0), star(rng, (shift, -0.1), 1.0)]
    for y in (-0.02, 0.0, 0.1):
        yield f"disc on flat {y}", [star(rng, (0.03, 1.0 + y), 1.0, 60, 0.0), flat(-2.0, 2.0, -0.6, 0.0, 37)]
    three = [star(rng, centre, 0.9) for centre in ((-0.88, -0.5), (0.88, -0.5), (0.0, 1.0))]
    yield "three stars", three


SCENES = dict(scenes())
every_scene = pytest.mark.parametrize("name", SCENES)


def closest(loops, s, other):
    """Distance of a node from another body's outline, negative inside, and the closest point; by shapely."""
    polygon = shapely.Polygon(loops.position[loops.body == other])
    point = shapely.Point(loops.position[s])
    ring = polygon.exterior
    nearest = np.array(ring.interpolate(ring.project(point)).coords[0])
    return (-1.0 if polygon.contains(point) else 1.0) * ring.distance(point), nearest


def outward(loops, s, e):
    """Outward unit normal of the segment from node s to node e."""
    t = loops.position[e] - loops.position[s]
    return np.array([t[1], -t[0]]) / np.linalg.norm(t)


def faces(loops, s, m):
    """Return True if a node's normal, the sum of its two segments', opposes that of a segment."""
    node = outward(loops, loops.previous[s], s) + outward(loops, s, loops.following[s])
    return node @ outward(loops, m, loops.following[m]) < 0.0


def segment_at(loops, point, other):
    """The segment of a body that a point of its outline lies on."""
    of_body = np.flatnonzero(loops.body == other)
    lines = [shapely.LineString(loops.position[[m, loops.following[m]]]) for m in of_body]
    return of_body[np.argmin([line.distance(shapely.Point(point)) for line in lines])]


@every_scene
def test_search_finds_the_closest_point_of_every_other_body(name):
    loops = join(SCENES[name])
    found = find(loops, h=H)
    expected = 0
    for s in range(len(loops.body)):
        for other in set(range(loops.n_bodies)) - {int(loops.body[s])}:
            gap, point = closest(loops, s, other)
            slot = np.flatnonzero((found.facet[s] >= 0) & (found.master[s] == other))
            if abs(gap) >= H * (1.0 + 1e-12):
                assert len(slot) == 0
                continue
            if not faces(loops, s, segment_at(loops, point, other)):
                assert all(faces(loops, s, found.facet[s, j]) for j in slot)
                expected += len(slot)
                continue
            expected += 1
            (j,) = slot
            start = found.facet[s, j]
            ends = loops.position[[start, loops.following[start]]]
            np.testing.assert_allclose(found.gap[s, j], gap, atol=1e-12)
            np.testing.assert_allclose(
                ends[0] + found.share[s, j, 1] * (ends[1] - ends[0]), point, atol=1e-12
            )
            if abs(gap) > 1e-9:
                np.testing.assert_allclose(found.normal[s, j], (loops.position[s] - point) / gap, atol=1e-6)
            assert loops.body[start] == other
    assert found.count == expected


@pytest.mark.parametrize("fold", [-0.05, 0.05])
def test_a_folded_tip_does_not_take_the_outside_for_its_inside(fold):
    """The wedge's tip has a segment the wrong way round, which sees what is below the wedge behind it."""
    wedge = np.array([[-fold, 0.0], [fold, 0.0], [1.0, 2.0], [-1.0, 2.0]])
    loops = join([wedge, star(np.random.default_rng(1), (0.0, -1.5), 0.5, 12, 0.0)])
    gaps = [minimum_gap(*ends, loops.outline, PLANE) for ends in ((4, 16, 0, 4), (0, 4, 4, 16))]
    assert min(gaps) == pytest.approx(1.0, rel=0.01)
    inside = join([wedge, star(np.random.default_rng(1), (0.0, 1.5), 0.1, 12, 0.0)])
    assert minimum_gap(4, 16, 0, 4, inside.outline, PLANE) < -0.4


def test_literal_detection_takes_every_segment_that_eq_10_names():
    loops = join(SCENES["stars 0.93"])
    found = find(loops, h=H, literal=True, slots=8)
    for s in range(len(loops.body)):
        expected = set()
        for m in np.flatnonzero(loops.body != loops.body[s]):
            a, b = loops.position[[m, loops.following[m]]]
            t, r = b - a, loops.position[s] - a
            xi, gap = r @ t / (t @ t), (r[0] * t[1] - r[1] * t[0]) / np.linalg.norm(t)
            near = min(np.linalg.norm(r), np.linalg.norm(loops.position[s] - b)) < H
            if near and gap < 0.0 and 0.0 <= xi <= 1.0:
                expected.add(int(m))
        assert set(found.facet[s][found.facet[s] >= 0].tolist()) == expected


def force_twin(loops, found, law, old_master, old_tangential):
    """Forces of all contacts and the pairs' frictional work, in NumPy and without Q."""
    pairs = list(itertools.combinations(range(loops.n_bodies), 2))
    force, work = np.zeros_like(loops.position), np.zeros(len(pairs))
    x, u = loops.position, loops.displacement
    for s, j in zip(*np.nonzero((found.facet >= 0) & (found.gap < 0.0)), strict=True):
        g, e_n, m = found.gap[s, j], found.normal[s, j], found.facet[s, j]
        e_t = np.array([-e_n[1], e_n[0]])
        point = x[m] + found.share[s, j, 1] * (x[loops.following[m]] - x[m])
        masters = [m]
        if found.share[s, j, 1] in (0.0, 1.0):  # both segments that meet at the vertex
            vertex = m if found.share[s, j, 1] == 0.0 else loops.following[m]
            masters = [loops.previous[vertex], vertex]
        along = np.array([max((x[loops.following[k]] - x[k]) @ e_t, 0.0) for k in masters])
        known = old_master[s] == loops.body[m]
        pair = tuple(sorted((int(loops.body[s]), int(loops.body[m]))))
        for k, part in zip(masters, along**2 / (along @ along), strict=True):
            if part == 0.0:
                continue
            end = loops.following[k]
            t = x[end] - x[k]
            xi = (point - x[k]) @ t / (t @ t)
            rows = np.array([1.0, xi - 1.0, -xi])
            couple = np.array([0.0, -1.0, 1.0]) * g / (t @ e_t)
            normal, tangential = np.zeros((2, *x.shape))
            normal[[s, k, end]] = np.outer(rows, e_n)
            tangential[[s, k, end]] = np.outer(rows, e_t) + np.outer(couple, e_n)
            slip, approach = (tangential * u).sum(), (normal * u).sum()
            stiffness = part * law.stiffness
            f_n = -stiffness * g
            dashpot = part * law.damping * approach
            f_n += np.clip(-dashpot, -f_n, 2.0 * stiffness * abs(approach))
            if not known.any() and approach < 0.0:
                slip *= min(1.0, g / approach)
            k_t = law.tangential_ratio * stiffness
            trial = (part * old_tangential[s][known][-1] if known.any() else 0.0) - k_t * slip
            limit = law.friction * (f_n + law.pull)
            f_t = np.clip(trial, -limit, limit)
            work[pairs.index(pair)] += abs(f_t) * abs(trial - f_t) / k_t
            force += f_n * normal + f_t * tangential
    return force, work


@every_scene
@pytest.mark.parametrize(("damping", "pull"), [(0.0, 20.0), (2e3, 0.0)])
def test_contact_forces_agree_with_numpy(name, damping, pull):
    rng = np.random.default_rng(2)
    loops, law = join(SCENES[name]), Law(damping=damping, pull=pull, tangential_ratio=0.7, friction=0.4)
    loops.displacement[:] = 0.01 * rng.normal(size=loops.position.shape)
    found = find(loops, h=H)
    old_master = np.where(rng.random(found.facet.shape) < 0.5, found.master, -1)
    old_tangential = 100.0 * rng.normal(size=found.facet.shape)
    expected, work = force_twin(loops, found, law, old_master, old_tangential)
    force, _, friction_work = forces(loops, found, law, old_master, old_tangential)
    np.testing.assert_allclose(force, expected, rtol=1e-10, atol=1e-9)
    np.testing.assert_allclose(friction_work, work, rtol=1e-10, atol=1e-12)


def test_a_candidate_ahead_of_a_segment_s_end_has_finite_rows():
    """The normal at the vertex lies along the segment: there is no lever, and nothing is carried."""
    tip = np.array([[0.1, 0.0], [0.3, 1.0], [0.2, 1.0]])
    plate = np.array([[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0]])
    loops = join([tip, plate])
    found = empty_candidates(len(loops.body), 1)
    found.facet[0], found.gap[0] = 3, 0.1
    rows = rows_of(loops, found)
    assert rows.count == 1
    for array in (rows.motion, rows.couple, rows.places.turn):
        assert np.isfinite(array).all()
