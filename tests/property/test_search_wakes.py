"""The contact search sleeps while bodies are apart, and misses nothing: against brute force."""

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mpmfw.runs.simulation import Simulation
from scenes_for_tests import two_blocks, with_changes

pytestmark = pytest.mark.effects
RADIUS = 0.4


@functools.cache
def discs():
    """Two discs 0.8 m apart; only their outlines are moved, by hand."""
    scene = two_blocks("penalty", shape__method="linear", output={"gap": False})
    for name, x in (("left", -0.8), ("right", 0.8)):
        disc = {"type": "disc", "centre": [x, 0.0], "radius": RADIUS}
        scene = with_changes(scene, **{f"bodies__{name}__geometry": disc})
    return Simulation(scene)


def signed_gaps(points, outline):
    """Distance of every point to the nearest of all segments, negative inside."""
    start, end = outline, np.roll(outline, -1, axis=0)
    along = end - start
    offset = points[:, None] - start
    xi = np.clip((offset * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
    distance = np.linalg.norm(offset - xi[..., None] * along, axis=2).min(axis=1)
    below, above = start[:, 1], end[:, 1]
    y = points[:, 1, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = start[:, 0] + (y - below) / (above - below) * along[:, 0]
    crosses = ((below > y) != (above > y)) & (points[:, 0, None] < crossing)
    return np.where(crosses.sum(axis=1) % 2 == 1, -distance, distance)


def faces(sim, node, other):
    """Return True if the node is on the side of its disc that is near the other one."""
    surface = sim.state.surface
    own = surface.position[surface.of(int(surface.body[node]))].mean(axis=0)
    return bool((surface.position[node] - own) @ (other.mean(axis=0) - own) > 0.0)


def check_step(sim):
    """Search, and compare with brute force; return the deepest gap [m] and True if the search was awake."""
    surface, contact = sim.state.surface, sim.contact.detection
    awake = contact.near.update()
    contact.count = contact.search()
    outlines = [surface.position[surface.of(body)] for body in (0, 1)]
    deepest = np.inf
    for body, other in ((0, 1), (1, 0)):
        gaps = signed_gaps(outlines[body], outlines[other])
        deepest = min(deepest, gaps.min())
        for node, gap in zip(range(*surface.of(body).indices(surface.count)), gaps, strict=True):
            found = contact.candidates.gap[node][contact.candidates.facet[node] >= 0] if awake else []
            if gap < 0.0 and faces(sim, node, outlines[other]):
                assert awake
                assert np.isclose(found, gap, rtol=1e-9, atol=1e-12).any(), (node, gap, found)
            elif gap > 0.0:  # what the search finds beyond is where brute force has it, too
                assert all(value >= gap - 1e-12 for value in found if value > 0.0)
    boxes = [(o.min(axis=0), o.max(axis=0)) for o in outlines]
    apart = max((boxes[1][0] - boxes[0][1]).max(), (boxes[0][0] - boxes[1][1]).max())
    assert awake == (apart <= contact.radius)
    return float(deepest), awake


@settings(max_examples=60)
@given(
    seed=st.integers(0, 2**32 - 1),
    aside=st.floats(-0.7, 0.7),
    share=st.floats(0.1, 0.99),
    jitter=st.floats(0.0, 0.9),
)
def test_no_contact_is_missed_by_bodies_slower_than_a_segment_a_step(seed, aside, share, jitter):
    sim = discs()
    surface, rng = sim.state.surface, np.random.default_rng(seed)
    start = surface.position.copy()
    left, right = surface.of(0), surface.of(1)
    step = share * np.linalg.norm(start - start[surface.facets[:, 1]], axis=1).min()
    sim.contact.detection.candidates.facet.fill(-1)
    sim.contact.detection.candidates.gap.fill(np.inf)
    sim.contact.detection.count, awake = 0, False
    turn, centre = rng.uniform(0.0, 2.0 * np.pi), start[right].mean(axis=0)
    c, s = np.cos(turn), np.sin(turn)
    shift = np.array([0.0, aside])
    try:
        surface.position[right] = (start[right] - centre) @ np.array([[c, s], [-s, c]]) + centre + shift
        while True:
            deepest, now = check_step(sim)
            assert now or not awake or deepest > 0.0
            awake = awake or now
            towards = surface.position[left].mean(axis=0) - surface.position[right].mean(axis=0)
            if deepest < -step or np.linalg.norm(towards) < RADIUS:
                break
            motion = towards / np.linalg.norm(towards) + jitter * rng.uniform(-1.0, 1.0, 2)
            surface.position[right] += step * motion / max(1.0, float(np.linalg.norm(motion)))
        assert awake
    finally:
        surface.position[:] = start
