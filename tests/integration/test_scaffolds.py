"""``mpmfw new`` writes distributions whose own tests pass, found by their entry points as installed ones
are.
"""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from command_line import called
from mpmfw.errors import SceneError
from mpmfw_testing.templates import TEMPLATES, write_package
from python_files import write_project_metadata

#: Kinds whose template is a distribution in the documentation, with its folder and the names in it.
WHOLE = {kind: (*folders, *names) for kind, (folders, *names) in TEMPLATES.items() if len(folders) == 1}
DOCS = Path(__file__).resolve().parents[2] / "docs"


#: Checks of contact that take most of the time, here of a detection; .ci/templates asks them of a law.
SLOW = (
    "time-step three-dimensions relabelling rotation shift shapes many-contacts options three-bodies "
    "met-again similarity step-length refinement moving-frame no-growth isolation energy"
)


def test_every_kind_of_one_module_passes_its_own_tests(tmp_path):
    """All in one process: an installation each would take a minute and show no more."""
    places = []
    for kind in TEMPLATES.keys() - WHOLE:
        places.append(write_package(kind, f"my_{kind}", tmp_path))
        write_project_metadata(places[-1])
    path = os.pathsep.join(str(place / "src") for place in places)
    fast = f"not ({' or '.join(SLOW.split())})"
    command = [sys.executable, "-m", "pytest", "-q", "-k", fast, "-p", "no:cacheprovider", *map(str, places)]
    found = subprocess.run(
        command, capture_output=True, text=True, cwd=tmp_path, env={**os.environ, "PYTHONPATH": path}, check=False  # noqa: E501
    )  # fmt: skip
    assert found.returncode == 0, found.stdout + found.stderr
    assert "passed" in found.stdout


@pytest.mark.parametrize("kind", WHOLE)
def test_contact_and_shape_are_the_templates_of_the_documentation(kind, tmp_path):
    """Under the templates' own name they are the same files; .ci/templates installs and tests these."""
    folder, known, _ = WHOLE[kind]
    place = write_package(kind, known, tmp_path)
    template = DOCS / folder
    for path in [*sorted(template.rglob("*.py")), template / "pyproject.toml"]:
        written = place / path.relative_to(template)
        expected = path.read_text(encoding="utf-8").replace("BoundedBSpline", "BoundedBspline")
        assert written.read_text(encoding="utf-8") == expected


@pytest.mark.parametrize("kind", WHOLE)
def test_a_renamed_template_has_nothing_of_the_old_name_in_its_code(kind, tmp_path):
    _, known, name = WHOLE[kind]
    place = write_package(kind, "soft_wall", tmp_path)
    for path in place.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        compile(text, str(path), "exec")
        assert f"mpmfw_{known}" not in text
        assert name not in text
    entry = tomllib.loads((place / "pyproject.toml").read_text(encoding="utf-8"))["project"]["entry-points"]
    group = "law" if kind == "contact" else kind
    assert entry[f"mpmfw.{group}"]["soft_wall"].endswith(":SoftWall")


@pytest.mark.parametrize(
    ("kind", "name", "said"),
    [
        ("laod", "wind", "there is no template of the kind 'laod'; did you mean 'load'?"),
        ("load", "Wind", "Wind: expected a name of small letters"),
        ("load", "class", "class: expected a name of small letters"),
        ("load", "drag", "drag: a load of this name is installed already"),
        ("contact", "penalty", "penalty: a contact of this name is installed already"),
    ],
)
def test_what_cannot_be_written_is_refused(kind, name, said, tmp_path):
    with pytest.raises(SceneError, match=said.replace("?", r"\?")):
        write_package(kind, name, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_the_command_writes_and_does_not_write_over(tmp_path):
    arguments = "new", "load", "wind", "--into", tmp_path
    called(*arguments)
    assert "exists already" in called(*arguments, status=2).output
