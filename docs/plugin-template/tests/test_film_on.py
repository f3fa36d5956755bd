# tests/test_film_on.py
from mpmfw_testing import contact_conformance

BY_DESIGN = {
    "coulomb-cone": "the film drags beside friction, in proportion to speed and area",
    "frictionless": "the film drags without friction, in proportion to speed and area",
    "similarity": "the option says no unit, so that the same number is another film in other units",
}


@contact_conformance("nodes+film(resistance=1e4)", expected_failures=BY_DESIGN)
def test_conformance_with_a_film(check):
    check()
