"""``module:Class``, and classes, wherever a plug-in is named."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

from faulty_plugins.contact.plain import PlainContact
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw_contact.penalty import Penalty
from mpmfw_shape.linear import Linear
from mpmfw_testing.contact.impact import Impact

PLACE = "faulty_plugins.contact.plain:PlainContact"


def end(contact: Any) -> np.ndarray:
    """Positions after twenty steps of two blocks that meet."""
    simulation = Simulation(Impact().mapping(), contact=contact)
    simulation.advance(20)
    return simulation.state.particles.position


def test_a_scene_names_a_class_of_a_module() -> None:
    assert np.array_equal(end_of({"method": PLACE, "friction": 0.0}), end(PlainContact()))


def end_of(contact: dict[str, Any]) -> np.ndarray:
    """As :func:`end`, of a scene with this table of contact."""
    simulation = Simulation({**Impact().mapping(), "contact": contact})
    simulation.advance(20)
    return simulation.state.particles.position


def test_options_stand_in_a_table_of_that_name_or_beside_it() -> None:
    place = "mpmfw_contact.penalty:Penalty"
    expected = end(Penalty(kappa=2.0))
    assert np.array_equal(end_of({"method": place, "friction": 0.0, place: {"kappa": 2.0}}), expected)
    assert np.array_equal(end(f"{place}(kappa=2)"), expected)
    with pytest.raises(SceneError, match="kapa"):
        load_scene({**Impact().mapping(), "contact": {"method": place, place: {"kapa": 2.0}}})


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("no_such_module:Law", "cannot be imported from no_such_module:Law: ModuleNotFoundError"),
        ("mpmfw_contact.penalty:Penalti", "cannot be imported from .*: AttributeError"),
    ],
)
def test_what_is_not_there_is_said(place: str, said: str) -> None:
    with pytest.raises(SceneError, match=said):
        load_scene({**Impact().mapping(), "contact": {"method": place}})


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (Linear, r"contact plug-in mpmfw_shape.linear.Linear .*derived from mpmfw.api.ContactStrategy"),
        (
            3,
            "contact: found 3; expected a name, module:Class, or a class derived from "
            "mpmfw.api.ContactStrategy",
        ),
    ],
)
def test_what_is_no_contact_is_refused_in_one_line(given: Any, said: str) -> None:
    with pytest.raises(SceneError, match=said):
        Simulation(Impact().mapping(), contact=given)


@pytest.mark.parametrize("made", [PlainContact(), Penalty(kappa=2.0)])
def test_strategies_travel_to_other_processes(made: Any) -> None:
    assert np.array_equal(end(pickle.loads(pickle.dumps(made))), end(made))
