"""The problems of "Which contact for my problem?" give what the page says."""

import math
from pathlib import Path

import pytest

from python_files import module_of

SCRIPT = Path(__file__).resolve().parents[2] / "docs" / "make_choosing.py"


@pytest.fixture(scope="module")
def choosing():
    return module_of(SCRIPT)


@pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")
@pytest.mark.parametrize(
    ("scene", "contact", "expected"),
    [
        ("press-fit", "penalty", 0.983),
        ("press-fit", "lcp(recovery=0.1)", 1.0),
        ("press-fit", "lcp", 0.0),
        # The case of validation runs its scene
        pytest.param("footing", "penalty", 1.0945, marks=pytest.mark.long),
        ("column-collapse", "bardenhagen(criterion=position,normal=master)", 2.50),
        pytest.param("column-collapse", "penalty", math.nan, marks=pytest.mark.long),
    ],
)
def test_a_problem_has_the_result_of_the_page(choosing, scene, contact, expected):
    value, _ = choosing.result(scene, contact)
    assert value == pytest.approx(expected, abs=0.02, nan_ok=True)
