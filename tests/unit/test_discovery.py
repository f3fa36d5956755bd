"""Plug-ins by entry points and by module:Class: found, imported one at a time, named when they are wrong."""

import sys

import numpy as np
import pytest

from command_line import called
from faulty_plugins.contact.plain import PlainContact
from faulty_plugins.small.geometry import Sound
from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available, load
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw_contact.penalty import Penalty
from mpmfw_shape.linear import Linear
from mpmfw_testing.contact.impact import Impact
from scenes_for_tests import block

#: A model of options, for the constructor to take.
OPTIONS = "from pydantic import BaseModel\nclass Options(BaseModel):\n    stiffness: float = 1.0\n"


def test_finding_imports_nothing_and_loading_imports_one(install):
    install("first_law", {"first": "first_law:Law"}, "class Law: pass\n")
    install("second_law", {"second": "second_law:Law"}, "class Law: name = 'second'\n")
    assert {"first", "second"} <= set(available("contact"))
    assert "first_law" not in sys.modules
    load("contact", "second")
    assert "first_law" not in sys.modules
    assert "second_law" in sys.modules


def test_an_unknown_name_gets_the_nearest_and_the_list(install):
    install("spring_law", {"spring": "spring_law:Spring"})
    with pytest.raises(
        SceneError, match=r"unknown contact plug-in 'sprnig'; did you mean 'spring'\? \(one of .*penalty"
    ):
        load("contact", "sprnig")


@pytest.mark.parametrize(
    ("source", "cause"),
    [
        ("import no_such_module_here\n", "ModuleNotFoundError: No module named 'no_such_module_here'"),
        ("1 / 0\n", "ZeroDivisionError: division by zero"),
        ("Law = 3\n", "is not a class"),
        ("class Law: pass\n", "expected a class attribute 'name', which is what scenes call it; found None"),
        (
            "class Law:\n    name = 'broken'\n    interface = 0\n",
            "Law is written for version 0 of the plug-in interface; expected 1, that of this mpmfw",
        ),
        ("class Law: name = 'law'\n", "Law has the name 'law'; expected the same as the entry point's"),
        (
            "class Law:\n    name = 'broken'\n    def __init__(self, stiffness): pass\n",
            r"Law\(…\) must be made from its options alone, given as keywords \(it has none\): .*'stiffness'",
        ),
    ],
)
def test_a_broken_plugin_names_its_distribution_and_the_cause(install, source, cause, request):
    distribution = f"broken_{request.node.callspec.indices['source']}"
    install(distribution, {"broken": f"{distribution}:Law"}, source)
    with pytest.raises(SceneError, match=f"'broken' of distribution {distribution}.*{cause}"):
        load("contact", "broken")


@pytest.mark.parametrize(
    ("constructor", "options"), [("self, stiffness", OPTIONS), ("self, **options", ""), ("self, at=0.0", "")]
)
def test_a_constructor_may_take_its_options_by_name_or_all_together(install, request, constructor, options):
    distribution = f"taking_{request.node.callspec.indices['constructor']}"
    own = "    Options = Options\n" if options else ""
    source = f"{options}class Law:\n    name = 'taking'\n{own}    def __init__({constructor}): pass\n"
    install(distribution, {"taking": f"{distribution}:Law"}, source)
    assert load("contact", "taking").name == "taking"


def test_two_distributions_with_one_name_are_both_named(install):
    install("one_law", {"twice": "one_law:Law"})
    install("other_law", {"twice": "other_law:Law"})
    assert "twice" in available("contact")  # the others are not hidden
    with pytest.raises(SceneError, match=r"'twice': o[a-z]*_law .* and o[a-z]*_law .*uninstall"):
        load("contact", "twice")
    assert load("contact", "penalty").name == "penalty"
    listed = called("plugins").output
    assert "penalty" in listed
    assert "BROKEN: two distributions" in " ".join(listed.split())


PLACE = "faulty_plugins.contact.plain:PlainContact"


def end(contact=None, **table):
    """Positions after twenty steps of two blocks that meet, of a contact or a scene's table of one."""
    mapping = Impact().mapping()
    simulation = Simulation({**mapping, "contact": table} if table else mapping, contact=contact)
    simulation.advance(20)
    return simulation.state.particles.position


def test_a_scene_names_a_class_of_a_module_and_options_in_a_table_of_that_name_or_beside_it():
    assert np.array_equal(end(method=PLACE, friction=0.0), end(PlainContact()))
    place = "mpmfw_contact.penalty:Penalty"
    expected = end(Penalty(kappa=2.0))
    assert np.array_equal(end(method=place, friction=0.0, **{place: {"kappa": 2.0}}), expected)
    assert np.array_equal(end(f"{place}(kappa=2)"), expected)
    with pytest.raises(SceneError, match="kapa"):
        load_scene({**Impact().mapping(), "contact": {"method": place, place: {"kapa": 2.0}}})


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("no_such_module:Law", "cannot be imported from no_such_module:Law: ModuleNotFoundError"),
        ("mpmfw_contact.penalty:Penalti", "cannot be imported from .*: AttributeError"),
        (Linear, r"contact plug-in mpmfw_shape.linear.Linear .*derived from mpmfw.api.ContactStrategy"),
        (3, "contact: found 3; expected a name, module:Class, or a class derived from mpmfw.api"),
    ],
)
def test_what_is_no_contact_is_refused(given, said):
    with pytest.raises(SceneError, match=said):
        Simulation(Impact().mapping(), contact=given)


def test_keys_of_a_stranger_s_geometry_have_units_and_are_told_by_name():
    def scene(**keys):
        return block(bodies__solid__geometry={"type": "faulty_plugins.small.geometry:Sound", **keys})

    made = load_scene(scene(hole="20 cm")).bodies["solid"].geometry
    assert isinstance(made, Sound)
    assert made.hole == 0.2
    with pytest.raises(SceneError) as found:
        load_scene(scene(hole="2 kg", centra=[0.0, 0.0]))
    said = str(found.value)
    assert "bodies.solid.geometry.hole: '2 kg' is not convertible to m; expected a length in m" in said
    assert "bodies.solid.geometry.centra: unknown key; did you mean 'centre'?" in said
