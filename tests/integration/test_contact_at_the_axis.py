"""Bodies of revolution under every contact and shape: what meets at the axis, and rings far from it."""

import numpy as np
import pytest
from test_contact_combinations import MEANT

from mpmfw.runs.simulation import Simulation
from scenes_for_tests import body_of, scene_of, solid, with_changes

CONTACTS = [name for name in MEANT if name.startswith(("nodes", "logistic", "surfaces"))]
CONTACTS += ["hamad2017", "tied", "bardenhagen(criterion=position, normal=master)"]
SHAPES = ("linear", "gimp", "cpdi", "cpdi2", "bspline", "cubic_bspline")
ALL = pytest.mark.parametrize("contact", CONTACTS)


def meeting(contact, shape="cpdi", radius=0.0, begins=0.0, rigid=False, gap=0.005, **changes):
    """Half a disc at ``radius`` m that meets a plate, which ``begins`` there, at 6 m/s."""
    angle = np.linspace(-0.5, 0.5, 9) * np.pi
    arc = np.stack([radius + 0.15 * np.cos(angle), gap + 0.15 + 0.15 * np.sin(angle)], axis=1)
    arc[[0, -1], 0] = radius
    still = {"velocity": [0.0, -3.0], "rotation": "lumped"}
    ball = body_of({"type": "polygon", "points": arc.tolist()}, 0.05, **still)
    plate = solid([radius + begins, -0.2], [radius + 0.3, 0.0], 0.05, **still | {"velocity": [0.0, 3.0]})
    if rigid:
        plate = {"geometry": plate["geometry"], "rigid": True}
    lower = max(radius - 0.2, 0.0)
    scene = scene_of({"ball": ball, "plate": plate}, 0.1, [lower, -0.5], [radius + 0.6, 0.6], end=1.0)
    scene |= {"contact": {"friction": 0.2}, "shape": {"method": shape}}
    contact += "(traction=100, separation=0.01)" if "adhesion" in contact else ""
    simulation = Simulation(with_changes(scene, **{"grid__axisymmetric": True, **changes}), contact=contact)
    simulation.start()
    return simulation


def moved(simulation):
    """Return displacements of the points after 15 ms (n, 2) [m]."""
    start = simulation.state.particles.position.copy()
    for _ in range(100):
        simulation.step(1.5e-4)
    return simulation.state.particles.position - start


@ALL
@pytest.mark.parametrize("shape", SHAPES)
def test_what_meets_at_the_axis_keeps_momentum_and_gains_no_energy(contact, shape):
    simulation = meeting(contact, shape)
    p, momentum, energy = simulation.state.particles, [], []
    for _ in range(105):
        momentum.append(p.mass @ p.velocity[:, 1])
        energy.append(p.mass @ (p.velocity**2).sum(axis=1))
        simulation.step(1.5e-4)
    passed = np.abs(simulation.contact.records.impulse[:, 1]).sum()
    layer = contact == "hamad2017"  # has momentum of its own
    assert 0.2 < passed / (3.0 * p.mass.sum()) < 0.8
    assert momentum[-1] == pytest.approx(momentum[0], abs=(2e-2 if layer else 1e-12) * p.mass.sum())
    assert max(energy) < 1.0001 * energy[0]
    assert simulation.state.arrays.get(f"{contact}/spring_work", np.zeros(1)).min() > -1e-9 * energy[0]
    assert p.position[:, 0].min() > 0.0
    assert np.isfinite(p.in_space.stress).all()


@ALL
def test_a_rigid_body_may_begin_at_the_axis_or_beyond_it(contact):
    at_axis, beyond = (moved(meeting(contact, begins=begins, rigid=True)) for begins in (0.0, -0.1))
    rest = 1e-3 if contact == "surfaces+hybrid" else 1e-12  # whose springs have the area at a corner
    assert np.abs(at_axis - beyond).max() < rest
    assert at_axis[:, 1].max() > -0.03


def test_a_node_on_a_corner_at_the_axis_is_pushed_along_it():
    simulation = meeting("surfaces+lcp", rigid=True, gap=0.0)
    simulation.step(1e-4)
    rows = simulation.contact.last_rows
    normal = rows.normal[: rows.count][simulation.contact.detection.radii(rows, simulation.state.grid) < 1e-9]
    assert normal.tolist() == [[0.0, 1.0]]


@ALL
def test_far_from_the_axis_a_ring_is_a_body_of_the_plane(contact):
    ring, plane = (moved(meeting(contact, radius=1e3, grid__axisymmetric=round_)) for round_ in (True, False))
    assert np.abs(ring - plane).max() < 1e-3 * np.abs(plane).max()


@pytest.mark.parametrize("contact", ["nodes+lcp", "logistic+lcp", "bardenhagen"])
def test_a_rod_slides_through_a_rigid_bore_narrower_than_a_cell(contact):
    """Its sides, nearly parallel to the axis, do not stop the nodes there along it."""
    bore = [[0.06, -0.5], [0.3, -0.5], [0.3, 0.5], [0.065, 0.5]]
    rod = solid([0.0, -0.2], [0.05, 0.2], 0.025, velocity=[0.0, -1.0])
    bodies = {"rod": rod, "bore": {"geometry": {"type": "polygon", "points": bore}, "rigid": True}}
    scene = with_changes(scene_of(bodies, 0.1, [0.0, -1.0], [0.6, 1.0], end=1.0), grid__axisymmetric=True)
    simulation = Simulation(scene, contact=contact)
    simulation.start()
    for _ in range(60):
        simulation.step(1e-4)
    assert simulation.contact.last_rows.count > 0
    assert simulation.state.particles.velocity[:, 1].mean() == pytest.approx(-1.0, abs=0.02)
