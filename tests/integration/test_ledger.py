"""The energy ledger: every term against what it must be, and the end of runs whose energy grows."""

from __future__ import annotations

import numpy as np
import pytest

from contact_scenes import impact, rectangle, scene
from mpmfw import run
from mpmfw.api import SimulationError
from mpmfw.effects.ledger import GROWTH_LIMIT
from mpmfw.simulation import Simulation

TERMS = (
    "gravity_work",
    "external_work",
    "contact_work",
    "inertia_work",
    "transfer_dissipation",
    "energy_residual",
)


def ledger(mapping, **keys):
    """The series of a run with the ledger on."""
    chosen = {"output.ledger": True, "output.particles": False, "output.gap": False}
    tree = run(mapping, set={**chosen, **{key.replace("__", "."): value for key, value in keys.items()}})
    return tree["series"].to_dataset()


def at_end(series, *names):
    """Values at the last output, summed over bodies or pairs."""
    return [float(series[name].isel(time=-1).sum()) for name in names]


def falling(**keys):
    """One block in free flight, thrown sideways."""
    mapping = scene({"block": rectangle([-0.2, -0.13], [0.2, 0.27], velocity=[0.5, 0.3])}, **keys)
    del mapping["contact"]
    mapping["time"] = {"end": 0.2, "output_interval": 0.05}
    return {**mapping, "gravity": {"vector": [0.0, -10.0]}}


def test_gravity_alone_accounts_for_free_fall():
    series = ledger(falling())
    energy = series["total_energy"].sum("body")
    gained = float(energy.isel(time=-1) - energy.isel(time=0))
    gravity, *others = at_end(series, *(term for term in TERMS if term in series))
    assert not {"external_work", "contact_work"} & set(series)  # nothing does any
    assert gravity == pytest.approx(gained, rel=1e-10)
    assert gravity == pytest.approx(160.0 * 10.0 * (0.5 * 10.0 * 0.2**2 - 0.3 * 0.2), rel=1e-10)  # m g h
    assert np.abs(others).max() < 1e-9 * gained


def test_prescribed_sides_do_the_work_on_a_bar_that_they_press():
    """A block between a fixed and a moving side: what the sides do is what the block stores."""
    sides = [{"side": "left", "fixed": ["x"]}, {"side": "right", "velocity": [-0.02, "free"]}]
    mapping = scene({"block": rectangle([-0.4, -0.2], [0.4, 0.2], sides=sides)})
    del mapping["contact"]
    mapping["time"] = {"end": 1.0, "output_interval": 0.1}
    series = ledger(mapping)
    external, residual, lost = at_end(series, "external_work", "energy_residual", "transfer_dissipation")
    (stored,) = at_end(series, "total_energy")
    assert external == pytest.approx(stored + lost - residual, rel=1e-9)
    assert abs(residual) < 0.02 * stored
    assert abs(lost) < 0.05 * stored


def test_pressure_does_work():
    sides = [{"side": "left", "fixed": ["x"]}, {"side": "right", "pressure": 500.0}]
    mapping = scene({"block": rectangle([-0.4, -0.2], [0.4, 0.2], sides=sides)})
    del mapping["contact"]
    mapping["time"] = {"end": 0.1, "output_interval": 0.01}
    series = ledger(mapping)
    external, stored = at_end(series, "external_work", "total_energy")
    motion = series["centre_of_mass"].sel(axis="x").isel(body=0)
    assert float(motion.isel(time=-1) - motion.isel(time=0)) < 0.0
    assert external == pytest.approx(stored, rel=0.05)
    assert stored > 0.0


def test_the_residual_falls_with_the_time_step():
    """Free spin of a soft block: what is left over is the strain's integration in time, of first order."""
    mapping = scene({"block": rectangle([-0.2, -0.2], [0.2, 0.2], angular_velocity=20.0)})
    del mapping["contact"]
    mapping["time"] = {"end": 0.05, "output_interval": 0.05}
    residuals = [
        abs(at_end(ledger(mapping, time__safety=safety), "energy_residual")[0]) for safety in (0.4, 0.2, 0.1)
    ]
    assert residuals[2] < 0.65 * residuals[1] < 0.45 * residuals[0]


@pytest.mark.parametrize(("safety", "share"), [(0.4, 0.03), (0.1, 0.008)])
def test_work_of_penalty_contact_is_in_springs_and_friction(safety, share):
    """To the error of the springs' integration in time."""
    mapping = impact(speed=2.0, slide=0.5)
    mapping["contact"]["method"] = "penalty"
    mapping["time"] = {"end": 0.08, "output_interval": 0.002}
    series = ledger(mapping, time__safety=safety)
    done = series["contact_work"]
    kept = sum(series[name].sum("pair") for name in ("contact_energy", "frictional_work", "spring_work"))
    kinetic = float(series["kinetic_energy"].sum("body").isel(time=0))
    assert float(kept.max()) > 0.02 * kinetic
    assert float(np.abs(done + kept).max()) < share * kinetic


def test_classical_contact_loses_what_its_record_says_it_rubbed_away():
    mapping = impact(speed=0.0, slide=0.5, gap=0.0)
    mapping["contact"]["method"] = "bardenhagen"
    mapping["time"] = {"end": 0.05, "output_interval": 0.01}
    work, rubbed = at_end(ledger(mapping), "contact_work", "frictional_work")
    assert work < 0.0
    assert rubbed >= 0.0


def unstable():
    """An impact with springs far past the stability limit."""
    mapping = impact(speed=2.0)
    mapping["contact"] |= {"method": "penalty", "penalty": {"kappa": 200.0}}
    mapping["time"] = {"end": 0.1, "output_interval": 0.01, "step": 2e-3}
    return mapping


def test_growing_energy_is_reported_with_its_cause():
    series = ledger(unstable() | {"allow_unstable": True}, time__end=0.03)
    energy = series["total_energy"].sum("body")
    assert float(energy.max()) > (1.0 + GROWTH_LIMIT) * float(energy.isel(time=0))


def test_a_run_whose_energy_grows_is_stopped():
    simulation = Simulation({**unstable(), "output": {"ledger": True}, "allow_unstable": True})
    simulation.manager.get_plugin("energy_ledger").bounded = True
    with pytest.raises(SimulationError, match=r"energy grew by .* likely cause: contact, .* softer contact"):
        simulation.run()


def test_the_plan_says_whether_energy_is_accounted():
    off, on = (Simulation({**falling(), "output": {"ledger": asked}}) for asked in (False, True))
    assert {e.name: e.on for e in off.effects}["energy ledger"] is False
    assert {e.name: e.on for e in on.effects}["energy ledger"] is True
    assert off.manager.get_plugin("energy_ledger") is None


def test_the_ledger_changes_no_digit_of_the_motion():
    mapping = impact(speed=1.0)
    mapping["contact"]["method"] = "penalty"
    mapping["time"] = {"end": 0.05, "output_interval": 0.01}
    without = run(mapping, set={"output.particles": False})["series"].to_dataset()
    xr_equal = without["centre_of_mass"].equals(ledger(mapping, output__gap=True)["centre_of_mass"])
    assert xr_equal
