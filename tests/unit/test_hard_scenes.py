"""The hard scenes as data: each one loads, as it stands and turned, and stays the same body there."""

import importlib.util
import math
import sys

import numpy as np
import pytest

from mpmfw.validation import Case, Method
from mpmfw.validation.suite import find_cases, shipped_suite

SUITE = shipped_suite() / "hard"


@pytest.fixture(autouse=True)
def _on_the_path(monkeypatch):
    before = set(sys.modules)
    monkeypatch.syspath_prepend(str(SUITE.parent))
    monkeypatch.syspath_prepend(str(SUITE))
    yield
    for name in {path.stem for path in (*SUITE.glob("*.py"), *SUITE.parent.glob("*.py"))} - before:
        sys.modules.pop(name, None)


def load(folder):
    """Return the test module of a case."""
    (file,) = folder.glob("test_*.py")
    spec = importlib.util.spec_from_file_location(f"case_{folder.name}", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("folder", find_cases(SUITE), ids=lambda folder: folder.name)
def test_every_scene_loads_as_it_stands_and_turned(folder):
    runs = load(folder).every
    assert len(runs.versions) == 2
    for place in runs.places:
        plain, turned = (
            runs.scene_at(Case(folder), place, version, Method("penalty", "cpdi"))
            for version in (runs.versions[0], runs.versions[-1])
        )
        assert turned.grid.cell_size == pytest.approx(1.4 * plain.grid.cell_size)
        assert list(turned.bodies) == list(plain.bodies)


def test_a_turned_place_is_a_motion_of_the_whole():
    placing = importlib.import_module("placing")
    scene = {
        "grid": {"cell_size": 0.1, "lower": [-1.0, -1.0], "upper": [1.0, 1.0]},
        "gravity": {"table": [[0.0, 0.0, -9.0], [1.0, 3.0, -9.0]]},
        "loads": {"push": {"force": [2.0, 0.0]}},
        "bodies": {
            "disc": {
                "geometry": {"type": "disc", "centre": [0.5, 0.0], "radius": 0.2},
                "velocity": [1.0, 0.0],
            },
            "box": {
                "geometry": {"type": "rectangle", "lower": [0.1, 0.4], "upper": [0.3, 0.5], "angle": "5 deg"}
            },
            "floor": {
                "geometry": {"type": "polygon", "points": [[-1, -1], [1, -1], [1, -0.5], [-1, -0.5]]},
                "sides": [{"side": "bottom", "fixed": True}],
            },
        },
    }
    found = placing.placed(scene, shift=(1.0, 2.0), turn=90)
    disc, box, floor = (found["bodies"][name]["geometry"] for name in ("disc", "box", "floor"))
    assert disc["centre"] == pytest.approx([0.1, 0.7])
    assert found["bodies"]["disc"]["velocity"] == pytest.approx([0.0, 1.0])
    assert np.add(box["lower"], box["upper"]) / 2 == pytest.approx([-0.45 + 0.1, 0.2 + 0.2])
    assert box["angle"] == pytest.approx(math.radians(95))
    assert np.array(found["gravity"]["table"]) == pytest.approx(np.array([[0, 9, 0], [1, 9, 3]]))
    assert found["loads"]["push"]["force"] == pytest.approx([0.0, 2.0])
    assert len(floor["points"]) == 6
    assert placing.placed(scene)["bodies"]["disc"] == scene["bodies"]["disc"]
