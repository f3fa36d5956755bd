"""Exactly the arrays, hooks, modules and variables of the effects that a scene calls for, scene by scene."""

import json
import subprocess
import sys
from collections import Counter

import pytest

import mpmfw
from effects_table import CASES, LEAST, arrays_of, hooks_of
from mpmfw.contact import springs
from mpmfw.contact.surfaces import detection, near_facets, surface_rows
from mpmfw.plugin.hooks import BoundHooks
from mpmfw.runs.simulation import Simulation
from mpmfw_contact import penalty
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


@pytest.fixture(scope="module")
def imported():
    """Modules of plug-ins and effects that each scene of the table imports, in a process of their own."""
    scenes = json.dumps({name: case.scene for name, case in CASES.items()})
    done = subprocess.run(
        [sys.executable, "-c", RUN], input=scenes, capture_output=True, text=True, check=True, timeout=300
    )
    return dict(json.loads(done.stdout))


@each_case
def test_exactly_the_arrays_and_hooks(case):
    sim = Simulation(case.scene)
    hooks = hooks_of(sim)
    assert {who for _, who in hooks} == case.expected("owners")
    sim.advance(STEPS)
    assert hooks_of(sim) == hooks  # settling leaves nothing behind
    assert arrays_of(sim) == case.expected("arrays")


@pytest.mark.parametrize("name", CASES)
def test_exactly_the_modules(name, imported):
    own = WITH_THE_PACKAGE if name == next(iter(CASES)) else set()
    assert set(imported[name]) - own == CASES[name].expected("modules")
    assert set(imported[""]) <= LEAST.modules | WITH_THE_PACKAGE


@each_case
def test_exactly_the_variables_and_the_plan(case):
    tree = mpmfw.run({**case.scene, "time": {"end": 1e-3, "output_interval": 1e-3}})
    assert set(tree["series"].data_vars) == case.expected("series")
    assert ("surface" in tree.children) == ("surface" in case.expected("owners"))
    assert "contact" not in tree.children  # no plug-in writes fields of a pair
    stored, effects = json.loads(tree.attrs["effects"]), Simulation(case.scene).effects
    assert stored == [{"name": e.name, "on": e.on, "reason": e.reason} for e in effects]
    assert all(effect.reason for effect in effects)


def test_structures_of_absent_effects_are_none_and_energies_are_left_out():
    state = Simulation(CASES["one body"].scene).state
    assert (state.surface, state.particles.affine, state.particles.moment) == (None, None, None)
    tree = mpmfw.run(with_changes(CASES["apic"].scene, output={"energy": False}))
    assert not {name for name in tree["series"].data_vars if str(name).endswith("energy")}


COUNTED = 5


def _spy(calls, key, function):
    def spy(*arguments):
        calls[key] += 1
        return function(*arguments)

    return spy


#: Hooks that one step of each scheme calls, and how often.
USL = Counter(
    [
        *("interpolate", "detect", "after_momentum_projection", "add_nodal_force", "after_momentum_update"),
        *("correct_inertia", "constrain_momentum", "after_velocity_gradient", "advect"),
        *("update_particle_domains", "update_stress", "end_step"),
    ]
)
#: The velocity that strains is projected once more, or before the forces.
PER_STEP = {"usl": USL, **dict.fromkeys(("musl", "usf"), USL + Counter(["constrain_momentum"]))}


def counted(sim):
    """Count the calls of every hook's implementations from now on, by hook and plug-in."""
    calls, names = Counter(), {id(plugin): name for name, plugin in sim.registry.plugins.items()}
    for hook in sim.hook_callers():
        for implementation in sim.registry.implementations[hook]:
            implementation.function = _spy(
                calls, (hook, names[id(implementation.plugin)]), implementation.function
            )
    sim.hook = BoundHooks(sim.registry, sim.clock)
    return calls


@pytest.mark.parametrize("name", ["frictional", "settled", "ledger", "self-contact"])
@pytest.mark.parametrize("scheme", PER_STEP)
def test_every_hook_is_called_so_often_a_step(scheme, name):
    sim = Simulation(with_changes(CASES[name].scene, stepping__scheme=scheme))
    sim.advance(0, [].append)  # from the first output on the ledger runs
    dt, calls = sim.stable_step(), counted(sim)
    for _ in range(COUNTED):
        sim.step(dt)
    times = PER_STEP[scheme] + Counter({"interpolate_surface": int(sim.state.surface is not None)})
    assert calls == {(hook, who): COUNTED * times[hook] for hook, who in hooks_of(sim) if times[hook]}


def test_diagnostics_are_called_at_outputs_alone():
    times = {"end": 4e-3, "output_interval": 2e-3}
    sim = Simulation(with_changes(CASES["stability of contact"].scene, time=times))
    calls = counted(sim)
    sim._recorder.hook = sim.hook
    sim.run()
    assert sim.state.steps > 3
    for plugin in ("body_series", "von_mises", "penalty", "time_step_series", "contact_events"):
        assert calls["diagnostics", plugin] == 3


#: Kernels of the search and of the force, each behind the one before it.
KERNELS = {
    penalty: ("set_springs", "spring_forces", "add_losses"),
    springs: ("add_friction",),
    detection: ("assemble", "find_candidates"),
    surface_rows: ("bound_couplings", "spread_forces", "move_rows"),
    near_facets: ("near_boxes", "list_near", "measure_motion"),
}


def test_bodies_apart_cost_a_comparison_of_boxes(monkeypatch):
    calls = Counter()
    for module, names in KERNELS.items():
        for name in names:
            monkeypatch.setattr(module, name, _spy(calls, name, getattr(module, name)))
    Simulation(CASES["two bodies apart"].scene).advance(COUNTED)
    assert calls == {"near_boxes": COUNTED}
