"""The length of a step is chosen from the contacts of that step, and to look at them changes nothing."""

import numpy as np
import pytest

from contact_scenes import ACTING, disc, impact, run, scene, simulation
from measures_for_tests import detect
from mpmfw.api import hookimpl
from mpmfw.runs.simulation import Simulation


def discs(**keys):
    """Two discs that meet within a few steps, and fast."""
    return scene(
        {
            "left": disc([-0.32, 0.05], 0.3, velocity=[3.0, 0.0]),
            "right": disc([0.31, -0.05], 0.3, velocity=[-3.0, 0.0], kind="stiff"),
        },
        **keys,
    )


@pytest.mark.parametrize("scheme", ["usl", "musl", "usf"])
def test_every_step_is_within_the_limit_of_its_own_contacts(scheme):
    simulation = Simulation(discs(stepping={"scheme": scheme}), contact="penalty(kappa=4)")
    simulation.start()
    shorter = 0
    for _ in range(60):
        before = simulation.stable_step()
        simulation.step()
        own = simulation.stable_step()  # the contacts that were detected last are those of the step
        assert simulation.state.dt == own
        shorter += own < 0.99 * before and simulation.state.steps > 1
    assert shorter > 0  # springs met that the step before did not know


@pytest.mark.parametrize("contact", ["penalty", "hamad2017", "bardenhagen"])
def test_to_detect_again_changes_nothing(contact):
    def run(again):
        simulation = Simulation(discs(), contact=contact)
        simulation.start()
        for _ in range(40):
            for _ in range(again):
                detect(simulation)
            simulation.step()
        p = simulation.state.particles
        return p.position, p.velocity, p.stress

    for once, twice in zip(run(0), run(1), strict=True):
        np.testing.assert_array_equal(once, twice)


CLASSICAL = [name for name in ACTING if name.startswith("bardenhagen")]
MUSL = {"scheme": "musl", "transfer": "flip"}


class StrainVelocity:
    """Largest approach at the contact's nodes, of the momenta as the second projection leaves them [m/s]."""

    name = "strain_velocity"

    def __init__(self, contact):
        self.contact, self.projected, self.corrected = contact, [], []

    def largest_approach(self, grid):
        """Over the nodes of the contact's own list; 0 if there are none."""
        rows = self.contact.rows
        velocity = np.zeros((rows.count, 2))
        rows.momentary_velocity(grid, velocity)
        return max(0.0, *-np.einsum("ij,ij->i", velocity, rows.normal[: rows.count]), 0.0)

    @hookimpl(tryfirst=True, specname="after_second_projection")
    def before(self, grid):
        self.projected.append(self.largest_approach(grid))

    @hookimpl(trylast=True, specname="after_second_projection")
    def after(self, grid):
        self.corrected.append(self.largest_approach(grid))


@pytest.mark.parametrize(
    ("strategy", "shape"),
    [*((strategy, "cpdi") for strategy in CLASSICAL), ("bardenhagen", "linear")],
)
def test_strain_sees_no_approach_at_shared_nodes(strategy, shape):
    sim = simulation(strategy, impact(shape={"method": shape}, stepping=MUSL))
    look = StrainVelocity(sim.contact)
    with sim.extra_plugin(look):
        run(sim, 80)
    assert max(look.projected) > 0.05  # of 1 m/s: the points' new velocities do approach
    assert max(look.corrected) < 1e-12
