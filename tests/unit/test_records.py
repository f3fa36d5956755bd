"""Records of comparisons: written, read, refused and ranked."""

import json
import math
import os
from pathlib import Path

import numpy as np
import pytest
from pydantic import BaseModel

import mpmfw
from command_line import called
from mpmfw.api import Boundary
from mpmfw.errors import SceneError
from mpmfw.plots import write_figure
from mpmfw.plots.records import dots
from mpmfw.report.records import Record, _given, _problem, dots_of, ranked, read_records, write_records
from mpmfw.scene import load_scene
from msh_files import write_msh
from python_files import module_of
from scenes_for_tests import SOFT, block, one_body, two_blocks, with_changes

ARENA_TABLE = module_of(Path(__file__).resolve().parents[2] / "docs" / "make_arena.py")
CELL = {"grid.cell_size": 0.4}
SLIP = "rolling-cylinder-slip-rigid"


SIZES = {"grid.cell_size": 0.8, "bodies.cylinder.particles.size": "1 cell", "time.end": 0.05}


@pytest.fixture(scope="module")
def dataset():
    return mpmfw.compare(SLIP, ["penalty"], ["linear"], {"time.safety": [0.4, 0.5]}, set=SIZES)


@pytest.fixture
def folder(dataset, tmp_path):
    write_records(dataset, tmp_path / "records")
    return tmp_path / "records"


def test_every_row_has_a_record_of_its_own(dataset, folder):
    one, two = sorted(read_records(folder), key=lambda record: record.settings["time.safety"])
    assert (one.settings["time.safety"], two.settings["time.safety"]) == (0.4, 0.5)
    assert one.settings["grid.cell_size"] == 0.8
    assert one.problem == two.problem
    assert (one.method, one.shape, one.status) == ("penalty", "linear", "ok")
    assert one.code == f"mpmfw {mpmfw.__version__}, float64, CPU"
    assert one.figures["steps"] == float(dataset["steps"].sel(safety=0.4).item())
    assert "displacement_error" not in one.figures  # it did not reach 10 m
    write_records(dataset, folder)
    assert len(list(folder.iterdir())) == 2


def test_other_settings_have_a_record_of_their_own(dataset, folder):
    changed = {**SIZES, "contact.penalty.kappa": "8", "time.safety": "0.4"}
    (path,) = write_records(mpmfw.compare(SLIP, ["penalty"], ["linear"], set=changed), folder)
    assert len(list(folder.iterdir())) == 3
    settings = json.loads(path.read_text())["settings"]
    assert (settings["contact.penalty.kappa"], settings["time.safety"]) == ("8", "0.4")
    assert "time.end" not in settings
    assert len({record.problem for record in read_records(folder)}) == 1
    edited = dataset.assign_attrs(scene=dataset.attrs["scene"] + "\n[contact.penalty]\nkappa = 8.0\n")
    write_records(edited.assign_attrs(title="of two\nlines"), folder)
    assert len(list(folder.iterdir())) == 5


class Held(Boundary):
    """Holds its bodies at a speed."""

    name = "held"

    class Options(BaseModel):
        speed: float = 1.0

    def velocity(self, position, time):
        return np.full_like(position, self.options.speed * time)


PUSH = {"model": "point_force", "at": [0, 0], "force": [1e4, 0]}
COHESION = {"method": "none", "friction_law": "mohr_coulomb", "mohr_coulomb": {"cohesion": 1e3}}


@pytest.mark.parametrize(
    ("scene", "changes"),
    [
        (block(), {"materials__soft__bulk_modulus": 3e6}),
        (block(), {"materials__soft__density": 900.0}),
        (block(), {"time__end": 1.0}),
        (block(), {"materials__soft__damping": {"bulk": 1e-6}}),
        (block(loads={"push": PUSH}), {"loads__push__force": [2e4, 0]}),
        (block(boundaries={"a": {"model": f"{__name__}:Held"}}), {"boundaries__a__speed": 2.0}),
        (
            two_blocks("none", contact=COHESION),
            {"contact__mohr_coulomb__cohesion": 2e3},
        ),
        (block(gravity={"vector": [0, -2]}, settle={}), {"settle": {"gravity": {"vector": [0, -1]}}}),
    ],
)
def test_the_problem_knows_the_options_of_plug_ins(scene, changes):
    assert _problem(load_scene(with_changes(scene, **changes)), {}) != _problem(load_scene(scene), {})


