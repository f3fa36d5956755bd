"""The scene: a sphere that is thrown obliquely at a slab, which is free and so heavy and stiff that it hardly moves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

RADIUS, SPEED, FRICTION = 1.0, 0.1, 0.3  #: of the sphere [m], v_n [m/s] along the slab's normal, μ
YOUNG, POISSON, DENSITY = 1e7, 0.3, 1000.0  #: of the sphere
#: The slab is so many times as stiff and as dense, and so has the sphere's speed of waves.
HEAVY = 1e4
#: E* = E / (1 − ν²) on a rigid plane [Pa]
E_STAR = YOUNG / (1.0 - POISSON**2)
MASS = 4.0 / 3.0 * math.pi * DENSITY * RADIUS**3  #: [kg]
#: Hertz's largest approach [m] and time of contact [s]; K. L. Johnson, Contact Mechanics (1985), section 11.4(a)
APPROACH = (15.0 * MASS * SPEED**2 / (16.0 * E_STAR * math.sqrt(RADIUS))) ** 0.4
CONTACT_TIME = 2.9432 * APPROACH / SPEED

#: Turns of the slab about x, then y, then z [°]: nothing lies or moves along an axis.
ANGLES = (20.0, 35.0, 50.0)
_TURN = Rotation.from_euler("xyz", ANGLES, degrees=True).as_matrix()
NORMAL = _TURN @ [0.0, 1.0, 0.0]  #: of the slab, towards the sphere
ALONG = _TURN @ [math.cos(0.5), 0.0, math.sin(0.5)]  #: where the sphere is thrown to, on the slab
ACROSS = np.cross(NORMAL, ALONG)

#: Half the edge of the slab, how far apart both begin, and where on the grid the slab's face is [m]
HALF, GAP = 0.35, 0.002
FACE = np.array([0.013, -0.021, 0.034])


def scene(angle: float, cells: float) -> dict[str, Any]:
    """Thrown at ``angle`` [°] to the normal, with so many ``cells`` to the radius, until it has left the slab."""
    h, slope = RADIUS / cells, math.tan(math.radians(angle))
    flight, way = GAP / SPEED, slope * (GAP + 0.5 * SPEED * CONTACT_TIME)
    start = FACE + (RADIUS + GAP) * NORMAL - way * ALONG  # half of the way along the slab before its middle
    middle, edges = FACE - h * NORMAL, np.array([HALF, h, HALF])
    end = flight + 1.5 * CONTACT_TIME
    ball = {"type": "ball", "centre": start.tolist(), "radius": RADIUS}
    slab = {
        "type": "box",
        "lower": (middle - edges).tolist(),
        "upper": (middle + edges).tolist(),
        "angles": np.radians(ANGLES).tolist(),
    }
    return {
        "title": "Oblique impact of a sphere",
        "grid": {"cell_size": h, "lower": [-2.6] * 3, "upper": [2.6] * 3},
        "time": {"end": end, "output_interval": end / 60.0},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": FRICTION},
        "materials": {"elastic": _solid(1.0), "heavy": _solid(HEAVY)},
        "bodies": {
            "sphere": {
                **_body("elastic", ball, "lattice"),
                "velocity": (SPEED * (slope * ALONG - NORMAL)).tolist(),
            },
            "slab": _body("heavy", slab, "fitted"),
        },
        "output": {"particles": False, "surface": False, "ledger": True, "contact_moment": [0.0, 0.0, 0.0]},
    }


def _solid(times: float) -> dict[str, Any]:
    return {
        "model": "neo_hookean",
        "density": times * DENSITY,
        "bulk_modulus": times * YOUNG / (3.0 * (1.0 - 2.0 * POISSON)),
        "shear_modulus": times * YOUNG / (2.0 * (1.0 + POISSON)),
    }


def _body(material: str, geometry: dict[str, Any], layout: str) -> dict[str, Any]:
    particles = {"layout": layout, "size": "0.5 cells"}
    return {"material": material, "geometry": geometry, "particles": particles, "segment": "0.5 cells"}
