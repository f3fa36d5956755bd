"""The arena: its scenes, their closed forms and its records."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

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


def known(path, measure="end-displacement", axis=None, **changes):
    """Return the exact value of a measure of an arena's or a shipped scene with keys changed, or None."""
    scene = load_scene(path if path in shipped_scenes() else ARENA / "scenes" / f"{path}.toml", set=changes)
    exact = exact_of(measure_of(measure), scene, About(axis=axis))
    return None if exact is None else exact.at(np.zeros(1))[0]


@pytest.mark.parametrize("name", [path.stem for path in SCENES])
def test_every_scene_has_a_closed_form(name):
    scene = load_scene(ARENA / "scenes" / f"{name}.toml")
    values = [known(name, measure) for measure in ("end-displacement", "length", "restitution")]
    assert declared(scene) is not None or any(values)


@pytest.mark.parametrize(("kind", "tilt", "friction"), [("slip", 60.0, 0.286), ("no-slip", 45.0, 0.495)])
def test_a_turned_plane_has_the_motion_of_a_level_one(kind, tilt, friction):
    name = f"cylinder-{kind}-turned"
    scene = load_scene(ARENA / "scenes" / f"{name}.toml")
    level = rolling_solution(np.radians(tilt), friction, 10.0, 1.6, 0.5)
    end = float(scene.time.end)

    assert known(name) == pytest.approx(level.displacement(end) * np.cos(np.pi / 6), rel=1e-7)
    assert known(name, axis="y") == pytest.approx(level.displacement(end) * -0.5, rel=1e-7)
    assert known(name, "acceleration") == pytest.approx(level.acceleration * np.cos(np.pi / 6), rel=1e-7)
    assert known(name, "spin") == pytest.approx(level.angular_acceleration * end, rel=1e-7)
    assert exact_of(measure_of("force-noise"), scene, About()) is None
    shipped = load_scene(f"rolling-cylinder-{kind}-rigid")
    assert scene.materials["soft"] == shipped.materials["soft"]
    turn = np.array([[np.cos(np.pi / 6), 0.5], [-0.5, np.cos(np.pi / 6)]])
    for name in ("cylinder", "plane"):
        place = turn @ shipped.bodies[name].geometry.centroid
        np.testing.assert_allclose(scene.bodies[name].geometry.centroid, place, atol=1e-8)


def test_a_block_stops_where_its_energy_is_spent():
    way = 0.8**2 / (2.0 * 0.3 * 10.0)
    assert known("stopping-block", **{"bodies.block.velocity": [0.8, 0.0]}) == pytest.approx(way)
    assert known("stopping-block", **{"bodies.block.velocity": [-0.8, 0.0]}) == pytest.approx(-way)
    early = {"bodies.block.velocity": [0.8, 0.0], "time.end": 0.1, "time.output_interval": 0.05}
    assert known("stopping-block", **early) == pytest.approx(0.8 * 0.1 - 0.5 * 3.0 * 0.1**2)
    assert known("stopping-block", axis="y") is None
    assert known("stopping-block", "spin") is None


@pytest.mark.parametrize("key", ["surface_velocity", "velocity"])
def test_a_belt_carries_the_block_along(key):
    motion = {"bodies.plane.rigid": {"motion": {key: [1.0, 0.0]}}}
    assert known("belt", **motion) == pytest.approx(0.4 - 1.0 / (2.0 * 0.3 * 10.0))
    assert known("belt", **motion, **{"bodies.block.velocity": [1.5, 0.0]}) == pytest.approx(
        0.4 + 0.25 / (2.0 * 0.3 * 10.0)
    )


def test_a_ball_leaves_the_plane_with_its_speed_after_the_time_of_hertz():
    modulus, mass = 1e6 / 0.91, 4e3 / 3.0 * np.pi
    deepest = (1.25 * mass * 0.09 / (4.0 / 3.0 * modulus)) ** 0.4  # of the energy of the spring
    time = 2.9432 * deepest / 0.3
    end = known("hertz-impact", axis="y")
    assert end == pytest.approx(0.3 * (0.6 - 0.003 / 0.3 - time) - 0.003, abs=2e-6)
    assert known("hertz-impact", axis="x") is None


