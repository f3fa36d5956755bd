"""What each constant of the search on surfaces is for: which way it fails where it is smaller or larger."""

from __future__ import annotations

import math

import numpy as np
import pytest

import contact_kernels
from contact_kernels import PLANE, empty_candidates, flat, join, star
from contact_scenes import CELL, impact, rectangle, scene, wave_speed
from interpreted import interpreted
from mpmfw.api import SimulationError
from mpmfw.contact import nodes, parts
from mpmfw.contact.events import FEWEST_STEPS
from mpmfw.contact.nodes import LEAST_MASS
from mpmfw.contact.surfaces import search
from mpmfw.contact.surfaces.assembly import equally_close
from mpmfw.contact.surfaces.detection import THIN
from mpmfw.contact.surfaces.outline import distance_to
from mpmfw.contact.surfaces.search import FLUSH, LEAST_COSINE, ROUNDING, opposes
from mpmfw.contact.surfaces.tracking import THROUGH, find_crossings, keep_inside
from mpmfw.kernels.boxes import BLOCK
from mpmfw.kernels.surfaces import minimum_gap, node_normal
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


def turned(points, angle):
    """Points turned about the origin."""
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(points, dtype=float) @ np.array([[c, s], [-s, c]])


def found_with(monkeypatch, loops, **constants):
    """Candidates of the search with other constants."""
    compiled = search.find_candidates
    monkeypatch.setattr(search, "find_candidates", interpreted(compiled, **constants))
    found = contact_kernels.find(loops, h=H)
    monkeypatch.setattr(search, "find_candidates", compiled)
    return found


def outline_normal(loops, s):
    """Sum of the unit normals of node s' segments."""
    normal = np.zeros(2)
    interpreted(node_normal)(s, loops.outline, normal, PLANE)
    return normal


def count_that_face(loops, s, facets, **constants):
    """How many of the facets face node s."""
    facing = interpreted(opposes, **constants)
    looks, outline = outline_normal(loops, s), loops.outline
    return sum(bool(facing(looks, m, outline, PLANE)) for m in facets)


def test_without_a_least_cosine_rounding_decides_whether_sides_at_right_angles_face_each_other():
    decided = {LEAST_COSINE: set(), 0.0: set()}
    for angle in np.linspace(0.01, 1.5, 40):
        loops = join([turned(block(0.0, 0.0, 1.0, 1.0, 0.25), angle)])
        for cosine, seen in decided.items():  # node 2 is on the bottom, facets 4 to 7 are the right side
            seen.add(count_that_face(loops, 2, range(4, 8), LEAST_COSINE=cosine))
    assert decided[LEAST_COSINE] == {0}
    assert len(decided[0.0]) > 1


def test_with_a_large_least_cosine_the_sides_of_a_thin_wedge_face_nothing():
    """Of one of 10°, whose sides are at 85° to what it is pressed into."""
    half = math.tan(math.radians(5.0))
    loops = join([flat(-1.0, 1.0, -1.0, 0.0, 4), [[0.0, 0.0], [half, 1.0], [-half, 1.0]]])
    top, sides = 6, (10, 12)  # a node of the flat body's top
    assert outline_normal(loops, top) == pytest.approx([0.0, 2.0])
    assert count_that_face(loops, top, sides, LEAST_COSINE=LEAST_COSINE) == 2
    assert count_that_face(loops, top, sides, LEAST_COSINE=0.1) == 0


def pressed(depth=0.02 * H, shift=0.02 * SEGMENT):
    """Two blocks of equal width, the upper one in the lower by a depth, and beside it by next to nothing."""
    return join([block(-0.5, -0.5, 0.5, 0.0), block(shift - 0.5, -depth, shift + 0.5, 0.5)])


def carrying(loops, found):
    """How many nodes of the two faces, corners included, have a candidate that lies in the other face."""
    number = 0
    for s in range(len(loops.body)):
        level = -0.02 * H if loops.body[s] == 1 else 0.0
        m = found.facet[s, 0]
        if loops.position[s, 1] == level and m >= 0:
            number += abs(found.normal[s, 0, 1]) > 0.1 and found.gap[s, 0] < 0.0
    return number


def test_all_of_two_flush_faces_carries_their_corners_included(monkeypatch):
    """Without turning far enough, or where next to nothing beside is no longer flush, corners carry
    nothing.
    """
    loops, whole = pressed(), 2 * (round(1.0 / SEGMENT) + 1)
    assert carrying(loops, contact_kernels.find(loops, h=H)) == whole
    assert carrying(loops, found_with(monkeypatch, loops)) == whole
    assert carrying(loops, found_with(monkeypatch, loops, ROUND_THE_CORNER=0.01)) < whole
    assert carrying(loops, found_with(monkeypatch, loops, FLUSH=0.0)) < whole


