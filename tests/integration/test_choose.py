"""A choice among methods of a scene of milliseconds: pilots, answer, messages, and the command."""

import copy
import json
from types import SimpleNamespace

import numpy as np
import pytest

import mpmfw
from command_line import called
from mpmfw.campaigns.measures import measure_of
from mpmfw.errors import SceneError
from mpmfw.plugin.measure import About, Measured
from mpmfw.scene import load_scene
from mpmfw.scene.toml_text import toml_text
from mpmfw.studies.conclusion import advice, method_rows
from mpmfw.studies.ladder import Ladder
from scenes_for_tests import scene_of, solid
from studies_for_tests import SLIDING

pytestmark = pytest.mark.filterwarnings("default::mpmfw.errors.ResultsWarning")


def scene(**changes):
    """The small block, its particles in cells; its motion has just begun, so that no error is small."""
    found = copy.deepcopy(SLIDING)
    for body in found["bodies"].values():
        body["particles"] = {"size": "0.5 cells"}
    return {**found, **changes}


METHODS = {"contact": ["penalty", "separate"], "shape": ["cpdi"]}


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    """Runs that all tests share."""
    return tmp_path_factory.mktemp("runs")


def test_the_first_method_that_meets_the_target_ends_the_ladder(store):
    found = mpmfw.choose(scene(), "90 %", store=store, **METHODS)
    assert found["cell_size"].values.tolist() == [0.4, 0.2, 0.1, 0.05]
    best = method_rows(found)[0]
    assert best["answer"]
    assert best["error"] <= 0.9
    assert best["cost"] > 0.0
    ran = found["status"] != "not run"
    assert bool(ran.sel(contact=best["contact"], cell_size=best["cell_size_needed"]).all())
    assert not ran.where(found["cell_size"] < best["cell_size_needed"], drop=True).any()
    assert advice(found)[0].startswith(f"For 90 %: {best['contact']}, cpdi, cell_size")
    assert "a rigid block under Coulomb friction" in advice(found)[1]
    assert "Error of end-displacement" in advice(found)[1]


def test_what_comes_after_the_answer_is_not_run(store):
    found = mpmfw.choose(scene(), "99 %", contact=["separate", "lcp"], shape=["cpdi"], store=store)
    first, last = method_rows(found)
    assert (first["contact"], first["verdict"], first["cell_size_needed"]) == ("separate", "meets", 0.4)
    assert last["verdict"] == "not run"
    assert int((found["status"] == "ok").sum()) == 1


def test_what_nobody_meets_is_undecided_and_says_what_is_nearest(store):
    found = mpmfw.choose(scene(), 1e-6, store=store, **METHODS)
    assert not found["answer"].any()
    assert advice(found)[0].startswith("Undecided for 0.0001 %: the nearest is ")
    rows = method_rows(found)
    assert {row["verdict"] for row in rows} == {"misses"}
    # no order of convergence takes an error above the target times 2³ there
    assert (found["status"].sel(cell_size=0.2) == "not run").all()


def test_without_a_closed_form_two_laws_say_what_errors_are_against(store):
    methods = {"contact": ["penalty", "impulse"], "shape": ["cpdi"]}
    found = mpmfw.choose(scene(), "50 %", measure="kinetic-energy", finest=0.1, store=store, **methods)
    assert found["cell_size"].values.tolist() == [0.4, 0.2, 0.1]
    both = found["status"].sel(shape="cpdi", cell_size=[0.4, 0.2]) == "ok"
    assert bool(both.all())
    assert found.attrs["error_against"].startswith("the limit at cells of size zero that ")
    assert 0.0 < found.attrs["uncertainty"] < 1.0
    assert (found["error"].where(both) > 0.0).sum() == 4  # the limit is none of the runs
    met = found["error"] + found.attrs["uncertainty"] <= 0.5
    assert bool((found["meets"] == met).all())
    assert "uncertain by" in advice(found)[1]


def test_one_law_alone_decides_nothing(store):
    methods = {"contact": ["penalty", "penalty(kappa=8)"], "shape": ["cpdi"]}
    found = mpmfw.choose(scene(), "90 %", measure="force-noise", finest=0.2, store=store, **methods)
    assert found.attrs["uncertainty"] == np.inf
    assert not found["answer"].any()


@pytest.mark.parametrize("measure", ["penetration", "energy-error", "dissipation"])
def test_what_a_measure_reads_is_recorded(measure, store):
    methods = {"contact": ["penalty", "impulse"], "shape": ["cpdi"]}
    found = mpmfw.choose(scene(), "99 %", measure=measure, finest=0.2, store=store, **methods)
    assert found.attrs["error_against"].startswith("the limit at cells of size zero that ")
    assert np.isfinite(found["error"]).all()


@pytest.mark.parametrize(("measure", "expected"), [("front", 0.51), ("rear", 0.11)])
def test_a_body_ends_at_its_faces(measure, expected):
    body = solid([0.1, 0.1], [0.5, 0.5], 0.05, velocity=[1.0, 0.0])
    tool = {"geometry": {**body["geometry"], "lower": [-0.2, -0.2], "upper": [0.0, 0.0]}}
    tool["rigid"] = {"motion": {"velocity": [-2.0, 0.0]}}
    free = scene_of({"tool": tool, "solid": body}, 0.1, [-0.3, -0.3], [1.0, 1.0], end=0.01)
    free = load_scene({**free, "contact": {"method": "penalty"}})
    run = mpmfw.run(free)
    run["particles/solid"]["deformation_gradient"][:] *= 30.0  # as of sand that has flowed
    found = measure_of(measure).of(run, free, About(axis="x"))
    assert found.values == pytest.approx([expected], rel=1e-6)
    with pytest.raises(SceneError, match=r"error\.body: 'tool' is rigid, and has no material points"):
        measure_of(measure).of(run, free, About("tool", axis="x"))


