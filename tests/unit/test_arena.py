"""The arena: its scenes, their closed forms and its records."""

from pathlib import Path

import numpy as np
import pytest

from mpmfw.campaigns.measures import exact_of, measure_of
from mpmfw.errors import SceneError
from mpmfw.plugin.measure import About
from mpmfw.report.records import _problem, read_records
from mpmfw.results.analysis import rolling_solution
from mpmfw.results.references import declared
from mpmfw.scene import load_scene
from mpmfw.scene.loading import shipped_scenes
from python_files import module_of

ARENA = Path(__file__).resolve().parents[2] / "docs" / "arena"
SCENES = sorted((ARENA / "scenes").glob("*.toml"))


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_every_scene_has_a_closed_form(path):
    scene = load_scene(path)
    exact = exact_of(measure_of("end-displacement"), scene, About())
    assert declared(scene) is not None or exact is not None
    assert exact is None or exact.at(np.zeros(1))[0] > 0.1


@pytest.mark.parametrize(("kind", "tilt", "friction"), [("slip", 60.0, 0.286), ("no-slip", 45.0, 0.495)])
def test_a_turned_plane_has_the_motion_of_a_level_one(kind, tilt, friction):
    scene = load_scene(ARENA / "scenes" / f"cylinder-{kind}-turned.toml")
    level = rolling_solution(np.radians(tilt), friction, 10.0, 1.6, 0.5)
    end = float(scene.time.end)

    def known(measure, axis=None):
        return exact_of(measure_of(measure), scene, About(axis=axis)).at(np.zeros(1))[0]

    assert known("end-displacement") == pytest.approx(level.displacement(end) * np.cos(np.pi / 6), rel=1e-7)
    assert known("end-displacement", "y") == pytest.approx(level.displacement(end) * -0.5, rel=1e-7)
    assert known("acceleration") == pytest.approx(level.acceleration * np.cos(np.pi / 6), rel=1e-7)
    assert known("spin") == pytest.approx(level.angular_acceleration * end, rel=1e-7)
    assert exact_of(measure_of("force-noise"), scene, About()) is None
    shipped = load_scene(f"rolling-cylinder-{kind}-rigid")
    assert scene.materials["soft"] == shipped.materials["soft"]
    turn = np.array([[np.cos(np.pi / 6), 0.5], [-0.5, np.cos(np.pi / 6)]])
    for name in ("cylinder", "plane"):
        place = turn @ shipped.bodies[name].geometry.centroid
        np.testing.assert_allclose(scene.bodies[name].geometry.centroid, place, atol=1e-8)


def stopping(**changes):
    """Closed form of the way of the stopping block, with keys changed."""
    scene = load_scene(ARENA / "scenes" / "stopping-block.toml", set=changes)
    return exact_of(measure_of("end-displacement"), scene, About()).at(np.zeros(1))[0]


def test_a_block_stops_where_its_energy_is_spent():
    scene = load_scene(ARENA / "scenes" / "stopping-block.toml")
    way = 0.8**2 / (2.0 * 0.3 * 10.0)
    assert stopping(**{"bodies.block.velocity": [0.8, 0.0]}) == pytest.approx(way)
    assert stopping(**{"bodies.block.velocity": [-0.8, 0.0]}) == pytest.approx(-way)
    early = {"bodies.block.velocity": [0.8, 0.0], "time.end": 0.1, "time.output_interval": 0.05}
    assert stopping(**early) == pytest.approx(0.8 * 0.1 - 0.5 * 3.0 * 0.1**2)
    assert exact_of(measure_of("end-displacement"), scene, About(axis="y")) is None
    assert exact_of(measure_of("spin"), scene, About()) is None


@pytest.mark.parametrize(
    ("file", "changes"),
    [
        ("stopping-block", {"contact.friction": 0.0}),
        ("stopping-block", {"bodies.block.velocity": [0.0, 0.0]}),
        ("stopping-block", {"gravity.vector": [1.0, -10.0]}),
        ("stopping-block", {"bodies.block.sides": [{"side": "left", "fixed": True}]}),
        ("cylinder-slip-turned", {"bodies.cylinder.velocity": [1.0, 0.0]}),
        (
            "cylinder-slip-turned",
            {"bodies.plane.geometry": {"type": "half_space", "point": [0.0, -3.0], "normal": [0.5, 1.0]}},
        ),
    ],
    ids=str,
)
def test_a_scene_of_another_kind_is_refused(file, changes):
    scene = load_scene(ARENA / "scenes" / f"{file}.toml", set=changes)
    with pytest.raises(SceneError, match="does not apply"):
        exact_of(measure_of("end-displacement"), scene, About())


def test_a_cylinder_that_goes_to_the_left_slips_as_to_the_right():
    path = ARENA / "scenes" / "cylinder-slip-turned.toml"
    scene = load_scene(path)
    gravity, turn = np.array(scene.gravity.at(0.0)), scene.bodies["plane"].geometry.angle
    along = np.array([np.cos(turn), np.sin(turn)])
    mirrored = load_scene(path, set={"gravity.vector": (gravity - 2.0 * (gravity @ along) * along).tolist()})
    for name in ("end-displacement", "acceleration", "spin"):
        one, other = (
            exact_of(measure_of(name), each, About()).at(np.zeros(1))[0] for each in (scene, mirrored)
        )
        assert one == pytest.approx(-other)


def test_records_are_of_scenes_as_they_are():
    """The schema is checked as they are read."""
    records = read_records(ARENA / "records")
    scenes = [load_scene(each) for each in (*shipped_scenes(), *SCENES)]
    known = {(scene.title, _problem(scene, {})) for scene in scenes}
    assert {(record.scene, record.problem) for record in records} <= known
    assert len({record.problem for record in records}) >= 12
    codes = {record.code.split()[0] for record in records}
    assert codes == {"mpmfw", "Newton", "NairnMPM", "CalculiX"}


def test_the_page_has_the_tables_of_its_records():
    page = (ARENA.parent / "arena.md").read_text(encoding="utf-8")
    make = module_of(ARENA.parent / "make_arena.py")
    assert make.tables([]) == [make.HEAD] * len(make.LEFT_OUT)
    for table in make.tables(read_records(ARENA / "records")):
        assert table in page, "python docs/make_arena.py"
