"""Classical contact with MUSL: the momentum that the strain is taken from is corrected as well, and nothing
else is.
"""

import numpy as np
import pytest

from contact_scenes import ACTING, impact, run, simulation
from mpmfw.api import hookimpl

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


@pytest.mark.parametrize("strategy", CLASSICAL)
def test_records_are_of_the_momentum_that_moves_points(strategy):
    """Impulse of every step on the first body against its change of momentum; friction only dissipates."""
    motion = run(simulation(strategy, impact(stepping=MUSL)), 80)
    change = np.diff(motion.momentum["left"], axis=0)
    scale = np.abs(change).max()
    assert scale > 1.0
    np.testing.assert_allclose(motion.impulse[:, 0], change, atol=1e-12 * scale)
    assert (motion.work >= 0.0).all()
