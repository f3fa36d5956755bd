"""Other codes as methods: what an adapter refuses, how its process runs, and what is read from a folder."""

import importlib.util
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import types
from pathlib import Path

import numpy as np
import pytest

import mpmfw
from mpmfw.api.code import (
    Code,
    MotionOutputs,
    MovingPoints,
    ProcessLimits,
    mesh_of_body,
    read_arrays,
    read_log,
)
from mpmfw.codes.code import codes_of
from mpmfw.codes.outputs import RunCost, results_of
from mpmfw.codes.process import run_process
from mpmfw.errors import MpmfwError, SceneError
from mpmfw.report import table
from mpmfw.report.records import records_of
from mpmfw.results.references import reference_of
from mpmfw.runs.identity import key_of
from mpmfw.scene import load_scene
from mpmfw.scene.tables import Series
from mpmfw_code.calculix import Calculix
from mpmfw_code.nairn import Nairn
from mpmfw_code.newton import OFF_FACE, ON_FACE, Newton

RECORDED = Path(__file__).resolve().parents[1] / "codes"
ARENA = Path(__file__).resolve().parents[2] / "docs/arena/scenes"
SLIP = "rolling-cylinder-slip-rigid"
HERTZ = ARENA / "hertz-impact.toml"
COARSE = {"grid.cell_size": 0.8, "bodies.cylinder.particles.size": "1 cell", "time.end": 0.1}


# -- a recorded folder


def copy_of(name):
    """Return a fixture: a copy of the folder that a code left of a small run."""
    return pytest.fixture(lambda tmp_path: Path(shutil.copytree(RECORDED / name, tmp_path / name)))


#: Newton 1.8.0: the slipping cylinder; CalculiX 2.20: the sliding block; NairnMPM 19.0: one on a rigid plane.
newton_folder, calculix_folder, nairn_folder = map(copy_of, ("newton", "calculix", "nairn"))

FILES = {
    Newton: ("motion.json", "motion.npz", "cost.json", "scene.toml", "points.npz"),
    Calculix: ("scene.dat", "log.txt", "mesh.npz"),
    Nairn: ("motion.41", "motion.991", "log.txt"),
}


