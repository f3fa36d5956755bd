"""Round-off is no motion: series, differences and titles."""

from __future__ import annotations

import numpy as np
import xarray as xr

from mpmfw.results.round_off import without_round_off


def series(noise: float) -> xr.Dataset:
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


def test_noise_is_zero_and_the_start_stays() -> None:
    clean = without_round_off(series(1e-13))
    assert (clean["centre_of_mass"].sel(axis="y") == 5.0).all()
    assert (clean["mean_velocity"].sel(axis="y") == 0.0).all()
    assert (clean["angular_velocity"] == 0.0).all()
    assert clean["centre_of_mass"].sel(body="a", axis="x").values[-1] == 6.0


def test_small_motion_is_kept() -> None:
    given = series(1e-6)
    xr.testing.assert_identical(without_round_off(given)["centre_of_mass"][3], given["centre_of_mass"][3])


def test_a_scene_at_rest_has_no_motion_at_all() -> None:
    still = series(1e-13).isel(body=[1])
    clean = without_round_off(still)
    assert np.ptp(clean["centre_of_mass"].values, axis=0).max() == 0.0
    assert not clean["mean_velocity"].any()
