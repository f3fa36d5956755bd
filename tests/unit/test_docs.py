"""The documentation says what the code says."""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from mpmfw.discovery import KINDS, available, load
from mpmfw.fields import CONTACT_SERIES, MIN_GAP, PARTICLE_FIELDS, SERIES_FIELDS, SURFACE_FIELDS
from mpmfw.hooks import hook_names
from mpmfw.hookspecs import HookSpecs
from mpmfw.scene import json_schema

ROOT = Path(__file__).resolve().parents[2]


def script(name: str) -> ModuleType:
    """A script of the documentation as a module."""
    spec = importlib.util.spec_from_file_location(f"docs_{name}", ROOT / "docs" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def text(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


def test_the_page_of_hooks_is_up_to_date():
    assert text("docs/hooks.md") == script("make_hooks").page(), "run: python docs/make_hooks.py"


@pytest.mark.parametrize("name", hook_names())
def test_every_hook_says_when_it_is_called_and_what_it_may_change(name):
    documented = getattr(HookSpecs, name).__doc__ or ""
    assert re.search(r"\b(May (change|add)|Returns)\b", documented)


def test_links_and_names_of_the_documentation_resolve(capsys):
    status = script("check").main()
    assert status == 0, capsys.readouterr().out


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("[a](nowhere.md)", "no file nowhere.md"),
        ("[a](page.md#Missing)", "no heading page.md#Missing"),
        ("`mpmfw.state.Stencl`", "no name mpmfw.state.Stencl"),
        ("`mpmfw.nothing`", "no name mpmfw.nothing"),
        ("[a](#a-heading), `mpmfw.state.Stencil.row`, `mpmfw.run(scene)`, [b](https://example.org)", None),
    ],
)
def test_the_check_finds_what_does_not_resolve(tmp_path, monkeypatch, line, problem):
    checks = script("check")
    monkeypatch.setattr(checks, "ROOT", tmp_path)
    page = tmp_path / "page.md"
    page.write_text(f"# A heading\n\n{line}\n", encoding="utf-8")
    found = [*checks.broken_links(page), *checks.unknown_names(page)]
    assert found == ([] if problem is None else [f"page.md: {problem}"])


def scene_keys(schema: Any) -> set[str]:
    """All keys of tables anywhere in a JSON schema."""
    if isinstance(schema, list):
        return set().union(*map(scene_keys, schema))
    if not isinstance(schema, dict):
        return set()
    own = set(schema.get("properties", {}))
    return own.union(*map(scene_keys, schema.values()))


def test_every_key_of_a_scene_is_documented():
    documented = set(re.findall(r"[\w]+", " ".join(re.findall(r"`([^`\n]+)`", text("docs/guide/scenes.md")))))
    assert scene_keys(json_schema()) - documented - {"contact", "shape", "stepping", "time"} == set()


@pytest.mark.parametrize("kind", KINDS)
def test_every_bundled_plugin_and_option_is_documented(kind):
    bundled = {name: entry for name, entry in available(kind).items() if entry.value.startswith("mpmfw_")}
    page = text("docs/guide/scenes.md")
    for name in bundled:
        assert f"`{name}`" in page
        for option in load(kind, name).Options.model_fields:
            assert f"`{option}`" in page


def test_every_field_in_the_files_is_documented():
    page = text("docs/guide/results.md")
    for field in (*PARTICLE_FIELDS, *SURFACE_FIELDS, *SERIES_FIELDS, *CONTACT_SERIES, MIN_GAP):
        assert not field.output or f"`{field.name}`" in page
