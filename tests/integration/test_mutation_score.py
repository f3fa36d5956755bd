"""The share of faults that the conformance kit finds; ``python tests/mutation_score.py`` prints each with its
check.
"""

import pytest

import mutation_score
from faulty_plugins.planted import MISSED, planted


def test_one_in_twenty_of_the_planted_faults_may_pass():
    assert len(MISSED) <= 0.05 * len(list(planted("contact")))


def test_a_rule_changes_one_thing_at_a_time():
    found = dict(mutation_score.mutants("def f(a):\n    return a + 0.5 * -a\n"))
    assert list(found) == [
        "line 2: a + 0.5 * -a → a - 0.5 * -a",
        "line 2: 0.5 * -a → 0.5 / -a",
        "line 2: 0.5 → 1.0",
        "line 2: -a → +a",
    ]
    assert found["line 2: -a → +a"] == "def f(a):\n    return a + 0.5 * +a"


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_mutants_of_a_sound_material_are_caught():
    found = list(mutation_score.mutated_materials())
    missed = [each.fault for each in found if not each.check]
    assert mutation_score.share(found) >= 0.95, missed
