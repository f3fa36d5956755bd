"""A method and its options in one text, wherever a method is named."""

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from contact_scenes import STRATEGIES, impact
from mpmfw.api import PlugIn
from mpmfw.campaigns.comparison import compare
from mpmfw.cli import app
from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import load
from mpmfw.runs.identity import key_of
from mpmfw.runs.run import run
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.scene.specification import (
    Specification,
    checked_specification,
    parse_specification,
    split_specifications,
)
from mpmfw.stability.request import check_overrides
from mpmfw.studies.grid import make_grid
from mpmfw.studies.loading import load_study
from mpmfw_testing import subject_of

SCENE = "rolling-cylinder-slip"
STRONG = "bardenhagen(criterion=position, normal=master)"


@pytest.mark.parametrize(
    ("text", "name", "options", "written"),
    [
        ("none", "none", {}, "none"),
        (" none() ", "none", {}, "none"),
        ("a(c=x,b=2)", "a", {"b": 2, "c": "x"}, "a(b=2, c=x)"),
        ("a(b=true, c=[1.0, 2])", "a", {"b": True, "c": [1.0, 2]}, "a(b=true, c=[1.0, 2])"),
        ('a(b="2", c="x, y", d=2 '
         'mm)', "a", {"b": "2", "c": "x, y", "d": "2 mm"}, 'a(b="2", c="x, y", d=2 mm)'),
        ("a(b=-1e-3)", "a", {"b": -1e-3}, "a(b=-0.001)"),
        ("module.of:Law(b=1)", "module.of:Law", {"b": 1}, "module.of:Law(b=1)"),
    ],
)  # fmt: skip
def test_a_text_is_read_and_written(text, name, options, written):
    said = parse_specification(text)
    assert (said.name, said.options, str(said)) == (name, options, written)
    assert parse_specification(written) == said


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected NAME or NAME(option=value, …)"),
        ("a b", "expected NAME or NAME(option=value, …)"),
        ("a(b=1", "is not closed"),
        ("a(b=1) c", "expected NAME or NAME(option=value, …)"),
        ("a(b)", "'b' is no option=value"),
        ("a(b=)", "'b=' is no option=value"),
        ("a(b=1,)", "'' is no option=value"),
        ("a(b=1, b=2)", "option 'b' is given twice"),
        ("a(b=[1)", "')' closes nothing"),
        ("a(b=(1)", "is not closed"),
        ("a(b='1)", "is not closed"),
    ],
)
def test_a_text_of_another_form_is_refused(text, message):
    with pytest.raises(SceneError) as error:
        [parse_specification(part) for part in split_specifications(text) or [text]]
    assert message in str(error.value)
    assert str(error.value).startswith(f"{text}: ")


def test_commas_in_brackets_and_quotes_do_not_separate():
    text = "none, a(b=1, c=[1, 2]),b(x='1,2', y=\"(\")"
    assert split_specifications(text) == ["none", "a(b=1, c=[1, 2])", "b(x='1,2', y=\"(\")"]
    with pytest.raises(SceneError, match="closes nothing"):
        split_specifications("a),b")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("bardenhagn(normal=master)", "no such contact plug-in; did you mean 'bardenhagen'?"),
        ("bardenhagen(critrion=position)", "critrion: unknown key; did you mean 'criterion'?"),
        ("bardenhagen(normal=mastr)", "normal: 'mastr' is unknown; did you mean 'master'? (one of averaged, master, specified)"),  # noqa: E501
        ("bardenhagen(cut_off=-1)", "cut_off: must be greater than 0, not -1; expected a number"),
        ("none(a=1)", "a: unknown key; no key is valid here"),
    ],
)  # fmt: skip
def test_one_message_says_what_was_expected(text, message):
    with pytest.raises(SceneError) as error:
        checked_specification("contact", text)
    assert str(error.value) == f"{text}: {message}" or str(error.value).startswith(
        f"{text}: {message} (one of "
    )


OBJECTS = [
    *((name, given) for name, given in STRATEGIES.values()),
    ("hamad2017", {"friction_law": "literal", "kappa": 2.0}),
    ("penalty", {"interface_thickness": 1e-3, "map": "plain"}),
    ("gimp", {}),
]


@pytest.mark.parametrize(("name", "options"), OBJECTS)
def test_a_label_names_the_method_that_has_it(name, options):
    kind = "shape" if name == "gimp" else "contact"
    made = load(kind, name)(**options)
    read = checked_specification(kind, made.label)
    again = load(kind, name)(**read.options)
    assert (again.label, again.options) == (made.label, made.options)
    assert made.label == str(read)


