"""Impulses of all rows at once in motion: first touch, and what is said of solutions that were cut short."""

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


def test_solutions_that_were_cut_short_are_told_and_others_are_not():
    scene = {**impact(), "time": {"end": 0.03, "output_interval": 0.03}}
    said = r"contact law 'lcp': \d+ of \d+ solutions ended after sweeps = 1 "
    with pytest.warns(ResultsWarning, match=said):
        mpmfw.run(scene, contact="lcp(sweeps=1)")
    assert not any("lcp" in said for said in mpmfw.run(scene, contact="lcp").attrs.get("warnings", []))
