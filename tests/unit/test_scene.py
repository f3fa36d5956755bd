"""Scenes: what is valid, what is refused, and in which words."""

import pickle
import tomllib

import pytest
from pydantic import ValidationError

from mpmfw.errors import SceneError
from mpmfw.scene import load_scene, located

TEXT = """\
title = "two blocks"

[grid]
cell_size = 0.5
lower = [0, 0]
upper = [10, 5]

[time]
end = 1
output_interval = "10 ms"

[shape]
method = "linear"

[contact]
method = "none"
friction = 0.2

[[contact.pairs]]
bodies = ["block", "floor"]
friction = 0.3

[materials.steel]
model = "neo_hookean"
density = 7850
bulk_modulus = "160 GPa"
shear_modulus = "80 GPa"

[bodies.block]
material = "steel"
geometry = { type = "disc", centre = [5, 2], radius = 1 }
particles = { layout = "lattice", size = 0.25 }
velocity = [1, 0]

[bodies.floor]
material = "steel"
geometry = { type = "rectangle", lower = [0, 0], upper = [10, 1] }
particles = { size = "250 mm" }
segment = 0.2

[[bodies.floor.sides]]
side = "bottom"
fixed = true

[gravity]
magnitude = 10
tilt = "30 deg"
"""


@pytest.fixture
def scene_file(tmp_path, monkeypatch):
    """Write the scene with replacements to ``s.toml`` in the working folder and return that name."""
    monkeypatch.chdir(tmp_path)

    def write(*replacements):
        text = TEXT
        for old, new in replacements:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "s.toml").write_text(text)
        return "s.toml"

    return write


def refusal(scene, **overrides):
    with pytest.raises(SceneError) as caught:
        load_scene(scene, **overrides)
    return str(caught.value)


def test_a_valid_scene_holds_si_values_and_its_source(scene_file):
    scene = load_scene(scene_file())
    assert scene.time.output_interval == pytest.approx(0.01)
    assert scene.materials["steel"].options.bulk_modulus == pytest.approx(160e9)
    assert scene.gravity.at(0.0) == pytest.approx((5.0, -8.660254037844386))
    assert scene.pairs == (("block", "floor", 0.3),)
    assert scene.bodies["block"].segment_length(scene.grid.cell_size) == 0.125
    assert scene.bodies["floor"].segment_length(scene.grid.cell_size) == 0.2
    assert (scene.dim, scene.name, scene.text, scene.source.name) == (2, "s", TEXT, "s.toml")
    assert scene.to_mapping() == tomllib.loads(TEXT)


def test_a_scene_does_not_change():
    mapping = tomllib.loads(TEXT)
    scene = load_scene(mapping)
    with pytest.raises(ValidationError, match="frozen"):
        scene.grid.cell_size = 1.0
    mapping["grid"]["cell_size"] = 99
    scene.to_mapping()["grid"]["cell_size"] = 99
    assert scene.to_mapping()["grid"]["cell_size"] == 0.5


def test_scenes_travel_between_processes():
    scene = load_scene(tomllib.loads(TEXT))
    again = pickle.loads(pickle.dumps(scene))
    assert again == scene
    assert again.text == scene.text
    assert again.materials["steel"].options == scene.materials["steel"].options


