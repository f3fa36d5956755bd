"""Impulses of all rows at once in motion: first touch, sliding, what is said of solutions that were cut
short.
"""

from __future__ import annotations

import numpy as np
import pytest

import mpmfw
from contact_scenes import CELL, impact, run
from mpmfw.errors import ResultsWarning
from mpmfw.runs.simulation import Simulation


def deepest(contact, steps=120):
    """Deepest overlap of two blocks that meet at 1 m/s, over a cell."""
    found = [0.0]

    def look(sim):
        rows = sim.contact.rows
        found.append(-rows.gap[: rows.count].min() / CELL if rows.count else 0.0)

    sim = Simulation(impact(friction=0.0, slide=0.0), contact=contact)
    sim.start()
    run(sim, steps, each=look)
    return max(found)


def test_a_first_touch_leaves_no_overlap():
    assert deepest("surfaces+impulse", 12) > 1e-3
    assert deepest("lcp", 12) < 1e-5
    assert deepest("lcp") < 1e-3  # what the tolerance leaves of a hundred steps that press


def test_a_block_slides_as_coulomb_says():
    settings = {
        "grid.cell_size": 0.15,
        "time.end": 0.3,
        "output.particles": False,
        "output.gap": False,
        "settle.tolerance": 0.01,
    }
    series = mpmfw.run("sliding-block", contact="lcp", set=settings)["series"]
    time, speed = series["time"].values, series["mean_velocity"].sel(body="block", axis="x").values
    late = time > 0.05
    found = np.polyfit(time[late], speed[late], 1)[0]
    exact = 10.0 * (np.sin(np.pi / 6.0) - 0.3 * np.cos(np.pi / 6.0))
    assert found == pytest.approx(exact, rel=0.02)  # two cells high: -1.1 %; with three +0.1 %


def test_solutions_that_were_cut_short_are_told():
    scene = {**impact(), "time": {"end": 0.03, "output_interval": 0.03}}
    with pytest.warns(
        ResultsWarning, match=r"contact law 'lcp': \d+ of \d+ solutions ended after sweeps = 1 "
    ):
        mpmfw.run(scene, contact="lcp(sweeps=1)")


def test_nothing_is_said_of_solutions_that_ended_well():
    scene = {**impact(), "time": {"end": 0.03, "output_interval": 0.03}}
    assert not any("lcp" in said for said in mpmfw.run(scene, contact="lcp").attrs.get("warnings", []))
