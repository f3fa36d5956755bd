"""The test of what plug-ins import does find an offender."""

from __future__ import annotations

import pytest

from plugin_imports import foreign_imports


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("from mpmfw.api import Grid, hookimpl", []),
        ("import mpmfw.api", []),
        ("from mpmfw.kernels import kernel\nfrom mpmfw.kernels.facets import signed_distance", []),
        ("from mpmfw_testing import contact_conformance", []),
        ("from mpmfw_contact import records\nfrom . import mpmfw\nimport mpmfwx", []),
        ("from mpmfw.state import Grid", ["line 1: mpmfw.state.Grid"]),
        ("import mpmfw", ["line 1: mpmfw"]),
        ("from mpmfw import run", ["line 1: mpmfw.run"]),
        ("from mpmfw import api", []),
        ("from mpmfw.kernels._jit import cache_folder", ["line 1: mpmfw.kernels._jit.cache_folder"]),
        (
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from mpmfw.setup import Setup",
            ["line 3: mpmfw.setup.Setup"],
        ),
        ("def late():\n    import mpmfw.simulation as s", ["line 2: mpmfw.simulation"]),
        ("import mpmfw.api\nmpmfw.api.Grid", []),
        ("import mpmfw.api; mpmfw.state.Grid", ["line 1: mpmfw.state.Grid"]),
        ("import mpmfw.api\nlaw = lambda: mpmfw.run('scene')", ["line 2: mpmfw.run"]),
        ("import mpmfw.kernels as k\nk._jit.OPTIONS", ["line 2: mpmfw.kernels._jit.OPTIONS"]),
        ("from mpmfw import kernels\nkernels.kernel(kernels._jit)", ["line 2: mpmfw.kernels._jit"]),
        ("from . import mpmfw\nmpmfw.state", []),
        ("import importlib\nimportlib.import_module('mpmfw.state')", ["line 2: mpmfw.state"]),
        (
            "from importlib import import_module as fetch\nfetch('mpmfw.state')",
            ["line 2: mpmfw.state"],
        ),
        ("__import__('mpmfw.setup')", ["line 1: mpmfw.setup"]),
        ("from importlib import import_module\nimport_module('mpmfw.api')\nimport_module(name)", []),
    ],
)
def test_what_a_plugin_must_not_import_is_found(source, found):
    assert foreign_imports(source) == found
