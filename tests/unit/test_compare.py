"""Comparisons: joining, failures, refusals, saving; and their table on data whose errors are known."""

import json

import numpy as np
import pytest
import xarray as xr

import mpmfw
from mpmfw.api import ContactStrategy, hookimpl
from mpmfw.errors import Interrupted, SceneError
from mpmfw.plots import figures_of
from mpmfw.report import table
from mpmfw.results.references import rings_table
from mpmfw.scene.loading import shipped_scenes
from studies_for_tests import SLIDING


def compare(contact, shape, vary=None, **arguments):
    """Compare runs of milliseconds, in this process."""
    return mpmfw.compare(SLIDING, contact, shape, vary, repeats=1, jobs=1, **arguments)


def test_methods_are_by_default_those_of_the_scene():
    data = compare(None, None, {"contact.friction": [0.1, 0.2]})
    assert (data.contact.item(), data["shape"].item()) == ("penalty", "cpdi")
    assert (data.status == "ok").all()


class Choosy(ContactStrategy):
    """Does not go with linear functions, and breaks with others."""

    name = "choosy"

    @hookimpl
    def setup(self, setup):
        if setup.shape == "linear":
            raise SceneError("choosy does not go with linear")

    @hookimpl
    def end_step(self):
        raise ValueError("it broke")


def test_joined_on_contact_and_shape_with_what_failed_and_what_was_refused():
    data = compare([Choosy(), "penalty"], ["linear", "cpdi"])
    assert data["centre_of_mass"].dims == ("contact", "shape", "time", "body", "axis")
    assert data["centre_of_mass"].attrs["units"] == "m"
    alone = mpmfw.run(SLIDING, contact="penalty", shape="cpdi")["series/centre_of_mass"]
    joined = data["centre_of_mass"].sel(contact="penalty", shape="cpdi")
    np.testing.assert_array_equal(joined, alone)
    assert (data["cpu_stage"].sel(contact="penalty", stage="shape") > 0.0).all()
    assert "scene" in data.attrs
    assert "contact" not in data.attrs
    (refused, failed), others = data["status"].values
    assert refused == "refused: choosy does not go with linear"
    assert failed.startswith("failed: ")
    assert others.tolist() == ["ok", "ok"]
    assert np.isnan(data["centre_of_mass"].values[0, 1, -1]).all()
    with pytest.raises(SceneError, match="does not go"):
        compare([Choosy()], ["linear"])


def made(scene, time, bodies, **series):
    """A comparison of one method: series with their dimensions, and costs."""
    lead = ("contact", "shape")
    arrays = {name: ((*lead, "time", *dims), values[None, None]) for name, (dims, values) in series.items()}
    costs = {"cpu_time": 0.6, "steps": 100.0, "material_points": 1000.0}
    arrays |= {name: (lead, np.full((1, 1), value)) for name, value in costs.items()}
    arrays["status"] = (lead, np.array([["ok"]]))
    coords = {"contact": ["penalty"], "shape": ["cpdi"], "time": time, "body": bodies}
    coords |= {"axis": ["x", "y"], "rotation": ["z"], "pair": ["-".join(bodies)]}
    attrs = {"scene": shipped_scenes()[scene], "varied": json.dumps({}), "kind": "compare"}
    return xr.Dataset(arrays, coords, attrs)


def rolling(friction):
    """A cylinder that rolls a hundredth too far, and turns a tenth too slowly."""
    time, zero = np.linspace(0.0, 1.7, 18), np.zeros(18)
    rate, spin = 10.0 * (np.sin(np.pi / 3) - friction * 0.5), -2.0 * friction * 10.0 * 0.5 / 1.6

    def of_bodies(values):
        return np.stack([values, zero], axis=1)

    way = np.stack([of_bodies(1.01 * 0.5 * rate * time**2), np.zeros((18, 2))], axis=2)
    return made(
        "rolling-cylinder-slip",
        time,
        ["cylinder", "plane"],
        centre_of_mass=(("body", "axis"), way),
        mean_velocity=(("body", "axis"), np.gradient(way, time, axis=0)),
        angular_velocity=(("body", "rotation"), of_bodies(0.9 * spin * time)[..., None]),
        min_gap=(("pair",), np.full((18, 1), 0.2)),
    )


def test_table_finds_the_errors_that_were_put_in_by_each_row_s_own_closed_form():
    (row,) = table(rolling(0.286))
    for name, error in (("displacement_error", 1.0), ("acceleration_error", 1.0), ("spin_error", -10.0)):
        assert row[name] == pytest.approx(error)
    assert (row["gap"], row["cost"]) == pytest.approx((0.5, 6000.0))
    (row,) = table(rolling(0.286).isel(time=slice(0, 8)))
    assert np.isnan(row["displacement_error"])
    several = xr.concat([rolling(each) for each in (0.1, 0.286)], xr.Variable("friction", [0.1, 0.286]))
    several.attrs["varied"] = json.dumps({"friction": "contact.pairs[0].friction"})
    assert [row["displacement_error"] for row in table(several)] == pytest.approx([1.0, 1.0])


def test_rings_measures_vanish_for_the_reference_itself():
    """Force and kinetic energy are those of the reference, at its times."""
    reference = rings_table("force")
    time = reference["time"]
    exact = np.diff(reference["fine_impulse_Ns_per_m"], prepend=0.0) / np.diff(time, prepend=-1.0)
    kinetic = np.interp(time, rings_table("energy")["time"], rings_table("energy")["fine_kinetic_J_per_m"])
    dataset = made(
        "colliding-rings",
        time,
        ["left", "right"],
        contact_force=(("pair", "axis"), np.stack([-exact, 0.0 * exact], axis=1)[:, None]),
        kinetic_energy=(("body",), np.stack([0.5 * kinetic] * 2, axis=1)),
    )
    (row,) = table(dataset)
    for name in ("impulse_error", "impulse_curve_error", "energy_curve_error", "force_error_100us"):
        assert row[name] == pytest.approx(0.0, abs=1e-6)
    assert row["separation"] == pytest.approx(2.971, abs=0.01)
    assert set(figures_of(dataset)) == {"force"}
    (short,) = table(dataset.isel(time=dataset["time"] < 3.1e-3))
    for name in ("impulse_curve_error", "energy_curve_error", "force_error_100us", "force_error_200us"):
        assert np.isnan(short[name])  # stopped before the end of what is compared
    assert short["impulse_error"] == pytest.approx(0.0, abs=1e-3)


def test_a_comparison_that_is_interrupted_writes_all_runs_that_ended(tmp_path):
    def stop(event):
        if event.done == 3:
            raise KeyboardInterrupt

    path = tmp_path / "all.nc"
    with pytest.raises(Interrupted, match="keeps 3 finished runs"):
        compare(["none", "separate"], ["linear", "gimp"], output=path, progress=stop)
    with xr.open_dataset(path) as data:
        assert int(data["steps"].notnull().sum()) == 3
