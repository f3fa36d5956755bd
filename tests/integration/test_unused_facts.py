"""``mpmfw explain`` names every fact of a scene that has no effect in the run that it explains."""

import warnings

import pytest

import mpmfw
from mpmfw.cli.explain import unused_facts
from mpmfw.errors import ResultsWarning
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import block, two_blocks

pytestmark = pytest.mark.effects

OPTIONS = {
    "contact__penalty": {"kappa": 3.0, "damping": 0.1},
    "contact__bardenhagen": {"normal": "master"},
}


def facts(scene):
    return unused_facts(Simulation(scene))


OTHER = {"model": "linear_elastic", "density": 1.0, "bulk_modulus": 1.0, "shear_modulus": 1.0}
EXACT = {"bodies__left__rotation": "exact", "output": {"gap": False}}
LAYER = {"contact__penalty": {"interface_thickness": 0.01}, "output": {"ledger": True}}


def apart(**changes):
    """Two blocks without contact, and so without friction."""
    return two_blocks("separate", contact__friction=0.0, **changes)


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        (two_blocks("penalty", **OPTIONS), ["contact.bardenhagen.normal: contact 'penalty' runs"]),
        (
            two_blocks("penalty", shape__gimp={"width": 1}),
            ["shape.gimp.width: shape 'cpdi' runs, not 'gimp'"],
        ),
        (apart(output={"surface": True, "gap": False}), ["output.surface: no surface is tracked"]),
        (apart(output={"surface": False, "gap": False}), []),
        (block(output={"gap": True}), ["output.gap: no gap is measured: one body"]),
        (
            block(output={"particle_interval": 1e-6}),
            ["output.particle_interval: material points are stored at every"],
        ),
        (two_blocks("bardenhagen", output={"stability": True}), ["output.stability: of the time step alone"]),
        (two_blocks("penalty", output={"stability": True, "contact_moment": "centre_of_mass"}), []),
        (
            apart(output={"contact_moment": "centre_of_mass"}),
            ["output.contact_moment: no moment is measured"],
        ),
        (
            two_blocks("none", materials__other=OTHER),
            ["friction of left-right: contact 'none' has none", "materials.other: no body is made of it"],
        ),
        (two_blocks("none", contact__friction=0.0, **EXACT), ["bodies.left.rotation: lumped anyway"]),
        (apart(**EXACT), []),
        (two_blocks("penalty", **LAYER), ["output.ledger: "]),
    ],
)
def test_facts_without_effect_are_named_and_no_others(scene, said):
    found = facts(scene)
    assert len(found) == len(said)
    assert all(line.startswith(start) for line, start in zip(found, said, strict=True))


@pytest.mark.parametrize("law", ["coulomb", "literal"])
def test_explain_and_results_name_a_friction_whose_value_is_ignored(law):
    scene = two_blocks(
        "hamad2017", contact__hamad2017={"friction_law": law}, time={"end": 2e-3, "output_interval": 1e-3}
    )
    line = "value of friction of left-right: contact 'hamad2017' with friction_law = 'literal' ignores it"
    assert facts(scene) == ([line] if law == "literal" else [])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultsWarning)
        tree = mpmfw.run(scene)
    assert (line in tree.attrs.get("warnings", "")) == (law == "literal")
