"""Geometries of other distributions in scenes: by name or module:Class, with messages of their own keys."""

from __future__ import annotations

from typing import Any

import pytest

from faulty_plugins.small.geometry import Sound, SoundSolid
from mpmfw.errors import SceneError
from mpmfw.runs.build import build
from mpmfw.scene import load_scene

PLACE = "faulty_plugins.small.geometry"


def scene(dim: int = 2, **keys: Any) -> dict[str, Any]:
    geometry = {"type": f"{PLACE}:{'Sound' if dim == 2 else 'SoundSolid'}", **keys}
    return {
        "grid": {"cell_size": 0.25, "lower": [-2.0] * dim, "upper": [2.0] * dim},
        "time": {"end": 1e-3, "output_interval": 1e-3},
        "shape": {"method": "linear"},
        "materials": {
            "m": {"model": "linear_elastic", "density": 1e3, "bulk_modulus": 5e6, "shear_modulus": 3e6}
        },
        "bodies": {"egg": {"material": "m", "geometry": geometry, "particles": {"size": 0.1}}},
    }


@pytest.mark.parametrize(("dim", "kind"), [(2, Sound), (3, SoundSolid)])
def test_a_body_has_the_volume_of_a_strangers_geometry(dim: int, kind: Any) -> None:
    made = build(load_scene(scene(dim)))
    assert isinstance(made.scene.bodies["egg"].geometry, kind)
    mass = 1e3 * float(kind().exact_volume)
    assert made.state.particles.mass.sum() == pytest.approx(mass, rel=1e-6 if dim == 2 else 1e-3)


def test_its_keys_have_units_and_are_told_by_name() -> None:
    assert load_scene(scene(hole="20 cm")).bodies["egg"].geometry.hole == 0.2  # type: ignore[union-attr]
    with pytest.raises(SceneError) as found:
        load_scene(scene(hole="2 kg", centra=[0.0, 0.0]))
    said = str(found.value)
    assert "bodies.egg.geometry.hole: '2 kg' is not convertible to m; expected a length in m" in said
    assert "bodies.egg.geometry.centra: unknown key; did you mean 'centre'?" in said
