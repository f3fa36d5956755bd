"""The tutorial says what its commands print, to the last quoted number."""

import importlib.util
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def tutorial():
    spec = importlib.util.spec_from_file_location("docs_make_tutorial", ROOT / "docs" / "make_tutorial.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.filterwarnings(
    "ignore::mpmfw.errors.ResultsWarning"
)  # averaged normals lean, and the run says so
def test_every_command_runs_and_prints_what_is_quoted(tutorial, tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "120")
    missing = tutorial.run_page(tmp_path)
    assert missing == [], "run: python docs/make_tutorial.py"
    page = tutorial.PAGE.read_text(encoding="utf-8")
    for figure in tutorial.FIGURE.findall(page):
        assert (tmp_path / figure).is_file()
        assert tutorial.PAGE.with_name(figure).is_file()
