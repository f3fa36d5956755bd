"""The map of stability: classes either side of the theoretical limit, its file, its figure, its refusals."""

from __future__ import annotations

import numpy as np
import pytest
from typer.testing import CliRunner

from contact_scenes import impact
from mpmfw import open as open_results
from mpmfw.api import SceneError
from mpmfw.cli.app import app
from mpmfw.plots import figures_of, plot_file
from mpmfw.scene.toml_text import toml_text
from mpmfw.stability import CLASSES, probe, stability_map
from mpmfw.stability.chart import largest_stable

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


def test_closed_form_of_equal_bodies(chart):
    assert chart["closed_form"].values == pytest.approx(1.0 / np.sqrt(1.0 + chart["kappa"].values))


def test_steps_per_contact_fall_with_the_step(chart):
    lasted = chart["steps_per_contact"].sel(kappa=0.5)
    assert float(lasted.sel(cfl=0.2)) > float(lasted.sel(cfl=0.6)) or np.isnan(lasted.sel(cfl=0.2))


def test_ratio_of_stiffness_lowers_the_share_of_the_springs():
    made = stability_map(blocks(), ratio=[1.0, 100.0], cfl=[0.3], steps=10)
    assert made["class"].dims == ("ratio", "cfl")
    assert made["closed_form"].values == pytest.approx([1.0 / np.sqrt(2.0), 1.0 / np.sqrt(1.01)], rel=1e-6)


def test_file_and_figure(chart, tmp_path):
    path = tmp_path / "map.nc"
    chart.to_netcdf(path)
    read = open_results(path).to_dataset()
    assert list(figures_of(read)) == ["stability"]
    assert [p.stat().st_size > 5000 for p in plot_file(path)] == [True]


def test_command_writes_the_map_and_says_what_holds(tmp_path):
    scene = tmp_path / "blocks.toml"
    scene.write_text(toml_text(blocks()), encoding="utf-8")
    output = tmp_path / "map.nc"
    arguments = [
        "stability",
        str(scene),
        "-o",
        str(output),
        "--kappa",
        "1",
        "--cfl",
        "0.2,0.4",
        "--steps",
        "40",
    ]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
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
    ],
)
def test_requests_without_sense_are_refused(wrong, said):
    with pytest.raises(SceneError, match=said):
        stability_map(blocks(), **wrong)


def test_bodies_that_do_not_meet_are_classed_so():
    apart = blocks()
    for body in apart["bodies"].values():
        body["velocity"] = [0.0, 0.0]
    apart["bodies"]["right"]["geometry"]["lower"][0] += 0.2
    apart["bodies"]["right"]["geometry"]["upper"][0] += 0.2
    apart["bodies"]["left"]["velocity"] = [-0.1, 0.0]
    made = stability_map(apart, kappa=[1.0], cfl=[0.3], steps=5)
    assert made["class"].item() == CLASSES.index("no contact")


def test_probe_reports_a_refusal_and_a_failure():
    refused = probe({**blocks(), "time": {"end": 0.1, "output_interval": 0.1, "step": 0.1}}, steps=3)
    assert refused.status == "refused"
    wild = {**blocks(), "allow_unstable": True, "time": {"end": 0.1, "output_interval": 0.1, "step": 0.05}}
    assert probe(wild, steps=50).status == "failed"


def test_probe_keeps_momentum_and_energy_of_an_impact():
    found = probe(blocks(), steps=80)
    assert found.status == "ok"
    assert found.touched
    assert found.energy <= 1.005
    assert found.momentum < 1e-12
    assert found.lost == 0
