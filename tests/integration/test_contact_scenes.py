"""Blocks on a plane, whose motion or rest is known in closed form, and requests that must be refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_scenes import CELL, MATERIALS, impact, rectangle, scene, simulation, wave_speed
from mpmfw import run as run_scene
from mpmfw.api import SceneError, SimulationError
from mpmfw.report.table import gap_measures, rolling_measures
from mpmfw.results.references import reference_of

GRAVITY = 10.0
HEIGHT = 0.4  # m, of a block
TOP = 0.0  # m, of the plane


def block(x, y=TOP, kind="firm"):
    """A square block that stands at x on the level y."""
    return rectangle([x, y], [x + HEIGHT, y + HEIGHT], kind=kind)


def incline(blocks, angle, *, friction=0.0, pairs=(), settled=True, method="penalty", **contact):
    """Blocks on a fixed plane under gravity tilted towards +x by ``angle`` [°]."""
    plane = rectangle([-1.1, TOP - 0.3], [1.1, TOP], kind="ground", sides=[{"side": "bottom", "fixed": True}])
    mapping = scene({**blocks, "plane": plane}, friction=friction, extent=1.3)
    mapping["time"] = {"end": 0.5, "output_interval": 0.02}
    mapping["gravity"] = {"magnitude": GRAVITY, "tilt": f"{angle} deg"}
    mapping["contact"] = {"method": method, "friction": friction, "pairs": list(pairs), **contact}
    if settled:
        mapping["settle"] = {}
    return mapping


def travel(result, body):
    """Displacement of a body's centre since time zero, (time, 2) [m]."""
    centre = series(result)["centre_of_mass"].sel(body=body)
    return (centre - centre.isel(time=0)).values


def series(result):
    """The series of a run."""
    return result["series"].to_dataset() if "series" in result.children else result.to_dataset()


def fitted_acceleration(result, body):
    """Least squares of d_0 + v_0 t + a t² / 2 over the last 80 % of the time [m/s²]."""
    time = series(result)["time"].values
    late = time >= 0.2 * time[-1]
    return 2.0 * np.polyfit(time[late], travel(result, body)[late, 0], 2)[0]


def sliding(method):
    """Fitted acceleration of a block on 30°, μ = 0.3, over the closed form a = g (sin θ − μ cos θ)."""
    angle, mu = math.radians(30.0), 0.3
    mapping = incline({"block": block(-0.9)}, 30, friction=mu)
    mapping["settle"] = {"gravity": {"magnitude": GRAVITY, "tilt": 0}}
    exact = GRAVITY * (math.sin(angle) - mu * math.cos(angle))
    return fitted_acceleration(run_scene(mapping, contact=method), "block") / exact


@pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")
@pytest.mark.parametrize(
    ("method", "least", "most"),
    [
        ("penalty", 0.995, 1.005),
        ("bardenhagen(criterion=position, normal=master)", 0.995, 1.005),
        ("bardenhagen", -0.1, 0.95),  # averaged normals lean at the block's corners and hold it back
        ("none", -0.05, 0.05),  # one field sticks
    ],
)
def test_a_block_slides_as_coulomb_says_or_is_held_back(method, least, most):
    assert least <= sliding(method) <= most


def test_block_rests_below_the_angle_of_friction():
    """20° with μ = 0.5 > tan 20°, settled under the tilted gravity."""
    result = run_scene(incline({"block": block(-0.2)}, 20, friction=0.5))
    assert np.abs(travel(result, "block")).max() < 1e-3 * HEIGHT


def test_penetration_is_pressure_over_stiffness():
    """p h / (κ M) under the weight of a block, M the softer body's K + 4 G / 3."""
    m = MATERIALS["firm"]
    modulus = m["bulk_modulus"] + 4.0 / 3.0 * m["shear_modulus"]
    for kappa in (1.0, 4.0):
        sim = simulation("penalty", incline({"block": block(-0.2)}, 0), kappa=kappa)
        sim.advance(20)
        contact = sim.contact.detection.candidates
        plane_node = sim.state.surface.body[:, None] == 1
        inner = (np.abs(sim.state.surface.position[:, :1]) < 0.12) & plane_node & (contact.facet >= 0)
        depth = -contact.gap[inner].mean()
        pressure = m["density"] * GRAVITY * HEIGHT
        assert depth == pytest.approx(pressure * CELL / (kappa * modulus), rel=0.15)


