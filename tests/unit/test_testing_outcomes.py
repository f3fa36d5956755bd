"""What comes of a check: outcomes, pictures, justified failures, and the same as pytest tests."""

import runpy
import sys

import pytest

import mpmfw
from command_line import called
from mpmfw.errors import SceneError
from mpmfw_testing import (
    Check,
    Inapplicable,
    Violation,
    checks_of,
    contact_conformance,
    examine,
    ladder,
    search,
    subject_of,
)

SUBJECT = subject_of("separate", "contact")


def failing(_subject):
    def trial(a, b):
        if a + b > 0.75:
            raise Violation(
                "too much", {"sum": a + b}, lambda axes: axes.plot([0, a], [0, b]), measured=a + b, bound=0.75
            )

    search({"a": ladder(0.0, 1.0, 5), "b": ladder(0.0, 1.0, 5)}, trial, examples=30, names={"a": "a [m]"})


def not_asked(_subject):
    raise Inapplicable("there is nothing to ask")


GOOD = Check("good", "All is well.", lambda _subject: None)
BAD = Check("bad", "The sum is small.", failing)
ASKED = Check("asked", "Something.", not_asked)
WHY = "the sum of two numbers may be large"


def test_outcomes_and_their_pictures(tmp_path):
    good, bad, asked = examine(SUBJECT, [GOOD, BAD, ASKED], pictures=tmp_path / "new")
    assert (good.status, bad.status, asked.status) == ("passed", "failed", "not applicable")
    assert [each.wrong for each in (good, bad, asked)] == [False, True, False]
    assert bad.picture == tmp_path / "new" / "separate-bad.png"
    assert bad.picture.stat().st_size > 1000
    for part in (
        "The sum is small.",
        "too much",
        "measured 1, bound 0.75",
        "a [m] = 0",
        "b = 1",
        str(bad.picture),
    ):
        assert part in bad.report
    assert asked.message == "there is nothing to ask"


def test_the_counterexample_is_the_smallest_and_the_same_in_every_run():
    for _ in range(2):
        with pytest.raises(Violation) as found:
            failing(SUBJECT)
        assert found.value.counterexample == {"a [m]": 0.0, "b": 1.0, "sum": 1.0}
        assert (found.value.measured, found.value.bound) == (1.0, 0.75)


def test_expected_failures_must_fail():
    good, bad, asked = examine(SUBJECT, [GOOD, BAD, ASKED], dict.fromkeys(("good", "bad", "asked"), WHY))
    assert (good.status, bad.status, asked.status) == (
        "unexpectedly passed",
        "expected failure",
        "unexpectedly passed",
    )
    assert good.wrong
    assert not bad.wrong
    assert asked.wrong
    assert "take it off the list" in good.message
    assert bad.justification == WHY


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"bad": ""}, "must be justified"),
        ({"bad": "it just does"}, "20 characters"),
        ({"bda": WHY}, "no such check 'bda'; did you mean 'bad'"),
    ],
)
def test_expected_failures_must_be_justified_and_known(table, said):
    with pytest.raises(SceneError, match=said):
        examine(SUBJECT, [GOOD, BAD], table)


def test_the_decorator_parametrises_over_all_checks():
    mark = contact_conformance("separate").mark
    assert mark.name == "parametrize"
    assert list(mark.kwargs["ids"]) == [check.name for check in checks_of("contact")]
    assert len(mark.args[1]) == len(checks_of("contact"))
    with pytest.raises(SceneError, match="did you mean 'energy'"):
        contact_conformance("separate", expected_failures={"enrgy": WHY})
    with pytest.raises(SceneError, match="did you mean 'energy'"):
        contact_conformance("separate", only=["enrgy"])


def test_an_error_says_file_and_line_of_the_strangers_code_and_one_cause_is_told_once(tmp_path):
    file = tmp_path / "my_law.py"
    file.write_text("def add_nodal_force():\n    x = 1\n    return x.force\n")
    scope = {}
    exec(compile(file.read_text(), str(file), "exec"), scope)
    fails = scope["add_nodal_force"]
    checks = [Check(name, "It works.", lambda _subject: fails()) for name in ("runs", "second", "third")]
    searched = Check(
        "searched", "Also.", lambda _subject: search({"_": ladder(0.0, 1.0, 3)}, lambda _: fails())
    )
    first, *others = examine(SUBJECT, [*checks, searched, BAD])
    assert f'File "{file}", line 3, in add_nodal_force' in first.report
    assert "return x.force" in first.report
    assert [one.same_as for one in others] == ["runs", "runs", "runs", ""]
    assert others[0].report == "second: failed, as runs"
    assert all(len(one.report.splitlines()) == 1 for one in others[:3])


def test_a_counterexample_is_saved_as_a_scene_and_a_program_that_runs_it(tmp_path, capsys):
    """The program is run, as whoever gets the two files would."""
    from faulty_plugins.load.faults import EachPoint

    check = next(each for each in checks_of("load") if each.name == "refinement")
    (outcome,) = examine(subject_of(EachPoint, "load"), [check], folder=tmp_path)
    scene, program = outcome.saved
    assert f"scene: {scene}" in outcome.report
    assert f"run it: python {program}" in outcome.report
    mpmfw.load_scene(scene)
    assert outcome.message.split("\n")[0] in scene.read_text(encoding="utf-8")
    runpy.run_path(str(program), run_name="__main__")
    assert capsys.readouterr().out.count(" s [[") >= 2  # the start, and a step


def test_the_command_finds_a_law_in_the_working_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [place for place in sys.path if place])
    (tmp_path / "my_law.py").write_text(
        "from mpmfw.api import ContactStrategy\n\n\nclass MyLaw(ContactStrategy):\n    name = 'mine'\n"
    )
    done = called("check", "my_law:MyLaw", "--only", "options")
    assert done.stderr == ""
    assert "the plug-in has no options" in done.stdout


def test_the_command_runs_checks_and_tells_of_failures(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = called("check", "separate", "--only", "pushes-apart", "--only", "options", status=1)
    for part in (
        "pushes-apart",
        "not applicable",
        "smallest counterexample",
        "mpmfw-check/separate-pushes-apart.png",
    ):
        assert part in done.stdout
    assert "1 of 2 checks went wrong: pushes-apart" in done.stderr
    assert (tmp_path / "mpmfw-check" / "separate-pushes-apart.png").is_file()

    (tmp_path / "why.toml").write_text(
        '[expected_failures]\npushes-apart = "no interaction: bodies pass through"\n'
    )
    chosen = ["--only", "pushes-apart", "--expected-failures", "why.toml", "--pictures", "shown"]
    done = called("check", "separate", *chosen)
    assert "expected failure" in done.stdout
    assert "no interaction: bodies pass through" in done.stdout
