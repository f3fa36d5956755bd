"""The scenes: a sphere against a slab, the cap of a larger sphere, or another of its kind, with Chung and
Ooi's numbers.

Slab and cap are free, and so heavy and stiff that they hardly move.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import common
import numpy as np
from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class Sphere:
    """E [Pa], ν, ρ [kg/m³], μ, R [m], and its speed towards the point of contact, v_n [m/s]."""

    young: float
    poisson: float
    density: float
    friction: float
    radius: float
    speed: float

    @property
    def approach(self) -> float:
        """Hertz's largest approach to a rigid plane [m]; half of that of two spheres, K. L. Johnson, Contact
        Mechanics (1985), section 11.4(a)."""
        energy = 0.5 * self.mass * self.speed**2
        return (15.0 * energy * self.compliance / (8.0 * math.sqrt(self.radius))) ** 0.4

    @property
    def contact_time(self) -> float:
        """Hertz's time of contact [s], with a rigid plane or another sphere."""
        return 2.9432 * self.approach / self.speed

    @property
    def force(self) -> float:
        """Hertz's largest force [N], with a rigid plane or another sphere."""
        return 4.0 / 3.0 * math.sqrt(self.radius) / self.compliance * self.approach**1.5

    @property
    def compliance(self) -> float:
        """1 / E* on a rigid plane [1/Pa]"""
        return (1.0 - self.poisson**2) / self.young

    @property
    def mass(self) -> float:
        """m [kg]"""
        return 4.0 / 3.0 * math.pi * self.density * self.radius**3


#: By test and material: their table's numbers; μ = 0 where friction has no part.
SPHERES = {
    "1 glass": Sphere(4.8e10, 0.20, 2800.0, 0.35, 0.01, 10.0),
    "1 limestone": Sphere(2.0e10, 0.25, 2500.0, 0.35, 0.01, 10.0),
    "2 aluminium": Sphere(7.0e10, 0.30, 2699.0, 0.0, 0.1, 0.2),
    "2 magnesium": Sphere(4.0e10, 0.35, 1800.0, 0.0, 0.1, 0.2),
    "4 oxide": Sphere(3.8e11, 0.23, 4000.0, 0.092, 0.0025, 3.9),
    "5 steel": Sphere(2.08e11, 0.30, 7850.0, 0.3, 1e-5, 5.0),
    "6 aluminium": Sphere(7.0e10, 0.33, 2700.0, 0.4, 0.1, 0.2),
    "6 nylon": Sphere(2.5e9, 0.40, 1000.0, 0.4, 0.1, 0.2),
    "7 copper": Sphere(1.2e11, 0.35, 8900.0, 0.4, 0.1, 0.2),
}

#: Slab and cap are so many times as stiff and as dense, and so have the sphere's speed of waves.
HEAVY = 1e4
#: Radius of the larger sphere, half the edge of the slab, and how far apart both begin, over R
LARGER, HALF, GAP = 5.0, 0.35, 0.002

#: Turns of the slab about x, then y, then z [rad]: nothing lies or moves along an axis.
ANGLES = np.radians((20.0, 35.0, 50.0))
_TURN = Rotation.from_euler("xyz", ANGLES).as_matrix()
NORMAL = _TURN @ [0.0, 1.0, 0.0]  #: from the point of contact towards the sphere
#: Where the sphere's point of contact goes along the plane
ALONG = _TURN @ [math.cos(0.5), 0.0, math.sin(0.5)]
ACROSS = np.cross(NORMAL, ALONG)
#: Where on the grid the point of contact is, over R: no corner of it
POINT = np.array([0.013, -0.021, 0.034])


def scene(
    test: str,
    cells: float,
    partner: Literal["slab", "cap", "twin"] = "slab",
    angle: float = 0.0,
    spin: float = 0.0,
    sense: int = 1,
    pace: float = 1.0,
) -> dict[str, Any]:
    """A sphere of ``SPHERES``, ``cells`` to the radius, until it has left its partner.

    It is thrown at ``angle`` [°] to the normal, with v_n and v_t = v_n tan θ, and turns by ``spin`` [rad/s]
    so that its point of contact goes the same way; the other one's goes the opposite way, or, for a ``sense``
    of -1, the same. All velocities are ``pace`` times those."""
    sphere = SPHERES[test]
    sphere, spin = replace(sphere, speed=pace * sphere.speed), pace * spin
    radius, h, slope = sphere.radius, sphere.radius / cells, math.tan(math.radians(angle))
    flight = GAP * radius / sphere.speed
    way = slope * (GAP * radius + 0.5 * sphere.speed * sphere.contact_time)  # half of it before the middle
    point, end = POINT * radius, flight + 1.5 * sphere.contact_time
    apart = (1.0 + GAP) * radius * NORMAL
    thrown = {
        **_ball(point + apart - way * ALONG, radius),
        "velocity": (sphere.speed * (slope * ALONG - NORMAL)).tolist(),
        "angular_velocity": (-spin * ACROSS).tolist(),
    }
    twin = {
        **_ball(point - apart, radius),
        "velocity": (sphere.speed * NORMAL).tolist(),
        "angular_velocity": (-sense * spin * ACROSS).tolist(),
    }
    partners = {"slab": _slab(point, radius, h), "cap": _cap(point, radius, h), "twin": twin}
    return common.scene(
        *(h, [-2.6 * radius] * 3, [2.6 * radius] * 3, end, end / 240.0, _solid(sphere, 1.0)),
        bodies={"sphere": thrown, partner: partners[partner]},
        title=f"Impact of a sphere, {test}",
        contact={"friction": sphere.friction},
        materials={"heavy": _solid(sphere, HEAVY)},
        output={"particles": False, "surface": False, "ledger": True, "contact_moment": point.tolist()},
    )


def _solid(sphere: Sphere, times: float) -> dict[str, Any]:
    return common.elastic(times * sphere.density, times * sphere.young, sphere.poisson, "neo_hookean")


def _ball(centre: np.ndarray, radius: float) -> dict[str, Any]:
    return _body("solid", {"type": "ball", "centre": centre.tolist(), "radius": radius}, "lattice")


def _slab(face: np.ndarray, radius: float, h: float) -> dict[str, Any]:
    """Two cells thick, with the middle of its face at ``face``."""
    middle, edges = face - h * NORMAL, np.array([HALF * radius, h, HALF * radius])
    box = {"lower": (middle - edges).tolist(), "upper": (middle + edges).tolist(), "angles": ANGLES.tolist()}
    return _body("heavy", {"type": "box", **box}, "fitted")


def _cap(top: np.ndarray, radius: float, h: float) -> dict[str, Any]:
    """Of the larger sphere, two cells thick, with its top at ``top``."""
    outer, angles = LARGER * radius, np.linspace(0.0, math.asin(HALF / LARGER), 9)
    arc = np.column_stack([outer * np.sin(angles), outer * (np.cos(angles) - 1.0)])
    ends = np.array([[0.0, -2.0 * h], [HALF * radius, -2.0 * h]])
    outline = {"type": "polygon", "points": np.concatenate([ends, arc[::-1]]).tolist()}
    turned = {"axis": "y", "origin": top.tolist(), "angles": ANGLES.tolist()}
    return _body("heavy", {"type": "revolution", "outline": outline, **turned}, "lattice")


def _body(material: str, geometry: dict[str, Any], layout: str) -> dict[str, Any]:
    particles = {"layout": layout, "size": "0.5 cells"}
    return {"material": material, "geometry": geometry, "particles": particles, "segment": "0.5 cells"}
