"""``detection`` and ``law`` in a scene: the other spelling of ``method = "DETECTION+LAW"``."""

from __future__ import annotations

import pytest

from mpmfw.errors import SceneError
from mpmfw.runs.identity import key_of
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
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
            "contact.detection: a method is named beside it; expected either method, or detection and law",
        ),
        (
            {"detection": "nodes"},
            "contact.law: missing beside detection = 'nodes'; expected one of "
            "adhesion, barrier, hamad2017, hybrid, impulse, lcp, penalty",
        ),
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
        "--set contact.law: a method is named beside it"
    )