def test_with_more_that_counts_as_flush_nodes_beside_a_body_are_held_as_if_within(monkeypatch):
    """A narrow block is a fifth of a cell deep in a wide face: the face's nodes beside it are in front of
    nothing.
    """
    depth = 0.2 * H
    loops = join([block(-0.5, -0.5, 0.5, 0.0), block(-1.01, -depth, 0.99, 0.5)])

    def beside(found):
        outside = (loops.body == 1) & (np.abs(loops.position[:, 0]) > 0.5 + FLUSH * SEGMENT)
        return int(((found.facet[:, 0] >= 0) & (found.gap[:, 0] < 0.0) & outside).sum())

    assert beside(found_with(monkeypatch, loops, FLUSH=FLUSH)) == 0
    assert beside(found_with(monkeypatch, loops, FLUSH=1.0)) > 0


@pytest.mark.parametrize("segment", [0.01 * CELL, 0.004 * CELL])
def test_a_corner_with_more_facets_than_can_be_looked_at_ends_the_run(segment):
    """A block is a fifth of a cell deep in the face of one as wide: its corner is on the other's side, that
    far from the face.
    """
    overlapping = scene(
        {
            "lower": rectangle([-0.3, -0.5], [0.3, 0.0], segment=segment),
            "upper": rectangle([-0.3, -0.2 * CELL], [0.3, 0.4]),
        },
        friction=0.0,
        allow_overlap=True,
    )
    simulation = Simulation(overlapping, contact="penalty")
    if segment >= 0.01 * CELL:
        simulation.advance(1)
        return
    with pytest.raises(
        SimulationError, match=r"more than 64 facets .* body 'upper', .* Try: a larger segment"
    ):
        simulation.advance(1)


def two_tips(angle, depth):
    """A tip that is as deep under both sides of another (facets 4 and 5), turned by an angle."""
    one = [[0.0, -depth], [0.5, 1.0], [-0.5, 1.0]]
    other = [[-1.0, -1.0], [1.0, -1.0], [0.0, 0.0]]
    return join([turned(one, angle), turned(other, angle)])


def part_of_the_neighbour(loops, s, m, **constants):
    """What a facet's neighbours take of its contact with node s."""
    outline = loops.outline
    share, normal, other_share, other_normal = np.zeros((4, 2))
    gap = interpreted(distance_to)(s, m, outline, share, normal, PLANE)
    close = interpreted(equally_close, **constants)
    return close(s, m, share, gap, normal, other_share, other_normal, outline, PLANE)[1]


def test_without_an_allowance_for_ties_an_index_decides_which_side_of_a_corner_holds_a_tip():
    parts = {"as it is": set(), "none": set()}
    for angle in np.linspace(0.0, 6.0, 40):
        loops = two_tips(angle, 0.01)
        parts["as it is"].add(round(part_of_the_neighbour(loops, 0, 4), 6))
        parts["none"].add(round(part_of_the_neighbour(loops, 0, 4, TIE=0.0), 6))
    assert parts == {"as it is": {0.5}, "none": {0.0, 0.5}}


def test_without_an_allowance_for_rounding_the_search_loses_one_of_two_equally_close_facets():
    """Of those that meet at the closest vertex the first is kept, although the other was found in the last
    step and rounding made listed distances larger.
    """

    def kept(rounding):
        face = [[0.0, 0.0], [-1.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 0.0]]
        loops = join([[[0.0, 0.07], [0.3, 1.0], [-0.3, 1.0]], face])
        lists, found = contact_kernels.lists_of(loops, H), empty_candidates(len(loops.body), 1)
        assert lists.update()
        lists.near.away[:] = np.nextafter(lists.near.away, np.inf)
        found.facet[0, 0] = 7
        search_for = interpreted(search.find_candidates, ROUNDING=rounding)
        search_for(H, lists.outline, lists.near, found, PLANE)
        return int(found.facet[0, 0])

    assert kept(ROUNDING) == 3
    assert kept(1.0) == 7


def lost_node(loops, s, facet, **constants):
    """What is added for node s, which was inside body 0 by a facet and is not found again, and how far
    through it is.
    """
    found = empty_candidates(len(loops.body), 1)
    found.set(inside=np.full((len(loops.body), 1), -1), inside_facet=np.full((len(loops.body), 1), -1))
    found.inside[s, 0], found.inside_facet[s, 0] = 0, facet
    through = np.zeros(3)
    added = interpreted(keep_inside, **constants)(loops.outline, found, through, PLANE)
    return added, through[0]


def test_a_node_that_comes_out_by_the_far_side_has_gone_through_and_one_by_a_side_has_not():
    """With a larger least cosine bodies cross without a word; with a smaller one a node that slips off a side
    ends the run.
    """
    sheet = np.array([[-0.5, 0.0], [0.4, 0.0], [0.5, 0.5], [-0.5, 0.5]])  # its right side leans out by 11°
    below = join([sheet, np.array([[0.0, -0.1], [0.5, 0.9], [-0.5, 0.9]])])
    top = 2
    assert lost_node(below, 4, top, THROUGH=THROUGH) == (1, pytest.approx(0.1))
    assert lost_node(below, 4, top, THROUGH=1.01) == (0, 0.0)
    beside = join([sheet, np.array([[0.6, 0.2], [1.1, 1.2], [0.1, 1.2]])])
    assert lost_node(beside, 4, top, THROUGH=THROUGH) == (0, 0.0)
    assert lost_node(beside, 4, top, THROUGH=0.1)[1] > 0.1