@pytest.mark.parametrize(
    ("scene", "changes"),
    [
        (block(gravity={"vector": [0, -2]}, settle={}), {"settle": {"max_time": 1.0, "tolerance": 1e-4}}),
        (block(), {"allow_overlap": True, "allow_unstable": True, "bodies__solid__volumetric": "averaged"}),
        (block(), {"materials": {"hard": SOFT}, "bodies__solid__material": "hard"}),
        (block(loads={"push": PUSH}), {"loads": {"pull": PUSH}}),
        (two_blocks("penalty"), {"contact__penalty": {"kappa": 2.0}, "grid__cell_size": 0.125}),
        (two_blocks("penalty"), {"contact__method": "lcp", "shape__method": "linear"}),
        (block(), {"bodies__solid__particles__size": 0.25, "stepping__transfer": "pic"}),
    ],
)
def test_the_problem_knows_no_methods_and_no_names(scene, changes):
    assert _problem(load_scene(with_changes(scene, **changes)), {}) == _problem(load_scene(scene), {})


def test_a_mesh_counts_by_its_content(tmp_path):
    def hashed(name, width):
        points, file = [(0, 0, 0), (width, 0, 0), (width, 1, 0), (0, 1, 0)], tmp_path / name
        write_msh(file, points, {"quad": [[0, 1, 2, 3]]})
        scene = one_body({"type": "mesh", "path": str(file)}, size=0.5, layout="fitted")
        return _problem(load_scene(scene), {})

    assert hashed("a.msh", 1.0) == hashed("b.msh", 1.0) != hashed("a.msh", 1.25)


