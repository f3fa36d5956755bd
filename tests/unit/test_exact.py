"""Scenes whose motion is known, by the kind that they declare."""

from __future__ import annotations

import math
from typing import Any

import pytest

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.results.references import SlidingReference, declared


def sliding(width: float, height: float, friction: float, tilt: float = 60.0) -> Any:
    """A block on a slope."""
    scene = mpmfw.load_scene("sliding-block").to_mapping()
    block, plane = (scene["bodies"][name]["geometry"] for name in ("block", "plane"))
    low = plane["upper"][1]
    block["lower"], block["upper"] = [1.0, low], [1.0 + width, low + height]
    scene["grid"]["upper"][1] = max(float(scene["grid"]["upper"][1]), low + 2.0 * height)
    scene["gravity"]["tilt"] = f"{tilt} deg"
    scene["contact"]["friction"] = friction
    scene["contact"].pop("pairs", None)
    return mpmfw.load_scene(scene)


@pytest.mark.parametrize("friction", [0.1, 0.49])
def test_a_block_slides_as_long_as_the_normal_force_lies_within_its_base(friction: float) -> None:
    """Moments about the centre: N e = μ N H/2, with e ≤ W/2; the block stays upright for μ ≤ W/H."""
    known = declared(sliding(1.0, 2.0, friction))
    angle = math.radians(60.0)
    assert isinstance(known, SlidingReference)
    assert known.solution.acceleration == pytest.approx(
        10.0 * (math.sin(angle) - friction * math.cos(angle)), rel=1e-12
    )
    assert known.solution.angular_acceleration == 0.0


@pytest.mark.parametrize(
    ("width", "height", "friction"), [(1.0, 2.0, 0.51), (0.5, 2.0, 0.26), (0.8, 1.6, 0.6)]
)
def test_a_block_that_tips_over_has_no_closed_form(width: float, height: float, friction: float) -> None:
    with pytest.raises(SceneError, match="the block tips over"):
        declared(sliding(width, height, friction))
    assert isinstance(declared(sliding(height, width, friction)), SlidingReference)