@pytest.mark.parametrize("name", ["colliding-discs", "colliding-discs-level"])
def test_discs_have_the_restitution_of_the_finite_elements(name):
    """Elements of 20 mm are within 1 % of those of 5 mm."""
    restitution = known(name, "restitution")
    assert known(name) is None
    if name.endswith("level"):
        assert module_of(ARENA / "discs_fem.py").solve(0.02)[0] == pytest.approx(restitution, rel=0.01)
    velocity = np.array([[[3.0, 4.0], [0.0, 0.0]], [[0.0, 0.0], [1.5, 2.0]]])
    for sign, expected in ((1.0, 0.5), (-1.0, 0.0)):
        moved = ("time", "body", "axis"), velocity * np.array([1.0, sign])[:, None, None]
        run = xr.DataTree.from_dict({"series": xr.Dataset({"mean_velocity": moved})})
        assert measure_of("restitution").of(run, None, About()).values == pytest.approx([expected])


def test_a_footing_has_prandtls_load_and_the_bar_a_published_length():
    assert known("footing", "reaction") == pytest.approx((2.0 + np.pi) * 10e3, rel=1e-6)
    assert known("taylor-bar", "length") == pytest.approx(21.46e-3)
    points = xr.Dataset(
        {
            "position": (("time", "point", "axis"), [[[0.0, 0.1], [0.0, 0.7]]]),
            "deformation_gradient": (("time", "point", "row", "column"), [[np.eye(2), 0.5 * np.eye(2)]]),
        },
        {"axis": ["x", "y"]},
    )
    scene = load_scene("taylor-bar", set={"bodies.bar.particles.size": 0.2})
    run = xr.DataTree.from_dict({"particles/bar": points})
    assert measure_of("length").of(run, scene, About()).values == pytest.approx([0.75])
    force = ("time", "pair", "axis"), [[[9.0, 9.0]], *[[[0.0, 0.0]]] * 3, [[3.0, 4.0]], [[3.0, 4.0]]]
    series = xr.Dataset(
        {"contact_force": force}, {"time": np.arange(6.0), "pair": ["a-b"], "axis": ["x", "y"]}
    )
    run = xr.DataTree.from_dict({"series": series})
    assert measure_of("reaction").of(run, scene, About()).values == pytest.approx([5.0])


@pytest.mark.parametrize(
    ("file", "changes"),
    [
        ("stopping-block", {"contact.friction": 0.0}),
        ("stopping-block", {"bodies.block.velocity": [0.0, 0.0]}),
        ("stopping-block", {"gravity.vector": [1.0, -10.0]}),
        ("stopping-block", {"bodies.block.sides": [{"side": "left", "fixed": True}]}),
        ("cylinder-slip-turned", {"bodies.cylinder.velocity": [1.0, 0.0]}),
        ("hertz-impact", {"time.end": 0.3}),
        ("hertz-impact", {"bodies.ball.velocity": [0.0, 0.3, 0.0]}),
        ("colliding-discs", {"bodies.first.velocity": [0.1, 0.2]}),
        ("colliding-discs", {"time.end": 2.0}),
        ("colliding-discs", {"materials.rubber.density": 900}),
        ("taylor-bar", {"bodies.bar.velocity": [0.0, -200.0]}),
        ("taylor-bar", {"materials.copper.yield_stress": 1e8}),
        ("footing", {"gravity.vector": [0.0, -10.0]}),
        (
            "cylinder-slip-turned",
            {"bodies.plane.geometry": {"type": "half_space", "point": [0.0, -3.0], "normal": [0.5, 1.0]}},
        ),
    ],
    ids=str,
)
def test_a_scene_of_another_kind_is_refused(file, changes):
    with pytest.raises(SceneError, match="does not apply"):
        known(file, **changes)


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
    assert len({record.problem for record in records}) >= 18
    codes = {record.code.split()[0] for record in records}
    assert codes == {"mpmfw", "Newton", "NairnMPM", "CalculiX"}


def test_the_page_has_the_tables_of_its_records():
    page = (ARENA.parent / "arena.md").read_text(encoding="utf-8")
    make = module_of(ARENA.parent / "make_arena.py")
    assert make.tables([]) == [make.HEAD] * len(make.LEFT_OUT)
    records = read_records(ARENA / "records")
    for table in make.tables(records):
        assert table in page, "python docs/make_arena.py"
