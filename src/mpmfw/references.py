"""Which closed form or reference a scene has, read from the scene that its results carry."""

from __future__ import annotations

import functools
import itertools
import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from io import StringIO
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.analysis import RollingSolution, rolling_solution
from mpmfw.fields import FloatArray
from mpmfw.scene.override import merge, parse_value
from mpmfw.units import to_si


@dataclass(frozen=True)
class RollingReference:
    """A disc that rolls down a fixed plane under tilted gravity."""

    body: str  #: the disc
    solution: RollingSolution
    distance: float = 10.0  #: at which the displacement is judged [m]

    def describe(self) -> str:
        """Say in one sentence what the results are compared with."""
        solution = self.solution
        return (
            f"a rigid cylinder that {'slips' if solution.slips else 'rolls without slip'}, from rest "
            "(eq. 13 of Hamad, Giridharan & Moormann 2017, Procedia Engineering 175, 116-123): acceleration "
            f"{solution.acceleration:.4g} m/s², angular acceleration "
            f"{abs(solution.angular_acceleration):.4g} rad/s², "
            f"{self.distance:g} m after {solution.time_to(self.distance):.4g} s"
        )


@dataclass(frozen=True)
class RingsReference:
    """The collision of two rings that the shipped finite-element solution is of."""

    first: str  #: the left ring
    second: str  #: the right ring
    end: float = 3.2e-3  #: until which the motions are compared [s]

    def describe(self) -> str:
        """Say in one sentence what the results are compared with."""
        return (
            "explicit total-Lagrangian plane-strain finite elements, nine-node quadrilaterals of 0.5 mm, one "
            "ring against a frictionless wall on the plane of symmetry; honest solutions differ by 2.4 % in "
            "impulse and by 0.19 in the L2 norm of the force averaged over 100 µs (four-node quadrilaterals "
            "of 2 mm)"
        )


Reference = RollingReference | RingsReference