def test_labels_of_every_kind_of_value_are_read_again():
    from pydantic import BaseModel

    class Options(BaseModel):
        flag: bool = False
        vector: tuple[float, ...] | None = None
        word: str = ""

    class Plug(PlugIn):
        name = "plug"

    Plug.Options = Options
    made = Plug(flag=True, vector=(1.0, 0.5), word="a, b")
    assert made.label == 'plug(flag=true, vector=[1.0, 0.5], word="a, b")'
    assert Plug(**parse_specification(made.label).options).options == made.options
    assert Plug(vector=None).label == "plug"


def test_a_scene_takes_it_for_the_name_and_the_options_of_its_table():
    told = load_scene(SCENE, set={"contact.method": STRONG})
    tabled = load_scene(
        SCENE,
        set={
            "contact.method": "bardenhagen",
            "contact.bardenhagen.normal": "master",
            "contact.bardenhagen.criterion": "position",
        },
    )
    assert told.contact == tabled.contact
    assert told.to_mapping() == tabled.to_mapping()
    assert key_of(told) == key_of(tabled)
    assert load_scene_text(told.text).contact == told.contact  # what results keep runs again
    assert "contact.method was set to" in told.text


def load_scene_text(text):
    """A scene from its text."""
    import tomllib

    return load_scene(tomllib.loads(text))


def test_options_are_set_over_the_scene_s_own_and_the_last_choice_of_a_method_holds():
    rings = load_scene("colliding-rings", set={"contact.method": "penalty(damping=0.1)"})
    assert (rings.contact.options.kappa, rings.contact.options.damping) == (0.25, 0.1)
    assert (
        load_scene("colliding-rings", set={"contact.method": "penalty(kappa=2)"}).contact.options.kappa == 2.0
    )
    strong = load_scene(SCENE, set={"contact.method": STRONG})
    plain = strong.with_overrides({"contact.method": "bardenhagen"})
    assert plain.contact.options.criterion == "velocity"
    shape = load_scene(SCENE, set={"shape.method": "gimp()"})
    assert shape.shape.method == "gimp"


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"contact.method": "bardenhagen(normal=mastr)"}, "--set contact.method: contact.bardenhagen.normal: 'mastr' is unknown"),  # noqa: E501
        ({"contact.method": "bardenhagen(cut_off=0.5)"}, "--set contact.method: contact.bardenhagen: 'cut_off' has no effect"),  # noqa: E501
        ({"contact.method": "bardenhagn(normal=master)"}, "--set contact.method: no such contact plug-in: 'bardenhagn'"),  # noqa: E501
        ({"contact.method": "bardenhagen(normal)"}, "--set contact.method: bardenhagen(normal): 'normal' is no option=value"),  # noqa: E501
        ({"contact.method": STRONG, "contact.bardenhagen.normal": "master"},
         f"--set contact.bardenhagen.normal: contact.method = '{STRONG}' sets it too; leave one of them out"),
        ({"contact.method": STRONG, "contact.bardenhagen": {"criterion": "position"}}, "sets it too"),
    ],
)  # fmt: skip
def test_a_scene_says_what_is_wrong_with_it_once(overrides, message):
    with pytest.raises(SceneError) as error:
        load_scene(SCENE, set=overrides)
    assert message in str(error.value)
    assert len(str(error.value).splitlines()) == 1


def test_a_scene_s_table_names_the_method_alone():
    mapping = impact()
    mapping["contact"]["method"] = STRONG
    with pytest.raises(
        SceneError,
        match=r"contact\.method: expected the name alone, 'bardenhagen', and its options in the table \[",
    ):
        load_scene(mapping)


def test_a_run_with_it_is_the_run_of_the_object():
    strong = load("contact", "bardenhagen")(criterion="position", normal="master")
    results = []
    for contact in (STRONG, strong):
        sim = Simulation(impact(), contact=contact)
        sim.advance(40)
        results.append((sim.contact.label, sim.contact.records.impulse.tobytes()))
    assert results[0] == results[1]
    assert results[0][0] == STRONG


def test_a_comparison_labels_and_runs_it():
    mapping = impact(slide=0.0, time={"end": 2e-3, "output_interval": 1e-3}, output={"gap": False})
    chosen = ["bardenhagen", "bardenhagen(normal=master,criterion=position)", "bardenhagen(cut_off=0.5)"]
    data = compare(mapping, chosen, ["linear"], repeats=1)
    assert data["contact"].values.tolist() == ["bardenhagen", STRONG, "bardenhagen(cut_off=0.5)"]
    assert data["status"].values.ravel().tolist()[:2] == ["ok", "ok"]
    assert (
        data["status"]
        .values.ravel()[2]
        .startswith("refused: contact bardenhagen(cut_off=0.5): contact.bardenhagen: 'cut_off' has no effect")
    )


