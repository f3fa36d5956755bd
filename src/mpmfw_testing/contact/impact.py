"""The scene of most checks: two bodies that meet, part, or slide along each other; and other bodies."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.contact.strategy import ContactStrategy
from mpmfw.plugin.discovery import available
from mpmfw.state.fields import FloatArray
from mpmfw_testing.searching import hypothesis, ladder, search

CELL = 0.1  #: h [m]
EXTENT = 1.5  #: half the edge of the grid [m]
RADIUS = 0.25  #: of discs [m]
DEPTH = 0.4  #: of blocks, along the line from one to the other [m]
WIDTH = 0.8  #: of blocks, along their common face [m]
#: Middle of the first body's face along normal and tangent, from a node of the grid [cells].
OFFSET = (0.3, 0.2)

BULK_MODULUS = 6e4  #: K of the first body [Pa]
DENSITY = 1000.0  #: ρ of the first body [kg/m^3]
#: c = sqrt((K + 4 G / 3) / ρ) of the first body, with G = K / 2 [m/s].
WAVE_SPEED = math.sqrt(BULK_MODULUS * 5.0 / 3.0 / DENSITY)

#: Segments of a disc's outline: a multiple of four, so that a quarter turn of the scene turns it too.
SEGMENTS = 64

#: Names of a case's numbers in a counterexample.
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


class NoInteraction(ContactStrategy):
    """A velocity field for each body without interaction, as a reference."""

    name = "no-interaction"
    keeps_apart = False


@dataclass(frozen=True)
class Impact:
    """Two bodies and how they move towards each other.

    Blocks have a common face of eight cells, exactly opposite each other, and turn by quarter turns only;
    discs turn by any angle, and their velocities with them. Lengths are in cells, since methods see cells.
    """

    form: str = "blocks"  #: blocks or discs
    speed: float = 1.0  #: of approach [m/s]; negative: the bodies part
    slide: float = 0.0  #: of the first body against the second, to the left along the line between them [m/s]
    gap: float = 0.1  #: [cells]
    friction: float = 0.0  #: Coulomb's μ
    heavier: float = 1.0  #: density of the second body over the first's
    stiffer: float = 1.0  #: moduli of the second body over the first's
    turn: float = 0.0  #: direction from the first to the second body [degrees]
    shift: float = 0.0  #: of the whole scene along x [cells]
    rise: float = 0.0  #: of the whole scene along y [cells]

    @property
    def normal(self) -> FloatArray:
        """Return the unit vector from the first to the second body."""
        exact = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
        angle = math.radians(self.turn)
        return np.array(exact.get(self.turn % 360.0, (math.cos(angle), math.sin(angle))))

    @property
    def tangent(self) -> FloatArray:
        """Return the normal turned by a quarter to the left."""
        return np.array([-self.normal[1], self.normal[0]])

    @property
    def origin(self) -> FloatArray:
        """Return the middle of the first body's face [m]."""
        within = OFFSET[0] * self.normal + OFFSET[1] * self.tangent
        return np.asarray(CELL * (within + np.array([self.shift, self.rise])))

    def mapping(self, **keys: Any) -> dict[str, Any]:
        """Return the scene; ``keys`` are tables that are added or replaced."""
        relative = self.speed * self.normal + self.slide * self.tangent
        n, t, at = self.normal, 0.5 * WIDTH * self.tangent, self.origin
        near = at + CELL * self.gap * n
        if self.form == "discs":
            centres = (at - RADIUS * n, near + RADIUS * n)
            shapes = [{"type": "disc", "centre": x.tolist(), "radius": RADIUS} for x in centres]
        else:
            shapes = [rectangle(at - DEPTH * n - t, at + t), rectangle(near - t, near + DEPTH * n + t)]
        bodies = {
            name: body(shape, name, sign * 0.5 * relative, self.form)
            for name, shape, sign in zip(("first", "second"), shapes, (1.0, -1.0), strict=True)
        }
        materials = {"first": material(), "second": material(self.stiffer, self.heavier)}
        return scene(bodies, materials, self.friction, **keys)

    @property
    def duration(self) -> float:
        """Return the time of the approach and of six passages of a wave through the slower body [s]."""
        approach = CELL * max(self.gap, 0.0) / abs(self.speed) if self.speed else 0.0
        return approach + 6.0 * DEPTH / (WAVE_SPEED * min(1.0, math.sqrt(self.stiffer / self.heavier)))

    @property
    def mass(self) -> tuple[float, float]:
        """Return the masses of the two bodies [kg/m]."""
        area = math.pi * RADIUS**2 if self.form == "discs" else DEPTH * WIDTH
        return DENSITY * area, self.heavier * DENSITY * area

    @property
    def reduced_mass(self) -> float:
        """Return m_1 m_2 / (m_1 + m_2) [kg/m]."""
        a, b = self.mass
        return a * b / (a + b)


