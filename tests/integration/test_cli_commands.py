"""The commands end to end on a scene of a second: files, tables, pages, exit statuses."""

import json
import re
import subprocess
import sys
from html.parser import HTMLParser

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import mpmfw
from mpmfw.cli import app
from mpmfw.errors import ResultsWarning
from mpmfw_contact.penalty import Penalty

# Without contact the disc falls through the floor and out of the grid.
SCENE = """\
title = "A disc dropped on a floor"

[grid]
cell_size = 0.25
lower = [0, 0]
upper = [3, 5]

[time]
end = 0.08
output_interval = 0.01

[shape]
method = "cpdi"

[contact]
method = "penalty"

[[contact.pairs]]
bodies = ["disc", "floor"]
friction = 0.3

[materials.rubber]
model = "neo_hookean"
density = 1000
bulk_modulus = "60 MPa"
shear_modulus = "30 MPa"

[bodies.disc]
material = "rubber"
geometry = { type = "disc", centre = [1.5, 1.6], radius = 0.5 }
particles = { layout = "fitted", size = 0.125 }
segment = 0.1
velocity = [0, -20]

[bodies.floor]
material = "rubber"
geometry = { type = "rectangle", lower = [0.5, 0.5], upper = [2.5, 1.0] }
particles = { size = 0.125 }
segment = 0.1
sides = [{ side = "bottom", fixed = true }]
"""

LEAD = ("contact", "shape")
DIMS = {
    "status": LEAD,
    "cpu_time_repeat": (*LEAD, "repeat"),
    "cpu_time_spread": LEAD,
    "repeats": LEAD,
    "load": LEAD,
    "scheme": LEAD,
    "transfer": LEAD,
    "centre_of_mass": (*LEAD, "time", "body", "axis"),
    "mean_velocity": (*LEAD, "time", "body", "axis"),
    "linear_momentum": (*LEAD, "time", "body", "axis"),
    "angular_velocity": (*LEAD, "time", "body", "rotation"),
    "angular_momentum": (*LEAD, "time", "body", "rotation"),
    "kinetic_energy": (*LEAD, "time", "body"),
    "strain_energy": (*LEAD, "time", "body"),
    "total_energy": (*LEAD, "time", "body"),
    "affine_energy": (*LEAD, "time", "body"),
    "contact_force": (*LEAD, "time", "pair", "axis"),
    "friction_force": (*LEAD, "time", "pair", "axis"),
    "contact_count": (*LEAD, "time", "pair"),
    "frictional_work": (*LEAD, "time", "pair"),
    "contact_energy": (*LEAD, "time", "pair"),
    "damping_work": (*LEAD, "time", "pair"),
    "spring_work": (*LEAD, "time", "pair"),
    "min_gap": (*LEAD, "time", "pair"),
    "steps": LEAD,
    "material_points": LEAD,
    "cpu_time": LEAD,
    "wall_time": LEAD,
    "peak_memory": LEAD,
    "settle_time": LEAD,
    "output_time": LEAD,
    "gap_time": LEAD,
    "compile_time": LEAD,
    "cpu_stage": (*LEAD, "stage"),
    "wall_stage": (*LEAD, "stage"),
    "outline": (*LEAD, "frame", "outlined_body", "outline_node", "axis"),
    "outline_time": (*LEAD, "frame"),
}


@pytest.fixture
def scene(tmp_path, monkeypatch):
    """The scene as a file in an empty folder, which is the working one."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "drop.toml"
    path.write_text(SCENE)
    return path


def invoke(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    """Folder, output and joined results of a comparison in which ``separate`` fails."""
    folder = tmp_path_factory.mktemp("compare")
    (folder / "drop.toml").write_text(SCENE)
    result = invoke(
        "compare", folder / "drop.toml", "--contact", "separate,bardenhagen,penalty", "--shape", "gimp,cpdi",
        "-o", folder / "c.nc", "--report", folder / "r.html",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    return folder, result, xr.load_dataset(folder / "c.nc")


def test_run_writes_what_mpmfw_opens(scene):
    result = invoke("run", scene, "--set", "grid.cell_size=0.2", "--set", "time.end=20 ms")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "drop.nc\n", "")
    tree = mpmfw.open("drop.nc")
    assert tree.attrs["status"] == "ok"
    assert tree.attrs["cell_size"] == 0.2
    assert {"series", "particles", "surface"} <= set(tree.children)
    np.testing.assert_allclose(tree["time"].values, [0.0, 0.01, 0.02], atol=1e-12)
    assert tree["series/centre_of_mass"].dims == ("time", "body", "axis")
    costs = ("steps", "material_points", "cpu_time", "wall_time", "peak_memory")
    assert all(tree.attrs[name] > 0 for name in costs)


@pytest.mark.filterwarnings("default::mpmfw.errors.ResultsWarning")
def test_a_run_that_fails_is_status_1_and_keeps_what_it_wrote(scene):
    result = invoke("run", scene, "--contact", "separate", "-o", "f.nc")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "'disc'" in result.stderr
    with pytest.warns(ResultsWarning, match=r"f\.nc is not complete: failed: "):
        tree = mpmfw.open("f.nc")
    assert tree.attrs["status"].startswith("failed: ")
    assert tree["series"].sizes["time"] >= 2
    plotted = invoke("plot", "f.nc")
    assert plotted.stdout == "f.png\n"
    assert "note: f.nc is not complete: failed: " in plotted.stderr


def test_names_and_dims_of_a_comparison(compared):
    _, _, data = compared
    assert {name: array.dims for name, array in data.data_vars.items()} == DIMS
    assert data["contact"].values.tolist() == ["separate", "bardenhagen", "penalty"]
    assert data["shape"].values.tolist() == ["gimp", "cpdi"]
    assert data["body"].values.tolist() == ["disc", "floor"]
    assert data["pair"].values.tolist() == ["disc-floor"]
    assert data["axis"].values.tolist() == ["x", "y"]


def test_a_failing_method_is_recorded_and_the_others_are_done(compared):
    _, result, data = compared
    failed = data["status"].sel(contact="separate").values.tolist()
    assert all(status.startswith("failed: ") for status in failed)
    others = data.sel(contact=["bardenhagen", "penalty"])
    assert (others["status"] == "ok").all()
    bounced = others["mean_velocity"].sel(body="disc", axis="y").isel(time=-1)
    assert (bounced > 5.0).all()
    assert np.isnan(data["mean_velocity"].sel(contact="separate").isel(time=-1)).all()
    assert f"separate, cpdi: {failed[1]}" in " ".join(result.stdout.split())


def test_a_pipe_gets_the_table_and_the_names_of_the_files(compared):
    folder, result, _ = compared
    assert result.stderr == ""
    assert "\x1b" not in result.stdout
    table, _, _ = result.stdout.partition("\n\n")
    assert max(map(len, table.splitlines())) <= 80
    lines = [line for line in result.stdout.splitlines() if line.startswith("penalty")]
    assert [line.split()[1] for line in lines] == ["gimp", "cpdi"]
    assert (
        f"{folder / 'c.nc'}: all series and costs\n{folder / 'r.html'}: tables and figures\n" in result.stdout
    )


class _Loads(HTMLParser):
    """What a page would load or run."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attrs):
        if tag in ("script", "link", "iframe", "object", "embed", "img"):
            self.found.append((tag, attrs))
        self.found += [(tag, attr) for attr in attrs if attr[0] == "src" or attr[0].startswith("on")]
        self.found += [
            (tag, attr) for attr in attrs if attr[0].endswith("href") and not attr[1].startswith("#")
        ]


