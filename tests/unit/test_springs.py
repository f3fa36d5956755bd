"""Springs whose share or rest changes while they are loaded, and new ones: no energy of nothing."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mpmfw
from contact_scenes import impact, rectangle, scene, wave_speed
from interpreted import interpreted
from mpmfw.runs.simulation import Simulation
from mpmfw_contact import _springs
from mpmfw_contact._springs import NOISE, WEAK, changed_spring, new_rest, set_springs

CELL = 0.1  # m
shares = st.floats(WEAK, 1.0)
gaps = st.floats(-0.5 * CELL, -1e-6 * CELL)
rests = st.floats(-0.5 * CELL, 0.0)
slides = st.floats(-2.0 * CELL, 2.0 * CELL)


def energy(share: float, rest: float, gap: float) -> float:
    """Of a spring of unit factor [m²]."""
    return 0.5 * share * max(rest - gap, 0.0) ** 2


@given(part=shares, old_part=shares, rest=rests, slid=slides, gap=gaps)
def test_a_spring_that_changes_never_pulls(part, old_part, rest, slid, gap):
    _, left = changed_spring(part, old_part, rest, slid, gap, CELL)
    assert left >= gap


@given(part=shares, old_part=shares, rest=rests, gap=gaps)
def test_a_spring_that_grows_keeps_its_force_and_one_that_shrinks_its_rest(part, old_part, rest, gap):
    rest = max(rest, gap)  # no more than unloaded
    share, left = changed_spring(part, old_part, rest, 0.0, gap, CELL)
    if part > old_part * (1.0 + NOISE):
        assert share * (left - gap) == pytest.approx(
            old_part * (rest - gap), rel=1e-9, abs=1e-17
        )  # forces are up to 1e-2
    else:
        assert left == rest
    assert share == (old_part if abs(part - old_part) <= NOISE * old_part else part)
    assert energy(old_part, rest, gap) - energy(share, left, gap) >= -1e-18  # nothing is gained


@given(gap=gaps, approached=st.floats(-0.2 * CELL, 0.5 * CELL))
def test_a_new_spring_has_at_most_the_force_of_what_approached(gap, approached):
    rest = new_rest(gap, approached)
    assert gap <= rest <= 0.0
    assert rest - gap == pytest.approx(min(max(approached, 0.0), -gap), abs=1e-15)


def test_a_node_that_comes_in_by_the_face_has_all_of_its_force():
    """At a fifth of the wave speed it comes far deeper in a step than bodies at rest ever lie."""
    mapping = impact(gap=0.0481, speed=0.2 * wave_speed("soft"), slide=0.0)
    mapping["contact"] = {"method": "penalty", "friction": 0.0}
    simulation = Simulation(mapping, shape="cpdi")
    rows = simulation.contact.old
    while not (rows.gap[: rows.count] < 0.0).any():
        simulation.advance(1)
        rows = simulation.contact.old
    loaded = np.flatnonzero(rows.gap[: rows.count] < 0.0)
    depth = -rows.gap[loaded]
    assert depth.min() > 0.015 * CELL
    assert (rows.own.rest[loaded] == 0.0).all()


@pytest.mark.parametrize(
    ("gap", "moved", "expected"),
    [
        (-0.03, -0.01, -0.005),  # by motion alone
        (-0.05, -0.01, -0.025),  # points have come: the depth is that of the motion
        (-0.01, -0.01, 0.0),  # points have left: less deep than the motion says, as none pulls bodies apart
    ],
)
def test_springs_of_mean_gaps_go_deeper_by_motion_alone(gap, moved, expected):
    zeros = {"area": np.ones(1), "tributary_area": np.ones(1), "motion": np.zeros((1, 2))}
    row = {"identity": np.zeros(1, int), "pair": np.zeros(1, int), "previous": np.zeros(1, int)}
    normal = np.array([[0.6, 0.8]])
    own, old_own = (
        SimpleNamespace(
            effective_area=np.ones(1), rest=np.full(1, -0.005), k=np.ones(1), limit_k=np.ones(1),
            moved=moved * normal,
        )
        for _ in range(2)
    )  # fmt: skip
    rows, old = (SimpleNamespace(gap=np.full(1, g), normal=normal, **row, **zeros) for g in (gap, -0.02))
    interpreted(set_springs)(rows, 1, own, old, 1, old_own, np.ones(1), 1.0, 1.0, 1.0, False, True)
    assert own.rest[0] == pytest.approx(expected, abs=1e-15)


def test_springs_at_nodes_do_not_sink_over_fifty_contacts():
    """Points that leave a node and come back take from its rest what the motion did not give."""
    pull = [
        [t, 0.0, -10.0 * (1.0 + 0.9 * np.sin(40.0 * np.pi * t))] for t in np.linspace(0.0, 2.5, 801).tolist()
    ]
    fixed = [{"side": "bottom", "fixed": True}]
    bodies = {
        "table": rectangle([-0.6, -0.3], [0.6, 0.037], kind="ground", sides=fixed),
        "block": rectangle([-0.2, 0.037], [0.2, 0.437], kind="firm"),
    }
    settle = {"gravity": {"vector": [0.0, -10.0]}}
    mapping = scene(bodies, friction=0.0, gravity={"table": pull}, settle=settle)
    mapping["time"] = {"end": 2.5, "output_interval": 0.0125}
    series = mpmfw.run(mapping, contact="nodes+penalty", shape="gimp")["series"]
    height = series["centre_of_mass"].sel(body="block", axis="y").values
    assert height[-40:].mean() == pytest.approx(height[40:80].mean(), abs=0.01 * CELL)
    energy = series["total_energy"].sum("body").values
    assert energy[-40:].max() < energy[:40].max()


def test_the_step_of_the_first_touch_is_no_longer_than_that_of_equal_bodies_in_contact():
    """With the square of the depth that it leaves grows the energy that nothing paid for."""
    simulation = Simulation(
        impact(gap=0.0481, speed=0.02 * wave_speed("soft"), slide=0.0), contact="penalty", shape="bspline"
    )
    contact = simulation.contact
    while True:
        simulation.advance(1)
        rows = contact.old
        if (rows.gap[: rows.count] < 0.0).any():
            break
        assert rows.count
        assert contact.omega_squared >= contact.estimate_frequency(contact.bulk_frequency)
    assert simulation.state.steps > 10


REST = 1e-3 * CELL  #: a depth at which bodies lie at rest [m]


def changed(part: float, old_part: float, rest: float, gap: float) -> tuple[float, float]:
    """Share and rest by the function as Python runs it, with the constants of this moment."""
    return _springs.changed_spring.py_func(part, old_part, rest, 0.0, gap, CELL)


def held_after(flickers: int) -> float:
    """Part of its force that a spring at rest still has when its share went up and down by 1 % so often."""
    share, rest = 0.5, 0.0
    for number in range(flickers):
        share, rest = changed(0.5 * (1.0 + 0.01 * (-1) ** number), share, rest, -REST)
    return share * (rest + REST) / (0.5 * REST)


def test_without_the_allowance_for_noise_a_spring_at_rest_lets_go(monkeypatch):
    assert held_after(500) == pytest.approx(1.0, abs=0.02)
    monkeypatch.setattr(_springs, "NOISE", 0.0)
    assert held_after(500) < 0.01


def force_of_a_node_from_the_side(depth: float) -> float:
    """Of one with a twentieth of its share by the side, when a face takes it, over that of all."""
    share, rest = changed(1.0, 0.05, 0.0, -depth)
    return share * (rest + depth) / depth


@pytest.mark.parametrize(("constant", "without"), [("WEAK", 0.0), ("SHALLOW", 0.0)])
def test_without_the_exception_a_node_from_the_side_bears_next_to_nothing(monkeypatch, constant, without):
    """Under the face it then has half of its length: the corner's slope was 6 % too small."""
    assert force_of_a_node_from_the_side(REST) == pytest.approx(0.5)
    monkeypatch.setattr(_springs, constant, without)
    assert force_of_a_node_from_the_side(REST) == pytest.approx(0.05)


