"""Scenes that the search found to break an invariant, with what it was; none does any more."""

from __future__ import annotations

from typing import Any

from hard_scenes import CELL, scene


def _pair(
    left: dict[str, Any],
    velocity: tuple[float, float],
    right: dict[str, Any],
    other: tuple[float, float, float],
    friction: float,
) -> dict[str, Any]:
    """A moving body of the usual material and one at rest of another: density [kg/m³], K and G [Pa]."""
    density, bulk, shear = other
    layout = "fitted" if left["type"] == "disc" else "lattice"
    material = {"model": "neo_hookean", "density": density, "bulk_modulus": bulk, "shear_modulus": shear}
    bodies = {
        "left": _body(left, "usual", velocity, layout),
        "right": _body({"type": "rectangle", **right}, "other", (0.0, 0.0), "lattice"),
    }
    return scene(bodies, friction=friction, materials={"other": material})


def _body(
    geometry: dict[str, Any], material: str, velocity: tuple[float, float], layout: str
) -> dict[str, Any]:
    particles = {"layout": layout, "size": 0.5 * CELL}
    return {"material": material, "geometry": geometry, "particles": particles, "velocity": list(velocity)}


#: Name → shape function and scene. In all three a surface node came in by the side of a corner, where no
#: segment faced it, and met a spring that was loaded to its whole depth at once: 5 %, 1.5 % and 0.9 % more
#: energy than at the start.
FOUND: dict[str, tuple[str, dict[str, Any]]] = {
    "square-on-soft-square": (
        "cpdi2",
        _pair(
            {
                "type": "rectangle",
                "lower": [-0.0833569, 0.0445115],
                "upper": [0.0201809, 0.148049],
                "angle": 0.387039,
            },
            (0.464717, 0.542622),
            {"lower": [0.0929444, 0.0311513], "upper": [0.231544, 0.16975], "angle": 0.387039},
            (3582.73, 12776.0, 19164.0),
            0.0,
        ),
    ),
    "disc-on-soft-square": (
        "cpdi",
        _pair(
            {"type": "disc", "centre": [0.0664077, -0.110593], "radius": 0.142971},
            (0.141381, 0.73404),
            {"lower": [-0.0581206, 0.0717357], "upper": [0.073964, 0.20382], "angle": 1.50573},
            (1580.3, 14744.5, 10324.5),
            0.6,
        ),
    ),
    "small-disc-at-a-corner": (
        "cpdi2",
        _pair(
            {"type": "disc", "centre": [-0.0208826, -0.0569936], "radius": 0.0517689},
            (1.71775, 2.00571),
            {"lower": [0.0411756, 0.0311513], "upper": [0.179775, 0.16975], "angle": 0.387039},
            (262.224, 12776.0, 19164.0),
            0.0,
        ),
    ),
}
