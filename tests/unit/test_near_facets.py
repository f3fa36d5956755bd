"""Where more bodies are near than there are slots, the nearest are kept, whatever the order of search."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from contact_kernels import empty_candidates
from mpmfw.contact.surfaces import near_facets
from mpmfw.contact.surfaces.near_facets import SKIN, VerletList
from mpmfw.contact.surfaces.search import keep_nearest
from mpmfw.kernels import kernel
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import SOFT


@kernel
def offer(order, gaps, share, normal, candidates):
    """Offer bodies 1, 2, … with the given gaps to node 0, in the given order."""
    for body in order:
        keep_nearest(0, body, body, gaps[body], share, normal, candidates, (1.0, 1.0))


def kept(order, gaps, slots):
    candidates = empty_candidates(1, slots)
    offer(np.array(order), np.array(gaps), np.array([0.5, 0.5]), np.array([0.0, 1.0]), candidates)
    return {int(body): float(gap) for body, gap in zip(candidates.master[0], candidates.gap[0], strict=True)}


def test_the_nearest_bodies_are_kept_in_any_order():
    gaps = [np.nan, 0.05, -0.035, 0.02, 0.06, -0.001]
    expected = {5: -0.001, 3: 0.02, 2: -0.035}
    for order in itertools.permutations(range(1, 6)):
        assert kept(order, gaps, 3) == expected


def test_of_equally_near_bodies_the_lower_index_is_kept():
    gaps = [np.nan, 0.02, 0.02, 0.02, -0.02]
    for order in itertools.permutations(range(1, 5)):
        assert set(kept(order, gaps, 3)) == {1, 2, 3}


H = 0.25
SKIN_LENGTH = SKIN * H


def bodies(slots=1):
    """A ball a hundredth of a cell over a box, and a second one beside it where there are more slots."""
    block = {"type": "box", "lower": [-1.0, -1.0, -1.0], "upper": [1.0, 1.0, 0.0]}
    ball = {"type": "ball", "centre": [0.0, 0.0, 0.5 + 0.01 * H], "radius": 0.5}
    made = {"block": block, "ball": ball}
    if slots > 1:
        made["other"] = {"type": "ball", "centre": [0.72, 0.72, 0.5 + 0.02 * H], "radius": 0.5}
    return Simulation(
        {
            "grid": {"cell_size": H, "lower": [-2.0] * 3, "upper": [2.0] * 3},
            "time": {"end": 1.0, "output_interval": 1.0},
            "shape": {"method": "cpdi"},
            "contact": {"method": "penalty"},
            "materials": {"soft": SOFT},
            "gravity": {"vector": [1.0, 0.5, -9.0]},
            "bodies": {
                name: {
                    "material": "soft",
                    "geometry": geometry,
                    "particles": {"size": 0.5 * H},
                    "segment": 0.4 * H,
                }
                for name, geometry in made.items()
            },
        }
    )


def found(detection):
    """Facets and gaps of all nodes that have a candidate."""
    candidates = detection.candidates
    return candidates.facet.copy(), np.where(candidates.facet >= 0, candidates.gap, 0.0)


def searched(detection):
    """What the search finds with lists that are just made."""
    detection.near.forget()
    detection._search()
    return found(detection)


@pytest.fixture(params=[1, 2], ids=["two bodies", "three"])
def ready(request):
    """A detection whose lists were just made, its nodes' places, and a random motion of length 1."""
    sim = bodies(request.param)
    sim.advance(3)
    detection = sim.contact.detection
    searched(detection)
    rng = np.random.default_rng(5)
    body = sim.state.surface.body
    way = rng.normal(size=(len(sim.state.bodies), 3))[body]
    way += 0.3 * rng.normal(size=(len(body), 3))  # they deform as well
    return detection, sim.state.surface.position, way / np.linalg.norm(way, axis=1).max()


@pytest.mark.parametrize("part", [0.0, 0.05, 0.3, 0.5])
def test_old_lists_give_what_new_ones_give(ready, part):
    """Each of two bodies moves by that part of the skin."""
    detection, position, way = ready
    listed_at = detection.near.listed_at.copy()
    position += part * SKIN_LENGTH * way
    assert detection._search() == (detection.candidates.facet >= 0).sum() > 20
    listed = found(detection)
    np.testing.assert_array_equal(detection.near.listed_at, listed_at)
    for ours, theirs in zip(listed, searched(detection), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_lists_are_made_anew_when_bodies_have_moved_by_the_skin(ready):
    detection, position, way = ready
    position += SKIN_LENGTH * way
    detection._search()
    np.testing.assert_array_equal(detection.near.listed_at, position)


def test_a_run_with_lists_is_one_without(monkeypatch):
    def run():
        sim = bodies()
        sim.advance(40)
        return sim.state.particles.position.copy(), sim.state.surface.position.copy()

    made = []
    plain = VerletList._list
    monkeypatch.setattr(VerletList, "_list", lambda self: made.append(plain(self)))
    with_lists = run()
    assert len(made) < 20
    monkeypatch.setattr(near_facets, "measure_motion", lambda *_: np.inf)
    for ours, theirs in zip(with_lists, run(), strict=True):
        np.testing.assert_array_equal(ours, theirs)
