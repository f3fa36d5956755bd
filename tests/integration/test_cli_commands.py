"""The commands end to end on a scene of a second: files, tables, pages, exit statuses."""

import csv
import io
import json
import re
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

import mpmfw
from command_line import called
from drop_for_tests import drop_scene
from mpmfw import Simulation
from mpmfw.errors import ResultsWarning
from mpmfw.scene.toml_text import toml_text
from scenes_for_tests import with_changes
from studies_for_tests import SLIDING

#: Without contact the disc falls through the floor and out of the grid.
SCENE = toml_text(
    with_changes(
        drop_scene(),
        grid__upper=[3, 5],
        time={"end": 0.04, "output_interval": 0.01},
        bodies__upper__velocity=[0, -40],
    )
)
LEAD = ("contact", "shape")


@pytest.fixture
def scene(tmp_path, monkeypatch):
    """The scene as a file in an empty folder, which is the working one."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "drop.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    """Folder, request, output and joined results of a comparison in which ``separate`` fails."""
    folder = tmp_path_factory.mktemp("compare")
    (folder / "drop.toml").write_text(SCENE)
    asked = [
        "compare",
        folder / "drop.toml",
        "--contact",
        "separate,bardenhagen,penalty",
        "-o",
        folder / "c.nc",
    ]
    asked += ["--shape", "gimp,cpdi"]
    result = called(*asked, "--report", folder / "r.html")
    return folder, asked, result, xr.load_dataset(folder / "c.nc")


def test_a_page_has_figures_before_the_last_run_ends(scene, monkeypatch):
    written = []

    def write(results, _page):
        status = results["status"] if isinstance(results, xr.Dataset) else xr.load_dataset(results)["status"]
        written.append([text.partition(":")[0] for text in status.values[:, 0].tolist()])

    monkeypatch.setattr("mpmfw.report.write_report", write)
    called("compare", scene, "--contact", "separate,bardenhagen,penalty", "--report", "r.html")
    assert written == [["failed", "ok", "not run"], ["failed", "ok", "ok"]]


def test_run_writes_what_mpmfw_opens(scene):
    result = called("run", scene, "--set", "grid.cell_size=0.2", "--set", "time.end=20 ms")
    assert (result.stdout, result.stderr) == ("drop.nc\n", "")
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
    result = called("run", scene, "--contact", "separate", "-o", "f.nc", status=1)
    assert result.stdout == ""
    assert "'upper'" in result.stderr
    with pytest.warns(ResultsWarning, match=r"f\.nc is not complete: failed: "):
        tree = mpmfw.open("f.nc")
    assert tree.attrs["status"].startswith("failed: ")
    assert tree["series"].sizes["time"] >= 2
    plotted = called("plot", "f.nc")
    assert plotted.stdout == "f.png\n"
    assert "note: f.nc is not complete: failed: " in plotted.stderr


def test_a_pipe_gets_the_table_and_the_names_of_the_files(compared):
    folder, _, result, _ = compared
    assert result.stderr == ""
    assert "\x1b" not in result.stdout
    lines = [line for line in result.stdout.splitlines() if line.startswith("penalty")]
    assert [line.split()[1] for line in lines] == ["gimp", "cpdi"]
    assert all(str(folder / name) in result.stdout for name in ("c.nc", "r.html"))
    assert "failed: " in (folder / "r.html").read_text(encoding="utf-8")


def test_csv_and_json_are_tables_of_the_same_rows(compared):
    _, asked, _, _ = compared
    first, second = (called(*asked, "--format", form) for form in ("json", "csv"))
    assert "all series and costs" in first.stderr
    rows, lines = json.loads(first.stdout), list(csv.DictReader(io.StringIO(second.stdout)))
    assert [row["contact"] for row in rows] == [line["contact"] for line in lines]
    assert all(row["cpu_time"] > 0.0 for row in rows)
    for row, line in zip(rows, lines, strict=True):
        assert all(line[key] == ("" if value is None else str(value)) for key, value in row.items())


def test_plot_draws_a_comparison(compared):
    folder = compared[0]
    result = called("plot", folder / "c.nc", "-o", folder / "figure.png")
    names = {line.rpartition("/")[2] for line in result.stdout.split()}
    kinds = ("positions", "motion", "forces", "gaps", "energies", "cost")
    assert names == {f"figure-{kind}.png" for kind in kinds}
    assert all((folder / name).stat().st_size > 10_000 for name in names)


def test_vary_adds_a_dimension_and_hints_at_the_figures(scene):
    vary = ["--vary", "grid.cell_size=0.25,0.2", "--set", "time.end=0.01"]
    result = called("compare", scene, *vary, "-o", "v.nc")
    data = xr.load_dataset("v.nc")
    assert data["kinetic_energy"].dims == (*LEAD, "cell_size", "time", "body")
    assert data["cell_size"].values.tolist() == [0.25, 0.2]
    assert data["steps"].values.ravel()[0] < data["steps"].values.ravel()[1]
    assert "mpmfw plot v.nc" in result.stdout


def test_explain_schema_and_plugins(scene):
    explained = called("explain", scene, "--contact", "none")
    assert "dt = " in explained.stdout
    assert "friction of upper-floor: contact 'none' has none" in explained.stdout
    assert "interpolate" not in explained.stdout
    longer = called("explain", scene, "--contact", "none", "--all").stdout
    assert "interpolate" in longer
    assert "particles/velocity_gradient" in longer
    schema = called("schema")
    assert {"grid", "time", "contact", "bodies"} <= set(json.loads(schema.stdout)["properties"])
    listed = called("plugins").stdout
    for name in ("none", "bardenhagen", "penalty", "linear", "cpdi2", "ck"):
        assert re.search(rf"^\s*(name\s+)?{name}\b", listed, re.MULTILINE)


def test_the_script_is_quiet_in_a_pipe(scene):
    command = [sys.executable, "-m", "mpmfw", "run", str(scene), "--set", "time.end=0.01", "-o", "q.nc"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=scene.parent)
    assert (done.stdout, done.stderr) == ("q.nc\n", "")


SCHEDULER = ["--scheduler", "tcp://127.0.0.1:1"]


@pytest.mark.parametrize(
    ("module", "arguments", "extra"),
    [
        ("hypothesis", ["check", "neo_hookean"], "testing"),
        ("xdist", ["validate", "hertz", "--quick"], "testing"),
        ("distributed", ["compare", "scene.toml", *SCHEDULER], "dask"),
    ],
)
def test_a_missing_extra_is_named_with_status_2(tmp_path, monkeypatch, module, arguments, extra):
    (tmp_path / "scene.toml").write_text(toml_text(SLIDING), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, module, None)
    assert f"pip install 'mpmfw[{extra}]'" in called(*arguments, status=2).output
    assert {path.name for path in tmp_path.iterdir()} <= {"scene.toml", "validation-results"}


def test_warm_up_takes_first_steps_of_every_combination(scene):
    result = called("warm-up", scene, "--contact", "bardenhagen,penalty", "--shape", "gimp,cpdi")
    assert "s to compile" in result.stdout
    lines = result.stdout.splitlines()
    assert [line.partition(":")[0] for line in lines] == [
        f"{contact}, {shape}" for contact in ("bardenhagen", "penalty") for shape in ("gimp", "cpdi")
    ]
    called("warm-up", scene, "--contact", "foo", status=2)
    assert not list(scene.parent.glob("*.nc*"))  # nothing is written


def test_warm_up_waits_until_bodies_touch(monkeypatch):
    forces = []

    class Watched(Simulation):
        def advance(self, steps, write=None):
            super().advance(steps, write and (lambda frame: [write(frame), forces.append(frame.series)]))

    monkeypatch.setattr("mpmfw.runs.simulation.Simulation", Watched)
    called("warm-up", "colliding-rings", "--contact", "penalty", "--shape", "linear")
    acts = [bool(series["contact_force"].any()) for series in forces]
    assert len(acts) > 6
    assert acts.index(True) >= len(acts) - 6  # of the last look
