"""Runs of small scenes against closed forms and invariants."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scenes import CELL, SPEED_OF_SOUND, bars

import mpmfw


@pytest.fixture(scope="module")
def impact():
    """Series of two equal bars that meet end on, every step recorded."""
    return mpmfw.run(bars())["series"].to_dataset()


def test_bars_exchange_their_velocities(impact):
    """Equal bars: e = 1 by wave theory, in one contact of the duration 2 L / c. The surface's cells alone stop for good."""
    speed = impact.mean_velocity.sel(axis="x")
    parting = speed.sel(body="right") - speed.sel(body="left")
    restitution = -float(parting[-1] / parting[0])
    assert 0.85 < restitution <= 1.0
    pressed = impact.time[np.abs(impact.contact_force.isel(pair=0).sel(axis="x")) > 0.0]
    assert float(pressed[-1] - pressed[0]) == pytest.approx(2.0 / SPEED_OF_SOUND, rel=0.1)


def test_force_is_the_waves(impact):
    """While the waves travel, each bar gets the force ρ c v/2 times its height."""
    force = impact.contact_force.isel(pair=0).sel(axis="x")
    met = float(impact.time[np.flatnonzero(force)[0]])
    during = force.sel(time=slice(met + 0.2 / SPEED_OF_SOUND, met + 1.8 / SPEED_OF_SOUND))
    assert float(during.mean()) == pytest.approx(-1000.0 * SPEED_OF_SOUND * 0.15 * 0.3, rel=0.05)


def test_nothing_penetrates_after_any_step(impact):
    assert float(impact.min_gap.min()) > -1e-4 * CELL
    touching = impact.min_gap.isel(pair=0)[impact.contact_count.isel(pair=0).values > 0]
    assert len(touching) > 50
    assert float(np.abs(touching).max()) < 1e-3 * CELL


def test_linear_momentum_is_kept(impact):
    total = impact.linear_momentum.sum("body")
    scale = float(np.abs(impact.linear_momentum).max())
    assert float(np.abs(total - total[0]).max()) < 1e-12 * scale


def test_impulse_is_the_change_of_momentum(impact):
    steps = impact.time.diff("time").values
    impulse = np.cumsum(impact.contact_force.isel(pair=0).sel(axis="x").values[1:] * steps)
    change = impact.linear_momentum.sel(body="left", axis="x").values
    np.testing.assert_allclose(impulse, change[1:] - change[0], atol=1e-10 * np.abs(change).max())


def test_energy_never_grows(impact):
    energy = (impact.kinetic_energy + impact.strain_energy).sum("body")
    assert float(energy.max()) <= 1.0005 * float(energy[0])


def test_works_add_up_to_what_contact_takes_from_the_grid():
    tree = mpmfw.run(bars(friction=0.3, slide=0.2, steps=150, passes="one", sweeps=1000))
    series = tree["series"].to_dataset()
    lost = (series.frictional_work + series.damping_work).isel(pair=0)
    assert float(series.frictional_work[-1, 0]) > 0.0
    np.testing.assert_allclose(lost, -series.contact_work, atol=1e-9 * float(lost[-1]))


@pytest.mark.parametrize("passes", ["one", "two"])
def test_block_slides_down_an_incline(passes):
    """a = g (sin θ − μ cos θ), fitted over the motion after the sudden tilt."""
    scene = mpmfw.load_scene(
        "sliding-block",
        set={"time.end": 0.2, "output.particles": False, "contact.surface_impulse.passes": passes},
    )
    series = mpmfw.run(scene, contact="surface_impulse")["series"].to_dataset()
    velocity = series.mean_velocity.sel(body="block", axis="x")
    found = np.polyfit(series.time, velocity, 1)[0]
    assert found == pytest.approx(10.0 * (0.5 - 0.3 * math.cos(math.pi / 6)), rel=0.01)
    assert float(series.min_gap.min()) > -1e-3 * CELL
