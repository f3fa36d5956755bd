"""Oblique impacts and a shaken table with classical contact: normals lean, and the run says by how much."""

import json
import math

import pytest

from contact_scenes import CELL, disc, rectangle, scene
from mpmfw import run
from mpmfw.contact.normal_bias import LARGEST
from mpmfw.errors import ResultsWarning
from mpmfw.runs.simulation import Simulation

TOP = 0.37 * CELL  # m, of the plane: off the grid lines
GAP = 0.2 * CELL  # m
SPEED = 1.0  # m/s
BODIES = {
    "block": lambda velocity: rectangle(
        [-0.663, TOP + GAP], [-0.263, TOP + GAP + 0.4], kind="firm", velocity=velocity
    ),
    "disc": lambda velocity: disc([-0.463, TOP + GAP + 0.2], 0.2, kind="firm", velocity=velocity),
}


def impact_at(angle, body="block", **options):
    """A frictionless body that comes down on a fixed plane at an angle [°] from the plane's normal."""
    velocity = [SPEED * math.sin(math.radians(angle)), -SPEED * math.cos(math.radians(angle))]
    fixed = [{"side": "bottom", "fixed": True}]
    plane = rectangle([-1.0, TOP - 0.3], [1.5, TOP], kind="ground", sides=fixed)
    mapping = scene({"faller": BODIES[body](velocity), "plane": plane}, friction=0.0, extent=1.7)
    end = GAP / -velocity[1] + 0.1
    mapping["time"] = {"end": end, "output_interval": end}
    mapping["contact"] = {"method": "bardenhagen", "friction": 0.0, "bardenhagen": options}
    mapping["output"] = {"gap": False}
    return mapping, velocity


def outcome(angle, body="block", **options):
    """Speed away from the plane over that of approach, sliding kept, lean, concerns."""
    mapping, velocity = impact_at(angle, body, **options)
    sim = Simulation(mapping)
    sim.run()
    p, points = sim.state.particles, sim.state.bodies[0].particles
    x, y = p.mass[points] @ p.velocity[points] / p.mass[points].sum()
    leaning = sim.contact.detection.bias
    lean = 0.0 if leaning is None else float(leaning.sideways()[0])
    return y / -velocity[1], x / velocity[0] if angle else 1.0, lean, sim.concerns()


@pytest.mark.parametrize("body", BODIES)
def test_averaged_normals_throw_up_what_slides_in_and_say_so(body):
    """Frictionless, 76° from the normal: rebound at 2.8 of the approach, and a third of the sliding is
    lost. Without sliding they lean to both sides alike.
    """
    rebound, kept, lean, concerns = outcome(76.0, body)
    assert rebound > 2.0
    assert kept < 0.7
    assert lean > 0.2
    felt = (1.0 - kept) * math.tan(math.radians(76.0)) / (1.0 + rebound)  # a friction, of the impulses
    assert 0.6 * felt < lean < felt
    assert len(concerns) == 1
    assert concerns[0].startswith(f"faller-plane: normals lean to one side by {lean:.2g} ")
    rebound, _, lean, concerns = outcome(0.0, body)
    assert rebound < 1.0
    assert lean < 0.2 * LARGEST
    assert not concerns


def test_one_body_s_normal_makes_incidence_no_matter():
    """The rebound at 76° is that of the vertical impact, and sliding is kept."""
    straight, oblique = outcome(0.0, normal="master"), outcome(76.0, normal="master")
    assert oblique[0] == pytest.approx(straight[0], abs=0.02)
    assert oblique[1] == pytest.approx(1.0, abs=0.005)
    assert not oblique[3]


def test_the_warning_is_in_the_results_and_is_not_of_the_settling():
    mapping, _ = impact_at(76.0)
    with pytest.warns(ResultsWarning, match=r"by 0\.\d+ of the normal impulse.*normal = \"master\""):
        tree = run(mapping)
    assert "normals lean" in json.loads(tree.attrs["warnings"])[0]
    sim = Simulation(mapping)
    sim.run()
    sim.contact.restart()
    assert not sim.concerns()


@pytest.mark.parametrize("options", [{}, {"normal": "master"}, {"criterion": "position", "normal": "master"}])
def test_a_table_that_is_shaken_hides_no_lean(options):
    """Sliding turns, and so do normals that lean ahead: over a period their mean is zero. Of equally stiff
    bodies ``master`` takes at corners the normal of the block, and the block follows the table.
    """
    shakes = [[0.0, 0.0, 0.0], [0.05, 0.5, 0.0], [0.15, -0.5, 0.0], [0.2, 0.0, 0.0]]
    table = rectangle(
        [-0.6, TOP - 0.2], [0.6, TOP], kind="ground", sides=[{"side": "bottom", "velocity": shakes}]
    )
    block = rectangle([-0.2, TOP], [0.2, TOP + 0.2], kind="ground")
    mapping = scene({"table": table, "block": block}, extent=1.0, gravity={"vector": [0.0, -10.0]})
    mapping["time"] = {"end": 0.2, "output_interval": 0.1}
    mapping["contact"] = {"method": "bardenhagen", "friction": 0.3, "bardenhagen": options}

    sim = Simulation(mapping)
    sim.run()
    found, concerns = sim.contact.detection.bias.sideways()[0], sim.concerns()
    assert found > LARGEST
    assert concerns[0].startswith(f"table-block: normals lean to one side by {found:.2g} ")
    if options:  # a table that is stiffer gives its normal everywhere
        mapping["materials"]["table"] = dict(mapping["materials"]["ground"])
        mapping["materials"]["table"]["bulk_modulus"] *= 1.01
        mapping["bodies"]["table"]["material"] = "table"
        assert Simulation(mapping).contact.detection.bias is None
