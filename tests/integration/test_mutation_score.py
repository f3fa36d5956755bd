"""Mutants of a sound material, made by a rule, and what the conformance kit finds of them.

Faults planted by hand are in test_conformance."""

import ast
import copy
import inspect
import textwrap

import numpy as np
import pytest

from faulty_plugins.contact.keeping import HalfTheWork
from faulty_plugins.material import sound
from kit_for_tests import check_of
from mpmfw_testing import checks_of, examine, subject_of
from mpmfw_testing.examination import examine_one

SWAPS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}


def mutants(source):
    """Yield each change and the changed source: + − × ÷ exchanged, a number doubled, a sign lost."""
    tree = ast.parse(source)
    for index, node in enumerate(ast.walk(tree)):
        changed = copy.deepcopy(tree)
        twin = list(ast.walk(changed))[index]
        if isinstance(node, ast.BinOp) and type(node.op) in SWAPS:
            twin.op = SWAPS[type(node.op)]()
        elif isinstance(node, ast.Constant) and type(node.value) is float:
            twin.value = 2.0 * node.value + (node.value == 0.0)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            twin.op = ast.UAdd()
        else:
            continue
        yield f"line {node.lineno}: {ast.unparse(node)} → {ast.unparse(twin)}", ast.unparse(changed)


def mutated_materials():
    """Mutants of the sound material's stress and energy."""
    for name in ("stress", "energy_density"):
        for what, text in mutants(textwrap.dedent(inspect.getsource(getattr(sound.Sound, name)))):
            names = dict(vars(sound))
            exec(text, names)
            mutant = type("Mutant", (sound.Sound,), {"name": "mutant", name: names[name]})
            if name == "stress":  # outputs that agree with the step hide nothing from the other checks
                mutant.cauchy_stress = lambda self, f: self.stress(in_space(f))
            yield f"{name}, {what}", mutant


def in_space(f):
    """F (n, 3, 3) of the plane or of space."""
    whole = np.tile(np.eye(3), (len(f), 1, 1))
    whole[:, : f.shape[1], : f.shape[1]] = f
    return whole


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_mutants_of_a_sound_material_are_caught():
    checks = checks_of("material")
    outcomes = {
        what: (examine(subject_of(mutant, "material"), [check])[0].status for check in checks)
        for what, mutant in mutated_materials()
    }
    missed = [what for what, statuses in outcomes.items() if "failed" not in statuses]
    assert len(missed) <= 0.05 * len(outcomes), missed


def test_the_fault_that_is_missed():
    """The slip of a face is not measured, and sound laws report half to all of friction times the slip."""
    found = examine_one(subject_of(HalfTheWork, "contact"), check_of("contact", "reports"))
    assert found.status == "passed", "planted.py may list it"