@pytest.mark.parametrize(("code", "file"), [(code, file) for code, files in FILES.items() for file in files])
@pytest.mark.parametrize("damage", ["missing", "cut short", "of another kind"])
def test_damaged_output_gives_one_line(tmp_path, code, file, damage):
    folder = Path(shutil.copytree(RECORDED / code.name, tmp_path / "run"))
    content = (folder / file).read_bytes()
    (folder / file).unlink()
    if damage != "missing":
        short = content[: len(content) // 2 + 20 * (code is not Newton)]
        (folder / file).write_bytes(short if damage == "cut short" else b"[1, 2")
    with pytest.raises(MpmfwError) as caught:
        code().read(folder)
    assert len(str(caught.value).splitlines()) == 1
    assert file == "scene.toml" or f"{code.title}: " in str(caught.value)


def test_a_recorded_folder_gives_the_figures_of_its_run(newton_folder):
    run = Newton(collider_basis="pic27").read(newton_folder)
    series, exact = run["series"].to_dataset(), reference_of(run.attrs)
    moved = series["centre_of_mass"].sel(body="cylinder", axis="x").values
    end = exact.solution.time_to(exact.distance)
    assert np.interp(end, series["time"], moved - moved[0]) / exact.distance - 1.0 == pytest.approx(
        0.0021, abs=1e-3
    )
    spin = series["angular_velocity"].sel(body="cylinder", rotation="z").values
    assert np.interp(end, series["time"], spin) / exact.solution.spin(end) == pytest.approx(0.0029, abs=1e-3)
    mass = float(run["particles/cylinder"]["mass"].sum())
    assert mass == pytest.approx(1000.0 * np.pi * 1.6**2, rel=2e-2)  # of a metre, not of the slab
    velocity = series["mean_velocity"].sel(body="cylinder").values
    kinetic = series["kinetic_energy"].sel(body="cylinder").values
    assert (kinetic >= 0.5 * mass * (velocity**2).sum(axis=1) * (1.0 - 1e-12)).all()
    assert run.attrs["code"] == "Newton 1.8.0, float32, CPU"
    assert run.attrs["status"] == "ok"
    assert run.attrs["steps"] == 816
    assert run.attrs["cpu_time"] > 0.0
    assert "logarithmic strain" in run.attrs["notes"]
    assert "slab" in run.attrs["notes"]


def test_the_contact_force_is_the_momentum_that_gravity_does_not_give(newton_folder):
    run = Newton().read(newton_folder)
    series = run["series"].to_dataset()
    force = series["contact_force"].sel(pair="cylinder-plane").transpose("time", "axis").values
    mass, time = float(run["particles/cylinder"]["mass"].sum()), series["time"].values
    momentum = series["linear_momentum"].sel(body="cylinder").transpose("time", "axis").values
    gravity = 10.0 * np.array([np.sin(np.pi / 3), -np.cos(np.pi / 3)])
    impulse = (force[1:] * np.diff(time)[:, None]).sum(axis=0)
    np.testing.assert_allclose(impulse + mass * gravity * time[-1], momentum[-1] - momentum[0], rtol=1e-9)
    tangential = -impulse[0] / impulse[1]
    assert tangential == pytest.approx(0.286, rel=1e-2)  # it slips all the way


@pytest.mark.parametrize(
    "change", ["not finite", "fewer points", "text", "times fall", "times of two dimensions"]
)
def test_a_damaged_motion_is_refused(newton_folder, change):
    with np.load(newton_folder / "motion.npz") as file:
        arrays = dict(file)
    if change == "not finite":
        arrays["velocity"][3, 2, 0] = np.nan
    elif change == "fewer points":
        arrays["position"] = arrays["position"][:, :-1]
    elif change == "times of two dimensions":
        arrays["time"] = arrays["time"][:, None]
    elif change == "text":
        arrays["time"] = arrays["time"].astype(str)
    else:
        arrays["time"][2] = arrays["time"][1]
    np.savez(newton_folder / "motion.npz", **arrays)
    with pytest.raises(MpmfwError, match="Newton: its output is missing or damaged"):
        Newton().read(newton_folder)


def _edit(path, **changes):
    facts = json.loads(path.read_text())
    path.write_text(json.dumps(facts | changes))


FACTS = [{"steps": -1}, {"steps": True}, {"cpu_time": -1.0}, {"cpu_time": "1"}, {"wall_time": float("inf")}]


@pytest.mark.parametrize("facts", FACTS, ids=str)
def test_facts_of_another_kind_are_refused(newton_folder, facts):
    _edit(newton_folder / ("cost.json" if "wall_time" in facts else "motion.json"), **facts)
    with pytest.raises(MpmfwError, match="Newton: its output is missing or damaged"):
        Newton().read(newton_folder)


def test_files_that_are_too_large_are_not_read(newton_folder):
    path = newton_folder / "motion.json"
    os.truncate(path, 2**24 + 1)  # a hole, which takes no room
    with pytest.raises(MpmfwError, match=r"motion\.json is too large"):
        Newton().read(newton_folder)
    packed = newton_folder / "more.npz"
    np.savez_compressed(packed, zeros=np.zeros(10**6))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mpmfw.codes.code.LARGEST", 10**6)
        assert packed.stat().st_size < 10**6
        with pytest.raises(ValueError, match=r"more\.npz is too large"):
            read_arrays(packed)


def test_texts_of_a_code_have_printable_characters(newton_folder):
    _edit(newton_folder / "motion.json", device="cuda", versions={"newton": "\x1b[2J1.8\x00\u202e.0\n"})
    asked = json.loads((newton_folder / "newton.json").read_text())
    (newton_folder / "newton.json").write_text(json.dumps({**asked, "device": "cuda"}))
    attrs = Newton().read(newton_folder).attrs
    assert attrs["code"] == "Newton [2J1.8 .0 , float32, cuda"
    assert all(attrs[name].isprintable() for name in ("code", "status", "notes", "code_versions"))

    class Falls(Newton):
        def outputs(self, scene, folder):  # noqa: ARG002
            raise MpmfwError("Newton: \x1b]0;title\x07 it fell")

    with pytest.raises(MpmfwError, match=r"^Newton: \]0;title it fell$"):
        Falls().read(newton_folder)


def test_another_version_is_named_in_the_status(newton_folder):
    _edit(newton_folder / "motion.json", versions={"newton": "1.9.2"})
    run = Newton().read(newton_folder)
    assert run.attrs["status"] == "suspect: measured with 1.8, not 1.9.2"
    assert "1.9.2" in run.attrs["code"]


def test_a_motion_that_ends_early_has_failed(newton_folder):
    with np.load(newton_folder / "motion.npz") as file:
        np.savez(newton_folder / "motion.npz", **{name: array[:-2] for name, array in dict(file).items()})
    assert Newton().read(newton_folder).attrs["status"] == "failed: it ended at 1.5 s of 1.7 s"


def test_a_recorded_folder_of_calculix_gives_the_figures_of_its_run(calculix_folder):
    run = Calculix().read(calculix_folder)
    series = run["series"].to_dataset()
    assert run.attrs["status"] == "ok"
    assert run.attrs["code"] == "CalculiX 2.20, float64, CPU"
    assert run.attrs["steps"] == 948
    assert float(run["particles/block"]["mass"].sum()) == pytest.approx(180.0)
    moved = series["centre_of_mass"].sel(body="block", axis="x").values
    exact = 0.5 * 10.0 * (np.sin(np.pi / 6) - 0.3 * np.cos(np.pi / 6)) * series["time"].values ** 2
    assert (moved - moved[0])[-1] == pytest.approx(exact[-1], rel=0.05)
    assert series["contact_force"].sel(pair="block-plane", axis="y").values[2:] == pytest.approx(
        180.0 * 10.0 * np.cos(np.pi / 6), rel=0.05
    )


@pytest.mark.parametrize("held", ["plane", "block", "both"])
def test_the_contact_force_is_of_the_body_that_nothing_holds(calculix_folder, held):
    scene = load_scene(calculix_folder / "scene.toml")
    outputs = Calculix().outputs(scene, calculix_folder)
    sides = [{"side": "bottom", "fixed": True}]
    changes = {f"bodies.{name}.sides": sides if held in (name, "both") else [] for name in scene.bodies}
    changed = scene.with_overrides(changes)
    run = results_of(changed, outputs, RunCost(1.0, 1.0, 1.0), {}, None)
    series = run["series"].to_dataset()
    if held == "both":
        assert "contact_force" not in series
        return
    momentum = series["linear_momentum"].sel(body="block" if held == "plane" else "plane")
    rate = np.diff(momentum.transpose("time", "axis").values, axis=0) / np.diff(series["time"])[:, None]
    mass = outputs.bodies[str(momentum["body"].item())].mass.sum()
    expected = rate - mass * np.array(scene.gravity.at(0.0))
    force = series["contact_force"].sel(pair="block-plane").transpose("time", "axis").values[1:]
    np.testing.assert_allclose(force, expected if held == "plane" else -expected)


def test_growing_energy_is_suspect(calculix_folder):
    path = calculix_folder / "scene.dat"
    lines, last = path.read_text().split("\n"), 0
    for k, line in enumerate(lines):
        last = k if line.startswith(" velocities") else last
    for k in range(last + 2, len(lines)):
        if words := lines[k].split():
            lines[k] = f"{words[0]} {2.0 * float(words[1])} {words[2]} {words[3]}"
    path.write_text("\n".join(lines))
    status = Calculix().read(calculix_folder).attrs["status"]
    assert status.startswith("suspect: the kinetic energy grew by ")


def test_the_input_of_calculix_joins_quadrilaterals(tmp_path):
    Calculix().prepare(load_scene("sliding-block", set={"grid.cell_size": 0.3}), tmp_path)
    lines = (tmp_path / "scene.inp").read_text().splitlines()
    at = lines.index("*NSET, NSET=PRINT, GENERATE")
    assert lines[at + 1 : at + 3] == ["1,6", "13,42"]  # of elements of 0.3 m, and below of 0.27 m
    elements = [line for line in lines if line.count(",") == 8]
    assert len(elements) == 2 + 14
    surface = lines[lines.index("*SURFACE, NAME=SB1, TYPE=ELEMENT") + 1 :][:6]
    assert sorted(surface) == ["1,S3", "1,S5", "1,S6", "2,S3", "2,S4", "2,S5"]
    assert "EB1,GRAV,10,0.5,-0.866025403784,0" in lines  # of the motion
    assert "EB1,GRAV,10,0,-1,0" in lines  # of the static step
    at = lines.index("*HYPERELASTIC, NEO HOOKE")
    assert [float(each) for each in lines[at + 1].split(",")] == pytest.approx([3e6, 2 / 12e6])


def test_the_input_of_calculix_has_no_names_of_bodies(tmp_path):
    text = load_scene("sliding-block", set={"grid.cell_size": 0.3}).text
    path = tmp_path / "named.toml"
    path.write_text(text.replace("bodies.block", "bodies.PLANE"))
    Calculix().prepare(load_scene(path), tmp_path)
    lines = (tmp_path / "scene.inp").read_text().splitlines()
    assert "*MATERIAL, NAME=MB1" in lines
    assert "*MATERIAL, NAME=MB2" in lines
    assert max(map(len, lines)) < 80


def test_a_step_of_calculix_is_below_its_limit(tmp_path):
    scene = load_scene("sliding-block", set={"grid.cell_size": 0.3, "time.output_interval": 0.0012})
    Calculix().prepare(scene, tmp_path)
    with np.load(tmp_path / "mesh.npz") as mesh:
        shortest = min(
            np.diff(np.unique(mesh[f"{name}_nodes"][:, 0].round(9))).min() for name in scene.bodies
        )
        assert mesh["step"] <= 0.3 * shortest / ((24e6 + 4 * 12e6 / 3) / 1000.0) ** 0.5


def test_no_weight_takes_the_weight_of_rest_away(tmp_path):
    changes = {"grid.cell_size": 0.3, "gravity": {"vector": [0.0, 0.0]}}
    Calculix().prepare(load_scene("sliding-block", set=changes), tmp_path)
    lines = (tmp_path / "scene.inp").read_text().splitlines()
    at = lines.index("*DLOAD, OP=NEW")
    assert lines[at + 1 : at + 3] == ["EB1,GRAV,0,-1,-1,-1", "EB2,GRAV,0,-1,-1,-1"]


def test_a_disc_rests_by_its_contact_on_a_rigid_face_alone(tmp_path):
    (problem,) = Calculix().problems(load_scene("rolling-cylinder-slip"))
    assert problem.key == "settle"
    assert "'cylinder' can roll away" in problem.message
    assert not Calculix().problems(load_scene("rolling-cylinder-slip", set={"settle": None}))

    scene = load_scene(SLIP, set={"grid.cell_size": 0.8})
    (x0, y0), (x1, y1) = scene.bodies["plane"].geometry.bounds.tolist()
    x, y = scene.bodies["cylinder"].geometry.centre
    for place in [x0 - 0.1, y], [x1 + 0.1, y], [x, y0 + y1 - y]:  # beside and below the face
        beside = load_scene(SLIP, set={"bodies.cylinder.geometry.centre": place})
        (problem,) = Calculix().problems(beside)
        assert "'cylinder' can roll away" in problem.message

    Calculix().prepare(scene, tmp_path)
    lines = (tmp_path / "scene.inp").read_text().splitlines()
    with np.load(tmp_path / "mesh.npz") as file:
        nodes, mass = file["cylinder_nodes"], file["cylinder_mass"]
    assert mass.sum() == pytest.approx(1000.0 * np.pi * 1.6**2, rel=1e-9)
    weight = 10.0 * mass.sum()  # a slab as deep as an element carries it by its stiffness over a cell
    face = scene.bodies["plane"].geometry.bounds[1][1]
    assert nodes[:, 1].min() == pytest.approx(face - weight / (6e6 + 4e6), rel=1e-6)
    top, begin = nodes[:, 1].argmax() + 1, lines.index("*STATIC")
    held = [k for k, line in enumerate(lines) if line == f"{top},1"]
    assert len(held) == 1
    assert begin < held[0] < lines.index("*DYNAMIC, EXPLICIT")
    assert lines.count("NB2,1,3") == 2


def test_a_ball_and_a_box_are_meshed_in_space():
    scene = load_scene(HERTZ)
    ball, box = mesh_of_body(scene, "ball", 0.25, 0.25), mesh_of_body(scene, "plane", 1.0, 0.25)
    radius = np.linalg.norm(ball.nodes - scene.bodies["ball"].geometry.centre, axis=1)
    outer = np.unique(ball.cells[ball.outer[:, 0]])
    np.testing.assert_allclose(
        np.sort(radius[outer])[-len(ball.outer) - 2 :], 1.0
    )  # by Euler, of quadrilaterals
    assert np.count_nonzero(radius > 1.0 - 1e-9) == len(ball.outer) + 2
    assert radius.max() <= 1.0 + 1e-9
    assert ball.volume.sum() == pytest.approx(4.0 / 3.0 * np.pi, rel=0.03)
    assert box.volume.sum() == pytest.approx(1.6 * 1.6 * 0.517)
    assert len(box.outer) == 16


def test_a_recorded_folder_of_nairn_gives_the_figures_of_its_run(nairn_folder):
    run = Nairn(normals="LOGR", shape="lCPDI").read(nairn_folder)
    series = run["series"].to_dataset()
    assert run.attrs["status"] == "ok"
    assert run.attrs["code"] == "NairnMPM 19.0, float64, CPU"
    assert run.attrs["steps"] == 950
    np.testing.assert_allclose(series["time"], 0.1 * np.arange(11.0))
    assert float(run["particles/block"]["mass"].sum()) == pytest.approx(180.0)
    moved = series["centre_of_mass"].sel(body="block", axis="x").values
    recorded = [0.046602, 0.182468, 0.410251, 0.727505, 1.131879]  # in closed form 1.200962 at the end
    np.testing.assert_allclose((moved - moved[0])[2::2], recorded, atol=1e-6)
    force = series["contact_force"].sel(pair="block-plane", axis="y").values[1:]
    assert force.mean() == pytest.approx(1571.535, abs=1e-3)  # its weight gives 1558.846
    total = run.attrs["cpu_time"] + run.attrs["settle_time"]
    assert run.attrs["settle_time"] / total == pytest.approx(41 / 991)


WARNED = "The warning 'Particle has left the grid and was pushed back' occurred on 7 time steps.\n"


@pytest.mark.parametrize(
    ("old", "new", "status"),
    [
        ("NairnMPM 19.0", "NairnMPM 20.1", "suspect: measured with 19.0, not 20.1"),
        ("***** 11.", WARNED + "***** 11.", "suspect: it warns on 7 steps: Particle has left the grid"),
        (
            "***** 11.",
            WARNED.replace("Particle has left", "Logistic regression did not converge") + "*****",
            "ok",
        ),
    ],
)
def test_what_nairn_says_is_in_the_row(nairn_folder, old, new, status):
    path = nairn_folder / "log.txt"
    path.write_text(path.read_text().replace(old, new))
    attrs = Nairn().read(nairn_folder).attrs
    assert attrs["status"].startswith(status)
    assert ("did not converge in 7 of 991 steps" in attrs["notes"]) == ("Logistic" in new)


def test_archives_of_nairn_in_another_order_are_refused(nairn_folder):
    path = nairn_folder / "motion.41"
    path.write_bytes(path.read_bytes().replace(b"iYYN", b"iYYY"))
    with pytest.raises(MpmfwError, match="is not an archive of positions and velocities"):
        Nairn().read(nairn_folder)


def test_the_input_of_nairn_has_numbers_alone(tmp_path):
    text = load_scene("rolling-cylinder-slip", set={"grid.cell_size": 0.8}).text
    path = tmp_path / "named.toml"
    path.write_text(text.replace("bodies.cylinder", "bodies.ROOT").replace('["cylinder"', '["ROOT"'))
    Nairn(apart=0.8, fmpm=2).prepare(load_scene(path), tmp_path)
    lines = (tmp_path / "scene.fmcmd").read_text().splitlines()
    assert "ROOT" not in "".join(lines)
    assert '<Grid xmin="-3.2" xmax="23.2" ymin="-3.2" ymax="8">' in lines
    assert '<Horiz nx="33"/>' in lines
    contact = (
        '<MultiMaterialMode Normals="2"><Friction>0.286</Friction><ContactPosition>0.8</ContactPosition>'
    )
    assert f"{contact}</MultiMaterialMode>" in lines
    assert '<Parameter name="FMPMOrder">2</Parameter>' in lines
    volumes = [0.64 * float(line.split('lpx="')[1].split('"')[0]) ** 2 for line in lines if 'mat="1"' in line]
    assert sum(volumes) == pytest.approx(np.pi * 1.6**2, rel=1e-5)
    assert '<Material Type="8" Name="B1"><rho>1000</rho><K>6000000</K><G1>3000000</G1>' in "".join(lines)
    held = [line for line in lines if line.startswith("<LdRect")]
    assert len(held) == 3
    assert 'ymax="8e-07"><DisBC dir="1" disp="0"/><DisBC dir="2" disp="0"/>' in held[0]
    (down,) = (line for line in lines if line.startswith("<GridBodyYForce>"))
    level, change = (float(word.split("*")[0]) for word in down[16:].split("+"))
    assert level - change == pytest.approx(-10.0)  # while it settles
    assert level + change == pytest.approx(-5.0)
    (damping,) = (line for line in lines if line.startswith("<Damping"))
    damped = re.findall(r'"([^*]*)\*\(1-sgn\(t-(.*)\)\)"', damping)[0]
    rate, end = 2.0 * float(damped[0]), float(damped[1])  # a wave takes 0.032 s through the cylinder
    assert (rate * 0.032, end / 0.032) == pytest.approx((1.0, 20.0))


def test_rigid_bodies_and_turning_points_are_written(tmp_path):
    start = {"bodies.cylinder.velocity": [1.0, 0.0], "bodies.cylinder.angular_velocity": -0.5}
    scene = load_scene(SLIP, set=COARSE | start)
    text = scene.text[: scene.text.index("[settle]")]
    path = tmp_path / "moving.toml"
    path.write_text(text)
    Nairn(points="scene").prepare(load_scene(path), tmp_path)
    lines = (tmp_path / "scene.fmcmd").read_text().splitlines()
    assert '<Material Type="11" Name="B2"><SetDirection>8</SetDirection></Material>' in lines
    rigid = [line for line in lines if line.startswith('<mp mat="2"')]
    assert len(rigid) == 100
    points = [re.findall(r' [xy]="([^"]*)"', line) for line in lines if line.startswith('<mp mat="1"')]
    place, speed = np.hsplit(np.array(points, dtype=float), 2)
    np.testing.assert_allclose(speed[:, 0], 1.0 + 0.5 * (place[:, 1] - 2.4), atol=1e-9)
    np.testing.assert_allclose(speed[:, 1], -0.5 * (place[:, 0] - 4.0), atol=1e-9)


# -- input

BLOCK = "sliding-block"
J2 = {"model": "j2", "yield_stress": 1e6}
MOVED = (SLIP, {"bodies.plane.rigid": {"motion": {"velocity": [1.0, 0.0]}}})
WIND = (SLIP, {"loads.wind": {"model": "drag", "rate": 1.0}})
HELD, PRESSED = {"side": "bottom", "fixed": True}, {"side": "top", "pressure": 1.0}
THROWN = (BLOCK, {"bodies.block.velocity": [1.0, 0.0]})
PAIR = "contact.pairs.block-plane"
#: What no run of any code can do: a scene and its changes, by the key that is named.
OF_ALL = {
    "bodies.wheel.rigid": ("wheel", {}),
    "contact.method": (BLOCK, {"contact.method": "separate"}),
    f"{PAIR}.method": (BLOCK, {PAIR: {"method": "tied"}}),
}
#: What no run of a code can do besides.
REFUSED = {
    Newton: {
        "bodies.cylinder.thickness": (SLIP, {"bodies.cylinder.thickness": 0.5}),
        "bodies.cylinder.self_contact": (SLIP, {"bodies.cylinder.self_contact": True}),
        "sleep": ("rolling-cylinder-slip", {"sleep": {}}),
        "settle.max_time": (SLIP, {"settle.max_time": 1.0}),
        "bodies": ("rolling-cylinder-slip", {}),
        "contact.friction_law": (
            SLIP,
            {"contact.friction_law": "mohr_coulomb", "contact.mohr_coulomb.cohesion": 1.0},
        ),
        "gravity.table": (SLIP, {"gravity": {"table": [[0, 1, -9], [1, 2, -9]]}}),
        "loads": WIND,
        "materials.soft.damping": (SLIP, {"materials.soft.damping": {"shear": 1e-3}}),
        "materials.soft.model": (SLIP, {f"materials.soft.{key}": value for key, value in J2.items()}),
        "bodies.plane.rigid": MOVED,
        "bodies.plane.geometry": (
            SLIP,
            {"bodies.plane.geometry": {"type": "disc", "centre": [4.0, -10.0], "radius": 10.8}},
        ),
    },
    Calculix: {
        "bodies.block.velocity": THROWN,
        "bodies.plane.rigid": MOVED,
        "bodies.plane.geometry": (
            ARENA / "hertz-impact.toml",
            {"bodies.plane.geometry": {"type": "ball", "centre": [0.0, -1.0, 0.0], "radius": 1.0}},
        ),
        "bodies.block.particles.layout": (BLOCK, {"bodies.block.particles.layout": "lattice"}),
        "materials.block.model": (BLOCK, {"materials.block.model": "linear_elastic"}),
        "bodies.plane.sides": (BLOCK, {"bodies.plane.sides": [HELD, PRESSED]}),
        "settle": (BLOCK, {"bodies.plane.sides": []}),
    },
    Nairn: {
        "bodies.block.velocity": THROWN,
        "bodies.plane.sides": (BLOCK, {"grid.lower": [-0.65, -0.45]}),
        "materials.block.model": (BLOCK, {f"materials.block.{key}": value for key, value in J2.items()}),
        "bodies.plane.rigid.motion": MOVED,
        "loads": WIND,
    },
}


@pytest.mark.parametrize(
    ("code", "key"), [(code, key) for code, keys in REFUSED.items() for key in (*keys, *OF_ALL)]
)
def test_what_a_code_cannot_do_is_refused_by_its_key(code, key, tmp_path):
    name, changes = {**OF_ALL, **REFUSED[code]}[key]
    scene = load_scene(name, set=changes)
    problems = code().problems(scene)
    assert key in [problem.key for problem in problems]
    assert all(problem.message.startswith(f"{code.title}: ") for problem in problems)
    with pytest.raises(SceneError, match=f"{code.title}: "):
        code().prepare(scene, tmp_path)
    assert not list(tmp_path.iterdir())
    own = [problem.key for problem in code().problems(load_scene(BLOCK, set={PAIR: {"friction": 0.1}}))]
    assert not any(each.startswith("contact") for each in own)


def test_the_input_has_the_points_of_mpmfw_in_a_slab(tmp_path):
    Newton(step=0.004).prepare(load_scene(SLIP, set=COARSE), tmp_path)
    with np.load(tmp_path / "points.npz") as file:
        assert file["volume"].sum() == pytest.approx(2 * 0.8 * np.pi * 1.6**2, rel=2e-2)
        assert file["position"][:, 1].min() > 0.8
        assert np.ptp(file["position"][:, 2]) == pytest.approx(0.8)
        assert not file["velocity"].any()
    facts = json.loads((tmp_path / "newton.json").read_text())
    assert facts["gravity"] == pytest.approx([5.0 * 3**0.5, -5.0, 0.0])
    assert facts["settle_gravity"] == pytest.approx([0.0, -10.0, 0.0])
    young = 9 * 6e6 * 3e6 / (3 * 6e6 + 3e6)
    assert facts["young_modulus"] == pytest.approx(young)
    assert facts["height"] == pytest.approx(0.8)
    assert facts["friction"] == 0.286
    assert facts["times"][-1] == 0.1
    assert len(facts["times"]) == 11


class _Values:
    """An array as Warp has it."""

    def __init__(self, values):
        self.values = np.array(values, dtype=np.float32)

    def numpy(self):
        return self.values

    def assign(self, values):
        assert values.shape == self.values.shape
        self.values[:] = values

    def zero_(self):
        self.values[:] = 0.0


class _Free:
    """A model and solver without forces: points keep their velocities."""

    def __init__(self, points):
        self.points = points
        self.device = types.SimpleNamespace(name="CPU")

    def state(self):
        count = len(self.points["volume"])
        gradient = types.SimpleNamespace(particle_qd_grad=_Values(np.zeros((count, 3, 3))))
        velocity, position = _Values(self.points["velocity"]), _Values(self.points["position"])
        return types.SimpleNamespace(particle_q=position, particle_qd=velocity, mpm=gradient)

    def set_gravity(self, gravity):
        """There is none."""

    def step(self, one, two, control, contacts, step):  # noqa: ARG002
        two.particle_q.assign(one.particle_q.values + step * one.particle_qd.values)
        two.particle_qd.assign(one.particle_qd.values)
        two.mpm.particle_qd_grad.assign(one.mpm.particle_qd_grad.values)
        self.gradient = two.mpm.particle_qd_grad.values


def test_a_velocity_at_the_start_stands_after_settling(tmp_path, monkeypatch):
    for name in ("newton", "newton.solvers", "warp"):
        monkeypatch.setitem(sys.modules, name, types.SimpleNamespace(SolverImplicitMPM=None))
    path = Path(importlib.util.find_spec("mpmfw_code.newton").origin).with_name("newton_driver.py")
    spec = importlib.util.spec_from_file_location("newton_driver", path)
    driver = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(driver)
    start = {"bodies.cylinder.velocity": [1.0, 0.0], "bodies.cylinder.angular_velocity": -0.5}
    Newton().prepare(load_scene(SLIP, set={**COARSE, **start}), tmp_path)
    free = []
    monkeypatch.setattr(driver, "make_model", lambda facts, points: free.append(_Free(points)) or free[0])  # noqa: ARG005
    monkeypatch.setattr(driver, "make_solver", lambda model, facts: model)  # noqa: ARG005
    monkeypatch.setattr(driver, "version", lambda name: "1.8.0")  # noqa: ARG005
    driver.main(tmp_path)
    with np.load(tmp_path / "motion.npz") as motion, np.load(tmp_path / "points.npz") as points:
        np.testing.assert_allclose(motion["position"][0], points["position"], rtol=1e-6)
        np.testing.assert_allclose(motion["velocity"][0], points["velocity"], rtol=1e-6)
        moved = motion["position"][-1] - motion["position"][0]
        np.testing.assert_allclose(moved, 0.1 * points["velocity"], atol=1e-4)
        assert points["velocity"].mean(axis=0) == pytest.approx([1.0, 0.0, 0.0], abs=1e-3)
    np.testing.assert_allclose(free[0].gradient[0], [[0, 0.5, 0], [-0.5, 0, 0], [0, 0, 0]])


def test_a_belt_is_a_rigid_material_that_moves_and_a_normal_may_be_given(tmp_path):
    Nairn(normals="SN", azimuth=-60.0).prepare(load_scene(ARENA / "belt.toml"), tmp_path)
    text = (tmp_path / "scene.fmcmd").read_text()
    assert '<MultiMaterialMode Normals="4" Polar="90" Azimuth="-60">' in text
    speeds = {k: set(re.findall(rf'<mp mat="{k}".*?<vel x="([^"]*)" y="0"/>', text)) for k in (1, 2)}
    assert speeds == {1: {"0"}, 2: {"1"}}


def test_points_on_faces_of_cells_move_off_them_with_the_plane(tmp_path):
    """Newton's motion is not finite where a point lies on the face of an empty cell."""
    shift = {}
    for name, x in (("on", 1.2), ("off", 1.23)):
        ball = {"bodies.sphere.geometry.centre": [x, 2.41, 0.01]}
        (tmp_path / name).mkdir()
        Newton().prepare(load_scene("rolling-sphere-slip-rigid", set=ball), tmp_path / name)
        facts = json.loads((tmp_path / name / "newton.json").read_text())
        with np.load(tmp_path / name / "points.npz") as points:
            position = points["position"] / 0.4
        assert np.abs(position - np.round(position)).min() > 0.9 * ON_FACE
        assert facts["height"] == pytest.approx(0.8 + facts["shift"][1], abs=1e-12)
        shift[name] = facts["shift"]
    assert shift["on"][0] == pytest.approx(0.4 * OFF_FACE)
    assert shift["off"] == [0.0, 0.0, 0.0]


def test_series_of_plug_ins_are_refused():
    scene = load_scene(SLIP).model_copy(update={"outputs": {"more": Series(model="mean")}})
    assert [problem.key for problem in Newton().problems(scene)] == ["outputs"]


# -- a code that is not installed


def test_a_code_that_is_not_installed_gives_the_command_that_installs_it(monkeypatch):
    monkeypatch.delenv("MPMFW_CODE_NEWTON", raising=False)
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *rest: None if name == "newton" else find(name, *rest)
    )
    with pytest.raises(SceneError) as caught:
        codes_of(["newton"])
    assert str(caught.value) == "code newton: is not installed; pip install 'mpmfw[newton]'"


