"""A reference that the validation computes: the elastic sphere."""

import importlib
import sys
from pathlib import Path

import pytest


@pytest.fixture
def elastic(monkeypatch):
    """The elastic sphere of the case sphere-impacts."""
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[2] / "validation" / "sphere-impacts"))
    yield importlib.import_module("elastic")
    sys.modules.pop("elastic", None)


@pytest.mark.parametrize("poisson", [0.2, 0.3, 0.4])
def test_an_elastic_sphere_slides_throughout_beyond_the_limit_and_not_below(elastic, poisson):
    limit, ratio = elastic.sliding_from(poisson), elastic.ratio(poisson)
    for psi in (limit + 0.1, limit + 1.5, limit + 4.0):
        assert psi * elastic.rebound(psi / ratio, poisson) == pytest.approx(psi - limit - 1.0, abs=1e-6)
    psi = limit - 0.5
    assert psi * elastic.rebound(psi / ratio, poisson) > psi - limit - 1.0 + 1e-3
