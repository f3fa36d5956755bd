"""Of many near bodies the nearest are kept, in any order; lists of near facets change no bit."""

import itertools

import numpy as np
import pytest

from contact_kernels import empty_candidates, join
from mpmfw.contact.surfaces import near_facets
from mpmfw.contact.surfaces.search import keep_nearest
from mpmfw.kernels import kernel
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import ball_on_a_box, two_blocks


@kernel
def offer(facets, outline, candidates):
    """Offer facets to node 0, in their order."""
    for m in facets:
        keep_nearest(0, m, 0.0, 1.0, outline, candidates, (1.0, 1.0))


def kept(order, gaps, slots):
    """Of bodies 1, 2, … whose tops are at the given gaps below a tip, those that are kept."""
    tip = [[0.0, 0.0], [0.1, 1.0], [-0.1, 1.0]]
    loops = join([tip, *([[-1.0, -1.0], [1.0, -1.0], [1.0, -gap], [-1.0, -gap]] for gap in gaps[1:])])
    found = empty_candidates(len(loops.body), slots)
    offer(np.array(order) * 4 + 1, loops.outline, found)
    bodies = loops.body[found.facet[0]].tolist()
    return dict(zip(bodies, found.gap[0].tolist(), strict=True))


def test_the_nearest_bodies_are_kept_in_any_order():
    gaps = [np.nan, 0.05, -0.035, 0.02, 0.06, -0.001]
    expected = {5: -0.001, 3: 0.02, 2: -0.035}
    for order in itertools.permutations(range(1, 6)):
        assert kept(order, gaps, 3) == expected


def test_a_run_with_lists_is_one_without(monkeypatch):
    """Lists that last until bodies have moved by the SKIN find what lists of every step find, to the bit."""
    made = []
    plain = near_facets.list_near
    monkeypatch.setattr(near_facets, "list_near", lambda *given: (made.append(1), plain(*given))[1])

    def run():
        made.clear()
        sim = Simulation(ball_on_a_box())
        sim.advance(20)
        return sim.state.particles.position.copy(), sim.state.surface.position.copy(), len(made)

    *with_lists, few = run()
    monkeypatch.setattr(near_facets, "measure_motion", lambda *_: np.inf)
    *without, many = run()
    assert few < 0.5 * many
    for ours, theirs in zip(with_lists, without, strict=True):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("make", [ball_on_a_box, two_blocks])
def test_lists_have_all_facets_of_the_other_body_whose_box_is_near(make):
    sim = Simulation(make("penalty") if make is two_blocks else make())
    sim.advance(3)
    lists, surface = sim.contact.detection.near, sim.state.surface
    lists.listed = False
    assert lists.update()
    corners = surface.position[surface.facets]
    lower, upper, x = corners.min(axis=1), corners.max(axis=1), surface.position[:, np.newaxis]
    away = np.linalg.norm(np.maximum(np.maximum(lower - x, x - upper), 0.0), axis=2)
    other = surface.body[:, np.newaxis] != surface.body[surface.facets[:, 0]]
    expected = [np.flatnonzero(row) for row in (away <= lists.radius + lists.skin) & other]
    listed = np.split(lists.near.facet[: lists.near.first[-1]], lists.near.first[1:-1])
    assert sum(map(len, expected)) > 0
    for ours, theirs in zip(listed, expected, strict=True):
        np.testing.assert_array_equal(np.sort(ours), theirs)


def test_of_facets_that_meet_at_the_closest_node_the_first_is_kept():
    scene = ball_on_a_box()
    upper = {"type": "box", "lower": [-0.5, -0.5, 0.0], "upper": [0.5, 0.5, 0.5]}
    scene["bodies"]["ball"] = {**scene["bodies"]["solid"], "geometry": upper}
    sim = Simulation(scene)
    sim.advance(2)
    surface, facet = sim.state.surface, sim.contact.detection.candidates.facet[:, 0]
    x, nodes = surface.position, np.flatnonzero(facet >= 0)
    inside = nodes[np.abs(x[nodes, :2]).max(axis=1) < 0.45]
    assert len(inside) > 20
    for s in inside:
        other = np.flatnonzero((surface.body != surface.body[s]) & (np.abs(x - x[s]).max(axis=1) < 1e-9))[0]
        assert facet[s] == surface.star[surface.star_first[other] : surface.star_first[other + 1]].min()
