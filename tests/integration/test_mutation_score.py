"""The share of faults that the conformance kit finds; ``python tests/mutation_score.py`` prints each with its
check.
"""

from __future__ import annotations

import inspect
import textwrap

import pytest

import mutation_score
from faulty_plugins.load.faults import FAULTS as LOAD
from faulty_plugins.material.sound import Sound
from integration import (
    test_conformance_contact,
    test_conformance_material,
    test_conformance_shape,
    test_conformance_small,
)


def test_there_are_a_hundred_faults_and_of_those_by_hand_one_in_twenty_may_pass() -> None:
    """The tables are the parameters of the tests of each kit, which ask for all but those that are known to
    pass.
    """
    tables = (test_conformance_contact, test_conformance_material, test_conformance_shape)
    small = test_conformance_small.MODULES.values()
    by_hand = sum(len(table.FAULTS) for table in (*tables, *small)) + len(LOAD)
    by_rule = sum(
        len(list(mutation_score.mutants(textwrap.dedent(inspect.getsource(method)))))
        for method in (Sound.stress, Sound.energy_density)
    )
    assert by_hand + by_rule >= 200
    assert len(test_conformance_contact.MISSED) <= 0.05 * len(test_conformance_contact.FAULTS)


def test_a_rule_changes_one_thing_at_a_time() -> None:
    found = dict(mutation_score.mutants("def f(a):\n    return a + 0.5 * -a\n"))
    assert list(found) == [
        "line 2: a + 0.5 * -a → a - 0.5 * -a",
        "line 2: 0.5 * -a → 0.5 / -a",
        "line 2: 0.5 → 1.0",
        "line 2: -a → +a",
    ]
    assert found["line 2: -a → +a"] == "def f(a):\n    return a + 0.5 * +a"


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_mutants_of_a_sound_material_are_caught() -> None:
    found = list(mutation_score.mutated_materials())
    missed = [each.fault for each in found if not each.check]
    assert mutation_score.share(found) >= 0.95, missed
