"""Constants of the search on surfaces: each with another value, and a measure that fails with it."""

from __future__ import annotations

import math
from unittest import mock

import numpy as np
import pytest
from numba import njit

import contact_kernels
from contact_kernels import PLANE, empty_candidates, flat, join, star, turned
from contact_scenes import CELL, impact, wave_speed
from interpreted import interpreted
from mpmfw.contact import nodes, strategy
from mpmfw.contact.surfaces import outline, seams, search
from mpmfw.contact.surfaces.assembly import equally_close
from mpmfw.contact.surfaces.outline import distance_to, opposes
from mpmfw.contact.surfaces.search import THIN, keep_inside
from mpmfw.kernels.sides import minimum_gap
from mpmfw.kernels.surfaces import BLOCK, node_normal
from mpmfw.runs.simulation import Simulation

H = 0.25  #: cell size, and radius of the search
SEGMENT = H / 8.0


def block(left, bottom, right, top, segment=SEGMENT):
    """A rectangle whose outline has segments of about one length."""
    corners = np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
    sides = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = round(np.linalg.norm(end - start) / segment)
        sides.append(start + np.linspace(0.0, 1.0, count, endpoint=False)[:, None] * (end - start))
    return np.concatenate(sides)


def found_with(loops, **constants):
    """Candidates of the search."""
    with mock.patch.object(search, "find_candidates", interpreted(search.find_candidates, **constants)):
        return contact_kernels.find(loops, h=H)


def count_that_face(loops, s, facets, **constants):
    """How many of the facets face node s, by the sum of the unit normals of its own."""
    facing, looks = interpreted(opposes, **constants), np.zeros(2)
    interpreted(node_normal)(s, loops.outline, looks, PLANE)
    return sum(bool(facing(looks, m, loops.outline, PLANE)) for m in facets)


def right_angles(**constants):
    """How many facets of a block's side its bottom faces, at many angles: rounding must not decide."""
    angles, square = np.linspace(0.01, 1.5, 40), block(0.0, 0.0, 1.0, 1.0, 0.25)
    return {count_that_face(join([turned(square, a)]), 2, range(4, 8), **constants) for a in angles}


def wedge(**constants):
    """How many sides of a wedge of 10° face what it is pressed into."""
    half = math.tan(math.radians(5.0))
    loops = join([flat(-1.0, 1.0, -1.0, 0.0, 4), [[0.0, 0.0], [half, 1.0], [-half, 1.0]]])
    return count_that_face(loops, 6, (10, 12), **constants)


def flush(**constants):
    """Part of the nodes of two flush faces, corners included, that lie in the other face."""
    depth, shift = 0.02 * H, 0.02 * SEGMENT
    loops = join([block(-0.5, -0.5, 0.5, 0.0), block(shift - 0.5, -depth, shift + 0.5, 0.5)])
    found = found_with(loops, **constants)
    on_face = loops.position[:, 1] == np.where(loops.body == 1, -depth, 0.0)
    carried = (found.facet[:, 0] >= 0) & (np.abs(found.normal[:, 0, 1]) > 0.1) & (found.gap[:, 0] < 0.0)
    return (on_face & carried).sum() / (2 * (round(1.0 / SEGMENT) + 1))


def beside(**constants):
    """How many nodes of a wide face beside a narrow block that is deep in it are held as if within."""
    loops = join([block(-0.5, -0.5, 0.5, 0.0), block(-1.01, -0.2 * H, 0.99, 0.5)])
    found = found_with(loops, **constants)
    outside = (loops.body == 1) & (np.abs(loops.position[:, 0]) > 0.5 + outline.FLUSH * SEGMENT)
    return int(((found.facet[:, 0] >= 0) & (found.gap[:, 0] < 0.0) & outside).sum())


def end_to_end(**constants):
    """Depth of two thin sheets that overlap by 1.5 segments, over that overlap."""
    overlap, thickness = 1.5 * SEGMENT, 0.5 * H
    loops = join([block(-1.0, 0.0, 0.0, thickness), block(-overlap, 0.0, 1.0 - overlap, thickness)])
    found = found_with(loops, **constants)
    return -found.gap[found.facet >= 0].min() / overlap


def part_of_the_neighbour(loops, m, **constants):
    """What a facet's neighbours take of its contact with node 0."""
    share, normal, other_share, other_normal = np.zeros((4, 2))
    gap = interpreted(distance_to)(0, m, loops.outline, share, normal, PLANE)
    close = interpreted(equally_close, **constants)
    return close(0, m, share, gap, normal, other_share, other_normal, loops.outline, PLANE)[1]


