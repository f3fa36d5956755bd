"""Records of comparisons: written, read, refused and ranked."""

import json

import pytest
from typer.testing import CliRunner

import mpmfw
from mpmfw.cli import app
from mpmfw.errors import SceneError
from mpmfw.report.records import Record, _problem, ranked, read_records, write_records
from mpmfw.scene import load_scene

SLIP = "rolling-cylinder-slip-rigid"


@pytest.fixture(scope="module")
def dataset():
    sizes = {"grid.cell_size": 0.8, "bodies.cylinder.particles.size": "1 cell", "time.end": 0.05}
    return mpmfw.compare(SLIP, ["penalty"], ["linear"], {"time.safety": [0.4, 0.5]}, set=sizes)


@pytest.fixture
def folder(dataset, tmp_path):
    write_records(dataset, tmp_path / "records")
    return tmp_path / "records"


def test_every_row_has_a_record_of_its_own(dataset, folder):
    one, two = sorted(read_records(folder), key=lambda record: record.settings["safety"])
    assert (one.settings["safety"], two.settings["safety"]) == (0.4, 0.5)
    assert one.settings["cell_size"] == 0.8
    assert one.problem == two.problem
    assert (one.method, one.shape, one.status) == ("penalty", "linear", "ok")
    assert one.code == f"mpmfw {mpmfw.__version__}, float64, CPU"
    assert one.figures["steps"] == float(dataset["steps"].sel(safety=0.4).item())
    assert "displacement_error" not in one.figures  # it did not reach 10 m
    write_records(dataset, folder)
    assert len(list(folder.iterdir())) == 2


def test_the_problem_is_the_same_for_all_methods_and_cells():
    def hashed(**changes):
        return _problem(load_scene(SLIP, set=changes))

    same = hashed()
    assert hashed(**{"grid.cell_size": 0.2, "contact.method": "lcp", "shape.method": "linear"}) == same
    assert hashed(**{"bodies.cylinder.particles.size": "1 cell", "stepping.transfer": "pic"}) == same
    for key, value in (("contact.friction", 0.1), ("materials.soft.density", 900), ("time.end", 1.0)):
        assert (hashed(**{key: value}) == same) == (key == "contact.friction")  # the pair has its own


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"more": 1}, "more: Extra inputs are not permitted"),
        ({"version": 2}, "version: Input should be 1"),
        ({"problem": "../../etc"}, "problem: String should match pattern"),
        ({"figures": {"steps": "many"}}, "figures.steps: "),
        (None, ": Invalid JSON"),
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


def test_links_and_large_files_are_refused(folder, tmp_path):
    (folder / "link.json").symlink_to(min(folder.iterdir()))
    (folder / "zeros.json").write_bytes(b" " * 200_000)
    with pytest.raises(SceneError) as caught:
        read_records(folder)
    assert len(str(caught.value).splitlines()) == 2
    with pytest.raises(SceneError, match="holds no records"):
        read_records(tmp_path / "none")


def test_the_largest_error_ranks_then_the_cost():
    def record(method, cost, **errors):
        figures = {f"{name}_error": value for name, value in errors.items()} | {"cpu_time": cost}
        facts = {"scene": "s", "problem": 16 * "0", "shape": "x", "code": "c", "settings": {}}
        return Record(**facts, method=method, machine="m", status="ok", figures=figures)

    records = [
        record("turns not", 1.0, displacement=0.1, spin=-99.0),
        record("dear", 9.0, displacement=1.0, spin=-3.0),
        record("cheap", 2.0, displacement=-3.0, spin=1.0),
    ]
    (rows,) = ranked(records).values()
    assert [row["method"] for row in rows] == ["cheap", "dear", "turns not"]


def test_rank_prints_records_or_says_what_it_needs(folder):
    done = CliRunner().invoke(app, ["rank", "--records", str(folder), "--format", "json"])
    assert done.exit_code == 0
    assert {row["method"] for row in json.loads(done.stdout)} == {"penalty"}
    assert CliRunner().invoke(app, ["rank"]).exit_code == 2