def energy_from_nothing(old_part: float, depth: float) -> float:
    """What a node gains whose whole share a face takes, over the energy of all of its share, if it gains."""
    share, rest = changed(1.0, old_part, 0.0, -depth)
    return share * ((rest + depth) / depth) ** 2 - old_part


def test_with_a_wider_exception_nodes_gain_energy(monkeypatch):
    """Deep ones, as in 3 of 200 random impacts at twice the depth, and those that had a share to keep."""
    assert energy_from_nothing(0.05, 1.5 * 0.01 * CELL) < 0.0
    assert energy_from_nothing(0.2, REST) < 0.0
    monkeypatch.setattr(_springs, "SHALLOW", 0.02)
    assert energy_from_nothing(0.05, 1.5 * 0.01 * CELL) > 0.1
    monkeypatch.setattr(_springs, "WEAK", 0.3)
    assert energy_from_nothing(0.2, REST) > 0.04


def depth_that_stops(layers: float) -> float:
    """Depth [cells] at which springs hold the energy of two bodies at their waves' speed."""
    limit = _springs.LINEAR_TO  # stiffness and modulus are 1, as are density, speed and cell

    def held(depth: float) -> float:
        return _springs.spring_energy.py_func(1.0, depth, limit)

    return next(depth for depth in (0.01 * n for n in range(1, 10**4)) if held(depth) >= layers)


