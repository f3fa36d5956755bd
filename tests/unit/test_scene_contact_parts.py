"""``detection`` and ``law`` in a scene: the other spelling of ``method = "DETECTION+LAW"``."""

import re

import pytest

from contact_scenes import STRATEGIES
from mpmfw.campaigns.campaign import compare
from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import load
from mpmfw.runs.identity import key_of
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.scene.specification import (
    checked_specification,
    parse_specification,
    split_specifications,
)
from scenes_for_tests import two_blocks

OPTIONS = {"nodes": {"cut_off": 0.7}, "penalty": {"kappa": 2}}
PARTS = {"detection": "nodes", "law": "penalty", **OPTIONS}
METHOD = {"method": "nodes+penalty", "nodes+penalty": {"cut_off": 0.7, "kappa": 2}}


def scene(contact, **overrides):
    return load_scene({**two_blocks("none"), "contact": contact}, set=overrides)


def refused(contact, **overrides):
    with pytest.raises(SceneError) as caught:
        scene(contact, **overrides)
    return str(caught.value)


def test_both_spellings_are_one_scene():
    one, other = scene(PARTS), scene(METHOD)
    assert one.contact.method == other.contact.method == "nodes+penalty"
    assert one.contact.options == other.contact.options
    assert key_of(one) == key_of(other)
    labels = [Simulation(each).contact.label for each in (one, other)]
    assert labels == ["nodes+penalty(cut_off=0.7, kappa=2.0)"] * 2


@pytest.mark.parametrize(
    ("contact", "said"),
    [
        (
            {**PARTS, "method": "penalty"},
            "contact.detection: does not go with a method; expected either method, or detection and law",
        ),
        ({"detection": "nodes"}, "contact.law: missing beside detection = 'nodes'; expected one of "),
        ({"detecton": "nodes", "law": "penalty"}, "contact.detecton: unknown key; did you mean 'detection'?"),
        ({"detection": "nods", "law": "penalty"}, "contact.detection: no such detection: 'nods' is unknown; did you"),  # noqa: E501
        ({**PARTS, "nodes": {"cutoff": 1}}, "contact.nodes.cutoff: unknown key; did you mean 'cut_off'?"),
        (
            {**PARTS, "nodes+penalty": {"kappa": 3}},
            'contact.penalty.kappa: [contact."nodes+penalty"] gives it too; leave one of them out',
        ),
        ({"detection": "nodes", "law": "hamad2017"}, "contact.law: contact 'nodes+hamad2017': law 'hamad2017' acts on"),  # noqa: E501
    ],
)  # fmt: skip
def test_what_is_wrong_gets_one_message(contact, said):
    message = refused(contact)
    assert message.startswith(said)
    assert "\n" not in message


def test_what_is_set_takes_the_place_of_the_other_spelling():
    assert scene(PARTS, **{"contact.method": "bardenhagen"}).contact.method == "bardenhagen"
    assert (
        scene(PARTS, **{"contact.method": "nodes+impulse(normal=master)"}).contact.options.normal == "master"
    )
    assert scene(PARTS, **{"contact.law": "impulse"}).contact.method == "nodes+impulse"
    parts = {"contact.detection": "surfaces", "contact.law": "impulse"}
    assert scene(METHOD, **parts).contact.method == "surfaces+impulse"
    assert refused(METHOD, **{"contact.law": "impulse"}).startswith(
        "--set contact.law: does not go with a method"
    )


@pytest.mark.parametrize("part", ["surfaces", "nodes"])
def test_an_option_of_a_part_that_is_not_named_has_no_effect(part):
    said = f"--set contact.{part}.bogus: has no effect: [contact] does not have detection = '{part}'"
    assert refused({"method": "penalty"}, **{f"contact.{part}.bogus": 5}).startswith(said)
    with pytest.raises(SceneError, match=re.escape(said)):
        compare(two_blocks("none"), ["penalty"], ["gimp"], set={f"contact.{part}.bogus": 5})
    assert "has no effect" not in refused(PARTS, **{"contact.nodes.bogus": 5})


@pytest.mark.parametrize("part", ["detection", "law"])
def test_a_part_that_cannot_be_imported_is_named(announce, part):
    announce(part, "broken", "no_such_module:Broken")
    said = f"contact.{part}: {part} plug-in 'broken'"
    assert refused({"detection": "nodes", "law": "penalty", part: "broken"}).startswith(said)


