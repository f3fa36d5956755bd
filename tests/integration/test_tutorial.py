"""The tutorial says what its commands print, to the last quoted number."""

from pathlib import Path

import pytest

from python_files import module_of

SCRIPT = Path(__file__).resolve().parents[2] / "docs" / "make_tutorial.py"


@pytest.mark.filterwarnings(
    "ignore::mpmfw.errors.ResultsWarning"
)  # averaged normals lean, and the run says so
def test_every_command_runs_and_prints_what_is_quoted(tmp_path, monkeypatch):
    tutorial = module_of(SCRIPT)
    monkeypatch.setenv("COLUMNS", "120")
    missing = tutorial.run_page(tmp_path)
    assert missing == [], "run: python docs/make_tutorial.py"
    page = tutorial.PAGE.read_text(encoding="utf-8")
    for figure in tutorial.FIGURE.findall(page):
        assert (tmp_path / figure).is_file()
        assert tutorial.PAGE.with_name(figure).is_file()
