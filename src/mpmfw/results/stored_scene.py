"""The scene of a stored result: its tables, and the scene itself without its methods."""

from __future__ import annotations

import functools
import json
import tomllib
from collections.abc import Mapping
from typing import Any

import xarray as xr

from mpmfw.errors import MpmfwError
from mpmfw.scene import Scene, load_scene
from mpmfw.scene.override import merge, parse_value
from mpmfw.scene.sources import code_in
from mpmfw.scene.toml_text import toml_text
from mpmfw.units import to_si


def scene_of(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    """Parse the scene of a result; empty if there is none."""
    try:
        return tomllib.loads(str(attributes.get("scene", "")))
    except ValueError:
        return {}


def cell_size(run: xr.Dataset) -> float:
    """Return the cell size of one combination of a comparison [m], or NaN."""
    try:
        return float(to_si(scene_of(own_attributes(run))["grid"]["cell_size"], "m"))  # type: ignore[arg-type]
    except (LookupError, TypeError, ValueError):
        return float("nan")


def own_attributes(run: xr.Dataset) -> dict[str, Any]:
    """Return attributes of one combination, with its varied keys in the scene."""
    keys = json.loads(run.attrs.get("varied", "{}"))
    own = {key: run.coords[dim].item() for dim, key in keys.items() if dim in run.coords}
    if not own:
        return dict(run.attrs)
    values = {key: parse_value(value) if isinstance(value, str) else value for key, value in own.items()}
    scene, _ = merge(scene_of(run.attrs), values)
    return {**run.attrs, "scene": toml_text(scene)}


#: Stands for a material whose code is not imported.
_RIGID = {"model": "neo_hookean", "density": 1.0, "bulk_modulus": 1.0, "shear_modulus": 1.0}


def scene_of_results(attributes: Mapping[str, Any]) -> Scene | None:
    """Return the scene of a result, or None."""
    text = attributes.get("scene")
    return loaded(text) if isinstance(text, str) else None


@functools.lru_cache(maxsize=64)
def loaded(text: str) -> Scene | None:
    """Return a scene without its methods and without code; None if it cannot be read."""
    scene = scene_of({"scene": text})
    contact, materials = scene.get("contact"), scene.get("materials")
    scene.pop("stepping", None)
    scene["shape"] = {"method": "linear"}
    if isinstance(contact, dict):
        kept = ("friction", "friction_law", "pairs", contact.get("friction_law"))
        scene["contact"] = {"method": "none"} | {key: contact[key] for key in contact if key in kept}
    if isinstance(materials, dict):
        scene["materials"] = {
            name: _RIGID if next(code_in(table), None) else table for name, table in materials.items()
        }
    if next(code_in(scene), None):
        return None
    try:
        return load_scene(scene)
    except MpmfwError:
        return None
