"""Constants of settling, flutter and the verdict: each decides what its comment says, and no more."""

import math
import warnings
from types import SimpleNamespace

import numpy as np
import pytest
from test_verdict import Idle, Pump

import mpmfw
from mpmfw.effects import flutter, series, settling, verdict
from mpmfw.effects.flutter import Flutter
from mpmfw.kernels import sides
from mpmfw.kernels.sides import node_normals
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import block, two_blocks


def hanging(**changes):
    """A square that rests on its lower side under its own weight."""
    scene = block(
        gravity={"vector": [0.0, -10.0]},
        settle={"tolerance": 1e-3},
        time__end=1e-3,
        time__output_interval=1e-3,
        **changes,
    )
    scene["bodies"]["solid"]["sides"] = [{"side": "bottom", "fixed": True}]
    return scene


def settled_stress(scene):
    """Stress of the material points after settling [Pa]."""
    simulation = Simulation(scene)
    simulation.start()
    return simulation.state.particles.stress.copy()


def test_the_way_to_equilibrium_does_not_decide_where_it_is(monkeypatch):
    shipped = settled_stress(hanging())
    for name, value in (("DAMPING", 0.5), ("FLIP_SHARE", 0.5), ("STEPS_OF_MEAN", 20)):
        with monkeypatch.context() as patch:
            patch.setattr(settling, name, value)
            other = settled_stress(hanging())
        assert 0.0 < np.abs(other - shipped).max() < 0.02 * np.abs(shipped).max(), name


@pytest.mark.filterwarnings("ignore:the scene still moved")
def test_settling_gives_up_after_its_crossings(monkeypatch):
    monkeypatch.setattr(settling, "CROSSINGS", 0.5)
    with pytest.warns(mpmfw.ResultsWarning, match="settling stopped"):
        mpmfw.run(hanging())


def test_motion_left_is_a_share_of_the_strain_energy(monkeypatch):
    assert settling.concern({"settle_motion": 0.9e-3}) == []
    assert settling.concern({"settle_motion": 1.1e-3})
    monkeypatch.setattr(settling, "MOTION_LEFT", 1e-2)
    assert settling.concern({"settle_motion": 1.1e-3}) == []


def flutters(*, outputs=12, share=0.9, swing=0.05, every=1, slip=1.0, way=0.01):
    """Return whether a contact is noted whose normal force swings by a share of its mean, and turns at
    ``every`` output.

    The bodies slide by ``way`` cells between two outputs, of which ``slip`` is slip, with ``share`` of the
    limit as friction."""
    names = ("impulse", "friction_impulse", "frictional_work")
    records = {f"law/{name}": np.zeros((1, 2) if "impulse" in name else 1) for name in names}
    position, mu, interval = np.array([[0.0, 1.0], [0.0, 0.0]]), 0.5, 0.1
    bodies = [SimpleNamespace(particles=slice(0, 1)), SimpleNamespace(particles=slice(1, 2))]
    state = SimpleNamespace(
        arrays=records, pairs=[SimpleNamespace(first=0, second=1, mu=mu, label="a-b")], bodies=bodies,
        time=0.0,
        centres_of_mass=position.copy(), pair_bodies=np.array([[0, 1]]),
        grid=SimpleNamespace(dim=2, cell_size=1.0),
    )  # fmt: skip
    note = Flutter("law", 2)
    note.diagnostics(state, 0.0)
    for output in range(outputs):
        normal = 1.0 + swing * (-1.0) ** (output // every)
        friction = share * mu * normal
        position[0, 0] += way
        state.centres_of_mass = position.copy()
        state.time += interval
        records["law/friction_impulse"][0] += [-friction * interval, 0.0]
        records["law/impulse"][0] += [-friction * interval, normal * interval]
        records["law/frictional_work"][0] += slip * friction * way
        note.diagnostics(state, interval)
    return bool(note.concerns())


@pytest.mark.parametrize(
    ("name", "just", "missed"),
    [
        ("OUTPUTS", {"outputs": flutter.OUTPUTS}, {"outputs": flutter.OUTPUTS - 1}),
        ("SHARE", {"share": flutter.SHARE - 0.01}, {"share": flutter.SHARE + 0.01}),
        ("SPREAD", {"swing": 0.6 * flutter.SPREAD}, {"swing": 0.4 * flutter.SPREAD}),
        ("TURNS", {"every": 1}, {"every": flutter.TURNS}),
        ("SLIP", {"slip": 1.1 * flutter.SLIP}, {"slip": 0.9 * flutter.SLIP}),
        ("CREEP", {"way": 1.1 * flutter.CREEP}, {"way": 0.9 * flutter.CREEP}),
    ],
)
def test_flutter_is_noted_past_each_bound_alone(name, just, missed):
    assert flutters(**just), name
    assert not flutters(**missed), name


def status_of(scene, contact):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mpmfw.ResultsWarning)
        return str(mpmfw.run(scene, contact=contact).attrs["status"])


