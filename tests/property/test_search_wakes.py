"""The contact search sleeps while bodies are apart, and misses nothing: against brute force."""

import functools

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from mpmfw.runs.simulation import Simulation
from scenes_for_tests import two_blocks

RADIUS = 0.4


@functools.cache
def discs():
    """Two discs 0.8 m apart; only their outlines are moved, by hand."""
    scene = two_blocks("penalty", shape__method="linear", output={"gap": False})
    for name, x in (("left", -0.8), ("right", 0.8)):
        scene["bodies"][name]["geometry"] = {"type": "disc", "centre": [x, 0.0], "radius": RADIUS}
    return Simulation(scene)


def check_search(detection, surface):
    """Return whether the search was awake, and check that it lists all nodes inside the other disc."""
    awake = detection.near.update()
    detection.count = detection.search()
    position = surface.position
    loops = [shapely.LinearRing(position[surface.of(body)]) for body in (0, 1)]
    centres = [position[surface.of(body)].mean(axis=0) for body in (0, 1)]
    for node, body in enumerate(surface.body):
        point, towards = shapely.Point(position[node]), centres[1 - body] - centres[body]
        facing = (position[node] - centres[body]) @ towards > 0.0
        if facing and shapely.Polygon(loops[1 - body]).contains(point):
            assert awake
            gaps = detection.candidates.gap[node][detection.candidates.facet[node] >= 0]
            assert np.isclose(gaps, -loops[1 - body].distance(point), rtol=1e-9, atol=1e-12).any()
    lower, upper = zip(*(np.split(np.array(loop.bounds), 2) for loop in loops), strict=True)
    apart = max((lower[1] - upper[0]).max(), (lower[0] - upper[1]).max())
    assert awake == (apart <= detection.radius)
    return awake


@settings(max_examples=20)
@given(
    seed=st.integers(0, 2**32 - 1),
    aside=st.floats(-0.7, 0.7),
    share=st.floats(0.3, 0.99),
    jitter=st.floats(0.0, 0.9),
)
def test_no_contact_is_missed_by_bodies_slower_than_a_segment_a_step(seed, aside, share, jitter):
    sim = discs()
    surface, detection, rng = sim.state.surface, sim.contact.detection, np.random.default_rng(seed)
    start, left, right = surface.position.copy(), surface.of(0), surface.of(1)
    step = share * np.linalg.norm(start - start[surface.facets[:, 1]], axis=1).min()
    awake, towards = [], np.array([1.0, 0.0])
    try:
        surface.position[right] += [0.0, aside]
        while np.linalg.norm(towards) > 1.6 * RADIUS:
            awake.append(check_search(detection, surface))
            towards = surface.position[left].mean(axis=0) - surface.position[right].mean(axis=0)
            motion = towards / np.linalg.norm(towards) + jitter * rng.uniform(-1.0, 1.0, 2)
            surface.position[right] += step * motion / max(1.0, float(np.linalg.norm(motion)))
        assert not awake[0]
        assert awake[-1]
    finally:
        surface.position[:] = start
