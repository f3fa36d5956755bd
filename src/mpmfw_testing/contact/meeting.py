"""The scene of most checks: two bodies that meet, part, or slide along each other."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.plugin.discovery import available
from mpmfw.state.fields import FloatArray
from mpmfw_testing.searching import hypothesis, ladder, search

CELL = 0.1  #: h [m]
EXTENT = 1.5  #: half the edge of the grid [m]
RADIUS = 0.25  #: of discs [m]
DEPTH = 0.4  #: of blocks, along the line from one to the other [m]
WIDTH = 0.8  #: of blocks, along their common face [m]
OFFSET = (
    0.3,
    0.2,
)  #: middle of the first body's face along normal and tangent, from a node of the grid [cells]

BULK_MODULUS = 6e4  #: K of the first body [Pa]
DENSITY = 1000.0  #: ρ of the first body [kg/m^3]
#: c = sqrt((K + 4 G / 3) / ρ) of the first body, with G = K / 2 [m/s].
WAVE_SPEED = math.sqrt(BULK_MODULUS * 5.0 / 3.0 / DENSITY)

#: Segments of a disc's outline: a multiple of four, so that a quarter turn of the scene turns the outline
#: too.
SEGMENTS = 64

#: What the numbers of a case are called in a counterexample.
NAMES = {
    "speed": "speed of approach [m/s]",
    "slide": "sliding speed [m/s]",
    "gap": "gap [cells]",
    "friction": "friction coefficient",
    "heavier": "density of the second body over the first's",
    "stiffer": "stiffness of the second body over the first's",
    "turn": "direction from the first to the second body [deg]",
    "shift": "shift along x [cells]",
    "rise": "shift along y [cells]",
    "form": "bodies",
}


@dataclass(frozen=True)
class Meeting:
    """Two bodies and how they move towards each other.

    Blocks have a common face of eight cells, exactly opposite each other, and turn by quarter turns only;
    discs turn by any angle, and their velocities with them. All lengths are in cells, since methods see
    cells.
    """

    form: str = "blocks"  #: blocks or discs
    speed: float = 1.0  #: of approach [m/s]; negative: the bodies part
    slide: float = (
        0.0  #: of the first body against the second, to the left as seen along the line between them [m/s]
    )
    gap: float = 0.1  #: [cells]
    friction: float = 0.0  #: Coulomb's μ
    heavier: float = 1.0  #: density of the second body over the first's
    stiffer: float = 1.0  #: moduli of the second body over the first's
    turn: float = 0.0  #: direction from the first to the second body [degrees]
    shift: float = 0.0  #: of the whole scene along x [cells]
    rise: float = 0.0  #: of the whole scene along y [cells]

    @property
    def normal(self) -> FloatArray:
        """Unit vector from the first to the second body."""
        exact = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
        angle = math.radians(self.turn)
        return np.array(exact.get(self.turn % 360.0, (math.cos(angle), math.sin(angle))))

    @property
    def tangent(self) -> FloatArray:
        """The normal turned by a quarter to the left."""
        n = self.normal
        return np.array([-n[1], n[0]])

    @property
    def origin(self) -> FloatArray:
        """Middle of the first body's face [m], within a cell unless it is shifted to a grid line."""
        within = OFFSET[0] * self.normal + OFFSET[1] * self.tangent
        return np.asarray(CELL * (within + np.array([self.shift, self.rise])))

    def mapping(self, **keys: Any) -> dict[str, Any]:
        """The scene; ``keys`` are tables beside or in place of its own."""
        relative = self.speed * self.normal + self.slide * self.tangent
        first, second = (self._disc if self.form == "discs" else self._block)()
        return scene(
            {
                "first": body(first, "first", 0.5 * relative, self.form),
                "second": body(second, "second", -0.5 * relative, self.form),
            },
            {"first": material(), "second": material(self.stiffer, self.heavier)},
            self.friction,
            **keys,
        )

    def _disc(self) -> tuple[dict[str, Any], dict[str, Any]]:
        first = self.origin - RADIUS * self.normal
        second = self.origin + (RADIUS + CELL * self.gap) * self.normal
        return disc(first), disc(second)

    def _block(self) -> tuple[dict[str, Any], dict[str, Any]]:
        n, t, at = self.normal, 0.5 * WIDTH * self.tangent, self.origin
        near = at + CELL * self.gap * n
        return rectangle(at - DEPTH * n - t, at + t), rectangle(near - t, near + DEPTH * n + t)

    @property
    def duration(self) -> float:
        """Time of the approach and of three passages of a wave through the slower body and back [s]."""
        approach = CELL * max(self.gap, 0.0) / abs(self.speed) if self.speed else 0.0
        return approach + 6.0 * DEPTH / slowest(self.stiffer, self.heavier)

    @property
    def mass(self) -> tuple[float, float]:
        """Masses of the two bodies [kg/m]."""
        area = math.pi * RADIUS**2 if self.form == "discs" else DEPTH * WIDTH
        return DENSITY * area, self.heavier * DENSITY * area

    @property
    def reduced_mass(self) -> float:
        """m_1 m_2 / (m_1 + m_2) [kg/m]."""
        a, b = self.mass
        return a * b / (a + b)


