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

from mpmfw.errors import MpmfwError
from mpmfw.geometry import Ball, Box, Disc, Rectangle, Ring
from mpmfw.results.analysis import RollingSolution, rolling_solution
from mpmfw.scene import Body, Scene, load_scene
from mpmfw.scene.content import code_in
from mpmfw.scene.override import merge, parse_value
from mpmfw.state.fields import FloatArray
from mpmfw.units import to_si

#: Where the cylinder's motion is given.
EQUATION = " (eq. 13 of Hamad, Giridharan & Moormann 2017, Procedia Engineering 175, 116-123)"


@dataclass(frozen=True)
class RollingReference:
    """A disc or a ball that rolls down a fixed plane under tilted gravity."""

    body: str  #: the disc or ball
    solution: RollingSolution
    distance: float = 10.0  #: at which the displacement is judged [m]
    rigid: str = "cylinder"  #: what the solution is of

    def describe(self) -> str:
        """Say in one sentence what the results are compared with."""
        solution = self.solution
        return (
            f"a rigid {self.rigid} that {'slips' if solution.slips else 'rolls without slip'}, from rest"
            f"{EQUATION if self.rigid == 'cylinder' else ''}: acceleration "
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
            "of 2 mm); an impact's force changes as fast as noise, and theirs has 79 % of it with outputs every 10 µs"
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
    texts = (str(array.attrs["against"]) for array in dataset.data_vars.values() if "against" in array.attrs)
    if text := "; ".join(dict.fromkeys(texts)):
        return text
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
        Of :func:`rolling` or :func:`rings`, unless the scene declares another kind; everything else has none
        here.
    """
    scene = scene_of_results(attributes)
    if scene is None:
        return None
    declared = None if scene.reference is None else scene.reference.kind
    if declared in (None, "rolling-cylinder") and (found := rolling(scene)) is not None:
        return found
    if declared in (None, "rolling-sphere") and (found := rolling_sphere(scene)) is not None:
        return found
    return rings(scene) if declared in (None, "colliding-rings") else None


#: Stands for a material whose code is not imported.
_RIGID = {"model": "neo_hookean", "density": 1.0, "bulk_modulus": 1.0, "shear_modulus": 1.0}


def scene_of_results(attributes: Mapping[str, Any]) -> Scene | None:
    """The scene of a run's or a comparison's ``attributes``; None where it cannot be read here."""
    text = attributes.get("scene")
    return _loaded(text) if isinstance(text, str) else None


@functools.lru_cache(maxsize=64)
def _loaded(text: str) -> Scene | None:
    """The scene of a result without its methods, which no reference depends on; None where it cannot be read
    here.

    Code that a result names is not imported.
    """
    scene = scene_of({"scene": text})
    contact, materials = scene.get("contact"), scene.get("materials")
    scene = {key: table for key, table in scene.items() if key != "stepping"} | {
        "shape": {"method": "linear"}
    }
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


def rolling(scene: Scene) -> RollingReference | None:
    """A single free disc, at rest at the start, on one fixed rectangle along x, with gravity by magnitude
    and tilt.
    """
    discs = [
        n for n, b in scene.bodies.items() if isinstance(b.geometry, Disc) and not b.sides and at_rest(b)
    ]
    planes = [name for name, body in scene.bodies.items() if _is_plane(body)]
    tilted = tilt_of(scene)
    if (
        len(scene.bodies) != 2
        or len(discs) != 1
        or len(planes) != 1
        or tilted is None
        or scene.contact is None
        or not scene.has_coulomb_friction
    ):
        return None
    magnitude, tilt = tilted
    geometry = scene.bodies[discs[0]].geometry
    if tilt <= 0.0 or not isinstance(geometry, Disc):
        return None
    return RollingReference(
        discs[0], rolling_solution(tilt, scene.pairs[0][2], magnitude, float(geometry.radius))
    )


def rolling_sphere(scene: Scene) -> RollingReference | None:
    """A single free ball, at rest at the start, on one fixed box along the axes, gravity towards +x and
    −y; judged at the end.
    """
    balls = [
        n for n, b in scene.bodies.items() if isinstance(b.geometry, Ball) and not b.sides and at_rest(b)
    ]
    planes = [name for name, body in scene.bodies.items() if _is_plane(body)]
    vector = None if scene.gravity is None or not scene.gravity.is_constant else scene.gravity.vector
    if (
        (len(scene.bodies), len(balls), len(planes)) != (2, 1, 1)
        or vector is None
        or len(vector) != 3
        or scene.contact is None
        or not scene.has_coulomb_friction
    ):
        return None
    along, down, across = (float(part) for part in vector)
    geometry = scene.bodies[balls[0]].geometry
    if along <= 0.0 or down >= 0.0 or across != 0.0 or not isinstance(geometry, Ball):
        return None
    tilt, g = float(np.arctan2(along, -down)), float(np.hypot(along, down))
    solution = rolling_solution(tilt, scene.pairs[0][2], g, float(geometry.radius), inertia=0.4)
    return RollingReference(
        balls[0], solution, distance=float(solution.displacement(scene.time.end)), rigid="sphere"
    )


def tilt_of(scene: Scene) -> tuple[float, float] | None:
    """Magnitude [m/s²] and tilt [rad] of a gravity that is given by both; None of any other."""
    magnitude, tilt = (getattr(scene.gravity, name, None) for name in ("magnitude", "tilt"))
    return None if magnitude is None or tilt is None else (float(magnitude), float(tilt))


def rings(scene: Scene) -> RingsReference | None:
    """Two rings with the properties, sizes and velocities of the shipped reference, under no load."""
    if scene.gravity is not None or len(scene.bodies) != 2:
        return None
    expected = (121.7e6, 26.1e6, 1010.0, 0.03, 0.04)
    for body in scene.bodies.values():
        material, ring = scene.materials[body.material], body.geometry
        options: Any = material.options
        if (
            not isinstance(ring, Ring)
            or material.model != "neo_hookean"
            or options.energy != "split"
            or body.sides
        ):
            return None
        found = (
            options.bulk_modulus,
            options.shear_modulus,
            material.density,
            ring.inner_radius,
            ring.outer_radius,
        )
        spins = body.angular_velocity is not None and np.any(body.angular_velocity)
        if not np.allclose(np.array(found, dtype=float), expected, rtol=1e-9, atol=0.0) or spins:
            return None
    # contact_force is on the pair's first body: only with the left one first does the reference's sign hold
    (first, left), (second, right) = scene.bodies.items()
    apart = np.subtract(right.geometry.centre, left.geometry.centre)  # type: ignore[union-attr]
    along_x = np.allclose(apart, [2.0 * expected[-1] + 0.004, 0.0], atol=1e-9)
    velocities = [left.velocity or (0.0, 0.0), right.velocity or (0.0, 0.0)]
    towards = np.allclose(np.array(velocities, dtype=float), [[30.0, 0.0], [-30.0, 0.0]])
    return RingsReference(first, second) if along_x and towards else None


def _is_plane(body: Body) -> bool:
    """A rectangle or box along the axes that fixed sides, and nothing else, hold."""
    shape = body.geometry
    return (
        (
            (isinstance(shape, Rectangle) and shape.angle == 0.0)
            or (isinstance(shape, Box) and not any(shape.angles))
        )
        and all(side.fixed for side in body.sides)
        and any(side.fixed is True for side in body.sides)
        and at_rest(body)
    )


def at_rest(body: Body) -> bool:
    """Whether a body neither moves nor turns at the start."""
    spin = body.angular_velocity
    return not any(body.velocity or ()) and not np.any(0.0 if spin is None else spin)


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
