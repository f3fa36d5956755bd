"""An effect that the scene does not call for is not imported, registers no hook, allocates nothing and is not
recorded.
"""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import pytest

import mpmfw
from effects_table import arrays_of
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import block, disc, two_blocks

pytestmark = pytest.mark.effects

FLIP_LINEAR = disc(shape__method="linear", bodies__solid__rotation="lumped", output={"particles": False})
CPDI = disc()
HELD = block(bodies__solid__sides=[{"side": "bottom", "fixed": True}], gravity={"vector": [0, -10]})
PRESSED = block(bodies__solid__sides=[{"side": "top", "pressure": 1e3}], bodies__solid__rotation="spin")
NONE = two_blocks("none", output={"gap": False})
PENALTY = two_blocks("penalty")
VELOCITY = two_blocks("bardenhagen", shape__method="gimp", output={"gap": False})
POSITION = two_blocks("bardenhagen", contact__bardenhagen={"criterion": "position"}, output={"gap": False})

ARRAYS = {
    *(
        f"particles/{name}"
        for name in ("position", "velocity", "mass", "initial_volume", "volume", "stress", "first")
    ),
    *(f"particles/{name}" for name in ("deformation_gradient", "velocity_gradient")),
    *(f"grid/{name}" for name in ("lower", "nodes", "window_lower", "window_shape", "offset")),
    *(f"grid/{name}" for name in ("position", "mass", "momentum", "start_velocity", "force", "velocity")),
}
AFFINE = {"particles/affine", "layout/half_edges"}
SPIN = {"local_spin/change", "local_spin/common"}
SURFACE = {
    f"surface/{n}"
    for n in (
        *(
            "position",
            "displacement",
            "tributary",
            "neighbours",
            "star_first",
            "star",
            "facet_first",
            "facets",
            "body",
            "first",
            "body_first",
        ),
        "cell_mass",
    )
}
RECORDS = {"impulse", "friction_impulse", "frictional_work", "damping_work", "energy", "count"}
CLASSICAL = {f"bardenhagen/{name}" for name in RECORDS | {"volume_gradient"}}
CLASSICAL |= {f"leaning_normals/{name}" for name in ("normal_impulse", "mean_normal", "lean")}


@pytest.mark.parametrize(
    ("scene", "extra"),
    [
        (FLIP_LINEAR, set()),
        (CPDI, AFFINE | SPIN),
        (HELD, AFFINE),
        (PRESSED, AFFINE | SURFACE | SPIN),
        (NONE, AFFINE),
        (VELOCITY, AFFINE | SPIN | CLASSICAL | {"gimp/half_length"}),
        (POSITION, AFFINE | SPIN | CLASSICAL | {"bardenhagen/mean_position"}),
    ],
    ids=["flip-linear", "cpdi", "held", "pressed", "none", "bardenhagen-velocity", "bardenhagen-position"],
)
def test_exactly_the_arrays_that_the_scene_needs(scene: dict[str, Any], extra: set[str]) -> None:
    sim = Simulation(scene)
    sim.advance(12)  # two bodies have met by then
    assert arrays_of(sim) == ARRAYS | extra


def test_exactly_the_arrays_that_penalty_contact_needs() -> None:
    sim = Simulation(PENALTY)
    sim.advance(12)
    arrays = arrays_of(sim)
    own = {name for name in arrays if name.startswith("penalty/")}
    assert arrays - own == ARRAYS | AFFINE | SPIN | SURFACE
    assert own >= {f"penalty/{name}" for name in RECORDS | {"force"}}
    assert "surface_layer/interface_mass" not in own  # no interface thickness


def test_absent_structures_are_none() -> None:
    state = Simulation(FLIP_LINEAR).state
    assert (state.surface, state.particles.affine, state.particles.moment) == (None, None, None)
    state = Simulation(CPDI).state
    assert state.surface is None
    assert state.particles.moment is None
    assert Simulation(disc(stepping={"transfer": "apic"})).state.particles.moment is not None


FILL = {
    "particle_reach": "shape",
    "interpolate": "shape",
    "interpolate_surface": "shape",
    "update_stress": "soft",
}
HOOKS: dict[str, tuple[dict[str, Any], dict[str, list[str]]]] = {
    "flip-linear": (
        FLIP_LINEAR,
        {
            "declare_fields": ["body_series"],
            "setup": ["soft", "shape", "body_series"],
            "diagnostics": ["body_series", "verdict"],
            "concerns": ["verdict"],
        },
    ),
    "held": (
        HELD,
        {
            "declare_fields": ["body_series", "von_mises"],
            "setup": ["soft", "shape", "constraint", "body_series"],
            "add_nodal_force": ["gravity"],
            "constrain_momentum": ["constraint"],
            "advect": ["constraint"],
            "end_step": ["constraint"],
            "diagnostics": ["body_series", "verdict", "von_mises"],
            "concerns": ["verdict"],
        },
    ),
    "penalty": (
        PENALTY,
        {
            "declare_fields": ["penalty", "gap", "local_spin", "body_series", "von_mises"],
            "setup": ["soft", "shape", "penalty", "surface_travel", "surface", "local_spin", "body_series"],
            "add_pairs": ["penalty", "surface_travel"],
            "detect": ["surface", "penalty"],
            "add_nodal_force": ["penalty"],
            "correct_inertia": ["local_spin"],
            "advect": ["penalty", "surface"],
            "stable_timestep": ["penalty", "surface_travel"],
            "end_step": ["verdict"],
            "diagnostics": ["penalty", "gap", "body_series", "verdict", "flutter", "von_mises"],
            "concerns": ["verdict", "flutter"],
        },
    ),
    "bardenhagen": (
        VELOCITY,
        {
            "declare_fields": [
                "shape",
                "bardenhagen",
                "leaning_normals",
                "local_spin",
                "body_series",
                "von_mises",
            ],
            "setup": ["soft", "shape", "bardenhagen", "leaning_normals", "local_spin", "body_series"],
            "add_pairs": ["bardenhagen", "leaning_normals"],
            "detect": ["bardenhagen"],
            "after_momentum_projection": ["bardenhagen", "leaning_normals"],
            "add_nodal_force": ["leaning_normals"],
            "advect": ["bardenhagen"],
            "after_momentum_update": ["bardenhagen", "leaning_normals"],
            "after_second_projection": ["bardenhagen"],
            "correct_inertia": ["local_spin"],
            "end_step": ["verdict"],
            "diagnostics": ["bardenhagen", "body_series", "verdict", "flutter", "von_mises"],
            "concerns": ["leaning_normals", "verdict", "flutter"],
        },
    ),
}


