"""What must not change the motion: the bodies' order, whole-cell shifts, quarter turns, and contact that is
not there.

``LACKS`` names the strategies without a property, and why; there the check must fail, so that no entry grows
stale.
"""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial import cKDTree

from contact_scenes import (
    CELL,
    STRATEGIES,
    VARIANTS,
    apart,
    disc,
    expect,
    impact,
    run,
    scene,
    shifted,
    simulation,
    slider,
    three_meet,
    turned,
)

ORDER = "rows that say nearly the same share a force by their order, and within the tolerance"

ROUNDING = "a node at 0 ≤ ξ ≤ 1 of several segments meets one more or less by a rounding error"
CORNER = "of two facets as close to a node outside, the one with the lower index counts"
TURN = "rounding decides whether a normal has turned by less than what ends its regression"

LACKS: dict[str, dict[str, str]] = {
    "order of three": {"lcp-nodes": ORDER},
    "whole-cell shift": {"hamad2017": ROUNDING},
    "quarter turn": {
        "hamad2017, impact": ROUNDING,
        "barrier, impact": CORNER,
        "lcp, impact": ORDER,
        "nairn, slider": TURN,
    },
}

every_strategy = pytest.mark.parametrize("strategy", STRATEGIES)
every_variant = pytest.mark.parametrize("strategy", VARIANTS)
STEPS = 80


def in_other_order(mapping, order):
    """The same bodies, listed in another order."""
    return {**mapping, "bodies": {name: mapping["bodies"][name] for name in order}}


def with_direction(strategy, x, y):
    """Option of a specified normal; nothing for other strategies."""
    return {"direction": [x, y]} if strategy == "bardenhagen-specified" else {}


@pytest.mark.parametrize("strategy", [*VARIANTS, "nairn"])
@pytest.mark.parametrize(
    "make", [impact, slider, lambda: impact(right="soft", slide=0.5)], ids=["impact", "slider", "equal"]
)
def test_order_of_two_bodies_does_not_matter(strategy, make):
    mapping = make()
    swapped = in_other_order(mapping, ("right", "left"))
    first = run(simulation(strategy, mapping), 50)
    second = run(simulation(strategy, swapped, **with_direction(strategy, -1.0, 0.0)), 50)
    assert apart(first, second) < 1e-10


@pytest.mark.parametrize("strategy", [name for name in VARIANTS if name != "bardenhagen-specified"])
def test_order_of_three_bodies_that_meet_does_not_matter(strategy):
    def check(name):
        first = run(simulation(name, three_meet()), STEPS)
        for order in itertools.islice(itertools.permutations(("left", "right", "top")), 1, None, 2):
            second = run(simulation(name, three_meet(order)), STEPS)
            assert apart(first, second) < 1e-10

    expect(LACKS["order of three"], strategy, check)


@every_strategy
def test_whole_cell_shift_of_the_scene_changes_nothing(strategy):
    def check(name):
        mapping = impact(gravity={"vector": [1.0, -3.0]})
        first = run(simulation(name, mapping), STEPS)
        for cells in ((3, -2), (-4, 5)):
            second = run(simulation(name, shifted(mapping, cells)), STEPS)
            for body in second.centre:
                second.centre[body] -= CELL * np.array(cells)
            assert apart(first, second) < 1e-9

    expect(LACKS["whole-cell shift"], strategy, check)


@every_strategy
@pytest.mark.parametrize("make", [impact, slider])
def test_quarter_turn_of_the_scene_turns_the_motion(strategy, make):
    def check(_):
        mapping = make(gravity={"vector": [1.0, -3.0]})
        first = run(simulation(strategy, mapping), STEPS)
        second = run(simulation(strategy, turned(mapping), **with_direction(strategy, 0.0, 1.0)), STEPS)
        back = np.array([[0.0, 1.0], [-1.0, 0.0]])
        for body in second.centre:
            second.centre[body] = second.centre[body] @ back.T
            second.momentum[body] = second.momentum[body] @ back.T
        assert apart(first, second) < 1e-9

    expect(LACKS["quarter turn"], f"{strategy}, {make.__name__}", check)


@pytest.mark.parametrize("along", [(1.0, 0.0), (0.5**0.5, 0.5**0.5)], ids=["axis", "diagonal"])
@pytest.mark.parametrize("nodes", [96, 101])
def test_two_discs_that_meet_head_on_stay_mirror_images(nodes, along):
    """About the line of centres and about the plane between them, whether nodes meet head-on (96) or not
    (100).

    Asked for 96 to 109 nodes, outlines have 96, 100, 104, 108 or 112.
    """
    radius, along = 0.3, np.array(along)
    bodies = {
        name: disc((side * (radius + 0.005) * along).tolist(), radius, velocity=(-side * along).tolist())
        | {"segment": 2.0 * np.pi * radius / nodes}
        for name, side in (("left", -1.0), ("right", 1.0))
    }
    sim = simulation("penalty", scene(bodies), kappa=1.0)  # stiffer springs shake the discs: rounding grows
    motion = run(sim, 120)
    x, v = sim.state.particles.position, sim.state.particles.velocity
    assert np.abs(motion.impulse.sum(axis=0)).max() > 100.0
    for plane in (along, np.array([-along[1], along[0]])):
        mirror = np.eye(2) - 2.0 * np.outer(plane, plane)
        distance, image = cKDTree(x).query(x @ mirror)
        assert distance.max() < 1e-11 * CELL
        assert np.abs(v[image] - v @ mirror).max() < 1e-11 * np.abs(v).max()


@every_variant
def test_bodies_far_apart_move_as_if_there_were_no_contact(strategy):
    mapping = impact(gap=0.5, gravity={"vector": [0.0, -2.0]})
    for b in mapping["bodies"].values():
        b["rotation"] = "lumped"
    sim, reference = simulation(strategy, mapping), simulation("separate", mapping)
    run(sim, 40)
    run(reference, 40)
    for field in ("position", "velocity", "stress"):
        actual, expected = (getattr(s.state.particles, field) for s in (sim, reference))
        np.testing.assert_array_equal(actual, expected)