@pytest.mark.parametrize(("constant", "without"), [("GROWTH", 0.0), ("LINEAR_TO", 1.5)])
def test_springs_that_do_not_grow_stiffer_let_bodies_cross_at_the_speed_of_their_waves(
    constant, without, monkeypatch
):
    """A layer of a cell of each has gone past the reach of the search, a cell, before it stops."""
    assert depth_that_stops(1.0) < 0.8
    monkeypatch.setattr(_springs, constant, without)
    assert depth_that_stops(1.0) > 1.3


def share_of_the_step(depth: float) -> float:
    """Part of the stable step that is left where springs are so deep [cells]."""
    return _springs.tangent_stiffness.py_func(1.0, depth, _springs.LINEAR_TO) ** -0.5


@pytest.mark.parametrize(("constant", "value"), [("GROWTH", 1600.0), ("LINEAR_TO", 0.005)])
def test_springs_that_grow_stiffer_sooner_or_more_cost_steps(constant, value, monkeypatch):
    """At a fifth of a cell, as in a hard impact, and at 0.3, in the hardest."""
    assert share_of_the_step(0.2) == 1.0
    assert share_of_the_step(0.3) > 0.6
    monkeypatch.setattr(_springs, constant, value)
    assert share_of_the_step(0.2 if constant == "LINEAR_TO" else 0.3) < 0.4


@pytest.mark.parametrize("limit", [0.03, _springs.LINEAR_TO])
@pytest.mark.parametrize("depth", [0.02, 0.04, 0.3, 1.0])
def test_force_is_the_slope_of_energy_and_the_tangent_that_of_force(depth, limit):
    """With any depth from which springs grow stiffer; there all three are continuous."""
    force, energy, tangent = (
        f.py_func for f in (_springs.normal_force, _springs.spring_energy, _springs.tangent_stiffness)
    )
    step = 1e-6
    assert (energy(2.0, depth + step, limit) - energy(2.0, depth - step, limit)) / (
        2 * step
    ) == pytest.approx(force(2.0, depth, limit), rel=1e-8)
    assert (force(2.0, depth + step, limit) - force(2.0, depth - step, limit)) / (2 * step) == pytest.approx(
        tangent(2.0, depth, limit), rel=1e-8
    )
    assert [f(2.0, limit * (1 + 1e-12), limit) for f in (force, energy, tangent)] == pytest.approx(
        [2.0 * limit, limit**2, 2.0], rel=1e-9
    )


KAPPA = 0.03162277660168379


@pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")
@pytest.mark.parametrize("k", [0, 3])
def test_the_last_digits_of_the_stiffness_do_not_decide_which_nodes_bear(k):
    """Every node of the lower face carries p times its length, within 1 %: those next to the corners as
    well.
    """
    scene = mpmfw.load_scene("contact-stress", set={"contact.penalty.kappa": KAPPA * (1.0 + k * 1e-9)})
    surface = mpmfw.run(scene)["surface/upper"]
    force, place = surface["force"].values[-1], surface["position"].values[-1]
    face = (place[:, 1] < place[:, 1].min() + 0.01) & (place[:, 0] > 0.01) & (place[:, 0] < 0.99)
    np.testing.assert_allclose(force[face, 1] / force[face, 1].mean(), 1.0, atol=0.01)