def slowest(stiffer: float, heavier: float) -> float:
    """Smaller of the two bodies' wave speeds [m/s]."""
    return WAVE_SPEED * min(1.0, math.sqrt(stiffer / heavier))


def material(stiffer: float = 1.0, heavier: float = 1.0) -> dict[str, Any]:
    """A Neo-Hookean solid, by the ratios of its moduli and density to the first body's."""
    return {
        "model": "neo_hookean",
        "density": heavier * DENSITY,
        "bulk_modulus": stiffer * BULK_MODULUS,
        "shear_modulus": 0.5 * stiffer * BULK_MODULUS,
    }


def rectangle(corner: FloatArray, opposite: FloatArray) -> dict[str, Any]:
    """A rectangle between two opposite corners [m]."""
    lower, upper = np.minimum(corner, opposite), np.maximum(corner, opposite)
    return {"type": "rectangle", "lower": lower.tolist(), "upper": upper.tolist()}


def disc(centre: FloatArray) -> dict[str, Any]:
    """A disc [m]."""
    return {"type": "disc", "centre": centre.tolist(), "radius": RADIUS}


def body(
    geometry: dict[str, Any], of: str, velocity: FloatArray | list[float], form: str = "blocks", **keys: Any
) -> dict[str, Any]:
    """A body of particles of half a cell."""
    layout = "fitted" if form == "discs" else "lattice"
    outline = {"segment": 2.0 * math.pi * RADIUS / SEGMENTS * (1.0 + 1e-6)} if form == "discs" else {}
    return {
        "material": of,
        "geometry": geometry,
        "particles": {"layout": layout, "size": 0.5 * CELL},
        "velocity": np.asarray(velocity, dtype=float).tolist(),
        **outline,
        **keys,
    }


def scene(bodies: dict[str, Any], materials: dict[str, Any], friction: float, **keys: Any) -> dict[str, Any]:
    """A scene of bodies round the origin, whose contact is to be given as an object."""
    dim = len(next(iter(bodies.values()))["velocity"])
    return {
        "grid": {"cell_size": CELL, "lower": [-EXTENT] * dim, "upper": [EXTENT] * dim},
        "time": {"end": 1.0, "output_interval": 1.0},
        "shape": {"method": "cpdi"},
        "contact": {
            "method": next(iter(available("contact"))),
            "friction": friction,
        },  # the subject takes its place
        "materials": {
            name: materials[name] for name in dict.fromkeys(b["material"] for b in bodies.values())
        },
        "bodies": bodies,
        "output": {"gap": False, "particles": False, "surface": False},
        **keys,
    }


#: Directions from the first body to the second [degrees]: ladders of :func:`search_meetings`.
TURNS, QUARTERS = (0.0, 345.0, 24), (0.0, 270.0, 4)
#: Ladders of a second body that is heavier and stiffer than the first.
UNEQUAL: dict[str, Any] = {"heavier": (1.0, 9.0, 5), "stiffer": (1.0, 9.0, 5)}


def search_meetings(
    trial: Callable[[Meeting], None],
    form: str = "blocks",
    *,
    examples: int = 8,
    most: int = 40,
    **numbers: Any,
) -> None:
    """Try a property on meetings that differ in some of their ``numbers``.

    A tuple is a ladder, by its first and last number and its rungs, a list has all values; others are the
    same in all.

    Raises
    ------
    Violation
        Of the smallest case that breaks it.
    """
    draw = hypothesis().strategies.sampled_from
    cases = {name: ladder(*given) for name, given in numbers.items() if isinstance(given, tuple)}
    cases |= {name: draw(given) for name, given in numbers.items() if isinstance(given, list)}
    fixed = {"form": form, **{name: given for name, given in numbers.items() if name not in cases}}

    def one(**case: Any) -> None:
        trial(Meeting(**fixed, **case))

    search(cases, one, examples=examples, most=most, names=NAMES)