def test_a_program_that_the_environment_names_is_checked(monkeypatch):
    monkeypatch.setenv("MPMFW_CODE_NEWTON", "/no/such/python")
    with pytest.raises(SceneError, match="MPMFW_CODE_NEWTON=/no/such/python is not a program"):
        Newton().find()
    monkeypatch.setenv("MPMFW_CODE_NEWTON", sys.executable)
    assert Newton().find() == sys.executable


def test_the_version_of_a_code_is_part_of_the_key_of_its_runs(tmp_path, monkeypatch):
    program = tmp_path / "ccx"
    program.write_text("#!/bin/sh")
    program.chmod(0o755)
    monkeypatch.setenv("MPMFW_CODE_CALCULIX", str(program))
    scene, keys = load_scene("sliding-block"), []
    for content in ("#!/bin/sh", "#!/bin/sh\n# another version"):
        program.write_text(content)
        (code,) = codes_of(["calculix"])
        keys.append(key_of(scene, code))
        assert key_of(scene, codes_of(["calculix"])[0]) == keys[-1]
    assert keys[0] != keys[1]
    monkeypatch.setenv("MPMFW_CODE_NEWTON", "/bin/false")
    with pytest.raises(SceneError, match=r"/bin/false has no Newton; pip install 'mpmfw\[newton\]'"):
        codes_of(["newton"])


