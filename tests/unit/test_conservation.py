"""What a run keeps of energy and momentum: series that are known, and a run."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import mpmfw
from mpmfw.conservation import energy_error, energy_put_in, momentum_change
from mpmfw.scene import load_scene
from scenes_for_tests import two_blocks

FREE = load_scene(two_blocks("penalty"))
PULLED = load_scene(two_blocks("penalty", gravity={"vector": [0.0, -9.81]}))

#: Three outputs of two bodies.
ENERGIES = {
    "total_energy": [[3.0, 1.0], [9.0, 9.0], [9.0, 9.0]],
    "gravity_work": [0.0, 6.0, 2.0],
    "external_work": [0.0, 50.0, 50.0],
    "energy_residual": [0.0, 0.5, -0.9],
}
MOMENTA = [[[2.0, 0.0], [-1.0, 0.0]], [[0.5, 0.0], [0.5, 0.3]], [[1.0, 0.0], [0.0, 0.0]]]


def run_of(**series):
    """A run with series over (time,), (time, body) or (time, body, axis)."""
    dims = ("time", "body", "axis")
    arrays = {name: (dims[: np.ndim(values)], values) for name, values in series.items()}
    return xr.DataTree.from_dict({"/series": xr.Dataset(arrays)})


def pushed(**side):
    """The blocks, the left one with a side that is pushed or held."""
    scene = two_blocks("penalty")
    scene["bodies"]["left"]["sides"] = [{"side": "left", **side}]
    return load_scene(scene)


def test_energy_is_put_in_at_the_start_by_gravity_and_by_what_moves():
    run = run_of(**ENERGIES)
    assert energy_put_in(run, FREE) == 4.0 + 6.0
    assert energy_put_in(run, pushed(fixed=["x"])) == 10.0
    assert energy_put_in(run, pushed(velocity=[1.0, "free"])) == 60.0
    assert energy_put_in(run, pushed(pressure=5.0)) == 60.0


def test_the_error_leaves_out_what_the_half_step_explains():
    assert energy_error(run_of(**ENERGIES), FREE) == pytest.approx(0.09)
    explained = run_of(**ENERGIES, half_step_work=[0.0, 0.5, -0.8], contact_residual=[0.0, 0.0, 0.3])
    assert energy_error(explained, FREE) == pytest.approx(0.02)
    without_ledger = run_of(total_energy=ENERGIES["total_energy"])
    assert np.isnan(energy_error(without_ledger, FREE))


def test_momentum_is_of_all_bodies_and_of_scenes_on_which_nothing_acts():
    run = run_of(linear_momentum=MOMENTA)
    assert momentum_change(run, FREE) == pytest.approx(0.3 / 3.0)
    for scene in (PULLED, pushed(fixed=["x"])):
        assert np.isnan(momentum_change(run, scene))


def test_a_collision_keeps_both_the_energy_to_the_step():
    errors = []
    for safety in (0.4, 0.1):
        times = {"time__end": 0.05, "time__output_interval": 0.005, "time__safety": safety}
        scene = two_blocks("penalty", output__ledger=True, **times)
        run = mpmfw.run(scene)
        assert momentum_change(run, load_scene(scene)) < 1e-12
        errors.append(energy_error(run, load_scene(scene)))
    assert 0.0 < errors[1] < 0.4 * errors[0] < 0.02
