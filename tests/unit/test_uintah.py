"""Uintah's input, with the tags of its own specification, what is refused, and its output."""

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from command_line import called
from mpmfw.errors import MpmfwError, SceneError
from mpmfw.scene import load_scene
from mpmfw_code.uintah import Uintah

STOPPING = Path(__file__).resolve().parents[2] / "docs/arena/scenes/stopping-block.toml"

#: Tags within each other in UPS_SPEC of Uintah (src/StandAlone/inputs, commit d4508b23), those that are used.
KNOWN = """
Uintah_specification: Meta SimulationComponent Time DataArchiver MPM PhysicalConstants MaterialProperties Grid
Meta: title
Time: initTime maxTime delt_min delt_max timestep_multiplier end_at_max_time_exactly clamp_time_to_output
DataArchiver: filebase outputInterval save
MPM: time_integrator interpolator material contact
PhysicalConstants: gravity
MaterialProperties: MPM
material: density constitutive_model thermal_conductivity specific_heat geom_object
constitutive_model: bulk_modulus shear_modulus yield_stress hardening_modulus alpha
geom_object: box cylinder difference parallelepiped sphere res velocity temperature
box: min max
cylinder: bottom top radius
difference: cylinder
parallelepiped: p1 p2 p3 p4
sphere: origin radius
contact: type materials mu master_material filename
Grid: BoundaryConditions Level
BoundaryConditions: Face
Face: BCType
BCType: value
Level: Box
Box: lower upper resolution extraCells autoPatch
"""
TAGS = {name: set(inside.split()) for name, inside in (line.split(":") for line in KNOWN.strip().split("\n"))}


def exported(folder, scene, changes=None, **options):
    """Return the root of the input of a scene with keys changed, whose tags are known."""
    Uintah(**options).prepare(load_scene(scene, set=changes or {}), folder)
    root = ET.parse(folder / "scene.ups").getroot()
    for element in root.iter():
        assert {child.tag for child in element} <= TAGS.get(element.tag, set()), element.tag
    return root


def numbers(root, path):
    """Return the numbers in the text of an element."""
    return [float(one) for one in root.findtext(path).strip("[]").split(",")]


def test_the_rings_have_bodies_material_contact_grid_times_and_outputs(tmp_path):
    root = exported(tmp_path, "colliding-rings")
    left, right = root.findall("MaterialProperties/MPM/material")
    assert (left.get("name"), right.get("name")) == ("left", "right")
    for body, side in ((left, -1.0), (right, 1.0)):
        assert body.find("constitutive_model").get("type") == "comp_neo_hook"
        assert numbers(body, "density") == [1010]
        assert numbers(body, "constitutive_model/bulk_modulus") == pytest.approx([121.7e6])
        assert numbers(body, "constitutive_model/shear_modulus") == pytest.approx([26.1e6])
        outer, inner = body.findall("geom_object/difference/cylinder")
        assert numbers(outer, "bottom") == pytest.approx([0.042 * side, 0, 0])
        assert numbers(outer, "top") == pytest.approx([0.042 * side, 0, 0.002])
        assert numbers(outer, "radius") + numbers(inner, "radius") == pytest.approx([0.04, 0.03])
        assert numbers(body, "geom_object/velocity") == [-30 * side, 0, 0]
        assert numbers(body, "geom_object/res") == [4, 4, 1]
    contact = root.find("MaterialProperties/MPM/contact")
    assert contact.findtext("type") == "friction_LR"
    assert numbers(contact, "materials") == [0, 1]
    assert numbers(contact, "mu") == [0.1]
    box = root.find("Grid/Level/Box")
    assert numbers(box, "lower") == [-0.12, -0.08, 0]
    assert numbers(box, "upper") == [0.12, 0.08, 0.002]
    assert numbers(box, "resolution") == [120, 80, 1]
    assert numbers(root, "Time/maxTime") == pytest.approx([3.2e-3])
    assert numbers(root, "DataArchiver/outputInterval") == pytest.approx([1e-5])
    assert {"p.x", "p.velocity", "p.mass"} <= {one.get("label") for one in root.iter("save")}
    assert numbers(root, "PhysicalConstants/gravity") == [0, 0, 0]
    assert root.findtext("MPM/interpolator") == "gimp"


