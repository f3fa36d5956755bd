"""``mpmfw explain`` names every fact of a scene that has no effect in the run that it explains."""

from __future__ import annotations

import warnings
from typing import Any

import pytest
from typer.testing import CliRunner

import mpmfw
from mpmfw.cli.app import app
from mpmfw.cli.unused import unused_facts
from mpmfw.errors import ResultsWarning
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import block, two_blocks

pytestmark = pytest.mark.effects

OPTIONS = {
    "contact__penalty": {"kappa": 3.0, "damping": 0.1},
    "contact__bardenhagen": {"normal": "master"},
}


def facts(scene: dict[str, Any]) -> list[str]:
    return unused_facts(Simulation(scene))


@pytest.mark.parametrize(
    ("method", "said"),
    [
        ("penalty", ["contact.bardenhagen.normal: contact 'penalty' runs, not 'bardenhagen'"]),
        (
            "bardenhagen",
            [
                "contact.penalty.kappa: contact 'bardenhagen' runs, not 'penalty'",
                "contact.penalty.damping: contact 'bardenhagen' runs, not 'penalty'",
            ],
        ),
    ],
)
def test_options_of_methods_that_do_not_run(method: str, said: list[str]) -> None:
    assert facts(two_blocks(method, **OPTIONS)) == said


def test_options_of_shape_functions_that_do_not_run() -> None:
    assert facts(two_blocks("penalty", shape__gimp={"width": 1})) == [
        "shape.gimp.width: shape 'cpdi' runs, not 'gimp'"
    ]


def apart(**changes: Any) -> dict[str, Any]:
    """Two blocks without contact, and so without friction."""
    return two_blocks("separate", contact__friction=0.0, **changes)


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        (apart(output={"surface": True, "gap": False}), ["output.surface: no surface is tracked"]),
        (apart(output={"surface": True}), []),
        (apart(output={"gap": False}), []),
        (apart(output={"surface": False, "gap": False}), []),
        (block(output={"gap": True}), ["output.gap: no gap is measured: one body"]),
        (
            block(output={"particle_interval": 1e-6}),
            ["output.particle_interval: material points are stored at every output: time.output_interval is "
             "no shorter"],
        ),
        (block(), []),
        (
            two_blocks("bardenhagen", output={"stability": True}),
            ["output.stability: of the time step alone: contact 'bardenhagen' has no series of its own "
             "stability"],
        ),
        (two_blocks("penalty", output={"stability": True}), []),
        (block(output={"stability": True}), []),
        (two_blocks("penalty", output={"contact_moment": "centre_of_mass"}), []),
        (
            two_blocks("separate", contact__friction=0.0, output={"contact_moment": "centre_of_mass"}),
            ["output.contact_moment: no moment is measured: contact 'separate' neither exerts forces nor "
             "changes momenta"],
        ),
    ],
)  # fmt: skip
def test_diagnostics_that_are_asked_for_and_not_recorded(scene: dict[str, Any], said: list[str]) -> None:
    assert facts(scene) == said


def test_materials_and_friction() -> None:
    other = {"model": "linear_elastic", "density": 1.0, "bulk_modulus": 1.0, "shear_modulus": 1.0}
    assert facts(two_blocks("none", materials__other=other)) == [
        "friction of left-right: contact 'none' has none",
        "materials.other: no body is made of it",
    ]


def test_the_command_prints_them() -> None:
    arguments = ["explain", "colliding-rings", "--contact", "bardenhagen"]
    printed = CliRunner().invoke(app, arguments).output.partition("Facts of the scene that are not used")[2]
    assert "contact.penalty.kappa: contact 'bardenhagen' runs, not 'penalty'" in printed


@pytest.mark.parametrize(("method", "unused"), [("none", True), ("separate", False)])
def test_explain_names_a_rotation_that_is_not_used(method: str, unused: bool) -> None:
    sim = Simulation(two_blocks(method, bodies__left__rotation="exact", output={"gap": False}))
    line = "bodies.left.rotation: lumped all the same: shares its velocity field with other bodies"
    assert (line in unused_facts(sim)) == unused


@pytest.mark.parametrize(("thickness", "kept"), [(0.0, True), (0.01, False)])
def test_explain_names_a_ledger_that_is_not_kept(thickness: float, kept: bool) -> None:
    changes = {"contact__penalty": {"interface_thickness": thickness}, "output": {"ledger": True}}
    sim = Simulation(two_blocks("penalty", **changes))
    said = [line for line in unused_facts(sim) if line.startswith("output.ledger: ")]
    assert len(said) == (0 if kept else 1)
    assert kept or "adds inertia of its own to the nodes" in said[0]


@pytest.mark.parametrize("law", ["coulomb", "literal"])
def test_explain_and_results_name_a_friction_whose_value_is_ignored(law: str) -> None:
    scene = two_blocks(
        "hamad2017", contact__hamad2017={"friction_law": law}, time={"end": 2e-3, "output_interval": 1e-3}
    )
    line = "value of friction of left-right: contact 'hamad2017' with friction_law = 'literal' ignores it"
    assert facts(scene) == ([line] if law == "literal" else [])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultsWarning)
        tree = mpmfw.run(scene)
    assert (line in tree.attrs.get("warnings", "")) == (law == "literal")
