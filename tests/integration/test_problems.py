"""The problems of "Which contact for my problem?" give what the page says."""

import importlib.util
import math
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "docs" / "make_choosing.py"


@pytest.fixture(scope="module")
def choosing():
    spec = importlib.util.spec_from_file_location("docs_make_choosing", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")
@pytest.mark.parametrize(
    ("scene", "contact", "expected"),
    [
        ("press-fit", "penalty", 0.983),
        ("press-fit", "lcp(recovery=0.1)", 1.0),
        ("press-fit", "lcp", 0.0),
        ("footing", "penalty", 1.10),
        ("column", "bardenhagen(criterion=position,normal=master)", 2.37),
        ("column", "penalty", math.nan),
    ],
)
def test_a_problem_has_the_result_of_the_page(choosing, scene, contact, expected):
    value, _ = choosing.result(scene, contact)
    assert value == pytest.approx(expected, abs=0.02, nan_ok=True)
