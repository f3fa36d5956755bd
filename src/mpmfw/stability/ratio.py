"""Another stiffness of a scene's second body."""

from __future__ import annotations

from typing import Any

from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import Scene


def stiffness_ratio(scene: Scene, ratio: float) -> dict[str, Any]:
    """Values by dotted key that make the second body ``ratio`` times as stiff as the first; Poisson's ratio stays.

    Parameters
    ----------
    scene
        Its second body gets a material of its own.
    ratio
        Of M = K + 4 G / 3.

    Raises
    ------
    SceneError
        There is no second body, or its material has no moduli by these names.
    """
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
