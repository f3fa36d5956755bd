"""The hard scenes as data: each one loads, as it stands and turned, and stays the same body there."""

import sys
from pathlib import Path

import pytest

from mpmfw.validation import Case, Method
from mpmfw.validation.suite import find_cases, suite_of
from python_files import module_of

SUITE = suite_of(Path("hard"))


@pytest.fixture(autouse=True)
def _on_the_path(monkeypatch):
    before = set(sys.modules)
    monkeypatch.syspath_prepend(str(SUITE.parent))
    monkeypatch.syspath_prepend(str(SUITE))
    yield
    for name in {path.stem for path in (*SUITE.glob("*.py"), *SUITE.parent.glob("*.py"))} - before:
        sys.modules.pop(name, None)


@pytest.mark.parametrize("folder", find_cases(SUITE), ids=lambda folder: folder.name)
def test_every_scene_loads_as_it_stands_and_turned(folder):
    (case,) = folder.glob("test_*.py")
    runs = module_of(case).every
    for places in zip(runs.places[::2], runs.places[1::2], strict=True):
        plain, turned = (runs.scene_at(Case(folder), place, Method("penalty", "cpdi")) for place in places)
        assert turned.grid.cell_size == pytest.approx(1.4 * plain.grid.cell_size)
        assert list(turned.bodies) == list(plain.bodies)
