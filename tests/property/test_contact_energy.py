"""Energy of contact: friction only takes, an impact gains nothing, and what has parted is free."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from contact_scenes import ACTING, CELL, STRATEGIES, VARIANTS, disc, impact, run, scene, simulation, slider
from mpmfw import run as run_scene

#: Some of these impacts are deep, and runs say so.
pytestmark = pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")


@pytest.mark.parametrize("strategy", VARIANTS)
def test_bodies_that_have_parted_do_not_feel_each_other(strategy):
    sim = simulation(strategy, impact(friction=0.0, slide=0.0))
    run(sim, 250)
    motion = run(sim, 300)
    distance = motion.centre["right"][:, 0] - motion.centre["left"][:, 0]
    parted = distance > 0.4 + 2.5 * CELL
    assert parted[-20:].all()
    assert np.abs(np.diff(motion.momentum["left"], axis=0)[parted[:-1]]).max() < 1e-11
    assert np.abs(motion.impulse[parted[:-1]]).max() == 0.0


@pytest.mark.parametrize("strategy", ACTING)
@settings(max_examples=3, derandomize=True, phases=[Phase.generate])  # shrinking takes minutes
@given(friction=st.floats(0.05, 1.0), gap=st.floats(0.0, 0.01).map(lambda x: x if x >= 1e-60 else 0.0))
def test_friction_never_does_negative_work(strategy, friction, gap):
    work = run(simulation(strategy, slider(friction=friction, gap=gap)), 60).work
    assert work.min() >= 0.0
    assert work.sum() > 0.0


def balance(name, mapping):
    """Kinetic, strain and spring energy and dissipation over the energy at the start, at every output."""
    method, options = STRATEGIES[name]
    contact = {**mapping["contact"], "method": method, **({method: options} if options else {})}
    series = run_scene({**mapping, "contact": contact})["series"]
    works = ("contact_energy", "frictional_work", "damping_work", "spring_work")
    spent = sum(series[work] for work in works if work in series)
    total = series["total_energy"].sum("body") + spent.sum("pair")
    return (total / total[0]).values


@pytest.mark.parametrize("strategy", VARIANTS)
def test_impact_of_blocks_gains_no_energy(strategy):
    mapping = impact(slide=0.5)
    mapping["time"] = {"end": 0.15, "output_interval": 0.005}
    assert balance(strategy, mapping).max() <= 1.005


@pytest.mark.parametrize("strategy", [name for name in ACTING if name != "hamad2017"])
def test_oblique_impact_of_discs_gains_no_energy(strategy):
    bodies = {
        "left": disc([-0.31, 0.0], 0.3, velocity=[0.7, 0.2]),
        "right": disc([0.31, 0.05], 0.3, kind="stiff", velocity=[-0.5, 0.0]),
    }
    mapping = scene(bodies, friction=0.4)
    mapping["time"] = {"end": 0.15, "output_interval": 0.005}
    total = balance(strategy, mapping)
    assert total.max() <= 1.005
    assert total.min() >= 0.5