@pytest.mark.parametrize(
    ("contact", "shared", "message"),
    [
        ([STRONG, "bardenhagen(normal=master, criterion=position)"], {}, r"is given twice"),
        (
            ["none", "bardenhagen(normal=mastr)"],
            {},
            r"contact bardenhagen\(normal=mastr\): normal: 'mastr' is unknown",
        ),
        (["none", STRONG], {"contact.penalty.kappa": 2}, "what runs is none, bardenhagen"),
    ],
)
def test_a_comparison_refuses_before_it_runs(contact, shared, message, monkeypatch):
    monkeypatch.setattr("mpmfw.campaigns.work.run", lambda *_, **__: pytest.fail("ran"))
    with pytest.raises(SceneError, match=message):
        compare(SCENE, contact, ["cpdi"], set=shared)


STUDY = """\
scene = "sliding-block"

[vary]
contact = ["bardenhagen", "bardenhagen(normal=master,criterion=position)"]
cell_size = [0.2]

[error]
quantity = "acceleration"
"""


def test_a_study_varies_it(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(STUDY)
    grid = make_grid(load_study(path))
    assert grid.coords["contact"] == ["bardenhagen", STRONG]
    assert grid.combinations[1, 0].scene.contact.options.normal == "master"
    for old, new, message in (
        ("normal=master", "normal=mastr", "contact.bardenhagen.normal: 'mastr' is unknown; did you mean "
                                          "'master'?"),
        ('"bardenhagen",', f'"{STRONG}",', f":4: vary.contact[1]: {STRONG} is given twice"),
        (",criterion=position)", "", "expected NAME or NAME(option=value, …)"),
    ):  # fmt: skip
        path.write_text(STUDY.replace(old, new))
        with pytest.raises(SceneError) as error:
            make_grid(load_study(path))
        assert message in str(error.value)
        assert str(error.value).startswith(f"{path}:4:")
        assert len(str(error.value).splitlines()) == 1


def test_a_map_of_stability_refuses_what_it_varies_itself():
    scene = load_scene(SCENE, set={"contact.method": "penalty(kappa=2)"})
    with pytest.raises(
        SceneError, match=r"contact\.method: has no effect on a map of stability: it varies kappa"
    ):
        check_overrides(scene, "kappa")


def test_the_conformance_kit_takes_it():
    subject = subject_of(STRONG, "contact")
    assert (subject.label, subject.make().options.normal) == (STRONG, "master")
    with pytest.raises(SceneError, match="the option 'normal' is given beside it as well"):
        subject_of(STRONG, "contact", {"normal": "averaged"})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", SCENE, "--contact", "bardenhagen(normal=mastr)"],
         "--contact bardenhagen(normal=mastr): normal: 'mastr' is unknown; did you mean 'master'?"),
        (["explain", SCENE, "--contact", "bardenhagen(cut_off=0.5)"],
         "--contact bardenhagen(cut_off=0.5): contact.bardenhagen: 'cut_off' has no effect"),
        (["compare", SCENE, "--contact", "none,bardenhagen(critrion=position)"],
         "--contact bardenhagen(critrion=position): critrion: unknown key; did you mean 'criterion'?"),
        (["compare", SCENE, "--contact", "none,bardenhagen(normal=master"],
         "--contact none,bardenhagen(normal=master: ( is not closed"),
        (["compare", SCENE, "--contact", "penalty(kappa=1),penalty( kappa = 1 )"], "a name is given twice"),
        (["stability", SCENE, "--contact", "penalty(kappa=2)"], "--set contact.method: has no effect on a map of stability"),  # noqa: E501
        (["check", "bardenhagen(normal=mastr)"], "bardenhagen: normal: "),
    ],
)  # fmt: skip
def test_the_command_line_refuses_in_its_own_words(arguments, message):
    result = CliRunner().invoke(app, arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in result.stderr
    assert result.stderr.count("\n") == 1


def test_the_command_line_runs_it(monkeypatch):
    import sys

    seen = {}
    stand_in = SimpleNamespace(run_to_file=lambda scene, **_: seen.update(scene=scene))
    monkeypatch.setitem(sys.modules, "mpmfw.runs.run", stand_in)
    result = CliRunner().invoke(app, ["run", SCENE, "--contact", STRONG, "-o", "unused.nc"])
    assert result.exit_code == 0, result.stderr
    assert seen["scene"].contact.options.criterion == "position"


def test_the_results_say_it():
    tree = run(impact(time={"end": 1e-3, "output_interval": 1e-3}), contact=STRONG)
    assert tree.attrs["contact"] == STRONG
    assert json.loads(tree.attrs["effects"])


def test_a_specification_is_a_value():
    assert Specification("a", {"b": 1}) == parse_specification("a(b=1)")