@pytest.mark.parametrize("cell", [0.4, 0.2])
def test_lengths_in_cells_follow_the_cell_size(cell):
    scene = load_scene("rolling-cylinder-slip", set={"grid.cell_size": cell})
    for body in scene.bodies.values():
        assert body.particles.size == pytest.approx(0.5 * cell, rel=1e-15)
        assert body.segment == pytest.approx(0.25 * cell, rel=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "place", "said"),
    [
        ("radius = 1", "raduis = 1", "31: bodies.block.geometry.raduis", "did you mean 'radius'?"),
        ("cell_size = 0.5", "cell_size = '2 s'", "4: grid.cell_size", "'2 s' is not convertible to m"),
        ("cell_size = 0.5", "cell_size = -1", "4: grid.cell_size", "must be greater than 0, not -1"),
        ("cell_size = 0.5", "cell_size = 5e-324", "4: grid.cell_size", "5e-324 is out of range"),
        ("lower = [0, 0]\nupper", "lower = [0, 'b']\nupper", "5: grid.lower[1]", "'b' is not a quantity"),
        ("segment = 0.2", 'segment = "0.5 cels"', "39: bodies.floor.segment", "cels"),
        ("segment = 0.2", 'segment = "-1 cells"', "39: bodies.floor.segment", "is not a quantity"),
        ("end = 1\n", "", "8: time.end", "missing; expected a time in s"),
        ('output_interval = "10 ms"', "output_interval = 2", "10: time.output_interval", "time.end, which is 1 s"),  # noqa: E501
        ("end = 1\n", "end = 1\nstep = 1e-5\nsafety = 0.4\n", "11: time.safety", "has no effect with a fixed"),  # noqa: E501
        ('method = "linear"', 'method = "liner"', "13: shape.method", "did you mean 'linear'?"),
        ('method = "linear"', 'method = "lin\\u0000ear"', "13: shape.method", "has the character NUL"),
        ("[shape]", '[stepping]\ntransfer = "apic"\npic_fraction = 0.1\n[shape]', "14: stepping.pic_fraction",
         "has no effect with transfer apic"),
        ("friction = 0.2", "[contact.penlty]\nstiffness = 1", "17: contact.penlty", "did you mean 'penalty'?"),  # noqa: E501
        ('"block", "floor"', '"block", "flor"', "20: contact.pairs[0].bodies[1]", "did you mean 'floor'?"),
        ('"block", "floor"', '"block", "block"', "20: contact.pairs[0].bodies", "not 'block' twice"),
        ('"160 GPa"', '"160 m"', "26: materials.steel.bulk_modulus", "'160 m' is not convertible to Pa"),
        ('material = "steel"\ngeometry = { type = "disc"', 'material = "stel"\ngeometry = { type = "disc"',
         "30: bodies.block.material", "did you mean 'steel'?"),
        ('type = "disc"', 'type = "disk"', "31: bodies.block.geometry.type", "did you mean 'disc'?"),
        ("velocity = [1, 0]", "velocity = [1, 0, 0]", "33: bodies.block.velocity", "because the grid is 2D"),
        ("fixed = true", "pressure = 1\nfixed = true", "41: bodies.floor.sides[0]", "has fixed and pressure"),
        ("fixed = true", "pressure = [[0, 0], [1, [2]]]", "43: bodies.floor.sides[0].pressure[1][1]", "modulus in Pa"),  # noqa: E501
        ("magnitude = 10", "vector = [0, -10]", "45: gravity", "has tilt and vector; expected exactly one of"),  # noqa: E501
        ("[grid]", f"a = {40 * '['}{40 * ']'}\n[grid]", "3: a[0][0]", "nested more than 32 tables and arrays"),  # noqa: E501
        ("[gravity]", "[gravity", "45", "not valid TOML"),
    ],
)  # fmt: skip
def test_one_problem_is_one_message(scene_file, old, new, place, said):
    message = refusal(scene_file((old, new)))
    assert message.startswith(f"s.toml:{place}: ")
    assert said in message
    assert "\n" not in message


def test_all_problems_are_listed_in_the_file_s_order(scene_file):
    path = scene_file(("radius = 1", "raduis = 1"), ("end = 1", "end = -1"), ('"linear"', '"liner"'))
    lines = refusal(path, set={"grid.cel_size": "2"}).splitlines()
    starts = [
        "s.toml:9: time.end",
        "s.toml:13: shape.method",
        "s.toml:31: bodies.block",
        "--set grid.cel_size: unknown",
    ]
    assert [line.startswith(start) for line, start in zip(lines, starts, strict=True)] == [True] * 4


