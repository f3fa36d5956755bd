"""What may be asked of a map of stability."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

from mpmfw.campaigns.grid import given_twice, has_option
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import Scene
from mpmfw.scene.override import parse_path
from mpmfw.scene.problem import Path
from mpmfw.scene.sources import walk
from mpmfw.scene.specification import keys_of

Axis: TypeAlias = Literal["kappa", "ratio"]

#: Tables and keys that a map sets itself, and why.
_OWN: dict[Path, str] = {
    ("time",): "its steps are those of cfl, and as many as steps says",
    ("output",): "it records what it judges by",
    ("allow_unstable",): "it goes past the limit in any case",
}


def axis_of(scene: Scene, contact: Any, kappa: Sequence[float] | None, ratio: Sequence[float] | None) -> Axis:
    """Return what is varied beside the Courant number."""
    if kappa is not None and ratio is not None:
        raise SceneError("kappa and ratio: a map has one of them; leave the other out")
    if ratio is not None:
        return "ratio"
    method = scene.contact.method if scene.contact is not None else "none"
    if not has_option("contact", method if contact is None else contact, "kappa"):
        name = method if contact is None else contact.name
        raise SceneError(f"contact '{name}' has no kappa; give stiffness ratios instead")
    return "kappa"


def check_values(values: Sequence[float], cfl: Sequence[float], steps: int) -> None:
    """Refuse values that are not positive or repeat, and too few steps."""
    for name, given in (("kappa or ratio", values), ("cfl", cfl)):
        if not given or not all(math.isfinite(value) and value > 0.0 for value in given):
            raise SceneError(f"{name}: expected numbers greater than 0")
        if given_twice(given):
            raise SceneError(f"{name}: a value is given twice")
    if steps < 2:
        raise SceneError(f"steps: {steps} are too few to judge")


def check_overrides(scene: Scene, axis: Axis) -> None:
    """Refuse overrides of keys that the map sets itself."""
    own = dict(_OWN)
    if axis == "kappa" and scene.contact is not None:
        own["contact", scene.contact.method, "kappa"] = "it varies kappa: give the values as kappa"
    for key, value in scene.source.overrides.items():
        for path, given in (keys_of(key, value) or {parse_path(key): value}).items():
            for at, _ in walk(given, path):
                for taken, why in own.items():
                    if at[: len(taken)] == taken:
                        raise SceneError(f"--set {key}: has no effect on a map of stability: {why}")


def stiffness_ratio(scene: Scene, ratio: float) -> dict[str, Any]:
    """Return overrides that make M = K + 4 G / 3 of the second body ``ratio`` times that of the first.

    Poisson's ratio stays; the second body gets a separate material."""
    if len(scene.bodies) < 2:
        raise SceneError("a stiffness ratio needs a scene of two bodies or more")
    first, second = Simulation(scene.with_overrides({"allow_unstable": True})).state.bodies[:2]
    material = scene.bodies[second.name].material
    table = scene.to_mapping()["materials"][material]
    table = {key: value for key, value in table.items() if key not in ("youngs_modulus", "poissons_ratio")}
    if not hasattr(scene.materials[material].options, "bulk_modulus"):
        raise SceneError(f"materials.{material}: has no bulk_modulus and shear_modulus to change")
    factor = ratio * first.p_wave_modulus / second.p_wave_modulus
    moduli = {"bulk_modulus": factor * second.bulk_modulus, "shear_modulus": factor * second.shear_modulus}
    name = f"{second.name}_of_ratio"
    return {f"materials.{name}": {**table, **moduli}, f"bodies.{second.name}.material": name}
