"""The documentation says what the code says."""

import importlib.util
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def script(name):
    """A script of the documentation as a module."""
    spec = importlib.util.spec_from_file_location(f"docs_{name}", ROOT / "docs" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def text(page):
    return (ROOT / page).read_text(encoding="utf-8")


def test_the_page_of_hooks_is_up_to_date():
    assert text("docs/hooks.md") == script("make_hooks").page(), "run: python docs/make_hooks.py"


def test_links_and_names_of_the_documentation_resolve(capsys):
    status = script("check").main()
    assert status == 0, capsys.readouterr().out