def test_each_pair_has_its_own_friction():
    """Three bodies: on 20° the block with μ = 0.1 slides, the one with μ = 0.6 stays."""
    pairs = [
        {"bodies": ["slippery", "plane"], "friction": 0.1},
        {"bodies": ["rough", "plane"], "friction": 0.6},
    ]
    mapping = incline({"rough": block(-0.9), "slippery": block(-0.2)}, 20, pairs=pairs)
    mapping["settle"] = {"gravity": {"magnitude": GRAVITY, "tilt": 0}}
    mapping["time"]["end"] = 0.4
    result = run_scene(mapping)
    angle = math.radians(20.0)
    exact = GRAVITY * (math.sin(angle) - 0.1 * math.cos(angle))
    assert fitted_acceleration(result, "slippery") == pytest.approx(exact, rel=0.01)
    # It leans and shakes by up to 1.1 % of its height; the slippery one slides by more than a third of it.
    assert np.abs(travel(result, "rough")).max() < 0.02 * HEIGHT
    assert travel(result, "slippery")[-1, 0] > 0.3 * HEIGHT
    work = series(result)["frictional_work"].isel(time=-1)
    normal = MATERIALS["firm"]["density"] * HEIGHT**2 * GRAVITY * math.cos(angle)
    slid = travel(result, "slippery")[-1, 0]
    assert float(work.sel(pair="slippery-plane")) == pytest.approx(0.1 * normal * slid, rel=0.03)


def limit(kind="soft", kappa=4.0):
    """2 / sqrt(ω_bulk² (1 + κ)) of equal bodies [s]."""
    return CELL / wave_speed(kind) / math.sqrt(1.0 + kappa)


def with_step(step, **keys):
    """Two equal blocks that meet, stepped at a fixed step."""
    mapping = impact(right="soft", **keys)
    mapping["time"] = {"end": 0.1, "output_interval": 0.05, "step": step}
    mapping["contact"] = {"method": "penalty", "friction": 0.3}
    return mapping


def test_a_step_past_the_limit_of_the_meeting_nodes_is_refused_when_it_shows():
    """Surfaces that meet in the middle of a cell share its nodes, which lowers the limit after the build."""
    mapping = with_step(0.99 * limit())
    for body in mapping["bodies"].values():
        for corner in ("lower", "upper"):
            x, y = body["geometry"][corner]
            body["geometry"][corner] = [x - 0.02, y]
    with pytest.raises(SimulationError, match="stability limit"):
        run_scene(mapping)


def test_initial_overlap_is_refused_unless_allowed():
    overlapping = impact(gap=-0.02)
    overlapping["contact"] = {"method": "penalty", "friction": 0.3}
    overlapping["time"] = {"end": 0.01, "output_interval": 0.01}
    with pytest.raises(SceneError, match=r"bodies\.left: overlaps body .right.*allow_overlap"):
        run_scene(overlapping)
    result = run_scene({**overlapping, "allow_overlap": True})
    assert result.attrs["status"] == "ok"
    assert float(series(result)["min_gap"][0, 0]) == pytest.approx(-0.02, abs=1e-12)


@pytest.mark.parametrize(("name", "tolerance"), [("slip", 2.0), ("no-slip", 0.5)])
def test_a_cylinder_rolls_down_as_the_closed_form(name, tolerance):
    """Errors of displacement and spin [%], and how deep the cylinder is in the plane [cells]."""
    tree = run_scene(f"rolling-cylinder-{name}", contact="penalty", set={"output.particles": False})
    rolled = rolling_measures(series(tree), reference_of(tree.attrs))
    assert abs(rolled["displacement_error"]) <= tolerance
    assert abs(rolled["spin_error"]) <= 5.0
    gap = series(tree)["min_gap"].isel(pair=0).values / tree.attrs["cell_size"]
    assert 0.0 <= gap_measures(gap)["penetration"] <= 0.03