def test_the_block_has_gravity_friction_and_a_grid_that_ends_at_fixed_sides(tmp_path):
    root = exported(
        tmp_path, "sliding-block", {"settle": None}, contact="friction_bard", interpolator="linear"
    )
    block, plane = root.findall("MaterialProperties/MPM/material")
    assert numbers(block, "geom_object/box/min") == [0.03, 0.013, 0]
    assert numbers(plane, "geom_object/box/max") == [3.2, 0.013, 0.1]
    assert numbers(root, "PhysicalConstants/gravity") == pytest.approx([5, -10 * np.sqrt(0.75), 0])
    assert root.findtext("MaterialProperties/MPM/contact/type") == "friction_bard"
    assert numbers(root, "MaterialProperties/MPM/contact/mu") == [0.3]
    box = root.find("Grid/Level/Box")
    assert numbers(box, "lower") == [-0.4, -0.2, 0]
    assert numbers(box, "resolution") == [36, 12, 1]
    assert numbers(box, "extraCells") == [0, 0, 0]
    faces = {face.get("side"): face.find("BCType").get("label") for face in root.iter("Face")}
    assert faces == dict.fromkeys(("x-", "x+", "y-", "y+"), "Velocity") | dict.fromkeys(
        ("z-", "z+"), "Symmetric"
    )


def test_rigid_bodies_are_masters_and_plastic_ones_yield(tmp_path):
    root = exported(tmp_path, "footing")
    soil = root.find("MaterialProperties/MPM/material")
    assert soil.find("constitutive_model").get("type") == "comp_neo_hook_plastic"
    assert numbers(soil, "constitutive_model/yield_stress") == [17320.508]
    contact = root.find("MaterialProperties/MPM/contact")
    assert contact.findtext("type") == "specified_friction"
    assert numbers(contact, "master_material") == [1]
    rows = np.loadtxt(tmp_path / contact.findtext("filename"))
    np.testing.assert_allclose(rows, [[0, 0, 0, 0], [0.05, 0, -0.025, 0], [0.25, 0, -0.025, 0]])
    faces = {face.get("side"): face.find("BCType").get("label") for face in root.iter("Face")}
    assert (faces["x-"], faces["y-"]) == ("Symmetric", "Velocity")
    turned = {"bodies.plane.geometry.angle": 0.1, "title": 'a < b & "c"'}
    (tmp_path / "turned").mkdir()
    root = exported(tmp_path / "turned", STOPPING, turned)
    assert root.findtext("Meta/title") == turned["title"]
    p1, p2, p3, p4 = (numbers(root, f".//parallelepiped/p{k}") for k in (1, 2, 3, 4))
    along, across = np.subtract(p2, p1), np.subtract(p3, p1)
    np.testing.assert_allclose(along, [3.6 * np.cos(0.1), 3.6 * np.sin(0.1), 0], atol=1e-9)
    np.testing.assert_allclose(across, [-0.213 * np.sin(0.1), 0.213 * np.cos(0.1), 0], atol=1e-9)
    np.testing.assert_allclose(np.subtract(p4, p1), [0, 0, 0.1], atol=1e-12)


REFUSED = {
    "settle": ("sliding-block", {}),
    "materials.block.model": (STOPPING, {"materials.block.model": "linear_elastic"}),
    "materials.block.energy": (STOPPING, {"materials.block.energy": "log"}),
    "materials.clay.rate_factor": ("footing", {"materials.clay.rate_factor": 0.1}),
    "bodies.block.angular_velocity": (STOPPING, {"bodies.block.angular_velocity": 1.0}),
    "bodies.block.sides": ("sliding-block", {"bodies.block.sides": [{"side": "outer", "pressure": 1.0}]}),
    "bodies.plane.sides": ("sliding-block", {"bodies.block.geometry.lower": [-0.5, 0.013]}),
    "bodies.plane.geometry": (
        STOPPING,
        {"bodies.plane.geometry": {"type": "half_space", "point": [0, 0.013], "normal": [0, 1]}},
    ),
    "bodies.plane.rigid.motion": (
        STOPPING,
        {"bodies.plane.rigid": {"motion": {"surface_velocity": [1.0, 0.0]}}},
    ),
}


