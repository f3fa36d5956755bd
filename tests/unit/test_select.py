"""Fields of a comparison: kept where the scene or the user asks, joined, selected and subtracted."""

import numpy as np
import pytest
import xarray as xr

import mpmfw
from mpmfw.errors import SceneError
from scenes_for_tests import two_blocks

SCENE = two_blocks(
    "none", time__end=2e-3, time__output_interval=1e-3, shape__method="linear", output={"particles": True}
)


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    path = tmp_path_factory.mktemp("fields") / "c.nc"
    return path, mpmfw.compare(SCENE, ["none", "separate"], ["linear"], output=path)


def test_fields_of_a_comparison_are_those_of_its_runs(compared):
    path, dataset = compared
    assert dataset["particle_position"].dims == ("contact", "shape", "particle_time", "particle", "axis")
    assert dataset["particle_position"].dtype == np.float32
    with xr.open_dataset(path) as plain:
        xr.testing.assert_equal(plain.load(), dataset)
    for contact in ("none", "separate"):
        alone, chosen = mpmfw.run(SCENE, contact=contact), mpmfw.select(path, contact=contact)
        assert chosen.attrs["contact"] == contact
        assert list(chosen["particles"].children) == list(alone["particles"].children)
        for body in alone["particles"].children:
            for name in alone[f"particles/{body}"].data_vars:
                np.testing.assert_array_equal(
                    chosen[f"particles/{body}/{name}"].values, alone[f"particles/{body}/{name}"].values
                )
        xr.testing.assert_equal(
            chosen["series/centre_of_mass"].drop_vars("body"),
            alone["series/centre_of_mass"].drop_vars("body"),
        )
        np.testing.assert_array_equal(mpmfw.field(chosen, "velocity"), mpmfw.field(alone, "velocity"))


def test_a_difference_is_that_of_the_values(compared):
    runs = [mpmfw.select(compared[1], contact=contact) for contact in ("none", "separate")]
    found = mpmfw.field(mpmfw.difference(*runs, "velocity_x"), "velocity_x_difference")
    values = [mpmfw.field(run, "velocity_x") for run in runs]
    np.testing.assert_array_equal(found, values[0].values - values[1].values)
    assert np.abs(found).max() > 0.0
    assert found.attrs["units"] == "m s-1"
    itself = mpmfw.field(mpmfw.difference(runs[0], runs[0]), "von_mises_difference")
    assert (itself == 0.0).all()


def test_what_the_scene_says_of_its_output_counts():
    """Both ways, and over the scene what is set; a scene that says nothing keeps series alone."""
    silent = {key: value for key, value in SCENE.items() if key != "output"}
    for scene, changes, kept in (
        (SCENE, {}, True),
        (SCENE, {"output.particles": False}, False),
        (silent, {}, False),
        (silent, {"output.particles": True}, True),
    ):
        dataset = mpmfw.compare(scene, ["none"], ["linear"], set=changes)
        assert ("particle_position" in dataset) == kept
        if not kept:
            with pytest.raises(
                SceneError, match=r"keeps no fields; run it with --set output\.particles=true"
            ):
                mpmfw.plots.field(dataset)
