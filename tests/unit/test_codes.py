"""Other codes as methods: what an adapter refuses, how its process runs, and what is read from a folder."""

import importlib.util
import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

import mpmfw
from mpmfw.api.code import Code, MotionOutputs, MovingPoints, ProcessLimits
from mpmfw.codes.code import codes_of
from mpmfw.codes.process import run_process
from mpmfw.errors import MpmfwError, SceneError
from mpmfw.report import table
from mpmfw.results.references import reference_of
from mpmfw.runs.identity import key_of
from mpmfw.scene import load_scene
from mpmfw_code.calculix import Calculix
from mpmfw_code.newton import Newton

RECORDED = Path(__file__).resolve().parents[1] / "codes"
SLIP = "rolling-cylinder-slip-rigid"
COARSE = {"grid.cell_size": 0.8, "bodies.cylinder.particles.size": "1 cell", "time.end": 0.1}


@pytest.fixture
def newton_folder(tmp_path):
    """A copy of what Newton 1.8.0 left of the slipping cylinder, at cells and points of 0.8 m."""
    return Path(shutil.copytree(RECORDED / "newton", tmp_path / "newton"))


# -- a recorded folder


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


@pytest.mark.parametrize("file", ["motion.json", "motion.npz", "cost.json", "scene.toml", "points.npz"])
@pytest.mark.parametrize("damage", ["missing", "cut short", "of another kind"])
def test_damaged_output_gives_one_line(newton_folder, file, damage):
    path = newton_folder / file
    content = path.read_bytes()
    path.unlink() if damage == "missing" else path.write_bytes(
        content[: len(content) // 2] if damage == "cut short" else b"[1, 2"
    )
    with pytest.raises(MpmfwError) as caught:
        Newton().read(newton_folder)
    assert len(str(caught.value).splitlines()) == 1
    assert file == "scene.toml" or "Newton: " in str(caught.value)


@pytest.mark.parametrize("change", ["not finite", "fewer points", "times fall"])
def test_a_motion_that_is_none_is_refused(newton_folder, change):
    with np.load(newton_folder / "motion.npz") as file:
        arrays = dict(file)
    if change == "not finite":
        arrays["velocity"][3, 2, 0] = np.nan
    elif change == "fewer points":
        arrays["position"] = arrays["position"][:, :-1]
    else:
        arrays["time"][2] = arrays["time"][1]
    np.savez(newton_folder / "motion.npz", **arrays)
    with pytest.raises(MpmfwError, match="Newton: its output is missing or damaged"):
        Newton().read(newton_folder)


def _edit(path, **changes):
    facts = json.loads(path.read_text())
    path.write_text(json.dumps(facts | changes))


def test_another_version_is_named_in_the_status(newton_folder):
    _edit(newton_folder / "motion.json", versions={"newton": "1.9.2"})
    run = Newton().read(newton_folder)
    assert run.attrs["status"] == "suspect: the adapter was measured with 1.8, not 1.9.2"
    assert "1.9.2" in run.attrs["code"]


def test_a_motion_that_ends_early_has_failed(newton_folder):
    with np.load(newton_folder / "motion.npz") as file:
        np.savez(newton_folder / "motion.npz", **{name: array[:-2] for name, array in dict(file).items()})
    assert Newton().read(newton_folder).attrs["status"] == "failed: it ended at 1.5 s of 1.7 s"


@pytest.fixture
def calculix_folder(tmp_path):
    """A copy of what CalculiX 2.20 left of the sliding block, with two elements in the block."""
    return Path(shutil.copytree(RECORDED / "calculix", tmp_path / "calculix"))


def test_a_recorded_folder_of_calculix_gives_the_figures_of_its_run(calculix_folder):
    run = Calculix().read(calculix_folder)
    series = run["series"].to_dataset()
    assert run.attrs["status"] == "ok"
    assert run.attrs["code"] == "CalculiX 2.20, float64, CPU"
    assert run.attrs["steps"] == 936
    assert float(run["particles/block"]["mass"].sum()) == pytest.approx(180.0)
    moved = series["centre_of_mass"].sel(body="block", axis="x").values
    exact = 0.5 * 10.0 * (np.sin(np.pi / 6) - 0.3 * np.cos(np.pi / 6)) * series["time"].values ** 2
    assert (moved - moved[0])[-1] == pytest.approx(exact[-1], rel=0.05)
    assert series["contact_force"].sel(pair="block-plane", axis="y").values[2:] == pytest.approx(
        180.0 * 10.0 * np.cos(np.pi / 6), rel=0.05
    )


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


@pytest.mark.parametrize("file", ["scene.dat", "log.txt", "mesh.npz"])
@pytest.mark.parametrize("damage", ["missing", "cut short", "of another kind"])
def test_damaged_output_of_calculix_gives_one_line(calculix_folder, file, damage):
    path = calculix_folder / file
    content = path.read_bytes()
    short = content[: len(content) // 2 + 20]
    path.unlink() if damage == "missing" else path.write_bytes(short if damage == "cut short" else b"7 8")
    with pytest.raises(MpmfwError, match="CalculiX: its output is missing or damaged") as caught:
        Calculix().read(calculix_folder)
    assert len(str(caught.value).splitlines()) == 1


def test_the_input_of_calculix_joins_quadrilaterals(tmp_path):
    Calculix().prepare(load_scene("sliding-block", set={"grid.cell_size": 0.3}), tmp_path)
    lines = (tmp_path / "scene.inp").read_text().splitlines()
    front = int(lines[lines.index("*NSET, NSET=FRONT, GENERATE") + 1].split(",")[1])
    assert front == 3 * 2 + 15 * 2  # of elements of 0.3 m, and below of 0.27 m
    elements = [line for line in lines if line.count(",") == 8]
    assert len(elements) == 2 + 14
    surface = lines[lines.index("*SURFACE, NAME=Sblock, TYPE=ELEMENT") + 1 :][:6]
    assert sorted(surface) == ["1,S3", "1,S5", "1,S6", "2,S3", "2,S4", "2,S5"]
    assert "Eblock,GRAV,10,0.5,-0.866025403784,0." in lines  # of the motion
    assert "Eblock,GRAV,10,0,-1,0." in lines  # of the static step
    at = lines.index("*HYPERELASTIC, NEO HOOKE")
    assert [float(each) for each in lines[at + 1].split(",")] == pytest.approx([3e6, 2 / 12e6])


REFUSED_BY_CALCULIX = {
    "bodies.plane.rigid": (SLIP, {}),
    "grid": ("rolling-sphere-slip", {}),
    "bodies.block.particles.layout": ("sliding-block", {"bodies.block.particles.layout": "lattice"}),
    "materials.block.model": ("sliding-block", {"materials.block.model": "linear_elastic"}),
    "bodies.plane.sides": (
        "sliding-block",
        {"bodies.plane.sides": [{"side": "bottom", "fixed": True}, {"side": "top", "pressure": 1.0}]},
    ),
    "settle": ("sliding-block", {"bodies.plane.sides": []}),
}


@pytest.mark.parametrize("key", REFUSED_BY_CALCULIX)
def test_what_calculix_cannot_do_is_refused_by_its_key(key):
    name, changes = REFUSED_BY_CALCULIX[key]
    problems = Calculix().problems(load_scene(name, set=changes))
    assert key in [problem.key for problem in problems]
    assert all(problem.message.startswith("CalculiX: ") for problem in problems)


# -- input


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


REFUSED = {
    "bodies": ("rolling-cylinder-slip", {}),
    "contact.friction_law": (
        SLIP,
        {"contact.friction_law": "mohr_coulomb", "contact.mohr_coulomb.cohesion": 1.0},
    ),
    "gravity.table": (SLIP, {"gravity": {"table": [[0, 1, -9], [1, 2, -9]]}}),
    "loads": (SLIP, {"loads.wind": {"model": "drag", "rate": 1.0}}),
    "materials.soft.damping": (SLIP, {"materials.soft.damping": {"shear": 1e-3}}),
    "materials.soft.model": (SLIP, {"materials.soft.model": "j2", "materials.soft.yield_stress": 1e6}),
    "bodies.plane.rigid": (SLIP, {"bodies.plane.rigid": {"motion": {"velocity": [1.0, 0.0]}}}),
    "bodies.plane.geometry": (
        SLIP,
        {"bodies.plane.geometry": {"type": "disc", "centre": [4.0, -10.0], "radius": 10.8}},
    ),
}


@pytest.mark.parametrize("key", REFUSED)
def test_what_newton_cannot_do_is_refused_by_its_key(key, tmp_path):
    name, changes = REFUSED[key]
    scene = load_scene(name, set=changes)
    problems = Newton().problems(scene)
    assert key in [problem.key for problem in problems]
    with pytest.raises(SceneError, match="Newton: "):
        Newton().prepare(scene, tmp_path)
    assert not list(tmp_path.iterdir())


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
    with pytest.raises(SceneError, match="MPMFW_CODE_NEWTON=/no/such/python is no program"):
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


def test_names_of_codes_stand_for_plainest_and_best_settings(monkeypatch):
    monkeypatch.setattr(Newton, "identify", lambda self: None)  # noqa: ARG005
    labels = [
        code.label for code in codes_of(["newton", "newton(step=0.01)", "newton(collider_basis=pic27)"])
    ]
    assert labels == ["Newton", "Newton(collider_basis=pic27)", "Newton(step=0.01)"]
    with pytest.raises(SceneError, match="collider_basis"):
        codes_of(["newton(collider_basis=none)"])
    with pytest.raises(SceneError, match="did you mean 'newton'"):
        codes_of(["newtn"])


# -- processes


def test_a_process_is_stopped_at_its_limits(tmp_path):
    limits = ProcessLimits(seconds=0.5)
    with pytest.raises(MpmfwError, match=r"stopped after 0\.5 s"):
        run_process([sys.executable, "-c", "import time; time.sleep(60)"], tmp_path, tmp_path / "log", limits)
    hungry = [sys.executable, "-c", "import time; time.sleep(0.5); bytearray(10**9)"]
    with pytest.raises(MpmfwError, match="ended with status 1: MemoryError"):
        run_process(hungry, tmp_path, tmp_path / "log", ProcessLimits(memory=300_000_000))


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
    monkeypatch.setattr(Parabola, "script", "raise SystemExit('it must come from the store')")
    with pytest.warns(mpmfw.ResultsWarning):
        again = mpmfw.compare(SLIP, contact=["penalty"], shape=["linear"], code=[codes[0]], **sizes)
    assert again["status"].values.ravel().tolist() == ["ok", "ok"]


def test_a_code_refuses_keys_of_other_methods_and_scenes_that_it_cannot_run():
    class Still(Parabola):
        """It knows no gravity."""

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