def test_without_a_value_nothing_is_what_errors_are_against(store):
    methods = {"contact": ["penalty", "impulse"], "shape": ["cpdi"]}
    found = mpmfw.choose(scene(), "99 %", measure="momentum-change", finest=0.2, store=store, **methods)
    assert found.attrs["error_against"].startswith("nothing: no two laws have a value")
    assert found["error"].isnull().all()


def test_a_motion_along_y_is_judged_along_y():
    falling = copy.deepcopy(SLIDING)
    del falling["reference"], falling["bodies"]["plane"], falling["contact"]
    falling["gravity"] = {"vector": [0.0, -10.0]}
    falling["bodies"]["block"]["particles"] = {"size": "0.5 cells"}
    asked = {"measure": "end-displacement", "shape": ["cpdi", "gimp"], "finest": 0.2}
    found = mpmfw.choose(falling, "50 %", **asked)
    assert found.attrs["quantity"] == "end-displacement of block along y"
    with pytest.raises(SceneError, match="along x is negligible beside that along y"):
        mpmfw.choose(falling, "50 %", axis="x", **asked)


def no_reference():
    found = scene()
    del found["reference"]
    return found


def no_contact():
    found = scene()
    del found["contact"], found["bodies"]["block"], found["reference"]
    return found


@pytest.mark.parametrize(
    ("given", "options", "message"),
    [
        (scene(), {"measure": "accelerations"}, "'accelerations' is unknown; did you mean 'acceleration'"),
        (no_reference(), {}, "has no closed form or reference; .* or a measure"),
        (no_reference(), {"measure": "interface-stress"}, "is a field; expected a number or a curve"),
        (scene(), {"measure": "spin", "axis": "x"}, "^axis: has no effect: spin takes body"),
        (scene(), {"body": "blok"}, "'blok' is no body of the scene; expected one of block, plane"),
        (SLIDING, {}, 'bodies.block.particles.size: is 0.1 m at every cell size.*expected cells, such as "0.5 cells"'),  # noqa: E501
        (scene(), {"finest": 0.3}, "finest 0.3 m: must be at most half of the coarsest cell, 0.4 m"),
        (scene(), {"coarsest": "4 kg"}, "coarsest: .4 kg. .*expected a cell size such as 0.4 or '4 mm'"),
        (scene(), {"error": 1}, "error 1: is an error of 100 %; expected '1 %' or 0.01"),
        (scene(), {"contact": ["penalti"]}, "did you mean 'penalty'"),
        (no_contact(), {"contact": ["penalty"], "measure": "kinetic-energy"}, "contact: the scene has none"),
    ],
)  # fmt: skip
def test_what_cannot_be_answered_is_refused_with_what_can(given, options, message):
    with pytest.raises(SceneError, match=message):
        mpmfw.choose(given, **{**METHODS, **options} if "contact" in given else options)


def test_the_command_prints_a_table_and_the_answer_and_rows_for_other_programs(tmp_path):
    (tmp_path / "s.toml").write_text(toml_text(scene()), encoding="utf-8")
    methods = ["--contact", "penalty,separate", "--shape", "cpdi"]
    asked = ["choose", tmp_path / "s.toml", *methods, "-o", tmp_path / "c.nc"]
    done = called(*asked, "--error", "90%")
    assert "For 90 %: " in done.stdout
    assert "The runs took" in done.stdout
    rows = json.loads(called(*asked, "--error", "80%", "--json").stdout)
    assert {row["contact"] for row in rows} == {"penalty", "separate"}
    assert sum(row["answer"] for row in rows) <= 1
    assert (tmp_path / "c.nc.runs").is_dir()


def test_two_laws_that_meet_by_chance_are_no_limit():
    contacts, sizes = ["a", "b", "c", "d"], [0.4, 0.2, 0.1]
    runs = SimpleNamespace(
        grid=SimpleNamespace(coords={"contact": contacts, "shape": ["s"], "cell_size": sizes})
    )
    ladder = Ladder(runs, SimpleNamespace(is_exact=False), 0.01)
    # The first two hardly converge, and lie 10 % off; the others converge to 1 with second order
    ends = {0: [0.900, 0.901, 0.902], 1: [0.905, 0.904, 0.903], 2: [1.16, 1.04, 1.01], 3: [0.84, 0.96, 0.99]}
    found = {
        (i, 0, k): Measured(np.array([end]), np.empty(0))
        for i, every in ends.items()
        for k, end in enumerate(every)
    }
    limit = ladder._agreed(found)
    assert limit is not None
    assert len(limit.laws) == 3
    assert limit.uncertainty > 0.04
    found |= {(1, 0, k): Measured(np.array([1.0 - 0.1 * size]), np.empty(0)) for k, size in enumerate(sizes)}
    limit = ladder._agreed(found)
    assert limit is not None
    assert limit.motion.values[0] == pytest.approx(1.0, abs=0.01)
    assert limit.uncertainty < 0.03
    assert "a, s" not in limit.laws
