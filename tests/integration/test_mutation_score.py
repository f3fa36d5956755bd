"""The share of faults that the conformance kit finds; ``python tests/mutation_score.py`` prints each with its
check.
"""

import pytest

import mutation_score
from faulty_plugins.planted import MISSED, planted


def test_one_in_twenty_of_the_planted_faults_may_pass():
    assert len(MISSED) <= 0.05 * len(list(planted("contact")))


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_mutants_of_a_sound_material_are_caught():
    found = list(mutation_score.mutated_materials())
    missed = [each.fault for each in found if not each.check]
    assert mutation_score.share(found) >= 0.95, missed