@pytest.mark.parametrize(
    ("key", "place"),
    [
        ("bodies.block", "s.toml:29: "),
        ("bodies.block.rotation", "s.toml:29: "),
        ("shape.method", "s.toml:13: "),
        ("time.step", "--set "),
    ],
)
def test_an_error_that_is_found_later_says_where_its_key_was_written(scene_file, key, place):
    scene = load_scene(scene_file(), set={"time.step": 1e-3})
    error = located(SceneError("wrong", key=key), scene)
    assert str(error) == str(located(error, scene)) == f"{place}{key}: wrong"
    assert str(located(SceneError("wrong", key=key), load_scene(scene.to_mapping()))) == f"{key}: wrong"


def test_more_than_one_body_needs_a_contact_method():
    mapping = tomllib.loads(TEXT)
    del mapping["contact"]
    assert refusal(mapping).startswith("contact: missing: name a method for more than one body")
    del mapping["bodies"]["floor"]
    assert load_scene(mapping).contact is None


def test_alternatives_are_not_validated_but_the_chosen_one_is(scene_file):
    path = scene_file(("friction = 0.2", "friction = 0.2\n[contact.penalty]\nno_such_option = 1"))
    assert load_scene(path).contact.method == "none"
    assert "contact.penalty.no_such_option: unknown key" in refusal(path, set={"contact.method": "penalty"})


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("grid.cell_size", "2 s", "--set grid.cell_size: '2 s' is not convertible to m"),
        ("bodies.blok.velocity", "[1, 1]", "--set bodies.blok.velocity: bodies.blok: no such name; did you"),
        ("contact.pairs[3].friction", "0.1", "--set contact.pairs[3].friction: contact.pairs has 1 entries"),
        ("grid..x", "1", "--set grid..x: 'grid..x' is not a key"),
        ("settle.tolerence", "1", "--set settle.tolerence: unknown key; did you mean 'tolerance'?"),
        ("grid.cell_size", 0, "--set grid.cell_size: must be greater than 0"),
        ("grid.cell_size", True, "--set grid.cell_size: true is a boolean"),
    ],
)
def test_a_wrong_override_names_its_key(scene_file, key, value, message):
    said = refusal(scene_file(), set={key: value})
    assert said.startswith(message)
    assert "\n" not in said


def test_overrides_are_toml_values_or_text(scene_file):
    values = {
        "grid.cell_size": "250 mm",
        "contact.pairs[0].friction": "0.1",
        "bodies.block.velocity": "[2, 0]",
    }
    scene = load_scene(scene_file(), set=values)
    assert scene.grid.cell_size == pytest.approx(0.25)
    assert scene.pairs == (("block", "floor", 0.1),)
    assert scene.bodies["block"].velocity == (2.0, 0.0)
    again = scene.with_overrides({"time.end": 2.0})
    assert (again.grid.cell_size, again.time.end, scene.time.end) == (0.25, 2.0, 1.0)


def test_the_text_of_an_overridden_scene_is_that_scene(scene_file):
    scene = load_scene(scene_file(), set={"grid.cell_size": 0.25, "title": 'a "quoted" title'})
    assert load_scene(tomllib.loads(scene.text)).to_mapping() == scene.to_mapping()


def test_gravity_in_time_is_linear_between_rows_and_constant_outside():
    mapping = tomllib.loads(TEXT)
    mapping["gravity"] = {"table": [[0.0, 0.0, 0.0], ["1 s", 0.0, -10.0]]}
    gravity = load_scene(mapping).gravity
    assert [gravity.at(t)[1] for t in (-1.0, 0.5, 2.0)] == [0.0, -5.0, -10.0]
    mapping["gravity"]["table"].append([0.5, 0, 0])
    assert refusal(mapping).startswith("gravity.table[2]: times must increase")
