"""Runs are judged suspect where bodies change sides, penetrate or gain energy, and only there."""

import math
import warnings
from types import SimpleNamespace

import pytest

import mpmfw
from command_line import called
from mpmfw.api import ContactStrategy, hookimpl
from mpmfw.effects.verdict import SIDES_LATEST, Verdict
from mpmfw.errors import ResultsWarning, SceneError
from mpmfw.runs.run import condensed
from mpmfw.runs.simulation import Simulation
from mpmfw.scene.toml_text import toml_text
from scenes_for_tests import block, body_of, scene_of, with_changes

CELL, SPEED = 0.1, 5.0
SOLID = {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 1e6, "shear_modulus": 5e5}


class Idle(ContactStrategy):
    """A contact that claims to keep bodies apart and does nothing."""

    name = "idle"
    velocity_fields = "per_body"


class Pump(ContactStrategy):
    """A contact that speeds every body up by a rate [1/s]."""

    name = "pump"
    velocity_fields = "per_body"
    rate = 0.0

    @hookimpl
    def after_momentum_update(self, grid, dt):
        """Add to the momentum."""
        grid.momentum *= 1.0 + self.rate * dt


def scene(*bodies, end, outputs, **changes):
    """A scene of bodies that move along x, in cells of 0.1 m."""
    dim = 2 if bodies[0][0]["type"] in ("disc", "rectangle", "ring", "polygon") else 3
    moving = {
        name: body_of(geometry, 0.5 * CELL, "solid", velocity=[speed] + [0.0] * (dim - 1))
        for name, (geometry, speed) in zip("ab", bodies, strict=False)
    }
    tables = {"shape": {"method": "linear"}, "contact": {"method": "separate"}, "materials": {"solid": SOLID}}
    made = scene_of(moving, CELL, [-2.0] * dim, [2.0] * dim, end, outputs, **tables)
    return with_changes(made, **{"output": {"particles": False}, **changes})


def boxes(*corners):
    """Rectangles or boxes between lower and upper corners."""
    kind = "rectangle" if len(corners[0]) == 2 else "box"
    return [
        {"type": kind, "lower": low, "upper": high}
        for low, high in zip(corners[::2], corners[1::2], strict=True)
    ]


DISCS = [{"type": "disc", "centre": [x, 0.0], "radius": 0.3} for x in (-0.35, 0.35)]
#: A block, and a sheet of half a cell in its way, in which no node can be deeper than a quarter of a cell.
SHEET = boxes([-0.45, -0.2], [-0.05, 0.2], [0.0, -0.4], [0.05, 0.4])
SHEET_3D = boxes([-0.35, -0.1, -0.1], [-0.05, 0.1, 0.1], [0.0, -0.2, -0.2], [0.05, 0.2, 0.2])