def tips(**constants):
    """Parts of a tip as deep under both sides of another, turned: no index must decide."""
    one = [[0.0, -0.01], [0.5, 1.0], [-0.5, 1.0]]
    other = [[-1.0, -1.0], [1.0, -1.0], [0.0, 0.0]]
    loops = [join([turned(one, a), turned(other, a)]) for a in np.linspace(0.0, 6.0, 40)]
    return {round(part_of_the_neighbour(each, 4, **constants), 6) for each in loops}


def over_a_segment(**constants):
    """Part of the neighbour that begins a tenth of a node's depth away from it."""
    loops = join([[[0.05, -0.2], [0.55, 1.0], [-0.45, 1.0]], flat(-1.0, 1.0, -1.0, 0.0, 4)])
    ends = loops.position[np.stack([np.arange(len(loops.body)), loops.following], axis=1)]
    over = int(np.flatnonzero((ends[:, :, 1] == 0.0).all(axis=1) & (ends[:, 0, 0] == 0.5))[0])
    return part_of_the_neighbour(loops, over, **constants)


def kept(**constants):
    """Of two facets that meet at the closest vertex, the one kept where rounding lengthens distances."""
    face = [[0.0, 0.0], [-1.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 0.0]]
    loops = join([[[0.0, 0.07], [0.3, 1.0], [-0.3, 1.0]], face])
    lists, found = contact_kernels.lists_of(loops, H), empty_candidates(len(loops.body), 1)
    assert lists.update()
    lists.near.away[:] = np.nextafter(lists.near.away, np.inf)
    found.facet[0, 0] = 7
    search_for = interpreted(search.find_candidates, **constants)
    search_for(H, lists.outline, lists.near, found, np.zeros(3), PLANE)
    return int(found.facet[0, 0])


def lost(place, **constants):
    """How far through a sheet, whose right side leans out by 11°, a node is that was inside by its top."""
    sheet = np.array([[-0.5, 0.0], [0.4, 0.0], [0.5, 0.5], [-0.5, 0.5]])
    loops = join([sheet, np.add(place, [[0.0, 0.0], [0.5, 1.0], [-0.5, 1.0]])])
    found, through = empty_candidates(len(loops.body), 1), np.zeros(3)
    near = contact_kernels.lists_of(loops, H).near
    interpreted(keep_inside, **constants)(4, 2, loops.outline, near, found, through, PLANE)
    return through[0]


def on_shared_nodes(**constants):
    """Least stable step over that of the bulk, and deepest gap [cells], with springs at shared nodes."""
    mapping = impact(gap=0.0481, speed=0.1 * wave_speed("soft"), slide=0.0, friction=0.0)
    for each in mapping["bodies"].values():  # to where splines reach some nodes by next to nothing
        each["geometry"] |= {end: [x + 0.2 * CELL, y] for end, (x, y) in list(each["geometry"].items())[1:]}
    with mock.patch.dict(vars(nodes), constants):
        simulation = Simulation(mapping, contact="nodes+penalty(kappa=1)", shape="bspline")
        bulk, steps, gaps = simulation.limits()[0][0], [], []
        gap = simulation.registry.plugins["gap"]
        for _ in range(60):
            simulation.advance(1)
            steps.append(simulation.state.dt)
            gaps.append(float(gap.diagnostics(simulation.state)["min_gap"][0]))
    return min(steps) / bulk, -min(gaps) / CELL


def ranks(**constants):
    """Ranks of moduli of which two are equal but for rounding, and a third differs by 1e-5."""
    with mock.patch.dict(vars(strategy), constants):
        return strategy.ranks_of(np.array([1.0, 2.0, 2.0 * (1.0 + 1e-9), 2.0 * (1.0 + 1e-5)])).tolist()


def is_flush(body, cover, first, second, **constants):
    """True if the facet of a cover between two places is flush with the body's node at the origin."""
    loops = join([np.array(body), np.array(cover)])
    node = int(np.flatnonzero(np.isclose(loops.position, 0.0).all(axis=1))[0])
    with mock.patch.dict(vars(seams), constants):
        flush_with = njit(seams.is_flush.py_func)
        return bool(
            flush_with(node, facet_of(loops, first, second), np.array([1.0, 0.0]), loops.outline, PLANE)
        )


def facet_of(loops, first, second):
    """The facet from one place to another."""
    corners = loops.position[loops.outline.facets]
    return int(np.flatnonzero(np.isclose(corners, [first, second]).all(axis=(1, 2)))[0])


