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
    with pytest.raises(SceneError, match=r"bodies\.cylinder\.segment"):
        load_scene("rolling-cylinder-slip", set={"bodies.cylinder.segment": text})


def test_an_override_in_metres_wins() -> None:
    scene = load_scene("rolling-cylinder-slip", set={"bodies.plane.particles.size": "10 cm"})
    assert scene.bodies["plane"].particles.size == 0.1


@pytest.mark.parametrize("wrong", ["4 kg", 0, -0.4, True, "", [1]])
def test_a_wrong_cell_size_is_all_that_is_reported(wrong: object) -> None:
    with pytest.raises(SceneError, match=r"^--set grid\.cell_size: [^\n]*$"):
        load_scene("rolling-cylinder-slip", set={"grid.cell_size": wrong})


@pytest.mark.parametrize("key", ["bodies.plane.segment", "bodies.plane.particles.size"])
def test_what_is_expected_mentions_cells(key: str) -> None:
    with pytest.raises(SceneError, match=r"'2 mm' or '0\.5 cells'"):
        load_scene("rolling-cylinder-slip", set={key: "3 kg"})