@pytest.mark.parametrize("script", ["exit 0", "echo 1.8", "echo one two", "printf '\\377'", "none"])
def test_a_program_without_two_versions_is_not_newton(tmp_path, monkeypatch, script):
    program = tmp_path / "python"
    program.write_text("#!/no/such/shell" if script == "none" else f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    monkeypatch.setenv("MPMFW_CODE_NEWTON", str(program))
    with pytest.raises(SceneError, match="has no Newton; pip install"):
        codes_of(["newton"])


def test_a_relative_path_is_that_of_the_folder_where_it_was_given(tmp_path, monkeypatch):
    program = tmp_path / "ccx"
    program.write_text("#!/bin/sh\necho $1 > seen\n")
    program.chmod(0o755)
    (tmp_path / "run").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPMFW_CODE_CALCULIX", "./ccx")
    assert Calculix().find() == str(program)
    Calculix().run(Path("run"))
    assert (tmp_path / "run" / "seen").read_text().strip() == str(tmp_path / "run" / "scene")


# -- processes


def test_a_process_is_stopped_at_its_limits(tmp_path):
    limits = ProcessLimits(seconds=0.5)
    with pytest.raises(MpmfwError, match=r"stopped after 0\.5 s"):
        run_process([sys.executable, "-c", "import time; time.sleep(60)"], tmp_path, tmp_path / "log", limits)
    hungry = [sys.executable, "-c", "import time; time.sleep(0.5); bytearray(10**9)"]
    with pytest.raises(MpmfwError, match="ended with status 1: MemoryError"):
        run_process(hungry, tmp_path, tmp_path / "log", ProcessLimits(memory=300_000_000))


def test_a_process_writes_no_larger_file_than_its_limit(tmp_path):
    code = "import signal; signal.signal(signal.SIGXFSZ, signal.SIG_DFL); print('x' * 200_000, flush=True)"
    limits = ProcessLimits(file=100_000)
    with pytest.raises(MpmfwError, match="ended with status -25"):
        run_process([sys.executable, "-c", code], tmp_path, tmp_path / "log", limits)
    assert (tmp_path / "log").stat().st_size == 100_000


def test_the_begin_and_the_end_of_a_log_are_read(tmp_path):
    log = tmp_path / "log"
    log.write_text("begin\n" + "middle\n" * 10**5 + "end\n")
    text = read_log(log)
    assert len(text) == 2**17
    assert text.startswith("begin")
    assert text.endswith("end\n")
    log.write_text("a\n" * 50_000)
    assert read_log(log) == "a\n" * 50_000
    code = "import sys; print('\\x1b[31mit\\x00 fell\\x07\\n\\x1b'); sys.exit(3)"
    with pytest.raises(MpmfwError) as caught:
        run_process([sys.executable, "-c", code], tmp_path, log, ProcessLimits())
    assert str(caught.value).endswith("ended with status 3: [31mit fell")


@pytest.mark.skipif(sys.platform != "linux", reason="needs prctl")
def test_a_process_ends_with_its_parent(tmp_path):
    parent = (
        "from pathlib import Path; import sys; from mpmfw.codes.process import ProcessLimits, run_process;"
        "child = 'import os, time; print(os.getpid(), flush=True); time.sleep(60)';"
        "run_process([sys.executable, '-c', child], Path('.'), Path('log'), ProcessLimits())"
    )
    process = subprocess.Popen([sys.executable, "-c", parent], cwd=tmp_path)
    log, limit = tmp_path / "log", time.monotonic() + 60.0
    while not (log.exists() and log.read_text().endswith("\n")) and time.monotonic() < limit:
        time.sleep(0.05)
    pid = int(log.read_text())
    process.send_signal(signal.SIGKILL)
    process.wait()
    limit = time.monotonic() + 10.0
    while _runs(pid) and time.monotonic() < limit:
        time.sleep(0.05)
    assert not _runs(pid)


def _runs(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_process_has_no_shell(tmp_path):
    code = "import sys; open('seen', 'w').write(sys.argv[1])"
    argument = "; touch made $(touch made)"
    cost = run_process([sys.executable, "-c", code, argument], tmp_path, tmp_path / "log", ProcessLimits())
    assert (tmp_path / "seen").read_text() == argument
    assert not (tmp_path / "made").exists()
    assert cost.cpu_time > 0.0
    assert cost.peak_memory > 1e6
    with pytest.raises(MpmfwError, match="cannot be started"):
        run_process([str(tmp_path / "none")], tmp_path, tmp_path / "log", ProcessLimits())


# -- in a comparison


class Parabola(Code):
    """A code that moves one point by the closed form of a slipping cylinder."""

    name, title, install = "parabola", "Parabola", "nothing installs it"
    reads = frozenset({"gravity", "settle"})
    script = "open('done', 'w').write('1')"

    def refusals(self, scene):  # noqa: ARG002
        """Refuse nothing more."""
        yield from ()

    def write(self, scene, folder):
        """Need no input."""

    def program(self):
        """Return this interpreter."""
        return sys.executable

    def command(self, program, folder):  # noqa: ARG002
        """Count the runs."""
        return [program, "-c", self.script]

    def outputs(self, scene, folder):
        """Return the closed form's motion of four points."""
        assert (folder / "done").read_text() == "1"
        time = np.linspace(0.0, float(scene.time.end), 11)
        exact = reference_of({"scene": scene.text}).solution
        corners = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
        turned = np.stack([-corners[:, 1], corners[:, 0]], axis=1)
        x = exact.acceleration * time
        position = corners + np.stack([0.5 * x * time, 2.4 + 0 * x], axis=1)[:, None]
        spin = exact.angular_acceleration * time
        velocity = spin[:, None, None] * turned + np.stack([x, 0 * x], axis=1)[:, None]
        points = MovingPoints(np.full(4, 25.0), position, velocity)
        return MotionOutputs(
            time, {"cylinder": points}, "Parabola 3, float64, CPU", 100, notes=("it is exact",)
        )


class Broken(Parabola):
    """A code that fails."""

    name, title = "broken", "Broken"
    script = "raise SystemExit('the licence has expired')"


def test_a_code_stands_in_a_comparison_like_a_contact(tmp_path, monkeypatch):
    sizes = {"set": {**COARSE, "time.end": 0.1}, "store": tmp_path / "store"}
    codes = [Parabola(), Broken()]
    with pytest.warns(mpmfw.ResultsWarning, match="Parabola, linear: it is exact"):
        joined = mpmfw.compare(SLIP, contact=["penalty"], shape=["linear", "gimp"], code=codes, **sizes)
    assert joined["contact"].values.tolist() == ["penalty", "Parabola", "Broken"]
    status = joined["status"].sel(shape="linear").values.tolist()
    assert status[:2] == ["ok", "ok"]
    assert status[2].startswith("failed: ")
    assert status[2].endswith("the licence has expired")
    twin = str(joined["status"].sel(contact="Parabola", shape="gimp").item())
    assert twin == "refused: shape gimp changes nothing here: it is the run of Parabola, linear"
    own = joined.sel(contact="Parabola", shape="linear")
    assert str(own["code"].item()) == "Parabola 3, float64, CPU"
    assert float(own["steps"]) == 100
    end = own.sel(body="cylinder").isel(time=-1)
    assert float(end["centre_of_mass"].sel(axis="x")) == pytest.approx(0.5 * 7.23 * 0.1**2, rel=1e-3)
    assert float(end["angular_velocity"].sel(rotation="z")) == pytest.approx(-0.1788, rel=1e-3)
    row = next(row for row in table(joined) if row["contact"] == "Parabola")
    assert row["shape"] == "its own"
    assert row["scheme"] == ""
    assert row["code"].startswith("Parabola 3")
    kept = {(one.method, one.shape): one for one in records_of(joined)}
    assert kept.keys() == {("penalty", s) for s in ("linear", "gimp")} | {
        (m, "its own") for m in ("Parabola", "Broken")
    }
    broken = kept["Broken", "its own"]
    assert (broken.code, broken.status, broken.figures) == ("Broken", status[2], {})
    monkeypatch.setattr(Parabola, "script", "raise SystemExit('it must come from the store')")
    with pytest.warns(mpmfw.ResultsWarning):
        again = mpmfw.compare(SLIP, contact=["penalty"], shape=["linear"], code=[codes[0]], **sizes)
    assert again["status"].values.ravel().tolist() == ["ok", "ok"]


def test_a_code_refuses_keys_of_other_methods_and_scenes_that_it_cannot_run():
    class Still(Parabola):
        """A code that does not read gravity."""

        name, title, reads = "still", "Still", frozenset()

    varied = {"stepping.transfer": ["apic", "flip"]}
    joined = mpmfw.compare(
        SLIP, contact=["penalty"], shape=["linear"], vary=varied, code=[Broken(), Still()], set=COARSE
    )
    one, two = joined["status"].sel(contact="Broken", shape="linear").values.tolist()
    assert one.startswith("failed")
    assert two.startswith("refused: transfer flip changes nothing here")
    refused = str(joined["status"].sel(contact="Still").values.ravel()[0])
    assert "gravity: Still: cannot be expressed" in refused
    refused = refused.replace("\n", "; ")
    assert {(one.method, one.status) for one in records_of(joined) if one.code == "Still"} == {
        ("Still", refused)
    }
    assert "settle: Still: " in refused


def test_a_study_takes_codes_among_its_contacts():
    study = {
        "scene": "rolling-cylinder-no-slip-rigid",
        "vary": {"contact": ["penalty"], "shape": ["linear"]},
        "set": {**COARSE, "time.end": 0.1},
        "error": {"quantity": "spin"},
    }
    with pytest.warns(mpmfw.ResultsWarning, match="it is exact"):
        found = mpmfw.study(study, code=[Parabola()], under=0.5)
    own = found.sel(contact="Parabola", shape="linear")
    assert float(own["error"]) == pytest.approx(0.0, abs=1e-12)
    assert (str(own["status"].item()), str(own["code"].item())) == ("ok", "Parabola")
    assert str(own["scheme"].item()) == ""
    study = {
        "scene": SLIP,
        "code": ["newton"],
        "vary": {"shape": ["linear"]},
        "error": {"quantity": "end-displacement"},
    }
    with pytest.raises(SceneError, match="has no contact"):
        mpmfw.study(study)
