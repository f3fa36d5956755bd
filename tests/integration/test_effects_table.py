"""Exactly the arrays, hooks, modules and variables of the effects that a scene calls for, scene by scene."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

import mpmfw
from effects_table import CASES, LEAST, Case, arrays_of, hooks_of
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import with_changes

pytestmark = pytest.mark.effects
each_case = pytest.mark.parametrize("case", CASES.values(), ids=CASES)

#: Steps after which the two blocks have met.
STEPS = 12

#: Modules of effects that come with :class:`Simulation`, whatever the scene.
WITH_THE_PACKAGE = {"mpmfw.effects.remedies", "mpmfw.effects.settling"}

#: One process for all scenes, which forgets plug-ins and effects in between, so that each scene imports its
#: own anew.
RUN = """
import json, sys
from mpmfw.runs.simulation import Simulation
parents = ("mpmfw_contact.", "mpmfw_load.", "mpmfw_shape.", "mpmfw_material.", "mpmfw.effects.")
parents += tuple("mpmfw.contact." + name for name in ("nodes", "normal_bias", "shared_nodes", "springs", "surfaces"))
own = lambda: [module for module in sys.modules if module.startswith(parents)]
found = {"": own()}
for name, scene in json.load(sys.stdin).items():
    Simulation(scene).advance(2)
    found[name] = own()
    if "sleep" not in scene:
        rare = ("mpmfw.runs.sleeping", "mpmfw.step.threads")
        assert not set(rare) & set(sys.modules), name
    for module in own() + ["mpmfw.runs.sleeping"]:
        sys.modules.pop(module, None)
print(json.dumps(found))
"""  # noqa: E501


def modules_of(*names: str) -> dict[str, list[str]]:
    """Modules of plug-ins and effects that scenes import in one process, which is fresh for the first."""
    scenes = json.dumps({name: CASES[name].scene for name in names})
    command = [sys.executable, "-c", RUN]
    done = subprocess.run(command, input=scenes, capture_output=True, text=True, check=True, timeout=300)
    return dict(json.loads(done.stdout))


@pytest.fixture(scope="module")
def imported() -> dict[str, list[str]]:
    """Modules of plug-ins and effects that each scene of the table imports."""
    return modules_of(*CASES)


@each_case
def test_exactly_the_arrays(case: Case) -> None:
    sim = Simulation(case.scene)
    sim.advance(STEPS)
    assert arrays_of(sim) == case.expected("arrays")


@each_case
def test_hooks_of_exactly_the_plug_ins(case: Case) -> None:
    sim = Simulation(case.scene)
    hooks = hooks_of(sim)
    assert {who for _, who in hooks} == case.expected("owners")
    sim.start()
    assert hooks_of(sim) == hooks  # settling leaves nothing behind


@pytest.mark.parametrize("name", CASES)
def test_exactly_the_modules(name: str, imported: dict[str, list[str]]) -> None:
    own = WITH_THE_PACKAGE if name == next(iter(CASES)) else set()
    assert set(imported[name]) - own == CASES[name].expected("modules")
    assert set(imported[""]) <= LEAST.modules | WITH_THE_PACKAGE


@pytest.mark.parametrize("name", ["frictional", "contact by velocity", "cpdi"])
def test_exactly_the_modules_in_a_fresh_process(name: str) -> None:
    assert set(modules_of(name)[name]) - WITH_THE_PACKAGE == CASES[name].expected("modules")


@each_case
def test_exactly_the_variables_and_the_plan(case: Case) -> None:
    tree = mpmfw.run({**case.scene, "time": {"end": 1e-3, "output_interval": 1e-3}})
    assert set(tree["series"].data_vars) == case.expected("series")
    assert ("surface" in tree.children) == ("surface" in case.expected("owners"))
    assert "contact" not in tree.children  # no plug-in writes fields of a pair
    stored, effects = json.loads(tree.attrs["effects"]), Simulation(case.scene).effects
    assert stored == [{"name": e.name, "on": e.on, "reason": e.reason} for e in effects]
    assert all(effect.reason for effect in effects)


#: Effects of the plan that are on in every scene of the table.
ALWAYS = {"energies", "von Mises stress"}
_TOUCHED = {"contact", "velocity field per body", "surfaces", "surface map mass_weighted", "surface frames"}
_TURNING = {"rotation of left: spin", "rotation of right: spin"}
PLANNED = {
    "one body": set(),
    "two bodies apart": {"friction", *_TOUCHED, *_TURNING},
    "frictionless": {"contact search", *_TOUCHED, *_TURNING},
    "frictional": {"contact search", "friction", *_TOUCHED, *_TURNING},
    "gravity": {"gravity"},
    "settled": {"settling", "gravity", "prescribed sides"},
    "ledger": {"energy ledger"},
    "pressure": {"loads on sides", "surfaces", "surface map mass_weighted", "surface frames"},
    "least gap": {"least gap", *_TOUCHED, *_TURNING},
    "moving domains": {"domain tracking", "affine field", "transported affine gradient"},
    "apic": {"affine field", "affine moments"},
    "aflip": {"affine field", "transported affine gradient"},
}


@pytest.mark.parametrize("name", PLANNED)
def test_the_plan_is_on_where_the_scene_calls_for_it(name: str) -> None:
    effects = Simulation(CASES[name].scene).effects
    assert len({effect.name for effect in effects}) == len(effects)
    assert {effect.name for effect in effects if effect.on} == ALWAYS | PLANNED[name]
    if name == "two bodies apart":
        (reason,) = [effect.reason for effect in effects if effect.name == "contact search"]
        assert "no two bodies' boxes are within its reach" in reason


def test_structures_of_absent_effects_are_none_and_energies_are_left_out() -> None:
    state = Simulation(CASES["one body"].scene).state
    assert (state.surface, state.particles.affine, state.particles.moment) == (None, None, None)
    tree = mpmfw.run(with_changes(CASES["apic"].scene, output={"energy": False}))
    assert not {name for name in tree["series"].data_vars if str(name).endswith("energy")}


def test_the_ledger_says_which_works_there_are() -> None:
    case = CASES["settled"].scene
    terms = {e.name: e.on for e in Simulation({**case, "output": {"ledger": True}}).effects}
    works = {name.removeprefix("ledger: "): on for name, on in terms.items() if name.startswith("ledger: ")}
    assert works == {
        "gravity work": True,
        "external work": True,
        "contact work": False,
        "inertia work": False,
    }
