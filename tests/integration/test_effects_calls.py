"""How often hooks and the kernels of contact are called."""

from collections import Counter

import pytest

from effects_table import CASES, hooks_of
from mpmfw.contact import rows, springs
from mpmfw.contact.surfaces import detection, near_facets
from mpmfw.plugin.hooks import BoundHooks
from mpmfw.runs.simulation import Simulation
from mpmfw_contact import penalty
from scenes_for_tests import with_changes

pytestmark = pytest.mark.effects
STEPS = 5

#: Hooks that one step of each scheme calls, and how often.
USL = Counter(
    {
        **dict.fromkeys(("interpolate", "detect", "after_momentum_projection", "add_nodal_force"), 1),
        **dict.fromkeys(("after_momentum_update", "correct_inertia", "constrain_momentum"), 1),
        "after_velocity_gradient": 1,
        **dict.fromkeys(("advect", "update_particle_domains", "update_stress", "end_step"), 1),
    }
)
PER_STEP = {
    "usl": USL,
    "musl": USL + Counter({"constrain_momentum": 1}),  # the velocity of the strain, projected once more
    "usf": USL + Counter({"constrain_momentum": 1}),  # the velocity that strains before the forces
}


def counted(sim):
    """Count the calls of every hook's implementations from now on, by hook and plug-in."""
    calls = Counter()
    for hook in sim.hook_callers():
        for implementation in getattr(sim.manager.hook, hook).get_hookimpls():
            implementation.function = _spy(calls, (hook, implementation.plugin_name), implementation.function)
    sim.hook = BoundHooks(sim.manager, sim.clock)
    return calls


def _spy(calls, key, function):
    def spy(*arguments):
        calls[key] += 1
        return function(*arguments)

    return spy


#: The other schemes differ in the boundary conditions alone.
ALL_SCHEMES = ("frictional", "settled", "ledger")
RUNS = [("usl", name) for name in CASES] + [(s, name) for s in ("musl", "usf") for name in ALL_SCHEMES]


@pytest.mark.parametrize(("scheme", "name"), RUNS)
def test_every_hook_is_called_so_often_a_step(scheme, name):
    case = CASES[name]
    sim = Simulation(with_changes(case.scene, stepping__scheme=scheme))
    sim.advance(0, [].append)  # from the first output on the ledger runs
    dt, calls = sim.stable_step(), counted(sim)
    for _ in range(STEPS):
        sim.step(dt)
    times = PER_STEP[scheme] + Counter({"interpolate_surface": int(sim.state.surface is not None)})
    assert calls == {(hook, who): STEPS * times[hook] for hook, who in hooks_of(sim) if times[hook]}


def test_diagnostics_are_called_at_outputs_alone():
    sim = Simulation(
        with_changes(CASES["stability of contact"].scene, time__end=4e-3, time__output_interval=2e-3)
    )
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
    rows: ("couplings", "add_row_forces"),
    near_facets: ("near_boxes", "list_near", "measure_motion"),
}


def test_bodies_apart_cost_a_comparison_of_boxes(monkeypatch):
    calls = Counter()
    for module, names in KERNELS.items():
        for name in names:
            monkeypatch.setattr(module, name, _spy(calls, name, getattr(module, name)))
    Simulation(CASES["two bodies apart"].scene).advance(STEPS)
    assert calls == {"near_boxes": STEPS}
