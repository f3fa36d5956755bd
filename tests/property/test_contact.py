"""What contact must conserve and must not do, for every strategy.

``LACKS`` names the strategies without a property, and why; there the check must fail, so that no entry grows
stale.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from contact_scenes import ACTING, MU, STEP, STRATEGIES, VARIANTS, expect, impact, run, simulation, slider
from mpmfw.api import ForceContact, ImpulseContact, SimulationError, hookimpl
from mpmfw.contact import springs

TILTED = "averaged normals tilt at the block's corners, where half of the impulse then has a tangential part"
LAYER = "the interface layer has a momentum of its own beside the material points'"
MAP = "the mass-weighted map has Σ N_i x_i ≠ x_s"

LACKS: dict[str, dict[str, str]] = {
    "momentum": {"hamad2017": LAYER},
    "cone of the pair": {"bardenhagen-position": TILTED, "lcp-nodes": TILTED},
    "moment": {
        "particles": "friction acts on the points, as published",
        "penalty, gimp": MAP,
        "lcp, gimp": MAP,
    },
}

every_variant = pytest.mark.parametrize("strategy", VARIANTS)


def exchanged(strategy, motion):
    """Impulse of every step on the first body, (n, 2): as recorded, or from its momentum."""
    return motion.impulse[:, 0] if strategy in ACTING else np.diff(motion.momentum["left"], axis=0)


#: Magnitudes that a scene takes: 0, or at least 1e-60.
SLIDE, GAP, FRICTION = (
    st.floats(least, most).map(lambda x: x if abs(x) >= 1e-60 else 0.0)
    for least, most in ((-1.0, 1.0), (0.0, 0.02), (0.0, 1.0))
)


@pytest.mark.parametrize("strategy", STRATEGIES)
@settings(max_examples=3, derandomize=True, phases=[Phase.generate])  # shrinking takes minutes
@given(
    speed=st.floats(0.5, 1.5),
    slide=SLIDE,
    gap=GAP,
    right=st.sampled_from(["soft", "stiff", "stiffer"]),
    friction=FRICTION,
)
def test_linear_momentum_is_kept_in_every_step(strategy, speed, slide, gap, right, friction):
    scene = impact(speed=speed, slide=slide, gap=gap, right=right, friction=friction)

    def check(name):
        total = run(simulation(name, scene), 60).total_momentum
        scale = 160.0 * speed
        assert np.abs(np.diff(total, axis=0)).max() < 1e-13 * scale
        assert np.abs(total - total[0]).max() < 1e-12 * scale

    expect(LACKS["momentum"], strategy, check)


@every_variant
def test_recorded_impulse_is_the_change_of_momentum(strategy):
    motion = run(simulation(strategy, impact()), 100)
    for body, sign in (("left", 1.0), ("right", -1.0)):
        change = np.diff(motion.momentum[body], axis=0)
        np.testing.assert_allclose(sign * motion.impulse[:, 0], change, atol=1e-11)


@pytest.mark.parametrize("strategy", [*VARIANTS, "hamad2017", "none"])
def test_bodies_that_meet_do_not_pass_through_each_other(strategy):
    motion = run(simulation(strategy, impact()), 150)
    distance = motion.centre["right"][:, 0] - motion.centre["left"][:, 0]
    assert distance.min() > 0.85 * distance[0]


def check_no_tension(strategy, spoil=lambda _: None):
    """Bodies that part exchange nothing, and in an impact every step pushes the left body to the left."""
    sim = simulation(strategy, impact(gap=0.0, speed=-1.0))
    spoil(sim)
    motion = run(sim, 30)
    assert np.abs(exchanged(strategy, motion)).max() < 1e-12
    assert np.abs(np.diff(motion.momentum["left"], axis=0)).max() < 1e-12
    sim = simulation(strategy, impact())
    spoil(sim)
    push = -exchanged(strategy, run(sim, 150))[:, 0]
    assert push.min() >= -0.01 * np.abs(push).max() - 1e-12


@pytest.mark.parametrize("strategy", [*VARIANTS, "particles"])
def test_contact_does_not_pull(strategy):
    check_no_tension(strategy)


def reverse_normals(sim):
    """n ← −n in this strategy object alone."""
    nodes = sim.contact.detection
    pairs = nodes.pairs
    pairs.set(weight_first=-pairs.weight_first, weight_second=-pairs.weight_second)
    nodes.given = -nodes.given


def mean_normal(strategy, spoil=lambda _: None):
    """Mean over the rows of n_x, of blocks that touch; −1 out of the right block."""
    sim = simulation(strategy, impact(gap=0.0))
    spoil(sim)
    sim.step(STEP)
    rows = sim.contact.last_rows
    return rows.normal[: rows.count, 0].mean()


@pytest.mark.parametrize("strategy", [name for name in STRATEGIES if name.startswith("bardenhagen")])
def test_no_tension_notices_a_reversed_normal(strategy):
    assert mean_normal(strategy) < -0.2
    assert mean_normal(strategy, reverse_normals) > 0.2
    with pytest.raises(AssertionError):
        check_no_tension(strategy, reverse_normals)


@pytest.mark.parametrize("strategy", ["penalty", "penalty-one-pass"])
def test_no_tension_notices_a_reversed_force(strategy, monkeypatch):
    original = springs.add_friction

    def reversed_forces(rows, *arguments):
        original(rows, *arguments)
        rows.force *= -1.0

    monkeypatch.setattr(springs, "add_friction", reversed_forces)
    with pytest.raises(
        (AssertionError, SimulationError)
    ):  # bodies that pull each other in may not get through at all
        check_no_tension(strategy)


@pytest.mark.parametrize("strategy", [*VARIANTS, "hamad2017"])
@pytest.mark.parametrize("friction", [MU, 0.0])
def test_sliding_along_a_flat_face_obeys_coulomb(strategy, friction):
    """Σ |J_t| ≤ μ Σ J_n + 1 % of it for the tilt of a face that bends; without friction the tangential
    velocity stays."""

    def check(name):
        motion = run(simulation(name, slider(friction=friction)), 100)
        normal, tangential = np.abs(exchanged(name, motion)).sum(axis=0)
        assert tangential <= (friction + 0.01) * normal + 1e-9

    expect(LACKS["cone of the pair"], strategy, check)


def largest_excess(sim):
    """Largest |J_t| − μ J_n over rows, as a fraction of the largest J_n."""
    rows = sim.contact.last_rows
    force, n = rows.force[: rows.count], rows.normal[: rows.count]
    normal = (force * n).sum(axis=1)
    tangential = np.linalg.norm(force - normal[:, None] * n, axis=1)
    return (tangential - MU * normal).max() / normal.max() if len(normal) and normal.max() > 0.0 else 0.0


@pytest.mark.parametrize("strategy", ACTING)
def test_every_node_stays_in_the_cone(strategy):
    excess = []
    run(simulation(strategy, slider()), 100, each=lambda sim: excess.append(largest_excess(sim)))
    assert max(excess) < 1e-12


class Before:
    """Nodal force and momentum before contact acts."""

    name = "before"

    @hookimpl(tryfirst=True)
    def add_nodal_force(self, grid):
        self.force = grid.force.copy()

    @hookimpl(tryfirst=True)
    def after_momentum_projection(self, grid):
        self.projected = grid.momentum.copy()

    @hookimpl(tryfirst=True)
    def after_momentum_update(self, grid):
        self.updated = grid.momentum.copy()


class After:
    """Net moment of the nodal impulses of every step, over the sum of their own magnitudes times the
    lever."""

    name = "after"

    def __init__(self, before, contact):
        self.before, self.contact, self.balance = before, contact, []

    @hookimpl(trylast=True)
    def add_nodal_force(self, grid, dt):
        if isinstance(self.contact, ForceContact):
            self.note(grid, dt * (grid.force - self.before.force))

    @hookimpl(trylast=True)
    def after_momentum_projection(self, grid):
        self.corrected = grid.momentum - self.before.projected

    @hookimpl(trylast=True)
    def after_momentum_update(self, grid):
        if isinstance(self.contact, ImpulseContact):
            self.note(grid, self.corrected + grid.momentum - self.before.updated)

    def note(self, grid, impulse):
        if np.abs(impulse).sum() > 1e-6 * np.abs(grid.momentum).sum():
            for centre in ((0.0, 0.0), (0.7, -1.3)):
                x, y = (grid.position - centre).T
                scale = max(np.abs(x).max(), np.abs(y).max()) * np.abs(impulse).sum()
                self.balance.append(abs(x @ impulse[:, 1] - y @ impulse[:, 0]) / scale)


@pytest.mark.parametrize(
    ("strategy", "shape"),
    [*((name, "cpdi") for name in ACTING), *((name, "gimp") for name in ("bardenhagen", "penalty", "lcp"))],
)
def test_contact_leaves_no_moment(strategy, shape):
    def check(_):
        sim = simulation(strategy, {**slider(), "shape": {"method": shape}})
        before = Before()
        after = After(before, sim.contact)
        with sim.extra_plugin(before), sim.extra_plugin(after):
            run(sim, 60)
        assert len(after.balance) > 20
        assert max(after.balance) < 1e-12

    expect(LACKS["moment"], strategy if shape == "cpdi" else f"{strategy}, {shape}", check)