def leaning(**constants):
    """A facet that leans by 20°, more than elastic faces do, near a node in the middle of a face."""
    lean = 0.4 * np.array([np.sin(np.radians(20.0)), np.cos(np.radians(20.0))])
    low, high = np.array([0.02, 0.0]) - lean, np.array([0.02, 0.0]) + lean
    face = [[0.0, -1.0], [0.0, 0.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]
    return is_flush(face, [high, low, [2.0, -1.0], [2.0, 1.0]], high, low, **constants)


def beyond_the_rim(**constants):
    """A facet's rim beyond a node where facets meet at 45°, which is a curved face and no edge."""
    body = [[-0.7071, -0.7071], [0.0, 0.0], [0.0, 1.0], [-2.0, 1.0], [-2.0, -0.7071]]
    cover = [[0.01, 1.03], [0.01, 0.03], [1.0, 0.03], [1.0, 1.03]]
    return is_flush(body, cover, cover[0], cover[1], **constants)


def notched(**constants):
    """A face between two facets of 30° that touch its corners, and leave its middle free."""
    body = [[0.0, 0.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0]]
    notch = [[0.0, 1.0], [0.2887, 0.5], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
    loops = join([np.array(body), np.array(notch)])
    listed = np.array([facet_of(loops, *notch[k : k + 2]) for k in (0, 1)], dtype=np.int32)
    with mock.patch.dict(vars(seams), constants):
        covered = njit(seams.is_covered.py_func)
        return bool(covered(facet_of(loops, body[0], body[1]), listed, 0, 2, loops.outline, PLANE))


#: Constant, another value, a measure, and the condition that it meets with the constant's own value alone.
CASES = [
    ("LEAST_COSINE", 0.0, right_angles, lambda seen: seen == {0}),
    ("LEAST_COSINE", 0.1, wedge, lambda count: count == 2),
    ("ROUND_THE_CORNER", 0.01, flush, lambda part: part == 1.0),
    ("ROUND_THE_CORNER", 1.0, end_to_end, lambda depth: depth < 1.0 + 1e-9),
    ("FLUSH", 0.0, flush, lambda part: part == 1.0),
    ("FLUSH", 1.0, beside, lambda count: count == 0),
    ("TIE", 0.0, tips, lambda seen: seen == {0.5}),
    ("TIE", 0.1, over_a_segment, lambda part: part == 0.0),
    ("ROUNDING", 1.0, kept, lambda facet: facet == 3),
    ("THROUGH", 1.01, lambda **c: lost((0.0, -0.1), **c), lambda way: way == pytest.approx(0.1)),
    ("THROUGH", 0.1, lambda **c: lost((0.6, 0.2), **c), lambda way: way == 0.0),
    ("LEAST_MASS", 0.0, on_shared_nodes, lambda found: found[0] > 0.3),
    ("LEAST_MASS", 0.8, on_shared_nodes, lambda found: found[1] < 0.6),
    ("EQUAL", 0.0, ranks, lambda found: found == [0, 1, 1, 2]),
    ("EQUAL", 1e-4, ranks, lambda found: found == [0, 1, 1, 2]),
    ("ASIDE", 0.4, leaning, lambda is_flush: not is_flush),
    ("EDGE", 0.8, beyond_the_rim, lambda is_flush: not is_flush),
    ("OPPOSITE", 0.8, notched, lambda is_covered: not is_covered),
]


@pytest.mark.parametrize(("name", "other", "measure", "holds"), CASES)
def test_with_another_value_it_fails(name, other, measure, holds):
    own, changed = measure(), measure(**{name: other})
    assert holds(own), own
    assert not holds(changed), changed


def test_blocks_of_facets_spare_comparisons_and_change_no_gap():
    loops = join([star(np.random.default_rng(2), (-0.93, 0.1), 1.0), block(-0.1, -0.5, 0.9, 0.5, H)])
    first = loops.body_first
    ends = (first[0], first[1], first[1], first[2], loops.outline, PLANE)
    gaps = {interpreted(minimum_gap, BLOCK=size)(*ends) for size in (1, 3, BLOCK, 100)}
    assert gaps == {minimum_gap(*ends)}


def test_a_node_that_passes_the_middle_of_a_thin_body_in_a_step_is_seen():
    """Of a sheet of 0.6 cells; with a larger least travel it is not looked for."""
    loops = join([block(-0.5, -0.3 * H, 0.5, 0.3 * H), block(-0.3, -0.02 * H, 0.3, 0.4)])
    loops.displacement[loops.body == 1] = (0.0, -0.4 * H)

    def seen(share):
        found, lists = empty_candidates(len(loops.body), 1), contact_kernels.lists_of(loops, H)
        assert lists.update()
        search_for = interpreted(search.find_candidates, THIN=share)
        return search_for(H, loops.outline, lists.near, found, np.zeros(3), PLANE)

    assert seen(THIN) - seen(0.5) >= (loops.position[loops.body == 1, 1] == -0.02 * H).sum()