def run(made, contact=None, **options):
    """Run without a word."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultsWarning)
        return mpmfw.run(made, contact=contact, **options)


@pytest.mark.parametrize(
    ("bodies", "why", "outputs", "gap"),
    [
        (DISCS, "penetration", 1, False),
        (SHEET, "changed sides", 20, False),
        (SHEET_3D, "changed sides", 1, True),
    ],
    ids=["discs, one output", "sheet", "sheet in space, one output"],
)
def test_bodies_that_pass_through_each_other_are_suspect_however_rare_the_outputs(bodies, why, outputs, gap):
    """They meet at once and are past each other at the end; without a contact they are to do so."""
    made = scene((bodies[0], SPEED), (bodies[1], -SPEED), end=0.14, outputs=outputs, output__gap=gap)
    status = run(made, Idle()).attrs["status"]
    assert status.startswith("suspect: a-b: ")
    assert why in status
    assert run(made).attrs["status"] == "ok"


def test_an_overlap_of_the_start_is_not_counted():
    """Blocks of 5 m/s that overlap by 0.8 cells, and by 1.2 or 1.4 at the end."""
    left, right = boxes([-0.56, -0.3], [0.04, 0.3], [-0.04, -0.3], [0.56, 0.3])
    for end, status in ((0.004, "ok"), (0.006, "suspect: a-b: penetration of 0.6 cells at 0.006 s")):
        made = scene((left, SPEED), (right, -SPEED), end=end, outputs=2, allow_overlap=True)
        assert run(made, Idle()).attrs["status"] == status


@pytest.mark.parametrize("speed", [-10.0, 10.0])
def test_a_block_that_slides_past_the_edge_of_another_is_not_suspect(speed):
    """Its corner has been inside the other by a hundredth of a cell, and comes out by the top."""
    left, right = boxes([-0.4, -0.2], [0.001, 0.2], [0.0, -0.4], [0.4, 0.0])
    made = scene((left, 0.0), (right, 0.0), end=0.02, outputs=20, allow_overlap=True)
    made["bodies"]["a"]["velocity"] = [0.0, speed]
    assert run(made, Idle()).attrs["status"] == "ok"


MOVED = [{"side": "left", "velocity": [1.0, "free"]}, {"side": "right", "fixed": ["x"]}]
WORKS = {
    "gravity that changes": {"gravity": {"table": [[0.0, 0.0, -10.0], [0.01, 200.0, 0.0], [0.02, 0.0, 0.0]]}},
    "moving side": {"bodies__solid__sides": MOVED},
    "pressure": {"bodies__solid__sides": [{"side": "left", "pressure": 2e4}]},
    "load": {"loads": {"push": {"model": "body_force", "force": [2e4, 0.0]}}},
}


@pytest.mark.parametrize(("name", "scheme"), [*((name, "usl") for name in WORKS), ("moving side", "usf")])
def test_the_work_of_loads_and_sides_is_that_of_the_ledger(name, scheme):
    made = block(time__end=0.05, time__output_interval=0.01, stepping__scheme=scheme, time__safety=0.2)
    made["output"] = {"ledger": True}
    simulation = Simulation(with_changes(made, **WORKS[name]))
    series = []
    simulation.run(lambda frame: series.append(dict(frame.series)))
    verdict = simulation.registry.plugins["verdict"]
    assert simulation.status == "ok"
    work = verdict.gravity_work + sum(plugin.work for plugin in verdict.working)
    ledger = series[-1].get("gravity_work", 0.0) + series[-1].get("external_work", 0.0)
    assert work > 10.0
    assert work == pytest.approx(
        float(ledger), rel=0.04
    )  # positions move with the velocity at the end of a step


def test_energy_that_gravity_takes_is_not_missed():
    """A body is thrown up and doubles its energy while it slows down: its kinetic energy alone never
    grows.
    """
    made = block(gravity={"vector": [0.0, -1000.0]}, bodies__solid__velocity=[0.0, 10.0])
    made = with_changes(made, time__end=0.005, time__output_interval=0.001)
    other = {**made["bodies"]["solid"], "geometry": boxes([1.0, -0.5], [1.9, 0.5])[0]}
    made["bodies"]["other"] = other
    made["contact"] = {"method": "separate"}
    assert run(made).attrs["status"] == "ok"
    pump = Pump()
    pump.rate = 50.0
    tree = run(made, pump)
    kinetic = tree["series"]["kinetic_energy"].sum("body").values
    assert kinetic[-1] < kinetic[0]
    assert tree.attrs["status"].startswith("suspect: energy")


def test_bodies_with_loads_that_settle_are_judged_from_time_zero_on():
    """A press fit of 0.3 cells releases its energy while it settles, or after it, and neither is a gain."""
    left, right = boxes([-0.53, -0.3], [0.015, 0.3], [-0.015, -0.3], [0.53, 0.3])
    for keys in ({}, {"settle": {"tolerance": 0.5, "gravity": {"vector": [1.0, 0.0]}}}):
        made = scene((left, 0.0), (right, 0.0), end=0.01, outputs=5, allow_overlap=True, **keys)
        made["contact"]["method"], made["shape"]["method"] = "penalty", "cpdi"
        assert run(made).attrs["status"] == "ok"


def test_sides_are_looked_at_between_outputs():
    simulation = Simulation(scene((DISCS[0], 0.0), (DISCS[1], 0.0), end=100.0, outputs=1), contact="penalty")
    simulation.start()
    judge = simulation.registry.plugins["verdict"]
    judge.diagnostics(simulation.state, 0.0)  # the first output
    assert judge.latest_sides == SIDES_LATEST
    simulation.advance(SIDES_LATEST + 1)
    assert judge.latest_sides == 2 * SIDES_LATEST


def passes_through():
    """Two discs whose springs are too soft to hold them, and a contact at nodes that lets them through."""
    made = scene((DISCS[0], 16.0), (DISCS[1], -16.0), end=0.04, outputs=10, shape__method="gimp")
    return with_changes(made, contact={"method": "midplane", "friction": 0.2, "midplane": {"kappa": 1.0}})


@pytest.mark.filterwarnings("default::mpmfw.errors.ResultsWarning")
def test_a_suspect_run_ends_well_and_every_table_shows_it(tmp_path):
    file, text = tmp_path / "run.nc", tmp_path / "scene.toml"
    made = passes_through()
    text.write_text(toml_text(made), encoding="utf-8")
    called("run", text, "-o", file)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # the file is complete
        tree = mpmfw.open(file)
    assert tree.attrs["status"].startswith("suspect: a-b:")
    assert "suspect: a-b" in tree.attrs["warnings"]
    with pytest.raises(SceneError, match="finished"):
        mpmfw.resume(file)
    answer = called("compare", text, "--contact", "midplane,penalty", "-o", tmp_path / "compare.nc")
    assert "midplane, gimp: suspect: a-b:" in " ".join(answer.output.split())


@pytest.mark.parametrize("gap", [0.5, 1.5])
def test_a_slit_that_closes_to_less_than_a_cell_is_named(gap):
    """The upper arm of a clip moves down; at the end the arms are ``gap`` cells apart."""
    points = [[0, 0], [1, 0], [1, 0.3], [0.3, 0.3], [0.3, 0.6], [1, 0.6], [1, 0.9], [0, 0.9]]
    made = scene(({"type": "polygon", "points": points}, 0.0), end=0.05, outputs=20, shape__method="cpdi")
    made["bodies"]["a"]["sides"] = [
        {"side": "bottom", "fixed": True},
        {"side": "top", "velocity": [0.0, -(0.3 - gap * CELL) / 0.05]},
    ]
    del made["contact"]
    found = str(run(made).attrs.get("warnings", ""))
    assert ("own surface" in found) == (gap < 1.0)


def test_a_notch_of_a_turning_body_does_not_come_close_to_itself():
    star = [
        [r * math.cos(math.pi * k / 5), r * math.sin(math.pi * k / 5)] for k, r in enumerate([0.8, 0.3] * 5)
    ]
    made = scene(({"type": "polygon", "points": star}, 1.0), end=0.05, outputs=5, shape__method="cpdi")
    made["bodies"]["a"]["angular_velocity"] = 20.0
    del made["contact"]
    assert "own surface" not in str(run(made).attrs.get("warnings", ""))


def test_a_block_flutters_at_the_limit_of_friction_and_not_far_from_it():
    """It lies on a floor, is settled and then pushed by 4.9 m/s² over 0.5 s, against μ g."""
    block_, floor = boxes([0.73, 0.33], [1.73, 0.73], [0.0, 0.0], [2.5, 0.33])
    made = scene((block_, 0.0), (floor, 0.0), end=0.9, outputs=45, shape__method="cpdi", settle={})
    made["grid"].update(lower=[-0.5, -0.5], upper=[3.0, 1.5])
    made["contact"] = {"method": "penalty", "friction": 0.5, "penalty": {"kappa": 1.0}}
    elastic = {"youngs_modulus": 1e7, "poissons_ratio": 0.3}
    made["materials"]["solid"] = {"model": "neo_hookean", "density": 1000, **elastic}
    for body in made["bodies"].values():
        del body["velocity"]
    made["bodies"]["b"]["sides"] = [{"side": "bottom", "fixed": True}]
    made["gravity"] = {"table": [[0.0, 0.0, -9.81], [0.5, 4.9, -9.81]]}
    assert "a-b: the bodies flutter at the limit of friction" in run(made).attrs["warnings"]
    time = {"end": 0.1, "output_interval": 0.1 / 60}
    settle = {"gravity": {"vector": [0.0, -9.81]}}
    made |= {"gravity": {"vector": [4.9, -9.81]}, "settle": settle, "time": time}
    made["contact"]["friction"] = 0.2
    tree = run(made)
    assert (tree["series"]["frictional_work"].values[-1] > 0.0).all()
    assert "flutter" not in str(tree.attrs.get("warnings", ""))


def test_of_notes_that_differ_in_names_and_numbers_one_is_printed():
    alike = [
        f"{pair}: deep by {cells} cells, more than 0.15" for pair, cells in (("a-b", "1e-05"), ("d1-d2", 0.2))
    ]
    assert condensed([*alike, "suspect: else"]) == [f"{alike[0]} (1 more alike)", "suspect: else"]


def test_of_penetrations_the_deepest_is_printed():
    depths = {"a-b": 0.2, "c-d": 0.3}
    verdict = SimpleNamespace(reasons=[], deepest=depths, deepest_at=depths, closed={})
    assert condensed(Verdict.concerns(verdict))[0].startswith("c-d: the bodies penetrate by 0.3 cells")
