"""The guide to a contact law of one's own is real: its files are written, announced, imported, typed, run and
checked.
"""

import contextlib
import importlib
import io
import os
import re
import shlex
import sys
from pathlib import Path

import pytest

from mpmfw.cli.app import app
from python_files import write_project_metadata

PAGE = Path(__file__).resolve().parents[2] / "docs" / "guide" / "write-a-contact-law.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"# ([\w./-]+\.(?:py|toml))\n")

#: Commands of the page that need a network or an installed package; .ci/templates checks the law.
ELSEWHERE = ("cd ", "pip ", "python -m build", "pytest", "mpmfw check")


@pytest.fixture(scope="module")
def blocks():
    return BLOCK.findall(PAGE.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def package(blocks, tmp_path_factory):
    """The package's files in a folder, announced as an installation would be."""
    root = tmp_path_factory.mktemp("mpmfw-film")
    for _, text in blocks:
        if named := FILE.match(text):
            path = root / named[1]
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
    write_project_metadata(root)
    sys.path.insert(0, str(root / "src"))
    os.environ["PYTHONPATH"] = str(
        root / "src"
    )  # for the processes of its own that a stranger's plug-in is checked in
    importlib.invalidate_caches()
    yield root
    sys.path.remove(str(root / "src"))
    del os.environ["PYTHONPATH"]
    for name in [name for name in sys.modules if name.partition(".")[0] == "mpmfw_film"]:
        del sys.modules[name]


def output_of(kind, text):
    """What a block of commands, or of Python, prints."""
    caught = io.StringIO()
    with contextlib.redirect_stdout(caught):
        if kind == "python":
            exec(compile(text, str(PAGE), "exec"), {"__name__": "guide"})
        for line in text.splitlines() if kind == "sh" else ():
            if not line.startswith(ELSEWHERE):
                run_command(shlex.split(line))
    return caught.getvalue()


def run_command(words):
    assert words[0] == "mpmfw"
    # without standalone mode the exit status is what the call returns
    assert app(words[1:], prog_name="mpmfw", standalone_mode=False) in (None, 0), words


def test_the_template_is_the_page_s_package(blocks):
    """Every file of the template that the page quotes is as quoted; it has no other but its README and the
    mark of its types.
    """
    template = PAGE.parents[1] / "plugin-template"
    quoted = {named[1]: text for _, text in blocks if (named := FILE.match(text))}
    files = {path.relative_to(template).as_posix(): path for path in template.rglob("*") if path.is_file()}
    files = {name: path for name, path in files.items() if "__pycache__" not in name}
    assert set(files) - set(quoted) == {"README.md", "src/mpmfw_film/py.typed"}
    for name, text in quoted.items():
        assert files[name].read_text(encoding="utf-8") == text


@pytest.mark.filterwarnings(
    "ignore::mpmfw.errors.ResultsWarning"
)  # averaged normals lean, and the run says so
@pytest.mark.usefixtures("package")
def test_its_commands_run_and_print_what_is_quoted(blocks, tmp_path):
    printed, quoted = "", 0
    with contextlib.chdir(tmp_path):
        for kind, text in blocks:
            if kind in ("sh", "python") and not FILE.match(text):
                printed = output_of(kind, text)
            elif kind == "text" and "├" not in text:
                quoted += 1
                assert text.strip() in printed
    assert quoted == 1
    for name in ("film.nc", "laws.nc", "laws.html"):
        assert (tmp_path / name).is_file()
