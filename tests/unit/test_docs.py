"""The documentation says what the code says."""

from pathlib import Path

from python_files import module_of

ROOT = Path(__file__).resolve().parents[2]


def script(name):
    """A script of the documentation as a module."""
    return module_of(ROOT / "docs" / f"{name}.py")


def text(page):
    return (ROOT / page).read_text(encoding="utf-8")


def test_the_page_of_hooks_is_up_to_date():
    assert text("docs/hooks.md") == script("make_hooks").page(), "run: python docs/make_hooks.py"
