"""How often things are called: each hook once for each plug-in and step, the contact search only where bodies
are near.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest

from effects_table import CASES, hooks_of
from mpmfw.contact import rows, springs
from mpmfw.contact.surfaces import detection, near_facets
from mpmfw.plugin.hooks import BoundHooks
from mpmfw.runs.simulation import Simulation
from mpmfw_contact import penalty
from scenes_for_tests import two_blocks, with_changes

pytestmark = pytest.mark.effects
STEPS = 5

#: Hooks that one step of each scheme calls, and how often.
USL = Counter(
    {
        **dict.fromkeys(("interpolate", "detect", "after_momentum_projection", "add_nodal_force"), 1),
        **dict.fromkeys(("after_momentum_update", "correct_inertia", "constrain_momentum"), 1),
        **dict.fromkeys(("advect", "update_particle_domains", "update_stress", "end_step"), 1),
    }
)
PER_STEP = {
    "usl": USL,
    "musl": USL + Counter({"constrain_momentum": 1}),  # the velocity of the strain, projected once more
    "usf": USL + Counter({"constrain_momentum": 1}),  # the velocity that strains before the forces
}


def counted(sim: Simulation) -> Counter[tuple[str, str]]:
    """Count the calls of every hook's implementations from now on, by hook and plug-in."""
    calls: Counter[tuple[str, str]] = Counter()
    for hook in sim.hook_callers():
        for implementation in getattr(sim.manager.hook, hook).get_hookimpls():
            implementation.function = _spy(calls, (hook, implementation.plugin_name), implementation.function)
    sim.hook = BoundHooks(sim.manager, sim.clock)
    return calls


def _spy(calls: Counter[Any], key: Any, function: Callable[..., Any]) -> Callable[..., Any]:
    def spy(*arguments: Any) -> Any:
        calls[key] += 1
        return function(*arguments)

    return spy


#: The other schemes differ in the boundary conditions alone.
ALL_SCHEMES = ("frictional", "settled", "ledger")
RUNS = [("usl", name) for name in CASES] + [(s, name) for s in ("musl", "usf") for name in ALL_SCHEMES]


@pytest.mark.parametrize(("scheme", "name"), RUNS)
def test_every_hook_is_called_so_often_a_step(scheme: str, name: str) -> None:
    case = CASES[name]
    sim = Simulation(with_changes(case.scene, stepping__scheme=scheme))
    sim.advance(0, [].append)  # from the first output on the ledger runs
    dt, calls = sim.stable_step(), counted(sim)
    for _ in range(STEPS):
        sim.step(dt)
    times = PER_STEP[scheme] + Counter({"interpolate_surface": int(sim.state.surface is not None)})
    assert calls == {(hook, who): STEPS * times[hook] for hook, who in hooks_of(sim) if times[hook]}


def test_diagnostics_are_called_at_outputs_alone() -> None:
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


@pytest.fixture
def kernel_calls(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """Count the calls of the penalty contact's kernels."""
    calls: Counter[str] = Counter()
    for module, names in KERNELS.items():
        for name in names:
            monkeypatch.setattr(module, name, _spy(calls, name, getattr(module, name)))
    return calls


def test_bodies_apart_cost_a_comparison_of_boxes(kernel_calls: Counter[str]) -> None:
    sim = Simulation(CASES["two bodies apart"].scene)
    sim.advance(STEPS)
    assert kernel_calls == {"near_boxes": STEPS}


def test_the_search_wakes_when_the_boxes_come_within_its_reach(kernel_calls: Counter[str]) -> None:
    """The blocks start farther apart than the reach of a cell, and approach at half a millimetre a step."""
    scene = two_blocks("penalty", shape__method="linear", output={"gap": False})
    for name, left in (("left", -0.635), ("right", 0.135)):
        geometry = {"type": "rectangle", "lower": [left, -0.25], "upper": [left + 0.5, 0.25]}
        scene = with_changes(scene, **{f"bodies__{name}__geometry": geometry})
    sim = Simulation(scene)
    sim.start()
    surface, awake = sim.state.surface, 0
    for _ in range(60):
        left, right = (surface.position[surface.of(body)] for body in (0, 1))
        near = right[:, 0].min() - left[:, 0].max() <= sim.contact.detection.radius
        before = kernel_calls["find_candidates"]
        sim.step(sim.stable_step())
        assert (kernel_calls["find_candidates"] > before) == near
        awake += near
    assert 0 < awake < 60