def material(stiffer: float = 1.0, heavier: float = 1.0) -> dict[str, Any]:
    """Return a Neo-Hookean solid, by the ratios of its moduli and density to the first body's."""
    return {
        "model": "neo_hookean",
        "density": heavier * DENSITY,
        "bulk_modulus": stiffer * BULK_MODULUS,
        "shear_modulus": 0.5 * stiffer * BULK_MODULUS,
    }


def rectangle(corner: FloatArray, opposite: FloatArray) -> dict[str, Any]:
    """Return a rectangle between two opposite corners [m]."""
    lower, upper = np.minimum(corner, opposite), np.maximum(corner, opposite)
    return {"type": "rectangle", "lower": lower.tolist(), "upper": upper.tolist()}


def body(
    geometry: dict[str, Any], of: str, velocity: FloatArray | list[float], form: str = "blocks"
) -> dict[str, Any]:
    """Return a body of particles of half a cell."""
    layout = "fitted" if form == "discs" else "lattice"
    outline = {"segment": 2.0 * math.pi * RADIUS / SEGMENTS * (1.0 + 1e-6)} if form == "discs" else {}
    return {
        "material": of,
        "geometry": geometry,
        "particles": {"layout": layout, "size": 0.5 * CELL},
        "velocity": np.asarray(velocity, dtype=float).tolist(),
        **outline,
    }


def scene(bodies: dict[str, Any], materials: dict[str, Any], friction: float, **keys: Any) -> dict[str, Any]:
    """Return a scene of bodies round the origin, whose contact is to be given as an object."""
    dim = len(next(iter(bodies.values()))["velocity"])
    return {
        "grid": {"cell_size": CELL, "lower": [-EXTENT] * dim, "upper": [EXTENT] * dim},
        "time": {"end": 1.0, "output_interval": 1.0},
        "shape": {"method": "cpdi"},
        # the subject takes the method's place
        "contact": {"method": next(iter(available("contact"))), "friction": friction},
        "materials": {body["material"]: materials[body["material"]] for body in bodies.values()},
        "bodies": bodies,
        "output": {"gap": False, "particles": False, "surface": False},
        **keys,
    }


def three_blocks(slide: float = 0.0, heavier: float = 1.0, stiffer: float = 1.0) -> dict[str, Any]:
    """Return three blocks that meet at one spot; the ratios are those of the second and the third."""
    off = CELL * np.array([0.3, 0.2])  # off the grid's lines

    def block(corner: tuple[float, float], of: str, velocity: list[float]) -> dict[str, Any]:
        return body(rectangle(np.array(corner) + off, np.array(corner) + 0.4 + off), of, velocity)

    bodies = {
        "first": block((-0.41, -0.4), "first", [0.8, slide]),
        "second": block((0.0, -0.4), "second", [-0.5, 0.0]),
        "third": block((-0.2, 0.01), "second", [0.0, -0.6]),
    }
    return scene(bodies, {"first": material(), "second": material(stiffer, heavier)}, 0.3)


#: Directions from the first body to the second [degrees]: ladders of :func:`search_impacts`.
TURNS, QUARTERS = (0.0, 345.0, 24), (0.0, 270.0, 4)
#: Ladders of a second body that is heavier and stiffer than the first.
UNEQUAL: dict[str, Any] = {"heavier": (1.0, 9.0, 5), "stiffer": (1.0, 9.0, 5)}


def search_impacts(
    trial: Callable[[Impact], None],
    form: str = "blocks",
    *,
    examples: int = 8,
    most: int = 40,
    **numbers: Any,
) -> None:
    """Try a property on impacts that differ in some of their ``numbers``; raise the smallest violation.

    A tuple is a ladder, by its first and last number and its rungs, a list has all values; others are the
    same in all.
    """
    draw = hypothesis().strategies.sampled_from
    cases = {name: ladder(*given) for name, given in numbers.items() if isinstance(given, tuple)}
    cases |= {name: draw(given) for name, given in numbers.items() if isinstance(given, list)}
    fixed = {"form": form, **{name: given for name, given in numbers.items() if name not in cases}}
    search(cases, lambda **case: trial(Impact(**fixed, **case)), examples=examples, most=most, names=NAMES)
