"""The documentation says what the code says."""

from __future__ import annotations

import importlib.util
import inspect
import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from mpmfw.plugin.discovery import KINDS, available, load
from mpmfw.plugin.hooks import HOOKS
from mpmfw.plugin.hookspecs import HookSpecs
from mpmfw.scene import json_schema
from mpmfw.state.fields import CONTACT_SERIES, MIN_GAP, PARTICLE_FIELDS, SERIES_FIELDS, SURFACE_FIELDS

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


def documented_hooks(page: str) -> dict[str, str]:
    """Section by section, what the page of hooks gives as the hook's signature."""
    return dict(re.findall(r"^## (\w+)\n\n```python\n\w+(\(.*)\n```$", page, re.MULTILINE))


def signature(name: str) -> str:
    """The specification's own."""
    found = inspect.signature(getattr(HookSpecs, name))
    parameters = ", ".join(str(p) for p in found.parameters.values() if p.name != "self")
    return f"({parameters}) -> {found.return_annotation}".replace("'", "")


def stale_hooks(page: str) -> list[str]:
    """Hooks that the page leaves out, makes up, or gives another signature."""
    documented, specified = documented_hooks(page), {name: signature(name) for name in HOOKS}
    names = sorted({*documented, *specified})
    return [name for name in names if documented.get(name) != specified.get(name)]


def test_every_hook_is_documented_with_its_own_signature():
    assert stale_hooks(text("docs/hooks.md")) == []


@pytest.mark.parametrize(
    ("written", "instead", "found"),
    [
        ("advect(grid: Grid, dt: float)", "advect(grid: Grid)", ["advect"]),
        ("end_step(state: State)", "end_step(state: Grid)", ["end_step"]),
        ("-> tuple[float, str] | None", "-> float", ["stable_timestep"]),
        ("## concerns", "## worries", ["concerns", "worries"]),
    ],
)
def test_a_hook_that_is_left_out_or_has_another_signature_is_found(written, instead, found):
    page = text("docs/hooks.md")
    assert written in page
    assert stale_hooks(page.replace(written, instead)) == found


@pytest.mark.parametrize("name", HOOKS)
def test_every_hook_says_when_it_is_called_what_it_may_change_and_what_it_is_given(name):
    documented = inspect.getdoc(getattr(HookSpecs, name)) or ""
    assert re.match(r"[^\n]+: [^\n]+\.$", documented.splitlines()[0])
    assert re.search(r"\bMay (change|add to)\b", documented)
    explained = set(re.findall(r"\w+", documented)) | {"particles", "grid", "state", "phi", "dt"}
    assert set(inspect.signature(getattr(HookSpecs, name)).parameters) - explained == {"self"}


def test_links_and_names_of_the_documentation_resolve(capsys):
    status = script("check").main()
    assert status == 0, capsys.readouterr().out


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("[a](nowhere.md)", "no file nowhere.md"),
        ("[a](page.md#Missing)", "no heading page.md#Missing"),
        ("`mpmfw.state.structs.Stencl`", "no name mpmfw.state.structs.Stencl"),
        ("`mpmfw.nothing`", "no name mpmfw.nothing"),
        (
            "[a](#a-heading), `mpmfw.state.structs.Stencil.row`, `mpmfw.run(scene)`, "
            "[b](https://example.org)",
            None,
        ),
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


@pytest.mark.parametrize("kind", KINDS)
def test_the_page_of_bundled_methods_has_all_of_them(kind):
    page = text("docs/api/bundled.md")
    for name, entry in available(kind).items():
        if entry.dist is None or entry.dist.name != "mpmfw" or not entry.module.startswith("mpmfw_"):
            continue
        method = load(kind, name)
        for one in (method, method.Options):
            path = f"{one.__module__}.{one.__qualname__}"
            assert path.startswith("mpmfw.") or f".. autoclass:: {path}\n" in page, path
