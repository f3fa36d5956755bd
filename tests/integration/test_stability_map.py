"""The map of stability: classes either side of the theoretical limit, its file, its figure, its refusals."""

import json
import re

import numpy as np
import pytest
import xarray as xr

from command_line import called
from contact_scenes import impact
from mpmfw import open as open_results
from mpmfw import run
from mpmfw.api import SceneError
from mpmfw.contact.events import FEWEST_STEPS
from mpmfw.errors import ResultsWarning
from mpmfw.plots import figures_of, plot_file
from mpmfw.plugin.discovery import load
from mpmfw.scene.toml_text import toml_text
from mpmfw.stability import CLASSES, probe, stability_map
from mpmfw.stability.chart import largest_stable

#: Steps at a Courant number of 0.2 after which the blocks have parted.
REBOUND = 200
STABLE, DIVERGED = CLASSES.index("stable"), CLASSES.index("diverged")


def blocks():
    """Two equal blocks that meet, as the penalty contact takes them."""
    mapping = impact(right="soft", gap=0.0)
    mapping["contact"] = {"method": "penalty", "friction": 0.3}
    mapping["time"] = {"end": 0.1, "output_interval": 0.05}
    return mapping


@pytest.fixture(scope="module")
def chart():
    return stability_map(blocks(), kappa=[0.5, 4.0], cfl=[0.2, 0.6], steps=60)


def test_classes_lie_on_their_side_of_the_limit(chart):
    found = chart["class"].transpose("kappa", "cfl").values
    assert found.tolist() == [[STABLE, STABLE], [STABLE, DIVERGED]]
    assert chart["energy"].sel(kappa=0.5).max() <= 1.005
    assert largest_stable(chart).tolist() == [0.6, 0.2]
    assert chart["closed_form"].values == pytest.approx(1.0 / np.sqrt(1.0 + chart["kappa"].values))


def test_a_run_is_suspect_whose_energy_alone_would_make_it_stable():
    """The springs are so soft that the blocks go through each other."""
    with pytest.warns(ResultsWarning, match=r"kappa 0\.001, cfl 0\.2: suspect: left-right: .*penetration"):
        made = stability_map(blocks(), kappa=[0.001], cfl=[0.2], steps=REBOUND)
    assert made["energy"].item() <= 1.005
    assert made["class"].item() == CLASSES.index("bounded")


def test_ratio_of_stiffness_lowers_the_share_of_the_springs():
    """Keys that the map does not set are the scene's."""
    made = stability_map(blocks(), ratio=[1.0, 100.0], cfl=[0.3], steps=10)
    assert made["class"].dims == ("ratio", "cfl")
    assert made["closed_form"].values == pytest.approx([1.0 / np.sqrt(5.0), 1.0 / np.sqrt(1.04)], rel=1e-6)
    values = {"contact.penalty.kappa": 9.0, "contact.penalty.damping": 0.1}
    made = stability_map(blocks(), ratio=[1.0], cfl=[0.2], steps=5, set=values)
    assert made["closed_form"].item() == pytest.approx(1.0 / np.sqrt(10.0))
    assert "kappa = 9.0" in made.attrs["scene"]
    assert "damping = 0.1" in made.attrs["scene"]


def test_file_and_figure(chart, tmp_path):
    path = tmp_path / "map.nc"
    chart.to_netcdf(path)
    read = open_results(path)
    figure, _ = figures_of(read)["stability"]
    (legend,) = figure.legends
    named = {text.get_text() for text in legend.get_texts()} - {""}
    assert named == {"stable", "diverged", "closed form", "Gershgorin bound", "refused"}
    assert read.attrs["courant"] == 0.8
    assert [p.stat().st_size > 5000 for p in plot_file(path)] == [True]


def test_command_writes_the_map_and_says_what_holds(tmp_path):
    scene = tmp_path / "blocks.toml"
    scene.write_text(toml_text(blocks()), encoding="utf-8")
    output = tmp_path / "map.nc"
    result = called("stability", scene, "-o", output, "--kappa", 1, "--cfl", "0.2,0.4", "--steps", 40)
    assert "largest" in result.output
    assert "0.707" in result.output
    assert output.exists()
    assert output.with_suffix(".png").exists()


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"kappa": [1.0], "ratio": [2.0]}, "leave the other out"),
        ({"contact": "bardenhagen"}, "has no kappa"),
        ({"kappa": [-1.0]}, "greater than 0"),
        ({"kappa": [1.0], "cfl": [0.2, 0.2]}, "given twice"),
        ({"kappa": [1.0], "steps": 1}, "too few"),
        (
            {"set": {"contact.penalty.kappa": 9.0}},
            "--set contact.penalty.kappa: has no effect .*: it varies kappa",
        ),
        ({"set": {"time.safety": 0.1}}, "--set time.safety: has no effect .* its steps are those of cfl"),
    ],
)
def test_requests_without_sense_are_refused(wrong, said):
    with pytest.raises(SceneError, match=said):
        stability_map(blocks(), **wrong)


