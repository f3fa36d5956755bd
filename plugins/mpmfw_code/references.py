"""Closed forms of the arena's scenes: a cylinder on a turned plane, and a block that comes to rest."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mpmfw.api import About
from mpmfw.api.code import Scene
from mpmfw.api.results import Exact, Reference


class TurnedCylinder(Reference):
    """A rigid cylinder that rolls from rest down a rigid rectangle, which may be turned against the grid.

    With the angle θ of gravity to the plane's normal: a = g (sin θ − μ cos θ) and α = 2 μ g cos θ / R if
    tan θ > 3 μ, a = 2/3 g sin θ = α R otherwise."""

    name = "turned-cylinder"

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:
        """Return displacement and acceleration along an axis, and spin."""
        (body,) = (one for one in scene.bodies.values() if not one.prescribed)
        (plane,) = (one for one in scene.bodies.values() if one.prescribed)
        geometry: Any = body.geometry
        turned, end = float(getattr(plane.geometry, "angle", 0.0)), float(scene.time.end)
        along = np.array([math.cos(turned), math.sin(turned)])
        across = np.array([-along[1], along[0]])
        gravity = np.zeros(2) if scene.gravity is None else np.array(scene.gravity.at(0.0))
        push, weight, friction = float(gravity @ along), -float(gravity @ across), scene.pairs[0][2]
        acceleration, turning = 2.0 / 3.0 * push, 2.0 / 3.0 * push / geometry.radius
        if push > 3.0 * friction * weight:
            acceleration, turning = push - friction * weight, 2.0 * friction * weight / geometry.radius
        axis = "xyz".index(about.axis or "x")
        values = {
            "end-displacement": 0.5 * acceleration * end**2 * along[axis],
            "acceleration": acceleration * along[axis],
            "spin": -turning * end,
        }
        says = f"a rigid cylinder from rest: {acceleration:.4g} m/s² along the plane, {turning:.4g} rad/s²"
        return _number(values.get(measure), says)


class StoppingBlock(Reference):
    """A rigid block with a velocity along x on a level plane, which friction brings to rest."""

    name = "stopping-block"

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:
        """Return the way on which it stops, v² / (2 μ g)."""
        (body,) = (one for one in scene.bodies.values() if any(one.velocity or ()))
        assert scene.gravity is not None
        assert body.velocity is not None
        braking = -scene.pairs[0][2] * float(scene.gravity.at(0.0)[1])
        way = float(body.velocity[0]) ** 2 / (2.0 * braking)
        known = measure == "end-displacement" and about.axis in (None, "x")
        return _number(way if known else None, f"a rigid block stops after v²/(2 μ g) = {way:.4g} m")


def _number(value: float | None, says: str) -> Exact | None:
    return None if value is None else Exact("closed-form", says, lambda _: np.array([value]))
