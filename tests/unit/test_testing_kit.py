"""The kit's frame: search and its smallest counterexample, outcomes, justified failures, decorators, the command."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import pytest
from pydantic import BaseModel, Field
from typer.testing import CliRunner

from mpmfw.api import ContactStrategy
from mpmfw.cli import app
from mpmfw.errors import SceneError
from mpmfw.testing import (
    Check,
    Inapplicable,
    Violation,
    contact_checks,
    contact_conformance,
    examine,
    ladder,
    search,
    shape_checks,
    subject_of,
    try_all,
)
from mpmfw.testing import parametrised as parametrised_module
from mpmfw.testing.option_values import candidates
from mpmfw_contact.penalty import Penalty

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


def test_the_counterexample_is_the_smallest_and_the_same_in_every_run():
    with pytest.raises(Violation) as first:
        failing(SUBJECT)
    with pytest.raises(Violation) as second:
        failing(SUBJECT)
    assert first.value.counterexample == {"a [m]": 0.0, "b": 1.0, "sum": 1.0}
    assert second.value.counterexample == first.value.counterexample
    assert (first.value.measured, first.value.bound) == (1.0, 0.75)


def test_the_simplest_case_is_tried_first():
    tried = []
    search({"a": ladder(3.0, 1.0, 3)}, lambda a: tried.append(a), examples=5)
    assert tried[0] == 3.0
    assert set(tried) <= {1.0, 2.0, 3.0}


def test_a_search_ends_after_so_many_trials():
    tried = []

    def trial(a):
        tried.append(a)
        if a > 3:
            raise Violation("beyond three")

    with pytest.raises(Violation) as caught:
        search({"a": ladder(0.0, 1000.0, 1001)}, trial, examples=50, most=12)
    assert len(tried) <= 12
    assert caught.value.counterexample["a"] > 3


def test_all_combinations_are_tried_simplest_first():
    tried = []

    def trial(a, b):
        tried.append((a, b))
        if a + b > 4:
            raise Violation("beyond four")

    with pytest.raises(Violation) as caught:
        try_all({"a": (1, 2), "b": (1, 3)}, trial, names={"b": "b [m]"})
    assert tried[0] == (1, 1)
    assert len(tried) == 4
    assert caught.value.counterexample == {"a": 2, "b [m]": 3}


def test_an_error_of_the_plugin_is_a_violation_with_its_case():
    def trial(a):
        if a > 0:
            raise ZeroDivisionError("no gap")

    with pytest.raises(Violation, match="ZeroDivisionError: no gap") as caught:
        search({"a": ladder(0.0, 4.0, 5)}, trial, examples=20)
    assert caught.value.counterexample == {"a": 1.0}
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


def test_what_cannot_be_asked_is_said():
    def trial(a):
        raise Inapplicable(f"it has no springs at {a:g} m")

    with pytest.raises(Inapplicable, match="no springs"):
        search({"a": ladder(0.0, 1.0, 2)}, trial)


def test_a_later_case_that_cannot_be_asked_hides_no_violation():
    def trial(a):
        if a > 0.6:
            raise Violation("beyond 0.6")
        if a > 0.3:
            raise Inapplicable("the middle cannot be asked")

    with pytest.raises(Violation, match=r"beyond 0\.6"):
        try_all({"a": (0.0, 0.5, 1.0)}, trial)
    with pytest.raises(Inapplicable, match="middle"):
        try_all({"a": (0.5, 1.0)}, trial)


def test_shrinking_into_a_case_that_cannot_be_asked_keeps_the_violation():
    tried = []

    def trial(a):
        broken = any(each > 0.8 for each in tried)
        tried.append(a)
        if a > 0.8:
            raise Violation("beyond 0.8")
        if broken and a > 0.0:
            raise Inapplicable("it has no springs")

    with pytest.raises(Violation, match=r"beyond 0\.8"):
        search({"a": ladder(0.0, 1.0, 11)}, trial, examples=40)
    assert 0.0 < tried[-1] <= 0.8


def test_a_note_of_a_check_that_passes_is_kept():
    noted = Check("noted", "All is well.", lambda _subject: "refuses: linear")
    (outcome,) = examine(SUBJECT, [noted])
    assert (outcome.status, outcome.message) == ("passed", "refuses: linear")


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
    assert list(mark.kwargs["ids"]) == [check.name for check in contact_checks()]
    assert len(mark.args[1]) == len(contact_checks())
    with pytest.raises(SceneError, match="did you mean 'energy'"):
        contact_conformance("separate", expected_failures={"enrgy": WHY})
    with pytest.raises(SceneError, match="did you mean 'energy'"):
        contact_conformance("separate", only=["enrgy"])


@pytest.mark.parametrize(
    ("check", "why", "result"),
    [
        (GOOD, "", None),
        (ASKED, "", pytest.skip.Exception),
        (BAD, "", pytest.fail.Exception),
        (BAD, WHY, pytest.xfail.Exception),
        (GOOD, WHY, pytest.fail.Exception),
    ],
)
def test_a_bound_check_passes_skips_or_fails(check, why, result, tmp_path):
    bound = parametrised_module.BoundCheck(SUBJECT, check, why, tmp_path)
    if result is None:
        bound()
        return
    with pytest.raises(result):
        bound()


def test_subjects_of_all_sorts():
    assert subject_of(Penalty(kappa=2.0), "contact").make().options.kappa == 2.0
    assert subject_of(Penalty, "contact", {"kappa": 3.0}).label == "penalty(kappa=3.0)"
    assert subject_of("mpmfw_contact.penalty:Penalty", "contact").make(kappa=4.0).options.kappa == 4.0
    made = subject_of(lambda: Penalty(kappa=5.0), "contact")
    assert made.make() is not made.make()
    assert made.make().options.kappa == 5.0


@pytest.mark.parametrize(
    ("plugin", "options", "said"),
    [
        ("penalti", {}, "did you mean 'penalty'"),
        ("mpmfw_contact.penalty:Nothing", {}, "has no attribute 'Nothing'"),
        ("mpmfw_shape.gimp:Gimp", {}, "is no contact plug-in"),
        (Penalty, {"kapa": 1.0}, "no such option 'kapa'; did you mean 'kappa'"),
        (Penalty, {"kappa": -1.0}, "kappa: .*greater than 0"),
        (3, {}, "cannot check 3"),
    ],
)
def test_what_is_no_subject_is_refused(plugin, options, said):
    with pytest.raises(SceneError, match=said):
        subject_of(plugin, "contact", options)


class Some(BaseModel):
    """Options of many types."""

    opaque: dict[str, float] = {}
    number: float = 2.0
    count: int = 3
    flag: bool = False
    maybe: str | None = None
    pair: tuple[float, ...] | None = None
    other: dict[str, float] = Field({}, examples=[{"a": 1.0}])
    narrow: float = Field(5.5, ge=5, le=6)
    open: float = Field(0.5, gt=0, lt=1)
    order: int = Field(2, ge=1)
    length: Annotated[float, Field(ge=100.0)] | None = None


def test_values_of_options_are_made_up_by_type():
    fields = Some.model_fields
    assert candidates(fields["number"])[:2] == [4.0, 1.0]
    assert set(candidates(fields["count"])) >= {6, 1}
    assert candidates(fields["flag"]) == [False, True]
    assert "first" in candidates(fields["maybe"])
    assert (1.0, 0.0) in candidates(fields["pair"])
    assert candidates(fields["other"]) == [{"a": 1.0}]
    assert candidates(fields["opaque"]) == []


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [("narrow", 5.0, 6.0), ("open", 1e-9, 1.0 - 1e-9), ("order", 1, 1000), ("length", 100.0, 1e9)],
)
def test_numbers_that_are_made_up_keep_the_bounds_of_the_field(name, least, most):
    field = Some.model_fields[name]
    others = [value for value in candidates(field) if value != field.default]
    assert len(others) >= 2
    assert all(least <= value <= most for value in others)
    for value in others:
        Some(**{name: value})


class Opaque(ContactStrategy):
    """A law with an option whose values nobody can guess."""

    name = "opaque"
    Options = Some


def test_importing_the_kit_needs_neither_pytest_nor_hypothesis_nor_numba():
    code = (
        "import sys, mpmfw.testing\n"
        "print([m for m in ('pytest', 'hypothesis', 'numba', 'matplotlib') if m in sys.modules])\n"
        "sys.modules['hypothesis'] = None\n"
        "from mpmfw.testing import ladder\n"
        "try: ladder(0.0, 1.0, 2)\n"
        "except Exception as error: print(type(error).__name__, error)\n"
        "sys.modules['pytest'] = None\n"
        "from mpmfw.testing import contact_conformance\n"
        "try: contact_conformance('penalty')\n"
        "except Exception as error: print(type(error).__name__, error)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert lines[0] == "[]"
    assert all(line.startswith("MpmfwError") and "mpmfw[testing]" in line for line in lines[1:])
    assert len(lines) == 3


@pytest.mark.parametrize("checks", [contact_checks, shape_checks])
def test_every_check_says_what_holds_and_states_its_bound(checks):
    names = [check.name for check in checks()]
    assert len(set(names)) == len(names)
    for check in checks():
        assert check.property.endswith(".")
        assert check.name == check.name.lower().replace(" ", "-")
        assert len(check.run.__doc__ or "") > 40


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["penalti"], "no plug-in 'penalti' is installed; did you mean 'penalty'?"),
        (
            ["neo_hookean"],
            "'neo_hookean' is a material; there are checks for contact laws and shape functions only",
        ),
        (["penalty", "--kind", "material"], "there are no checks for materials"),
        (["penalty", "--kind", "contakt"], "did you mean 'contact'?"),
        (["cpdi", "--kind", "contact"], "unknown contact plug-in 'cpdi'"),
        (["a:B"], "say --kind contact or --kind shape"),
        (["penalty", "--only", "enrgy"], "no such check 'enrgy'; did you mean 'energy'?"),
        (["penalty", "--set", "kapa=1"], "no such option 'kapa'; did you mean 'kappa'?"),
        (["penalty", "--set", "kapa"], "expected KEY=VALUE"),
        (["penalty", "--expected-failures", "missing.toml"], "missing.toml"),
    ],
)
def test_the_command_refuses_what_it_cannot_check(arguments, said):
    done = CliRunner().invoke(app, ["check", *arguments])
    assert done.exit_code == 2
    assert said in done.stderr
    assert done.stderr.count("\n") == 1


def test_the_command_finds_a_law_in_the_working_directory(tmp_path):
    (tmp_path / "my_law.py").write_text(
        "from mpmfw.api import ContactStrategy\n\n\nclass MyLaw(ContactStrategy):\n    name = 'mine'\n"
    )
    command = "import sys; from mpmfw.cli import app; sys.path.remove(''); app()"
    asked = ["check", "my_law:MyLaw", "--kind", "contact", "--only", "options"]
    done = subprocess.run(
        [sys.executable, "-c", command, *asked], cwd=tmp_path, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "the plug-in has no options" in done.stdout


def test_the_command_runs_checks_and_tells_of_failures(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["check", "separate", "--only", "pushes-apart", "--only", "options"])
    assert done.exit_code == 1
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
    done = CliRunner().invoke(app, ["check", "separate", *chosen])
    assert done.exit_code == 0
    assert "expected failure" in done.stdout
    assert "no interaction: bodies pass through" in done.stdout


def test_an_option_whose_values_cannot_be_made_up_is_asked_for():
    options = next(check for check in contact_checks() if check.name == "options")
    outcome = examine(subject_of(Opaque, "contact"), [options])[0]
    assert outcome.status == "failed"
    assert outcome.counterexample["option"] == "opaque"
    assert "give its field examples" in outcome.message


@pytest.mark.parametrize(
    ("heading", "checks"), [("Contact laws", contact_checks), ("Shape functions", shape_checks)]
)
def test_the_guide_lists_every_check_with_its_property(heading, checks):
    page = (Path(__file__).parents[2] / "docs" / "guide" / "conformance.md").read_text(encoding="utf-8")
    section = page.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `([\w-]+)` \| (.*?[^\\]) \|", section, re.MULTILINE)
    assert rows == [(check.name, check.property.replace("|", "\\|")) for check in checks()]