def test_bodies_that_do_not_meet_are_classed_so():
    apart = impact(right="soft", gap=0.2, speed=0.0)
    apart["contact"] = {"method": "penalty", "friction": 0.3}
    made = stability_map(apart, kappa=[1.0], cfl=[0.3], steps=5)
    assert made["class"].item() == CLASSES.index("no contact")


def test_probe_reports_a_refusal_and_a_failure():
    refused = probe({**blocks(), "time": {"end": 0.1, "output_interval": 0.1, "step": 0.1}}, steps=3)
    assert refused.status == "refused"
    wild = {**blocks(), "allow_unstable": True, "time": {"end": 0.1, "output_interval": 0.1, "step": 0.05}}
    assert probe(wild, steps=50).status == "failed"


def test_a_subclass_has_its_kappa(chart):
    """A law that is derived from penalty contact, by another name, is mapped as any."""
    law = type("MyPenalty", (load("contact", "penalty"),), {"name": "mypenalty", "__module__": __name__})
    made = stability_map(blocks(), law(), kappa=[0.5], cfl=[0.2, 0.6], steps=60)
    xr.testing.assert_equal(made.drop_attrs(), chart.sel(kappa=[0.5]).drop_attrs())
    assert made.attrs["contact"] == "mypenalty"


def colliding(kappa=1.0, gap=0.01, end=0.12, **keys):
    """Two equal blocks that meet."""
    mapping = impact(gap=gap, speed=1.0, slide=0.0, right="soft")
    mapping["contact"] |= {"method": "penalty", "penalty": {"kappa": kappa}}
    mapping["time"] = {"end": end, "output_interval": 0.01}
    return {**mapping, "output": {"stability": True}, **keys}


def test_steps_and_limits_are_recorded():
    tree = run(colliding(gap=0.25, end=0.3))  # apart by more than the search radius for half of the time
    series = tree["series"].to_dataset()
    owners = json.loads(tree.attrs["time_step_owners"])
    named = {owners[int(index)] for index in series["time_step_owner"].values}
    assert named == set(owners) == {"bulk wave speed (h / c)", "penalty springs and bulk"}
    steps = (0.01 / series["time_step"].values[1:]).round().sum()
    assert steps == tree.attrs["steps"]
    assert (
        series["time_step"].values[1:] <= 0.5 * (1.0 + 1e-12) * series["time_step_limit"].max().item()
    ).all()


def test_contacts_are_counted_in_steps():
    """A block touches for 2 L / c; nodes at the rim bounce more often, but none for fewer than 3 steps."""
    series = run(colliding())["series"].to_dataset().isel(pair=0)
    assert np.isnan(series["steps_per_contact"].values[0])
    assert np.nanmin(series["steps_per_contact"]) >= 3
    assert series["penetration"].max() > 0.0
    assert series["penetration"].max() >= 0.99 * (-series["min_gap"] / 0.1).max()


def test_contacts_are_those_of_the_step_whose_force_is_recorded():
    """With one output for each step, penetration and force come and go in the same frames, and a contact ends
    in the first frame without the force that it had."""
    scene = colliding(end=0.12)
    scene["time"] |= {"step": 4e-4, "output_interval": 4e-4}
    series = run(scene)["series"].to_dataset().isel(pair=0)
    pushed = np.abs(series["contact_force"].values).max(axis=1) > 0.0
    assert pushed.any()
    assert not pushed[-1]
    np.testing.assert_array_equal(series["penetration"].values > 0.0, pushed)
    last = np.flatnonzero(pushed)[-1]
    ended = np.flatnonzero(np.isfinite(series["steps_per_contact"].values))
    assert ended[-1] == last + 1


@pytest.mark.parametrize(
    ("kappa", "said"),
    [
        (0.1, r"left-right: the bodies penetrate by .* cells at time .*, more than 0\.15"),
        (0.01, r"suspect: left-right: penetration of .* cells at"),
    ],
)
def test_soft_springs_are_reported(kappa, said):
    with pytest.warns(ResultsWarning, match=said):
        tree = run(colliding(kappa=kappa))
    (warning,) = json.loads(tree.attrs["warnings"])
    assert re.search(said, warning)
    assert tree.attrs["status"].startswith("suspect") == said.startswith("suspect")


@pytest.mark.filterwarnings("ignore:suspect. energy of .* without a source")  # the step is past the limit
def test_contacts_that_steps_do_not_resolve_are_reported():
    scene = colliding(kappa=200.0, allow_unstable=True)
    scene["time"]["step"] = 1.5e-3
    with pytest.warns(
        ResultsWarning, match=rf"left-right: a contact lasted [12] steps, fewer than {FEWEST_STEPS}"
    ):
        run(scene)
