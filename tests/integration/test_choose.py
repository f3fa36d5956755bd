"""A choice among methods of a scene of milliseconds: pilots, answer, messages, and the command."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import mpmfw
from mpmfw.cli import app
from mpmfw.errors import SceneError
from mpmfw.scene.toml_text import toml_text
from mpmfw.studies.advice import advice, method_rows
from studies_for_tests import SLIDING

pytestmark = pytest.mark.filterwarnings("default::mpmfw.errors.ResultsWarning")


def scene(**changes: Any) -> dict[str, Any]:
    """The small block, its particles in cells; its motion has just begun, so that no error is small."""
    found = copy.deepcopy(SLIDING)
    for body in found["bodies"].values():
        body["particles"] = {"size": "0.5 cells"}
    return {**found, **changes}


METHODS: dict[str, Any] = {"contact": ["penalty", "separate"], "shape": ["cpdi"]}


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs that all tests share."""
    return tmp_path_factory.mktemp("runs")


def test_methods_run_at_two_cells_and_the_answer_is_what_meets_the_target(store: Path) -> None:
    found = mpmfw.choose(scene(), "90 %", store=store, **METHODS)
    assert found["cell_size"].values.tolist() == [0.4 / k for k in (1, 2, 3, 4, 6, 8)]
    best = method_rows(found)[0]
    ran = found["status"].sel(contact=best["contact"], shape="cpdi") == "ok"
    assert 1 <= int(ran.sum()) <= 3
    assert np.isfinite(found["error"].sel(contact=best["contact"], shape="cpdi").where(ran, drop=True)).all()
    assert best["answer"]
    assert best["upper"] <= 0.9
    assert best["cost"] > 0.0
    assert advice(found)[0].startswith(f"For 90 %: {best['contact']}, cpdi, cell_size")
    assert "a rigid block under Coulomb friction" in advice(found)[1]


def test_what_costs_more_than_a_run_that_meets_the_target_is_not_run(store: Path) -> None:
    cheap, dear = "separate", "lcp"
    found = mpmfw.choose(scene(), "99 %", contact=[dear, cheap], shape=["cpdi"], store=store)
    first, last = method_rows(found)
    assert (first["contact"], first["verdict"], first["cell_size_needed"]) == (cheap, "measured", 0.4)
    assert last["verdict"] == "not run"
    assert last["why"].startswith("predicted to take ")
    assert (found["status"].sel(contact=dear) == "not run").all()
    assert int((found["status"] == "ok").sum()) == 1


def test_what_is_likely_to_meet_the_target_runs_before_what_is_cheap(
    store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "mpmfw.studies.pilots.chances", lambda methods, _, __: dict(zip(methods, (1.0, 1e-6), strict=True))
    )
    likely, cheap = "lcp", "separate"
    found = mpmfw.choose(scene(), "99 %", contact=[likely, cheap], shape=["cpdi"], store=store)
    first, last = method_rows(found)
    assert (first["contact"], first["verdict"]) == (likely, "measured")
    assert (last["contact"], last["verdict"]) == (cheap, "not run")
    assert "and to meet the target with a probability of 0.0001 %" in last["why"]


def test_what_nobody_meets_has_no_answer_and_says_what_is_nearest(store: Path) -> None:
    found = mpmfw.choose(scene(), 1e-6, store=store, **METHODS)
    assert not found["answer"].any()
    assert advice(found)[0].startswith("No method is certain to meet 0.0001 %: the nearest is ")
    assert all(row["why"] for row in method_rows(found))


def test_runs_that_are_kept_are_not_made_again(store: Path) -> None:
    mpmfw.choose(scene(), 1e-6, store=store, **METHODS)
    kept = {path.name: path.stat().st_mtime_ns for path in store.glob("*.json")}
    mpmfw.choose(scene(), 2e-6, store=store, **METHODS)
    assert {path.name: path.stat().st_mtime_ns for path in store.glob("*.json")} == kept