SCENE = "rolling-cylinder-slip"
STRONG = "bardenhagen(criterion=position, normal=master)"


@pytest.mark.parametrize(
    ("text", "name", "options", "written"),
    [
        (" none() ", "none", {}, "none"),
        ("a(b=true, c=[1.0, 2])", "a", {"b": True, "c": [1.0, 2]}, "a(b=true, c=[1.0, 2])"),
        ('a(b="2", c="x, y", d=2 '
         'mm)', "a", {"b": "2", "c": "x, y", "d": "2 mm"}, 'a(b="2", c="x, y", d=2 mm)'),
        ("module.of:Law(b=1)", "module.of:Law", {"b": 1}, "module.of:Law(b=1)"),
    ],
)  # fmt: skip
def test_a_text_is_read_and_written(text, name, options, written):
    said = parse_specification(text)
    assert (said.name, said.options, str(said)) == (name, options, written)
    assert parse_specification(written) == said


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected NAME or NAME(option=value, …)"),
        ("a(b=1", "is not closed"),
        ("a(b)", "'b' is not option=value"),
        ("a(b=1, b=2)", "option 'b' is given twice"),
        ("a(b=[1)", "')' closes nothing"),
    ],
)
def test_a_text_of_another_form_is_refused(text, message):
    with pytest.raises(SceneError) as error:
        [parse_specification(part) for part in split_specifications(text) or [text]]
    assert message in str(error.value)
    assert str(error.value).startswith(f"{text}: ")


OBJECTS = [
    *((name, given) for name, given in STRATEGIES.values()),
    ("hamad2017", {"friction_law": "literal", "kappa": 2.0}),
    ("penalty", {"interface_thickness": 1e-3, "map": "plain"}),
    ("gimp", {}),
]


@pytest.mark.parametrize(("name", "options"), OBJECTS)
def test_a_label_names_the_method_that_has_it(name, options):
    kind = "shape" if name == "gimp" else "contact"
    made = load(kind, name)(**options)
    read = checked_specification(kind, made.label)
    again = load(kind, name)(**read.options)
    assert (again.label, again.options) == (made.label, made.options)
    assert made.label == str(read)


def test_a_scene_takes_it_for_the_name_and_the_options_of_its_table():
    told = load_scene(SCENE, set={"contact.method": STRONG})
    tabled = load_scene(
        SCENE,
        set={
            "contact.method": "bardenhagen",
            "contact.bardenhagen.normal": "master",
            "contact.bardenhagen.criterion": "position",
        },
    )
    assert told.contact == tabled.contact
    assert told.to_mapping() == tabled.to_mapping()
    assert key_of(told) == key_of(tabled)
    assert load_scene_text(told.text).contact == told.contact  # what results keep runs again
    assert "contact.method was set to" in told.text


def load_scene_text(text):
    """A scene from its text."""
    import tomllib

    return load_scene(tomllib.loads(text))


def test_options_are_set_over_the_scene_s_own_and_the_last_choice_of_a_method_holds():
    rings = load_scene("colliding-rings", set={"contact.method": "penalty(damping=0.1)"})
    assert (rings.contact.options.kappa, rings.contact.options.damping) == (0.25, 0.1)
    assert (
        load_scene("colliding-rings", set={"contact.method": "penalty(kappa=2)"}).contact.options.kappa == 2.0
    )
    strong = load_scene(SCENE, set={"contact.method": STRONG})
    plain = strong.with_overrides({"contact.method": "bardenhagen"})
    assert plain.contact.options.criterion == "velocity"
    shape = load_scene(SCENE, set={"shape.method": "gimp()"})
    assert shape.shape.method == "gimp"


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"contact.method": "bardenhagen(normal=mastr)"}, "--set contact.method: contact.bardenhagen.normal: 'mastr' is unknown"),  # noqa: E501
        ({"contact.method": "bardenhagen(cut_off=0.5)"}, "--set contact.method: contact.bardenhagen: 'cut_off' has no effect"),  # noqa: E501
        ({"contact.method": STRONG, "contact.bardenhagen.normal": "master"},
         f"--set contact.bardenhagen.normal: contact.method = '{STRONG}' sets it too; leave one of them out"),
    ],
)  # fmt: skip
def test_a_scene_says_what_is_wrong_with_it_once(overrides, message):
    with pytest.raises(SceneError) as error:
        load_scene(SCENE, set=overrides)
    assert message in str(error.value)
    assert len(str(error.value).splitlines()) == 1