def pumped(growth, speed):
    """Status of two blocks that part at a speed and whose kinetic energy grows by a share."""
    scene = two_blocks("separate", time__end=0.01, time__output_interval=2e-3, shape__method="linear")
    scene["bodies"]["left"]["velocity"], scene["bodies"]["right"]["velocity"] = [-speed, 0.0], [speed, 0.0]
    pump = Pump()
    pump.rate = 0.5 * math.log(1.0 + growth) / 0.01
    return status_of(scene, pump)


def test_growth_is_the_share_of_energy_past_which_a_run_is_suspect(monkeypatch):
    assert pumped(0.9 * verdict.GROWTH, 1.0) == "ok"
    assert pumped(1.2 * verdict.GROWTH, 1.0).startswith("suspect: energy")
    monkeypatch.setattr(verdict, "GROWTH", 0.3)
    assert pumped(0.2, 1.0) == "ok"


def test_energy_below_rounding_is_nothing(monkeypatch):
    assert pumped(1.0, 1e-7) == "ok"
    monkeypatch.setattr(series, "NOTHING", 0.0)
    assert pumped(1.0, 1e-7).startswith("suspect: energy")


def test_too_deep_is_in_cells_however_often_runs_are_judged(monkeypatch):
    """At 1 m/s each the blocks are 0.09 m deep at the end, in cells of 0.25 m."""
    scene = two_blocks("separate", time__end=0.05, time__output_interval=2e-3, shape__method="linear")
    assert status_of(scene, Idle()) == "ok"
    monkeypatch.setattr(verdict, "TOO_DEEP", 0.3)
    for name in ("ENERGY_EVERY", "SIDES_EVERY", "OWN_EVERY"):
        assert status_of(scene, Idle()).startswith("suspect: left-right: penetration of 0.36 cells"), name
        monkeypatch.setattr(verdict, name, 1)
    assert status_of(scene, Idle()).startswith("suspect: left-right: penetration of 0.36 cells")


def test_a_node_enters_by_a_facet_that_faces_it():
    """Of a square that is turned by 30° and lies in another, one side faces its top, cos 30° > −FACING, the
    other not.
    """
    scene = two_blocks("separate", shape__method="linear", allow_overlap=True)
    corner = np.array([0.0, 0.15])
    axes = np.array([[math.cos(math.pi / 6), 0.5], [-0.5, math.cos(math.pi / 6)]])
    corners = [corner + 0.5 * np.array(each) @ axes for each in ([0, 0], [1, 0], [1, 1], [0, 1])]
    scene["bodies"]["left"]["geometry"] = {"type": "polygon", "points": [each.tolist() for each in corners]}
    scene["bodies"]["right"]["geometry"] = {"type": "rectangle", "lower": [-0.8, -0.5], "upper": [0.8, 0.3]}
    state = Simulation(scene).state
    outlines = verdict.Outlines(state)
    surface = outlines.surface
    inside = np.full(surface.count, -1)
    outlines.inside(state, inside)
    normal = np.zeros_like(surface.position)
    node_normals(surface, normal, state.grid.spacing)
    deep = (surface.body == 0) & (surface.position[:, 1] < 0.3 - 1e-9)
    towards = deep & (normal[:, 1] < sides.FACING)
    assert towards.sum() > 1
    assert (deep & ~towards).sum() > 0
    assert (inside[towards] == 1).all()
    assert (inside[deep & ~towards] == -1).all()