@pytest.mark.parametrize("name", HOOKS)
def test_exactly_the_hooks_that_the_scene_needs(name: str) -> None:
    scene, expected = HOOKS[name]
    called = {"shape": scene["shape"]["method"], "soft": "neo_hookean soft"}
    want = {**{hook: [who] for hook, who in FILL.items()}, **expected}
    want = {hook: [called.get(who, who) for who in names] for hook, names in want.items()}
    found = {hook: names for hook, names in Simulation(scene).hook_callers().items() if names}
    assert found == want


#: Every run has series and is judged.
VERDICT = {
    f"mpmfw.effects.{name}" for name in ("series", "remedies", "settling", "verdict", "ledger_energies")
}
MODULES = """
import json, sys
from mpmfw.runs.simulation import Simulation
Simulation(json.loads(sys.argv[1])).advance(2)
print(json.dumps([name for name in sys.modules if name.startswith("mpmfw")]))
"""


def imported(scene: dict[str, Any]) -> set[str]:
    """Modules of plug-ins and effects that a fresh process imports to run the scene."""
    done = subprocess.run(
        [sys.executable, "-c", MODULES, json.dumps(scene)],
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
    )
    modules = json.loads(done.stdout)
    parents = ("mpmfw_contact.", "mpmfw_load.", "mpmfw_shape.", "mpmfw_material.", "mpmfw.effects.")
    parents += tuple(
        "mpmfw.contact." + name for name in ("nodes", "normal_bias", "shared_nodes", "springs", "surfaces")
    )
    return {name for name in modules if name.startswith(parents)}


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (
            disc(bodies__solid__rotation="lumped"),
            {
                "mpmfw_shape.cpdi",
                "mpmfw_shape._at_points",
                "mpmfw_shape._packed_rows",
                "mpmfw_shape._degenerate_domains",
                "mpmfw_material.neo_hookean",
                "mpmfw_material._isotropic",
            },
        ),
        (
            two_blocks(
                "separate", shape__method="bspline", gravity={"vector": [0, -1]}, output={"gap": False}
            ),
            {
                "mpmfw_shape.bspline",
                "mpmfw_shape._at_points",
                "mpmfw_material.neo_hookean",
                "mpmfw_material._isotropic",
                "mpmfw_contact.separate",
                "mpmfw.effects.gravity",
                "mpmfw.effects.local_spin",
                "mpmfw.effects.second_moments",
            },
        ),
    ],
    ids=["one-body", "separate"],
)
def test_exactly_the_modules_that_the_scene_needs(scene: dict[str, Any], expected: set[str]) -> None:
    assert imported(scene) == expected | VERDICT


SERIES = {
    *("centre_of_mass", "mean_velocity", "angular_velocity", "linear_momentum", "angular_momentum"),
    *("kinetic_energy", "strain_energy", "total_energy"),
}
PAIRS = {
    "contact_force",
    "friction_force",
    "contact_count",
    "frictional_work",
    "contact_energy",
    "damping_work",
}
POINTS = {"position", "velocity", "mass", "volume", "deformation_gradient", "stress", "von_mises"}


@pytest.mark.parametrize(
    ("scene", "series", "points"),
    [
        (FLIP_LINEAR, set(), set()),
        (CPDI, {"affine_energy"}, POINTS),
        (disc(shape__method="cpdi2"), {"affine_energy"}, POINTS | {"corners"}),
        (NONE, {"affine_energy"}, POINTS),
        (VELOCITY, {"affine_energy"} | PAIRS, POINTS),
        (PENALTY, {"affine_energy", "min_gap", "spring_work"} | PAIRS, POINTS),
    ],
    ids=["flip-linear", "cpdi", "cpdi2", "none", "bardenhagen", "penalty"],
)
def test_exactly_the_variables_that_the_scene_needs(
    scene: dict[str, Any], series: set[str], points: set[str]
) -> None:
    tree = mpmfw.run(scene)
    assert set(tree["series"].data_vars) == SERIES | series
    assert ("particles" in tree.children) == bool(points)
    for body in tree["particles"].children.values() if points else ():
        assert set(body.data_vars) == points
    assert ("surface" in tree.children) == (scene is PENALTY)
    assert "contact" not in tree.children  # no plug-in writes fields of a pair


def test_energies_are_left_out_where_the_scene_does_not_want_them() -> None:
    tree = mpmfw.run(disc(output={"energy": False}))
    assert not {name for name in tree["series"].data_vars if str(name).endswith("energy")}


def test_effects_say_why_they_are_off() -> None:
    effects = {effect.name: effect for effect in Simulation(FLIP_LINEAR).effects}
    for name in (
        "affine field",
        "contact",
        "surfaces",
        "gravity",
        "prescribed sides",
        "loads on sides",
        "von Mises stress",
    ):
        assert not effects[name].on
        assert effects[name].reason