def scene_of(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Parse the scene in the attributes of a result (TOML or JSON); empty if there is none."""
    text = attributes.get("scene")
    if not isinstance(text, str):
        return {}
    for parse in (tomllib.loads, json.loads):
        try:
            scene = parse(text)
        except ValueError:
            continue
        return scene if isinstance(scene, dict) else {}
    return {}


def cell_size_of(attributes: Mapping[str, Any]) -> float:
    """Cell size h of the scene [m]; NaN if it is not known."""
    return _si(scene_of(attributes).get("grid", {}).get("cell_size"), "m")


def cell_size(run: xr.Dataset) -> float:
    """Cell size h of one combination of a comparison [m]: varied, or the scene's; NaN if it is not known."""
    return cell_size_of(own_attributes(run))


def own_attributes(run: xr.Dataset) -> dict[str, Any]:
    """Attributes of one combination of a comparison, its own values of the varied keys set into the scene.

    Parameters
    ----------
    run
        The comparison at one value of each varied key; ``varied`` among its attributes holds their keys.
    """
    keys = json.loads(run.attrs.get("varied", "{}"))
    own = {key: run.coords[dim].item() for dim, key in keys.items() if dim in run.coords}
    if not own:
        return dict(run.attrs)
    values = {key: parse_value(value) if isinstance(value, str) else value for key, value in own.items()}
    scene, _ = merge(scene_of(run.attrs), values)
    return {**run.attrs, "scene": json.dumps(scene, default=str)}


def own_references(dataset: xr.Dataset) -> list[Reference | None]:
    """The different references of a comparison's rows: one, unless a varied key changes it."""
    varied = [dim for dim in dataset["status"].dims if dim not in ("contact", "shape")]
    labels = itertools.product(*(range(dataset.sizes[dim]) for dim in varied))
    rows = (dataset.isel(dict(zip(varied, index, strict=True))) for index in labels)
    return list(dict.fromkeys(reference_of(own_attributes(row)) for row in rows))


def described(dataset: xr.Dataset) -> str:
    """What the rows of a comparison are compared with; empty if there is nothing."""
    told = (str(array.attrs["against"]) for array in dataset.data_vars.values() if "against" in array.attrs)
    if said := "; ".join(dict.fromkeys(told)):
        return said
    references = own_references(dataset)
    if len(references) > 1:
        return "each row against its own closed form, as the varied keys change it"
    return references[0].describe() if references and references[0] is not None else ""


def grid_lower_of(attributes: Mapping[str, Any]) -> list[float]:
    """Lower corner of the scene's grid [m]; empty if it is not known."""
    corner = [_si(value, "m") for value in scene_of(attributes).get("grid", {}).get("lower", [])]
    return corner if np.all(np.isfinite(corner)) else []


def reference_of(attributes: Mapping[str, Any]) -> Reference | None:
    """Recognise the scene of a result.

    Parameters
    ----------
    attributes
        Root attributes of a run, or those of a comparison, with the ``scene``.

    Returns
    -------
    RollingReference, RingsReference or None
        A single free disc, at rest at the start, on one fixed rectangle along x with gravity given as
        magnitude and tilt rolls. Two rings with the properties, sizes and velocities of the shipped reference,
        under no load, are that collision. Everything else has no reference.
    """
    scene = scene_of(attributes)
    bodies = scene.get("bodies", {})
    if len(bodies) != 2:
        return None
    declared = scene.get("reference", {}).get("kind")
    if (found := _rolling(scene, bodies)) is not None:
        return found if declared in (None, "rolling-cylinder") else None
    return _rings(scene, bodies) if declared in (None, "colliding-rings") else None


def _rolling(scene: Mapping[str, Any], bodies: Mapping[str, Any]) -> RollingReference | None:
    discs = [
        name
        for name, body in bodies.items()
        if _geometry(body).get("type") == "disc" and not body.get("sides") and _at_rest(body)
    ]
    planes = [name for name, body in bodies.items() if _is_plane(body)]
    gravity = scene.get("gravity", {})
    if len(discs) != 1 or len(planes) != 1 or gravity.keys() != {"magnitude", "tilt"}:
        return None
    radius = _si(_geometry(bodies[discs[0]]).get("radius"), "m")
    tilt, g = _si(gravity["tilt"], "rad"), _si(gravity["magnitude"], "m/s^2")
    values = (radius, tilt, g, _friction(scene))
    if not np.all(np.isfinite(values)) or tilt <= 0.0:
        return None
    return RollingReference(discs[0], rolling_solution(tilt, _friction(scene), g, radius))


def _rings(scene: Mapping[str, Any], bodies: Mapping[str, Any]) -> RingsReference | None:
    expected = {"K": 121.7e6, "G": 26.1e6, "rho": 1010.0, "inner": 0.03, "outer": 0.04, "speed": 30.0}
    if scene.get("gravity"):
        return None
    centres: dict[str, list[float]] = {}
    velocities: dict[str, list[float]] = {}
    for name, body in bodies.items():
        geometry, material = _geometry(body), scene.get("materials", {}).get(body.get("material"), {})
        velocity = [_si(component, "m/s") for component in body.get("velocity", [])]
        if geometry.get("type") != "ring" or material.get("model") != "neo_hookean" or len(velocity) != 2:
            return None
        if material.get("energy", "split") != "split" or body.get("sides") or not _spinless(body):
            return None
        found = {
            "K": _si(material.get("bulk_modulus"), "Pa"),
            "G": _si(material.get("shear_modulus"), "Pa"),
            "rho": _si(material.get("density"), "kg/m^3"),
            "inner": _si(geometry.get("inner_radius"), "m"),
            "outer": _si(geometry.get("outer_radius"), "m"),
            "speed": abs(velocity[0]),
        }
        if not all(np.isclose(found[key], expected[key], rtol=1e-9) for key in expected):
            return None
        centres[name] = [_si(x, "m") for x in geometry.get("centre", [])]
        velocities[name] = velocity
    # contact_force is on the pair's first body: only with the left one first does the reference's sign hold
    first, second = centres
    apart = np.subtract(centres[second], centres[first])
    along_x = np.allclose(apart, [2.0 * expected["outer"] + 0.004, 0.0], atol=1e-9)
    towards = np.allclose([velocities[first], velocities[second]], [[30.0, 0.0], [-30.0, 0.0]])
    return RingsReference(first, second) if along_x and towards else None


def _geometry(body: Mapping[str, Any]) -> Mapping[str, Any]:
    geometry = body.get("geometry", {})
    return geometry if isinstance(geometry, Mapping) else {}


def _is_plane(body: Mapping[str, Any]) -> bool:
    """A rectangle along the axes that fixed sides, and nothing else, hold."""
    geometry, sides = _geometry(body), body.get("sides", [])
    return (
        geometry.get("type") == "rectangle"
        and _si(geometry.get("angle", 0.0), "rad") == 0.0
        and all("fixed" in side for side in sides)
        and any(side.get("fixed") is True for side in sides)
        and _at_rest(body)
    )


def _at_rest(body: Mapping[str, Any]) -> bool:
    return _spinless(body) and all(_si(component, "m/s") == 0.0 for component in body.get("velocity", []))


def _spinless(body: Mapping[str, Any]) -> bool:
    return _si(body.get("angular_velocity", 0.0), "rad/s") == 0.0


def _friction(scene: Mapping[str, Any]) -> float:
    contact = scene.get("contact", {})
    pairs = contact.get("pairs", [])
    return _si(pairs[0].get("friction") if pairs else contact.get("friction"), "1")


def _si(value: object, unit: str) -> float:
    if value is None:
        return float("nan")
    try:
        number = to_si(value, unit)
    except ValueError:
        return float("nan")
    return float(number) if isinstance(number, int | float) else float("nan")


@functools.cache
def rings_table(name: str) -> dict[str, FloatArray]:
    """Columns of a shipped reference table, ``force`` or ``energy``; ``time`` in s added.

    Raises
    ------
    FileNotFoundError
        There is no such table.
    """
    text = files("mpmfw").joinpath("reference", f"rings_fem_{name}.csv").read_text(encoding="utf-8")
    table = np.genfromtxt(StringIO(text), delimiter=",", names=True)
    return {**{column: table[column] for column in table.dtype.names or ()}, "time": 1e-3 * table["time_ms"]}