def test_the_report_is_self_contained(compared):
    folder, _, _ = compared
    page = (folder / "r.html").read_text(encoding="utf-8")
    parser = _Loads()
    parser.feed(page)
    assert parser.found == []
    assert not re.search(r"url\((?!#)|@import", page)
    assert page.count("<svg") >= 3
    assert "How it was measured" in page
    assert "failed: " in page


def test_plot_draws_a_comparison(compared):
    folder, _, _ = compared
    result = invoke("plot", folder / "c.nc", "-o", folder / "figure.png")
    assert result.exit_code == 0
    names = {line.rpartition("/")[2] for line in result.stdout.split()}
    kinds = ("positions", "motion", "forces", "gaps", "energies", "cost")
    assert names == {f"figure-{kind}.png" for kind in kinds}
    assert all((folder / name).stat().st_size > 10_000 for name in names)


def test_vary_adds_a_dimension_and_hints_at_the_figures(scene):
    result = invoke(
        "compare", scene, "--vary", "grid.cell_size=0.25,0.2", "--set", "time.end=0.01", "-o", "v.nc"
    )
    assert result.exit_code == 0, result.output
    data = xr.load_dataset("v.nc")
    assert data["kinetic_energy"].dims == ("contact", "shape", "cell_size", "time", "body")
    assert data["cell_size"].values.tolist() == [0.25, 0.2]
    assert data["steps"].values.ravel()[0] < data["steps"].values.ravel()[1]
    assert "mpmfw plot v.nc" in result.stdout


def test_explain_schema_and_plugins(scene):
    explained = invoke("explain", scene, "--contact", "none")
    assert explained.exit_code == 0
    assert "dt = " in explained.stdout
    assert "friction of disc-floor: contact 'none' has none" in explained.stdout
    assert len(explained.stdout.splitlines()) <= 30
    assert "interpolate" not in explained.stdout
    longer = invoke("explain", scene, "--contact", "none", "--all").stdout
    assert "interpolate" in longer
    assert "particles/velocity_gradient" in longer
    schema = invoke("schema")
    assert schema.exit_code == 0
    assert {"grid", "time", "contact", "bodies"} <= set(json.loads(schema.stdout)["properties"])
    listed = invoke("plugins")
    assert listed.exit_code == 0
    names = ("none", "bardenhagen", "penalty", "linear", "cpdi2", "ck")
    assert all(re.search(rf"^\s*(name\s+)?{name}\b", listed.stdout, re.MULTILINE) for name in names)


def test_the_script_is_quiet_in_a_pipe(scene):
    command = [sys.executable, "-m", "mpmfw", "run", str(scene), "-o", "q.nc"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=scene.parent)
    assert (done.stdout, done.stderr) == ("q.nc\n", "")


def test_configured_strategies_are_compared_under_their_labels(scene):
    stiff = Penalty(kappa=8.0)  # twice the default
    data = mpmfw.compare(
        scene, contact=["penalty", stiff, Penalty(kappa=8.0)], shape=["gimp"], set={"time.end": 0.04}
    )
    labels = data["contact"].values.tolist()
    assert labels == ["penalty", stiff.label, f"{stiff.label}#2"]
    assert "kappa" in stiff.label
    assert (data["status"] == "ok").all()
    depth = -data["min_gap"].isel(pair=0, shape=0).min("time")
    assert depth[1] < depth[0]
    xr.testing.assert_equal(
        data["centre_of_mass"].sel(contact=labels[1], drop=True),
        data["centre_of_mass"].sel(contact=labels[2], drop=True),
    )
