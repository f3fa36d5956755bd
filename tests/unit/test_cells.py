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


@pytest.mark.parametrize("text", ["0.5 cels", "-1 cells"])
def test_other_texts_are_refused(text: str) -> None:
    with pytest.raises(SceneError, match=r"bodies\.cylinder\.segment"):
        load_scene("rolling-cylinder-slip", set={"bodies.cylinder.segment": text})


@pytest.mark.parametrize("wrong", ["4 kg", 0, True])
def test_a_wrong_cell_size_is_all_that_is_reported(wrong: object) -> None:
    with pytest.raises(SceneError, match=r"^--set grid\.cell_size: [^\n]*$"):
        load_scene("rolling-cylinder-slip", set={"grid.cell_size": wrong})
