"""Texts of the distributions that ``mpmfw new`` writes beside the module itself."""

from __future__ import annotations

PYPROJECT = """\
[build-system]
requires = ["hatchling>=1.26"]
build-backend = "hatchling.build"

[project]
name = "mpmfw-@DASHED@"
version = "0.1.0"
description = "A @KIND@ of one's own for mpmfw"
requires-python = ">=3.11"
dependencies = ["mpmfw", "numpy>=2.2", "pydantic>=2.9"]

[project.optional-dependencies]
test = ["mpmfw[testing]"]

# mpmfw finds it here; nothing in mpmfw changes.
[project.entry-points."mpmfw.@KIND@"]
@NAME@ = "mpmfw_@NAME@:@ENTRY@"

[tool.hatch.build.targets.wheel]
packages = ["src/mpmfw_@NAME@"]
"""

README = """\
# mpmfw-@DASHED@

A @KIND@ of one's own for mpmfw. It does something simple and passes its tests; replace what is in `src/mpmfw_@NAME@/@KIND@.py`.

```sh
pip install -e ".[test]"
mpmfw plugins
pytest
```
@RUN@"""

MODULE_OF = '''\
"""A @KIND@, a plug-in of mpmfw."""

from mpmfw_@NAME@.@KIND@ import @ENTRY@

__all__ = ["@ENTRY@"]
'''

#: How a scene names it.
RUN = {
    "material": '\n```toml\n[materials.soft]\nmodel = "@NAME@"\ndensity = 1000\n```\n',
    "load": '\n```toml\n[loads.push]\nmodel = "@NAME@"\n```\n',
    "detection": '\n```toml\n[contact]\ndetection = "@NAME@"\nlaw = "impulse"\n```\n',
    "friction": '\n```toml\n[contact]\nfriction_law = "@NAME@"\n```\n',
    "geometry": '\n```toml\n[bodies.mine]\ngeometry = { type = "@NAME@", centre = [0.0, 0.5] }\n```\n',
}

_SCENE = '''\
"""What the plug-in does in a run of a square that falls."""

import numpy as np
import pytest

import mpmfw

SCENE = {
    "grid": {"cell_size": 0.25, "lower": [-1.5, -1.5], "upper": [1.5, 1.5]},
    "time": {"end": 0.01, "output_interval": 0.005, "step": 1e-4},
    "shape": {"method": "cpdi"},
    "materials": {
        "soft": {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 5e6, "shear_modulus": 3e6}
    },
    "bodies": {
        "block": {
            "material": "soft",
            "geometry": {"type": "rectangle", "lower": [-0.5, -0.5], "upper": [0.5, 0.5]},
            "particles": {"size": 0.125},
        }
    },
    "gravity": {"vector": [0.0, -10.0]},
}

'''

_IMPORT = "from mpmfw_testing import @KIND@_conformance as conformance\n"
_CHECK = """\
@conformance("@NAME@")
def test_conformance(check):
    check()
"""
_CHECKED = f"{_IMPORT}\n\n{_CHECK}"
_CHECKED_SCENE = _SCENE.replace("import mpmfw\n", f"import mpmfw\n{_IMPORT}") + _CHECK + "\n"

TESTS = {
    "material": _CHECKED,
    "load": _CHECKED,
    "friction": _CHECKED_SCENE
    + """
def test_a_factor_of_two_is_twice_the_friction():
    lower = {"type": "rectangle", "lower": [-1.0, -1.0], "upper": [1.0, -0.5]}
    bodies = {**SCENE["bodies"], "plane": {**SCENE["bodies"]["block"], "geometry": lower}}
    bodies["plane"]["sides"] = [{"side": "bottom", "fixed": True}]
    bodies["block"] = {**bodies["block"], "velocity": [1.0, -0.5]}

    def end(friction, law):
        contact = {"method": "penalty", "friction": friction, **law}
        series = mpmfw.run({**SCENE, "bodies": bodies, "contact": contact})["series"]
        return series["mean_velocity"].sel(body="block").values[-1]

    ours = end(0.1, {"friction_law": "@NAME@", "@NAME@": {"factor": 2.0}})
    np.testing.assert_allclose(ours, end(0.2, {}), rtol=1e-12)
""",
    "detection": _CHECKED_SCENE
    + """
def test_without_a_leading_body_it_is_what_nodes_are():
    lower = {"type": "rectangle", "lower": [-1.0, -1.0], "upper": [1.0, -0.5]}
    bodies = {**SCENE["bodies"], "plane": {**SCENE["bodies"]["block"], "geometry": lower}}
    bodies["block"] = {**bodies["block"], "velocity": [1.0, -0.5]}

    def end(contact):
        series = mpmfw.run({**SCENE, "bodies": bodies, "contact": {"friction": 0.2, **contact}})["series"]
        return series["mean_velocity"].values[-1]

    ours = end({"method": "@NAME@+impulse", "@NAME@": {"exponent": 0.0}})
    np.testing.assert_allclose(ours, end({"method": "nodes+impulse"}), rtol=1e-12)
""",
    "geometry": _CHECKED_SCENE
    + """
def test_the_body_falls_with_the_mass_of_its_area():
    egg = {**SCENE["bodies"]["block"], "geometry": {"type": "@NAME@", "semi_axes": [0.5, "20 cm"]}}
    series = mpmfw.run({**SCENE, "bodies": {"egg": egg}})["series"]
    momentum = series["linear_momentum"].sel(axis="y").values[-1]
    assert momentum == pytest.approx(-1000.0 * np.pi * 0.5 * 0.2 * 10.0 * 0.01, rel=1e-6)
""",
}
