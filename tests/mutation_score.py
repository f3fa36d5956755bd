"""How many faults the conformance kit finds: those planted by hand, and mutants of a sound material made by a
rule.

``python tests/mutation_score.py`` prints each fault with its check, and the score of each kind; below 95 % it
ends with 1. A planted fault counts as caught where the check that is meant for it fails; a mutant where any
check fails."""

import ast
import copy
import inspect
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parent))

import faulty_plugins.planted
from faulty_plugins.material import sound
from mpmfw_testing import checks_of, examine, subject_of

SWAPS = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
}  # fmt: skip


@dataclass(frozen=True)
class Found:
    """A fault, and the check that found it; empty if none did."""

    kind: str
    fault: str
    check: str


def planted():
    """The hand-planted faults of all kinds, each judged by the check that is meant for it."""
    for kind, fault, meant in faulty_plugins.planted.planted():
        checks = [check for check in checks_of(kind) if check.name == meant]
        (outcome,) = examine(subject_of(fault, kind), checks)
        yield Found(kind, fault.__name__, meant if outcome.status == "failed" else "")
    yield from (Found("contact", fault.__name__, "") for fault in faulty_plugins.planted.MISSED)


def mutants(source):
    """What was changed, and the source with that change: every + − × ÷ exchanged, every number doubled, every
    call's result negated, one at a time."""
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
    """Mutants of the sound material's stress and energy, with all checks."""
    names = ("stress", "energy_density")
    for name in names:
        source = textwrap.dedent(inspect.getsource(getattr(sound.Sound, name)))
        for what, text in mutants(source):
            module = ModuleType("mutant")
            module.__dict__.update(vars(sound))
            exec(text, module.__dict__)
            mutant = type("Mutant", (sound.Sound,), {"name": "mutant", name: module.__dict__[name]})
            if name == "stress":  # which outputs have as well
                mutant.cauchy_stress = _outputs_of(mutant)
            subject = subject_of(mutant, "material")
            outcomes = (examine(subject, [check])[0] for check in checks_of("material"))
            caught = next((outcome.check for outcome in outcomes if outcome.status == "failed"), "")
            yield Found("material", f"{name}, {what}", caught)


def _outputs_of(mutant):
    """The full stress of the same mutant: outputs that agree with the step hide nothing from the other
    checks.
    """

    def cauchy_stress(self, deformation_gradient):
        import numpy as np

        f = np.tile(np.eye(3), (len(deformation_gradient), 1, 1))
        dim = deformation_gradient.shape[1]
        f[:, :dim, :dim] = deformation_gradient
        return mutant.stress(self, f)

    return cauchy_stress


def share(found):
    """Of the faults, those that were caught."""
    return sum(bool(each.check) for each in found) / len(found)


def main():
    """Print each fault with its check as it is judged, then the score of each kind."""
    lowest = 1.0
    for title, faults in (("planted by hand", planted()), ("mutants by rule", mutated_materials())):
        found = {}
        for each in faults:
            print(f"{each.kind:10}{each.check or 'NOT CAUGHT':22}{each.fault}", flush=True)
            found.setdefault(each.kind, []).append(each)
        for kind, those in found.items():
            print(f"{title}, {kind}: {sum(bool(e.check) for e in those)} of {len(those)} caught")
            lowest = min(lowest, share(those))
        print()
    return 0 if lowest >= 0.95 else 1


if __name__ == "__main__":
    raise SystemExit(main())
