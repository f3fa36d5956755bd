"""What a run keeps of energy and momentum: series that are known, and a run."""

import numpy as np
import pytest
import xarray as xr

import mpmfw
from mpmfw.results.analysis import without_round_off
from mpmfw.results.conservation import dissipation, energy_error, energy_put_in, momentum_change
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


KEPT = {
    "kinetic_energy": [[3.0, 0.0], [1.0, 0.5]],
    "strain_energy": [[0.5, 0.5], [0.25, 0.25]],
    "total_energy": [[3.5, 0.5], [1.25, 0.75]],
}


def test_dissipation_is_what_is_left_of_the_start_beside_all_that_is_known():
    assert dissipation(run_of(**KEPT), FREE) == pytest.approx(0.5)
    plastic = run_of(**KEPT, material_dissipation=[[0.0, 0.0], [0.5, 0.5]])
    assert dissipation(plastic, FREE) == pytest.approx(0.25)
    series = run_of(**KEPT)["series"].to_dataset()
    pairs = {
        "frictional_work": [[0.0], [0.6]],
        "contact_energy": [[0.0], [0.2]],
        "damping_work": [[0.0], [0.3]],
    }
    series = series.assign({name: (("time", "pair"), values) for name, values in pairs.items()})
    assert dissipation(series, FREE) == pytest.approx(0.3)


def test_dissipation_counts_works_and_is_unknown_without_them():
    assert np.isnan(dissipation(run_of(**KEPT), PULLED))
    assert dissipation(run_of(**KEPT, gravity_work=[0.0, 4.0]), PULLED) == pytest.approx(6.0 / 8.0)
    assert np.isnan(dissipation(run_of(**KEPT), pushed(pressure=5.0)))
    failed = {name: [values[0], [np.nan, np.nan]] for name, values in KEPT.items()}
    assert np.isnan(dissipation(run_of(**failed), FREE))


def test_dissipation_is_what_the_transfer_takes_of_two_blocks_that_meet():
    """The ledger measures the same where energy changes hands; its other terms are small here, and known."""
    scene = load_scene({**two_blocks("penalty"), "output": {"ledger": True}})
    run = mpmfw.run(load_scene(scene, set={"stepping.transfer": "pic"}))
    series = run["series"].to_dataset().isel(time=-1)
    known = series["transfer_dissipation"] - series["energy_residual"] - series.get("inertia_work", 0.0)
    known = (
        known - series["contact_work"] - (series["contact_energy"] + series["frictional_work"]).sum("pair")
    )
    put_in = energy_put_in(run, scene)
    assert dissipation(run, scene) == pytest.approx(float(known) / put_in, abs=1e-9)
    assert dissipation(run, scene) > 0.1
    flip = mpmfw.run(load_scene(scene, set={"stepping.transfer": "flip"}))
    assert 0.0 < dissipation(flip, scene) < dissipation(run, scene)


def series(noise):
    """A body that moves along x by 1 m within a second, with ``noise`` along y; another one at rest."""
    time = np.linspace(0.0, 1.0, 11)
    place = np.zeros((11, 2, 2)) + 5.0
    place[:, 0, 0] += time
    place[:, :, 1] += noise * np.sin(40.0 * time)[:, None]
    velocity = np.gradient(place, time, axis=0)
    spin = noise * np.cos(time)[:, None, None] * np.ones((11, 2, 1))
    return xr.Dataset(
        {
            "centre_of_mass": (("time", "body", "axis"), place, {"units": "m"}),
            "mean_velocity": (("time", "body", "axis"), velocity, {"units": "m s-1"}),
            "angular_velocity": (("time", "body", "rotation"), spin, {"units": "rad s-1"}),
        },
        coords={"time": time, "body": ["a", "b"], "axis": ["x", "y"], "rotation": ["z"]},
    )


def test_noise_is_zero_and_the_start_stays():
    clean = without_round_off(series(1e-13))
    assert (clean["centre_of_mass"].sel(axis="y") == 5.0).all()
    assert (clean["mean_velocity"].sel(axis="y") == 0.0).all()
    assert (clean["angular_velocity"] == 0.0).all()
    assert clean["centre_of_mass"].sel(body="a", axis="x").values[-1] == 6.0


def test_small_motion_is_kept():
    given = series(1e-6)
    xr.testing.assert_identical(without_round_off(given)["centre_of_mass"][3], given["centre_of_mass"][3])


def test_a_scene_at_rest_has_no_motion_at_all():
    still = series(1e-13).isel(body=[1])
    clean = without_round_off(still)
    assert np.ptp(clean["centre_of_mass"].values, axis=0).max() == 0.0
    assert not clean["mean_velocity"].any()