def test_without_a_closed_form_errors_are_against_a_finer_run_whose_own_is_added(store: Path) -> None:
    found = mpmfw.choose(scene(), "50 %", measure="kinetic-energy", store=store, **METHODS)
    assert found["cell_size"].values.tolist() == [0.4, 0.2, 0.4 / 3, 0.1]
    assert found["status"].sel(contact="penalty", shape="cpdi", cell_size=0.1) == "ok"
    assert found.attrs["error_against"] == "the run of penalty, cpdi at cells of 0.1 m"
    own = found["error"].sel(contact="penalty", shape="cpdi")
    assert own.sel(cell_size=0.1) == 0.0
    assert found.attrs["slack"] == pytest.approx(
        float(own.where(own["cell_size"] > 0.1).dropna("cell_size")[-1]), rel=2.0
    )
    assert "itself off by about" in advice(found)[1]


def test_a_method_that_cannot_run_has_its_reason(store: Path) -> None:
    found = mpmfw.choose(scene(), 0.5, contact=["penalty", "nodes+hybrid"], shape=["cpdi"], store=store)
    last = method_rows(found)[-1]
    assert (last["contact"], last["verdict"]) == ("nodes+hybrid", "failed")
    assert "law 'hybrid' acts on facets of surfaces" in last["why"]


def no_reference() -> dict[str, Any]:
    found = scene()
    found["gravity"] = {"vector": [3.0, -9.0]}
    return found


def no_contact() -> dict[str, Any]:
    found = scene()
    del found["contact"], found["bodies"]["block"]
    return found


@pytest.mark.parametrize(
    ("given", "options", "message"),
    [
        (scene(), {"measure": "accelerations"}, "'accelerations' is unknown; did you mean 'acceleration'"),
        (no_reference(), {}, "has no closed form or reference, so that it does not say what an error is of; expected a measure"),
        (no_reference(), {"measure": "interface-stress"}, "has no closed form of it, and a field has no finer run"),
        (SLIDING, {}, 'bodies.block.particles.size: is 0.1 m at every cell size.*expected cells, such as "0.5 cells"'),
        (scene(), {"finest": 0.3}, "finest 0.3 m: must be at most half of the coarsest cell, 0.4 m"),
        (scene(), {"finest": 0.05, "measure": "kinetic-energy"}, "finest: has no effect where nothing is known of the measure"),
        (scene(), {"coarsest": "4 kg"}, "coarsest 4 kg: .*expected a cell size such as 0.4 or '4 mm'"),
        (scene(), {"error": 1}, "error 1: is an error of 100 %; expected '1 %' or 0.01"),
        (scene(), {"contact": ["penalti"]}, "did you mean 'penalty'"),
        (no_contact(), {"contact": ["penalty"], "measure": "kinetic-energy"}, "contact: the scene has none"),
    ],
)  # fmt: skip
def test_what_cannot_be_answered_is_refused_with_what_can(
    given: dict[str, Any], options: dict[str, Any], message: str
) -> None:
    with pytest.raises(SceneError, match=message):
        mpmfw.choose(given, **{**METHODS, **options} if "contact" in given else options)


def test_the_command_prints_a_table_and_the_answer_and_rows_for_other_programs(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text(toml_text(scene()), encoding="utf-8")
    asked = [
        "choose",
        str(tmp_path / "s.toml"),
        "--contact",
        "penalty,separate",
        "--shape",
        "cpdi",
        "-o",
        str(tmp_path / "c.nc"),
    ]
    done = CliRunner().invoke(app, [*asked, "--error", "90%"])
    assert done.exit_code == 0, done.output
    assert "For 90 %: " in done.stdout
    assert "The runs took" in done.stdout
    again = CliRunner().invoke(app, [*asked, "--error", "80%", "--format", "json"])
    assert again.exit_code == 0, again.output
    rows = json.loads(again.stdout)
    assert {row["contact"] for row in rows} == {"penalty", "separate"}
    assert sum(row["answer"] for row in rows) <= 1
    assert (tmp_path / "c.nc.runs").is_dir()
    refused = CliRunner().invoke(app, ["choose", str(tmp_path / "s.toml"), "--contact", "penalti"])
    assert refused.exit_code == 2
    assert "did you mean 'penalty'" in refused.output
