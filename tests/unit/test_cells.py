"""Lengths in cells follow the cell size."""

from __future__ import annotations

import pytest

from mpmfw.errors import SceneError
from mpmfw.scene import load_scene


@pytest.mark.parametrize("cell", [0.4, 0.2])
def test_one_override_refines_the_shipped_scene(cell: float) -> None:
    scene = load_scene("rolling-cylinder-slip", set={"grid.cell_size": cell})
    for body in scene.bodies.values():
        assert body.particles.size == pytest.approx(0.5 * cell, rel=1e-15)
        assert body.segment == pytest.approx(0.25 * cell, rel=1e-15)


def test_the_paper_s_sizes_are_exact() -> None:
    rings = load_scene("colliding-rings")
    assert [body.particles.size for body in rings.bodies.values()] == [0.0005, 0.0005]
    assert [body.segment for body in rings.bodies.values()] == [0.002, 0.002]


@pytest.mark.parametrize("text", ["0.5 cels", "cells", "-1 cells", "0 cells", "1 cell 2"])
def test_other_texts_are_refused(text: str) -> None:
    with pytest.raises(SceneError, match="bodies.cylinder.segment"):
        load_scene("rolling-cylinder-slip", set={"bodies.cylinder.segment": text})


def test_an_override_in_metres_wins() -> None:
    scene = load_scene("rolling-cylinder-slip", set={"bodies.plane.particles.size": "10 cm"})
    assert scene.bodies["plane"].particles.size == 0.1


def test_a_wrong_cell_size_is_what_is_reported() -> None:
    with pytest.raises(SceneError, match=r"grid\.cell_size"):
        load_scene("rolling-cylinder-slip", set={"grid.cell_size": "4 kg"})