@pytest.mark.parametrize("key", REFUSED)
def test_what_is_not_written_is_refused_by_its_key(key, tmp_path):
    name, changes = REFUSED[key]
    with pytest.raises(SceneError, match=f"{key}: Uintah: "):
        Uintah().prepare(load_scene(name, set=changes), tmp_path)
    assert not list(tmp_path.iterdir())


def test_the_command_writes_a_folder_or_nothing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rings = "colliding-rings", "--to", "uintah"
    called("export", *rings, "--set", "time.end=1e-3")
    assert "<maxTime>0.001</maxTime>" in Path("colliding-rings-uintah/scene.ups").read_text()
    assert "exists" in called("export", *rings, status=2).output
    refused = called("export", "sliding-block", "--to", "uintah", status=2)
    assert "settle: Uintah: " in refused.output
    assert not Path("sliding-block-uintah").exists()
    run = called("compare", "colliding-rings", "--code", "uintah", status=2)
    assert "mpmfw export SCENE --to uintah" in run.output
    alone = called("export", "run.nc", "--set", "time.end=1", status=2)
    assert "no effect without --to" in alone.output
    for option in (["--every", "2"], ["--body", "left"], ["--force"]):
        idle = called("export", *rings, "-o", "new", *option, status=2)
        assert f"{option[0]}: has no effect with --to" in idle.output
        assert not Path("new").exists()


VARIABLE = """<Variable type="ParticleVariable"><variable>{}</variable><index>{}</index><patch>{}</patch>
<start>{}</start><numParticles>{}</numParticles><end>{}</end><filename>p{:05d}.data</filename></Variable>"""


def archived(folder, times, points, order="<"):
    """Write an archive of two patches; ``points(time, patch)`` has arrays by material and name."""
    steps = ""
    for number, time in enumerate(times, 1):
        steps += f'<timestep href="t{number:05d}/timestep.xml" time="{time}">{number}</timestep>'
        place = folder / f"scene.uda/t{number:05d}"
        (place / "l0").mkdir(parents=True)
        files = ""
        for patch in (0, 1):
            content, listed = b"", ""
            for (index, name), values in points(time, patch).items():
                start = len(content)
                content += values.astype(values.dtype.newbyteorder(order)).tobytes()
                listed += VARIABLE.format(name, index, patch, start, len(values), len(content), patch)
                content += bytes(-len(content) % 512)
            (place / f"l0/p{patch:05d}.data").write_bytes(content)
            (place / f"l0/p{patch:05d}.xml").write_text(f"<Uintah_Output>{listed}</Uintah_Output>")
            files += f'<Datafile href="l0/p{patch:05d}.xml" proc="{patch}"/>'
        endianness = {"<": "little_endian", ">": "big_endian"}[order]
        (place / "timestep.xml").write_text(
            f"<Uintah_timestep><Meta><endianness>{endianness}</endianness></Meta><Data>{files}</Data></Uintah_timestep>"
        )
    (folder / "scene.uda/index.xml").write_text(
        f"<Uintah_DataArchive><timesteps>{steps}</timesteps></Uintah_DataArchive>"
    )


def sliding(time, patch):
    """A block of four points that move at 1 m/s and change their patch; the plane, material 1, has two."""
    ids = np.array([3, 0, 2, 1] if time > 0.1 else [0, 1, 2, 3])
    own = ids[:1] if patch else ids[1:]
    place = np.column_stack([0.1 * own + time, 0.2 * own, np.full(own.size, 0.05)])
    block = {"p.stress": np.zeros((own.size, 9)), "p.particleID": own, "p.x": place}
    block |= {"p.velocity": np.tile([1.0, 0.0, 0.0], (own.size, 1)), "p.mass": 0.1 * (1.0 + own)}
    plane = {"p.x": np.zeros((1, 3)), "p.particleID": np.array([patch])}
    return {(0, name): values for name, values in block.items()} | {
        (1, name): one for name, one in plane.items()
    }


