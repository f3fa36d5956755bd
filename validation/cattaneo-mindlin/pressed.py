"""The scene: a cylinder's underside on a block of the same solid, cut off and guided above."""

from typing import Any

import numpy as np

RADIUS, HALF_WIDTH = 20.0, 1.0  #: of the cylinder, and of the contact that the load is chosen for [m]
YOUNG, POISSON, DENSITY, FRICTION = 1e6, 0.3, 1000.0, 0.3
#: 1/E* = 2 (1 − ν²)/E of two bodies of one solid [Pa]
E_STAR = YOUNG / (2.0 * (1.0 - POISSON**2))
#: P = π E* a² / (4 R) [N/m]; K. L. Johnson, Contact Mechanics (1985), section 4.2(c)
LOAD = np.pi * E_STAR * HALF_WIDTH**2 / (4.0 * RADIUS)
#: Half the width of both bodies, and the height of each [m]
SIDE, HEIGHT = 5.0, 5.0
#: The lowest point of the cylinder: off the grid lines [m]
TOUCH = (0.011, 0.017)
SHEAR, BULK = YOUNG / (2.0 * (1.0 + POISSON)), YOUNG / (3.0 * (1.0 - 2.0 * POISSON))  #: [Pa]
SOLID = {"model": "linear_elastic", "density": DENSITY, "bulk_modulus": BULK, "shear_modulus": SHEAR}
BLOCK = {"lower": [TOUCH[0] - SIDE, TOUCH[1] - HEIGHT], "upper": [TOUCH[0] + SIDE, TOUCH[1]]}
#: Speed of shear waves [m/s]
SHEAR_WAVE = float(np.sqrt(SHEAR / DENSITY))


def scene(crossings: float = 24.0, drift: float = 0.036) -> dict[str, Any]:
    """Pressed by P while it settles, then drawn sideways by ``drift`` [m] in so many crossings of the height
    by shear waves.

    It slides after about 0.8 of that.
    """
    end = crossings * HEIGHT / SHEAR_WAVE
    sides = {"velocity": [drift / end, "free"]}
    return {
        "title": "Cattaneo and Mindlin's partial slip",
        "grid": {"cell_size": 0.1, "lower": [-6.0, -5.5], "upper": [6.5, 6.0]},
        "time": {"end": end, "output_interval": end / 24.0},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": FRICTION},
        "materials": {"solid": SOLID},
        "bodies": {
            "cylinder": {
                "material": "solid",
                "geometry": {"type": "polygon", "points": _cylinder()},
                "particles": {"size": "0.5 cells"},
                "segment": "0.25 cells",
                "sides": [
                    {"side": "left", **sides},
                    {"side": "right", **sides},
                    {"side": "top", "pressure": LOAD / (2.0 * SIDE)},
                ],
            },
            "block": {
                "material": "solid",
                "geometry": {"type": "rectangle", **BLOCK},
                "particles": {"layout": "fitted", "size": "0.5 cells"},
                "segment": "0.25 cells",
                "sides": [
                    {"side": "bottom", "fixed": True},
                    {"side": "left", "fixed": ["x"]},
                    {"side": "right", "fixed": ["x"]},
                ],
            },
        },
        "settle": {"tolerance": 1e-3},
    }


def _cylinder() -> list[list[float]]:
    """The lowest part of the cylinder's outline, straight above."""
    x = np.linspace(-SIDE, SIDE, 201)
    rim = np.column_stack([x, RADIUS - np.sqrt(RADIUS**2 - x**2)])
    return (np.array(TOUCH) + np.vstack([rim, [[SIDE, HEIGHT], [-SIDE, HEIGHT]]])).tolist()