def on_shared_nodes(monkeypatch, least_mass):
    """Least stable step over that of the bulk, and the deepest gap [cells], of an impact with springs at
    shared nodes.
    """
    monkeypatch.setattr(nodes, "LEAST_MASS", least_mass)
    mapping = impact(gap=0.0481, speed=0.1 * wave_speed("soft"), slide=0.0, friction=0.0)
    for each in mapping["bodies"].values():  # to where splines reach some nodes by next to nothing
        each["geometry"] |= {end: [x + 0.2 * CELL, y] for end, (x, y) in list(each["geometry"].items())[1:]}
    simulation, steps, gaps = Simulation(mapping, contact="nodes+penalty(kappa=1)", shape="bspline"), [], []
    bulk = simulation.limits()[0][0]
    for _ in range(60):
        simulation.advance(1)
        steps.append(simulation.state.dt)
        gaps.append(float(simulation.manager.get_plugin("gap").diagnostics(simulation.state)["min_gap"][0]))
    return min(steps) / bulk, -min(gaps) / CELL


def test_forces_on_nodes_of_next_to_no_mass_cost_steps_and_none_on_ordinary_ones_let_bodies_sink(monkeypatch):
    step, depth = on_shared_nodes(monkeypatch, LEAST_MASS)
    assert step > 0.3
    assert on_shared_nodes(monkeypatch, 0.0)[0] < 0.1 * step
    assert on_shared_nodes(monkeypatch, 0.8)[1] > 2.0 * depth


def test_blocks_of_facets_spare_comparisons_and_change_no_gap():
    loops = join([star(np.random.default_rng(2), (-0.93, 0.1), 1.0), block(-0.1, -0.5, 0.9, 0.5)])
    first = loops.body_first
    ends = (first[0], first[1], first[1], first[2], loops.outline, PLANE)
    assert {interpreted(minimum_gap, BLOCK=size)(*ends) for size in (1, 3, BLOCK, 100)} == {
        minimum_gap(*ends)
    }


def test_a_node_that_passes_the_middle_of_a_thin_body_in_a_step_is_seen():
    """Of a sheet of a tenth of a cell; with a larger least travel it is not looked for, a smaller one only
    costs time.
    """
    loops = join([block(-0.5, -0.05 * H, 0.5, 0.05 * H), block(-0.3, -0.02 * H, 0.3, 0.4)])
    loops.displacement[loops.body == 1] = (0.0, -0.1 * H)

    def seen(share):
        found = empty_candidates(len(loops.body), 1)
        lists = contact_kernels.lists_of(loops, H)
        assert lists.update()
        return interpreted(find_crossings)(
            share * H, loops.outline, lists.partners, lists.boxes, found, PLANE
        )

    face = int((loops.position[loops.body == 1, 1] == -0.02 * H).sum())
    assert seen(THIN) >= face
    assert seen(0.2) == 0


def free_impact(step, phase):
    """Steps that a contact of unit mass and stiffness lasts, and the share of its energy that it gains."""
    gap, speed, steps = step * phase, -1.0, 0
    while gap < 0.0 or steps == 0:
        if gap < 0.0:
            speed, steps = speed - step * gap, steps + 1
        gap += step * speed
    return steps, speed**2 - 1.0


def test_contacts_of_fewer_steps_gain_more_than_those_that_are_let_be():
    """At every step's length the fewest steps of all phases, and what the worst gains."""
    gains = {}
    for step in np.linspace(0.2, 1.4, 121):
        impacts = [free_impact(step, phase) for phase in np.linspace(0.0, 1.0, 100, endpoint=False)]
        fewest = min(steps for steps, _ in impacts)
        gains[fewest] = max(gains.get(fewest, 0.0), max(gain for _, gain in impacts))
    assert gains[FEWEST_STEPS - 1] > 0.5
    assert gains[FEWEST_STEPS] < 0.25
    assert gains[FEWEST_STEPS + 1] > 0.1  # a larger limit would warn of a third of that


def test_bodies_are_equal_up_to_a_millionth(monkeypatch):
    """Of equals each is slave once; rounding of a modulus, or of a sum of areas, must not choose a master."""
    values = np.array([1.0, 2.0, 2.0 * (1.0 + 1e-9), 2.0 * (1.0 + 1e-5)])
    assert parts.ranks_of(values).tolist() == [0, 1, 1, 2]
    monkeypatch.setattr(parts, "EQUAL", 0.0)
    assert parts.ranks_of(values).tolist() == [0, 1, 2, 3]
    monkeypatch.setattr(parts, "EQUAL", 1e-4)
    assert parts.ranks_of(values).tolist() == [0, 1, 1, 1]
