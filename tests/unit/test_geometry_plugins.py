"""Geometries of other distributions in scenes: by name or module:Class, with messages of their own keys."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from faulty_plugins.small.geometry import Sound, SoundSolid
from mpmfw.errors import SceneError
from mpmfw.geometry.discretise import refuse_incomplete
from mpmfw.runs.build import build
from mpmfw.scene import load_scene
from mpmfw.scene.geometries import with_geometries
from mpmfw.scene.schema import json_schema

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


def test_what_is_no_geometry_is_refused() -> None:
    wrong = scene()
    wrong["bodies"]["egg"]["geometry"] = {"type": "mpmfw_contact.penalty:Penalty"}
    with pytest.raises(SceneError, match=r"expected a class derived from mpmfw\.api\.PlaneGeometry"):
        load_scene(wrong)
    wrong["bodies"]["egg"]["geometry"] = {"type": "elips"}
    with pytest.raises(SceneError, match="'elips' is unknown; expected one of disc, ring"):
        load_scene(wrong)


def test_what_a_class_leaves_out_is_named() -> None:
    from mpmfw.api import PlaneGeometry

    with pytest.raises(SceneError, match="lacks outlines, region"):
        refuse_incomplete(PlaneGeometry)


def test_the_schema_has_its_keys() -> None:
    schema = with_geometries(json_schema(), [f"{PLACE}:Sound", "no_such:Class"])
    table = schema["$defs"]["Body"]["properties"]["geometry"]
    assert list(schema["$defs"][table["oneOf"][-1]["$ref"].rsplit("/", 1)[1]]["properties"]) == [
        "type", "centre", "semi_axes", "hole",
    ]  # fmt: skip
    assert list(table["discriminator"]["mapping"])[-1] == f"{PLACE}:Sound"


def test_scenes_that_differ_by_one_of_its_keys_are_two() -> None:
    dumped: list[Any] = [
        load_scene(scene(hole=h)).model_dump()["bodies"]["egg"]["geometry"]["hole"] for h in (0.1, 0.2)
    ]
    assert dumped == [0.1, 0.2]


def test_bodies_that_are_alike_share_a_layout_that_is_moved() -> None:
    given = scene()
    given["contact"] = {"method": "separate"}
    given["bodies"]["other"] = {
        **given["bodies"]["egg"], "geometry": {"type": f"{PLACE}:Sound", "centre": [-0.55, 0.1], "semi_axes": [0.5, 0.4]}  # noqa: E501
    }  # fmt: skip
    given["bodies"]["egg"]["geometry"] |= {"centre": [0.75, 0.35], "semi_axes": [0.5, 0.4]}
    made = build(load_scene(given))
    one, other = (made.state.particles.position[body.particles] for body in made.state.bodies)
    np.testing.assert_allclose(one - other, np.broadcast_to([1.3, 0.25], one.shape), atol=1e-12)


def test_a_table_that_is_missing_has_an_example() -> None:
    given = scene()
    del given["bodies"]["egg"]["particles"]
    with pytest.raises(SceneError, match=r"particles: missing; expected a table such as \{ size = '2 mm' \}"):
        load_scene(given)
