"""Lists of near facets: they give what the search gives while they hold, and say when they do not."""

from __future__ import annotations

import numpy as np
import pytest

from mpmfw.contact.surfaces.near_facets import SKIN, STALE, WORTH, NearFacets
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import SOFT

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


def searched(detection, grid):
    """What the search finds, without the lists."""
    detection.near.forget()
    detection._search(grid)
    return found(detection)


@pytest.fixture(params=[1, 2], ids=["two bodies", "three"])
def ready(request):
    """A detection whose lists were just made, the places of its nodes, and a random motion of each body of
    length 1.
    """
    sim = bodies(request.param)
    sim.advance(3)
    detection, grid = sim.contact.detection, sim.state.grid
    searched(detection, grid)
    assert detection.near.made
    rng = np.random.default_rng(5)
    body = sim.state.surface.body
    way = rng.normal(size=(len(sim.state.bodies), 3))[body]
    way += 0.3 * rng.normal(size=(len(body), 3))  # they deform as well
    return detection, grid, sim.state.surface.position, way / np.linalg.norm(way, axis=1).max()


def test_they_are_stale_when_bodies_have_moved_by_the_skin(ready):
    detection, _, position, way = ready
    position += SKIN_LENGTH * way
    assert detection.near.find(detection.candidates) == STALE
    assert not detection.near.made


def test_they_are_not_made_where_they_would_not_last(ready):
    detection = ready[0]
    detection.outline.displacement[:] = 0.0
    detection.outline.displacement[7, 1] = -0.49 * SKIN_LENGTH / WORTH
    assert detection.near.margin() == pytest.approx(SKIN_LENGTH)
    detection.outline.displacement[7, 1] = -0.51 * SKIN_LENGTH / WORTH
    assert detection.near.margin() == 0.0


def test_a_run_with_lists_is_one_without(monkeypatch):
    def run():
        sim = bodies()
        sim.advance(40)
        return sim.state.particles.position.copy(), sim.state.surface.position.copy()

    uses = []
    plain = NearFacets.find
    monkeypatch.setattr(NearFacets, "find", lambda self, to: uses.append(plain(self, to)) or uses[-1])
    with_lists = run()
    assert sum(count != STALE for count in uses) > 20
    monkeypatch.setattr(NearFacets, "margin", lambda _: 0.0)
    for ours, theirs in zip(with_lists, run(), strict=True):
        np.testing.assert_array_equal(ours, theirs)
