"""What is advised where the stable step falls to next to nothing: options that the contact has, and no
other's.
"""

import pytest

from mpmfw.api import ContactStrategy, SimulationError, hookimpl
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import two_blocks


class Strangers(ContactStrategy):
    """A contact without an option, whose limit falls in the third step."""

    name = "strangers"

    @hookimpl
    def stable_timestep(self, state):
        return (1e-3 if state.steps < 3 else 1e-12, self.name)


def advice(contact):
    """Of the error that ends the run, which went well before the bodies met."""
    with pytest.raises(SimulationError, match="the stable time step fell to") as error:
        Simulation(two_blocks("none"), contact=contact).advance(2000)
    return error.value.advice


def test_of_a_stranger_s_contact_no_option_is_named():
    assert advice(Strangers) == "a softer contact, or another shape function"


def test_of_springs_the_keys_of_the_scene_are_named():
    """Of a joined contact those of its parts' tables."""
    said = advice("surfaces+penalty(kappa=1e12)")
    assert "contact.penalty.kappa" in said
    assert "contact.surfaces.map" in said
