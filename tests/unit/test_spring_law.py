"""A law of springs of a third party: its normal force, no line of friction or of geometry."""

from __future__ import annotations

import numpy as np

from contact_scenes import slider
from mpmfw import Simulation
from mpmfw.api import ForceContact
from mpmfw.contact.springs import SpringArrays, SpringLaw
from mpmfw.contact.surfaces import Surfaces
from mpmfw.kernels import kernel
from mpmfw.kernels.contact import Records, Rows
from mpmfw_contact.hamad2017 import Hamad2017Law


@kernel
def press(rows: Rows, count: int, own: SpringArrays, ratio: float, records: Records) -> None:
    """N = −k g of every row that overlaps."""
    for c in range(count):
        k, gap = own.k[c], rows.gap[c]
        if gap < 0.0:
            own.normal[c], own.k_t[c] = -k * gap, ratio * k
            records.energy[rows.pair[c]] += 0.5 * k * gap * gap


class Linear(SpringLaw):
    """Linear springs."""

    name = "linear_springs"

    def normal_forces(self, rows, old, records):  # noqa: ARG002
        """Write N."""
        press(rows, rows.count, rows.own, self.options.tangential_ratio, records)


class LinearContact(ForceContact):
    """Linear springs between surfaces."""

    name = "linear_contact"
    Detection = Surfaces
    Law = Linear


class ByHamad(ForceContact):
    """The bundled linear springs between the same surfaces."""

    name = "by_hamad"
    Detection = Surfaces
    Law = Hamad2017Law


def test_a_law_of_springs_is_its_normal_force() -> None:
    """Friction of the stage is that of the bundled law, to the bit."""
    positions, works = [], []
    for contact in (LinearContact(), ByHamad()):
        simulation = Simulation(slider(), contact=contact)
        simulation.start()
        for _ in range(40):
            simulation.step()
        positions.append(simulation.state.particles.position.copy())
        works.append(simulation.contact.records.frictional_work.copy())
    np.testing.assert_array_equal(*positions)
    np.testing.assert_array_equal(*works)
    assert works[0].max() > 0.0