def stopping(folder, times=(0.01, 0.15, 0.21), points=sliding, order="<"):
    """Write the input of the stopping block, with outputs at 0.1 and 0.2 s, and an archive."""
    exported(folder, STOPPING, {"time.end": 0.2, "time.output_interval": 0.1})
    archived(folder, times, points, order)


@pytest.mark.parametrize("order", ["<", ">"])
def test_an_archive_gives_the_motion_of_its_points_per_metre_of_thickness(tmp_path, order):
    stopping(tmp_path, order=order)
    run = Uintah().read(tmp_path)
    series = run["series"].to_dataset().sel(body="block")
    np.testing.assert_allclose(series["time"], [0.0, 0.1, 0.2])
    mean = np.arange(4) @ (1.0 + np.arange(4)) / 10.0
    np.testing.assert_allclose(series["centre_of_mass"].sel(axis="x"), 0.1 * mean + np.array([0.0, 0.1, 0.2]))
    np.testing.assert_allclose(series["centre_of_mass"].sel(axis="y"), 0.2 * mean)
    np.testing.assert_allclose(series["kinetic_energy"], 0.5 * 1.0 / 0.1)  # cells are 0.1 m deep
    assert run.attrs["status"].startswith("suspect: its output does not name its version")
    assert run.attrs["steps"] == 3
    assert np.isnan(run.attrs["cpu_time"])


@pytest.mark.parametrize(
    ("old", "new"), [("t00002/", "../t00002/"), ("</timesteps>", ""), ('time="0.15"', 'time="soon"')]
)
def test_a_damaged_archive_gives_one_line(tmp_path, old, new):
    stopping(tmp_path)
    index = tmp_path / "scene.uda/index.xml"
    index.write_text(index.read_text().replace(old, new))
    with pytest.raises(MpmfwError, match=r"^Uintah: its output is missing or damaged"):
        Uintah().read(tmp_path)


def test_an_archive_may_hold_the_start(tmp_path):
    stopping(tmp_path, [0.0, 0.1, 0.2])
    series = Uintah().read(tmp_path)["series"].to_dataset().sel(body="block", axis="x")
    np.testing.assert_allclose(np.diff(series["centre_of_mass"]), 0.1)


def losing(time, patch):
    """The sliding block, of which a point leaves."""
    found = sliding(time, patch)
    if time > 0.1 and patch:
        found = {key: values[:0] if key[0] == 0 else values for key, values in found.items()}
    return found


def without(name):
    """Return the sliding block without a variable."""
    return lambda time, patch: {
        key: values for key, values in sliding(time, patch).items() if key != (0, name)
    }


@pytest.mark.parametrize(
    ("points", "said"),
    [
        (losing, "p.particleID of material 0 changes: points have left or come"),
        (without("p.mass"), "p.mass of material 0 is absent"),
        (without("p.particleID"), "of material 0 has not as many points as p.particleID"),
    ],
    ids=["points leave", "no mass", "no IDs"],
)
def test_points_that_leave_or_lack_a_variable_are_named(tmp_path, points, said):
    stopping(tmp_path, points=points)
    with pytest.raises(MpmfwError, match=said):
        Uintah().read(tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("</Variable>", "<compression>gzip</compression></Variable>", "is compressed"),
        ("<start>", "<start>-", "p00000.data: expected a file .* with bytes -"),
        ("</end>", "0000000000000000</end>", "p00000.data: expected a file"),
        ("p00000.data", ".", "l0: expected a file"),
    ],
    ids=["compressed", "before the start", "past the end", "a folder"],
)
def test_a_range_that_a_file_does_not_have_is_refused(tmp_path, old, new, said):
    stopping(tmp_path)
    listed = tmp_path / "scene.uda/t00002/l0/p00000.xml"
    listed.write_text(listed.read_text().replace(old, new))
    with pytest.raises(MpmfwError, match=said):
        Uintah().read(tmp_path)


def test_times_that_go_back_are_refused(tmp_path):
    stopping(tmp_path, [0.15, 0.01, 0.21])
    with pytest.raises(MpmfwError, match="expected timesteps in the order of time"):
        Uintah().read(tmp_path)