def test_keys_of_later_versions_that_are_off_leave_the_problem():
    tables = {"a": 0.0, "b": {"c": [0, 0], "d": True}}
    later = {**tables, "b": {**tables["b"], "new": None, "switch": False}, "table": {"inner": {}}, "list": []}
    assert _given(later) == tables
    assert _given({**later, "b": {**later["b"], "switch": True}}) != tables


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"more": 1}, "'more': Extra inputs are not permitted"),
        ({"version": 2}, "'version': Input should be 1"),
        ({"problem": "../../etc"}, "'problem': String should match pattern"),
        (None, ": Invalid JSON"),
        ({"more\nlines": 1}, r"'more\nlines': Extra"),
        ({"settings": CELL | {"cpu_time": "x"}}, "'cpu_time' does not name one of the settings"),
        ({"settings": CELL | {"method": "best"}}, "'method' does not name one of the settings"),
        ({"settings": CELL | {"style": "red"}}, "'style' does not name one of the settings"),
        ({"settings": CELL | {"a\x1b[31m": 1.0}}, "String should match pattern"),
        ({"figures": {"foo_error": 1.0}}, "'foo_error' does not name one of the figures"),
        ({"code": "\x1b[31mred"}, "'code': String should match pattern"),
        ({"machine": "x" * 1000}, "'machine': String should have at most"),
        *(
            ({"settings": {"grid.cell_size": size}}, f"expected a positive number [m], not {size!r}")
            for size in ("abc", -1, 0.0, True, math.inf, math.nan)
        ),
        ({"code": ""}, "'code': Value error, expected a name, not ''"),
        ({"figures": {"cpu_time": -1}}, "'figures': Value error, cpu_time: expected 0 or more, not -1"),
    ],
)
def test_a_file_that_is_no_record_gives_one_line(folder, change, said):
    path = min(folder.iterdir())
    path.write_text("{" if change is None else json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(SceneError) as caught:
        read_records(folder)
    (line,) = str(caught.value).splitlines()
    assert line.startswith(str(path))
    assert said in line


def test_links_pipes_and_large_files_are_refused(folder, tmp_path):
    (folder / "link.json").symlink_to(min(folder.iterdir()))
    (folder / "zeros.json").write_bytes(b" " * 200_000)
    os.mkfifo(folder / "pipe.json")
    with pytest.raises(SceneError) as caught:
        read_records(folder)
    assert len(str(caught.value).splitlines()) == 3
    with pytest.raises(SceneError, match="holds no records"):
        read_records(tmp_path / "none")


def record(method, cost, status="ok", settings=None, machine="m", problem=16 * "0", **figures):
    """A record of a made-up problem."""
    facts = {"scene": "s", "problem": problem, "tables": 16 * "0", "shape": "x", "code": "c"}
    facts |= {"machine": machine, "settings": CELL | (settings or {})}
    figures |= {"cpu_time": cost}
    return Record(**facts, method=method, status=status, figures=figures)


def test_the_largest_error_ranks_then_the_cost():
    records = [
        record("suspect", 0.1, "suspect: energy grew", displacement_error=0.0, spin_error=0.0),
        record("has no spin", 0.1, displacement_error=0.1),
        record("turns not", 1.0, displacement_error=0.1, spin_error=-99.0),
        record("dear", 9.0, displacement_error=1.0, spin_error=-3.0, settings={"foo_error": "hello"}),
        record("cheap", 2.0, displacement_error=-3.0, spin_error=1.0),
    ]
    (rows,) = ranked(records).values()
    assert [row["method"] for row in rows] == ["cheap", "dear", "turns not", "has no spin", "suspect"]


def test_a_share_is_compared_with_per_cent():
    records = [
        record("20 %", 1.0, force_error_100us=0.2, impulse_error=1.0),
        record("10 %", 2.0, force_error_100us=0.1, impulse_error=2.0),
        record("5 %", 3.0, force_error_100us=0.01, impulse_error=5.0),
    ]
    (rows,) = ranked(records).values()
    assert [row["method"] for row in rows] == ["5 %", "10 %", "20 %"]


def test_a_figure_has_the_errors_and_the_cost_of_each_record():
    records = [
        record(
            "fine",
            2.0,
            displacement_error=-3.0,
            impulse_error=10.0,
            force_error_100us=0.3,
            spin_error=-20.0,
            settings={"grid.cell_size": 0.2},
        ),
        record("fine", 1.0, displacement_error=-4.0, spin_error=0.0),
        record("failed", 1.0, "suspect: energy grew", displacement_error=1.0),
        record("bare", 3.0),
    ]
    found = dots_of(records)
    assert [(dot.row[2], dot.method) for dot in found] == [(0.4, "bare"), (0.4, "fine"), (0.2, "fine")]
    assert found[1][2:] == ("c", 4.0, 0.0, 1.0)
    assert found[2][2:] == ("c", pytest.approx(10.0), 20.0, 2.0)
    assert np.isnan([found[0].motion, found[0].spin]).all()
    spin = [line.get_xdata()[0] for line in dots(found).axes[1].lines if line.get_marker() == "o"]
    assert spin[1:] == pytest.approx([0.01, 20.0])  # at the edge, as a logarithm has no zero


def test_machines_and_problems_do_not_mix():
    other = {"machine": "n"}
    records = [record(name, cost) for name, cost in (("penalty", 1.0), ("lcp", 2.0))]
    records += [record(name, cost, **other) for name, cost in (("penalty", 10.0), ("lcp", 40.0))]
    records += [record("lcp", 1.0, **other, problem=16 * "1"), record("none", 1.0, machine="third")]
    assert len(dots(dots_of(records)).axes[0].get_yticklabels()) == 4
    table = {line.split(" | ")[0]: line.split(" | ")[-1] for line in ARENA_TABLE.rows(records).splitlines()}
    assert table["| penalty"] == "1.00 |"
    assert table["| lcp"] == "3.00 |"  # of 2 and 4, each on its machine
    assert table["| none"] == "– |"


@pytest.mark.parametrize("figures", [{"cpu_time": 0.0}, {}, {"cpu_time": 1.0, "displacement_error": 1e300}])
def test_every_valid_record_has_a_figure(tmp_path, figures):
    records = [record("penalty", 1.0).model_copy(update={"figures": figures}), record("lcp", 1.0)]
    write_figure(dots(dots_of(records)), tmp_path / "x.png")
    assert "| lcp |" in ARENA_TABLE.rows(records)


def test_records_of_failed_runs_alone_have_no_figure():
    with pytest.raises(SceneError, match="no record is ok"):
        dots(dots_of([record("penalty", 1.0, "failed")]))


def test_rank_draws_records(folder, tmp_path):
    given = ["rank", "--records", folder, "-o", tmp_path / "x.png"]
    called(*given)
    assert (tmp_path / "x.png").read_bytes()[1:4] == b"PNG"
    assert "x.png" in called(*given, status=2).stderr
    called(*given, "--force")


def test_rank_prints_records_or_says_what_it_needs(folder):
    done = called("rank", "--records", folder, "--format", "json")
    assert {row["method"] for row in json.loads(done.stdout)} == {"penalty"}
    called("rank", status=2)
    given = ["--by", "contact", "--levels", "1%", "--force", "-o", "x.png", "--body", "a"]
    refused = called("rank", "--records", folder, *given, status=2)
    said = "--by, --levels, --body: has no effect with --records"
    assert said in " ".join(refused.stderr.split())


def test_a_folder_that_cannot_be_made_stops_a_comparison_before_its_runs(tmp_path):
    (tmp_path / "file").touch()
    done = called("compare", SLIP, "--records", tmp_path / "file", "-o", tmp_path / "x.nc", status=1)
    assert "file': File exists" in done.stderr
    assert not list(tmp_path.glob("x.nc*"))
