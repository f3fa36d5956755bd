"""Closed forms of the arena's scenes: a cylinder on a turned plane, and a block that comes to rest."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mpmfw.api import About, FloatArray, SceneError
from mpmfw.api.code import Scene
from mpmfw.api.results import Exact, Reference


class OnRigidPlane(Reference):
    """Base: one deformable body on a rigid one at rest, under constant gravity and Coulomb's friction."""

    def need(self, holds: bool, expected: str) -> None:
        """Refuse the scene unless a condition ``holds``."""
        if not holds:
            raise SceneError(f"reference.kind: '{self.name}' does not apply: {expected}")

    def pair(self, scene: Scene) -> tuple[Any, Any, float]:
        """Return the body, the plane and their friction."""
        bodies = list(scene.bodies.values())
        free, planes = ([one for one in bodies if one.prescribed is held] for held in (False, True))
        self.need(len(free) == len(planes) == 1, "expected one body on one rigid plane")
        (body,), (plane,) = free, planes
        self.need(getattr(plane, "rigid", None) is True, "expected a plane at rest")
        self.need(
            not body.sides and not scene.loads and not scene.boundaries, "expected no loads or held parts"
        )
        self.need(not getattr(body, "rigid", False), "expected a deformable body")
        self.need(scene.has_coulomb_friction and bool(scene.pairs), "expected Coulomb's friction")
        return body, plane, scene.pairs[0][2]

    def gravity(self, scene: Scene) -> FloatArray:
        """Return constant gravity (2,) [m/s²]."""
        constant = scene.dim == 2 and scene.gravity is not None and scene.gravity.is_constant
        self.need(constant, "expected constant gravity in the plane")
        assert scene.gravity is not None
        return np.array(scene.gravity.at(0.0))


class TurnedCylinder(OnRigidPlane):
    """A rigid cylinder that rolls from rest down a rigid rectangle, which may be turned against the grid.

    With the angle θ of gravity to the plane's normal: a = g (sin θ − μ cos θ) and α = 2 μ g cos θ / R if
    tan θ > 3 μ, a = 2/3 g sin θ = α R otherwise."""

    name = "turned-cylinder"

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:
        """Return displacement and acceleration along an axis, and spin."""
        body, plane, friction = self.pair(scene)
        geometry: Any = body.geometry
        self.need(geometry.type == "disc" and not any(body.velocity or ()), "expected a disc at rest")
        self.need(plane.geometry.type == "rectangle", "expected a plane that is a rectangle")
        turned, end = float(plane.geometry.angle), float(scene.time.end)
        along = np.array([math.cos(turned), math.sin(turned)])
        across = np.array([-along[1], along[0]])
        gravity = self.gravity(scene)
        push, weight = float(gravity @ along), -float(gravity @ across)
        self.need(weight > 0.0, "expected gravity towards the plane")
        braking = min(friction * weight, abs(push) / 3.0)  # all of Coulomb's friction where it slips
        acceleration = push - math.copysign(braking, push)
        turning = math.copysign(2.0 * braking, push) / geometry.radius
        axis = "xyz".index(about.axis or "x")
        values = {
            "end-displacement": 0.5 * acceleration * end**2 * along[axis],
            "acceleration": acceleration * along[axis],
            "spin": -turning * end,
        }
        says = f"a rigid cylinder from rest: {acceleration:.4g} m/s² along the plane, {turning:.4g} rad/s²"
        return _number(values.get(measure), says)


class StoppingBlock(OnRigidPlane):
    """A rigid block with a velocity along x on a level plane, which friction brings to rest."""

    name = "stopping-block"

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:
        """Return the way until it stops after v / (μ g), or until the run ends."""
        body, plane, friction = self.pair(scene)
        gravity, velocity = self.gravity(scene), body.velocity or (0.0, 0.0)
        level = plane.geometry.type == "rectangle" and plane.geometry.angle == 0.0
        self.need(level and gravity[0] == velocity[1] == 0.0 > gravity[1], "expected a level rectangle")
        self.need(friction > 0.0 and velocity[0] != 0.0, "expected friction and a velocity along x")
        speed, braking = abs(float(velocity[0])), -friction * float(gravity[1])
        time = min(speed / braking, float(scene.time.end))
        way = math.copysign(speed * time - 0.5 * braking * time**2, velocity[0])
        known = measure == "end-displacement" and about.axis in (None, "x")
        return _number(way if known else None, f"a rigid block that friction stops: {way:.4g} m at the end")


def _number(value: float | None, says: str) -> Exact | None:
    return None if value is None else Exact("closed-form", says, lambda _: np.array([value]))
