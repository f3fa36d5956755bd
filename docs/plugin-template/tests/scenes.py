"""Scenes of the tests, as mappings."""

from __future__ import annotations

from typing import Any

CELL = 0.1  # m
YOUNG, DENSITY = 1e6, 1000.0  # Pa, kg/m³
SPEED_OF_SOUND = (YOUNG / DENSITY) ** 0.5  # m/s, of a bar without lateral contraction


def bars(
    speed: float = 0.3,
    gap: float = 0.03,
    steps: int = 300,
    friction: float = 0.0,
    slide: float = 0.0,
    **options: Any,
) -> dict[str, Any]:
    """Two equal bars of ten cells that meet end on, every step recorded; ν = 0, so that waves in them are one-dimensional."""

    def bar(left: float, velocity: list[float]) -> dict[str, Any]:
        corners = {"lower": [left, 0.02], "upper": [left + 1.0, 0.32]}
        return {
            "material": "elastic",
            "geometry": {"type": "rectangle", **corners},
            "particles": {"layout": "fitted", "size": 0.5 * CELL},
            "segment": 0.25 * CELL,
            "velocity": velocity,
            "rotation": "lumped",
        }

    step = 0.4 * CELL / SPEED_OF_SOUND
    return {
        "grid": {"cell_size": CELL, "lower": [-2.0, -0.8], "upper": [2.0, 1.2]},
        "time": {"end": steps * step, "step": step, "output_interval": step},
        "shape": {"method": "cpdi"},
        "contact": {"method": "surface_impulse", "friction": friction, "surface_impulse": options},
        "materials": {
            "elastic": {
                "model": "neo_hookean",
                "density": DENSITY,
                "bulk_modulus": YOUNG / 3.0,
                "shear_modulus": YOUNG / 2.0,
            }
        },
        "bodies": {
            "left": bar(-1.0 - 0.5 * gap, [0.5 * speed, slide]),
            "right": bar(0.5 * gap, [-0.5 * speed, 0.0]),
        },
        "output": {"gap": True, "energy": True, "ledger": True, "particles": False, "surface": False},
    }
