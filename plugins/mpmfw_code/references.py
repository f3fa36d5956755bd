"""References of the arena's scenes, and the measures that they need beside the bundled ones."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from mpmfw.api import About, FloatArray
from mpmfw.api.code import Scene, elasticity, surface_velocity
from mpmfw.api.results import Exact, Measure, Measured, Reference


class OnRigidPlane(Reference):
    """Base: one deformable body on a rigid one, with Coulomb's friction."""

    def pair(self, scene: Scene) -> tuple[Any, Any, float]:
        """Return the body, the plane and their friction."""
        bodies = list(scene.bodies.values())
        free, planes = ([one for one in bodies if one.prescribed is held] for held in (False, True))
        self.need(len(free) == len(planes) == 1, "expected one body on one rigid plane")
        (body,), (plane,) = free, planes
        self.need(surface_velocity(plane) is not None, "expected a plane at rest, or a belt")
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
        self.need(plane.rigid is True, "expected a plane at rest")
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
        return Exact.number(values.get(measure), says)


class StoppingBlock(OnRigidPlane):
    """A rigid block that moves along x on a level plane or a belt, and that friction brings to rest on it."""

    name = "stopping-block"

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:
        """Return the way until it rests on the plane after v / (μ g), or until the run ends."""
        body, plane, friction = self.pair(scene)
        gravity, velocity = self.gravity(scene), np.array(body.velocity or (0.0, 0.0))
        belt = surface_velocity(plane)
        assert belt is not None
        level = plane.geometry.type == "rectangle" and plane.geometry.angle == 0.0
        level = level and gravity[0] == velocity[1] == belt[1] == 0.0 > gravity[1]
        self.need(level, "expected a level rectangle")
        (speed, _), end, braking = velocity - belt, float(scene.time.end), -friction * float(gravity[1])
        self.need(friction > 0.0 and speed != 0.0, "expected friction and a velocity along x")
        time = min(abs(speed) / braking, end)
        way = speed * time - math.copysign(0.5 * braking * time**2, speed) + float(belt[0]) * end
        known = measure == "end-displacement" and about.axis in (None, "x")
        return Exact.number(
            way if known else None, f"a rigid block that friction stops: {way:.4g} m at the end"
        )


class HertzImpact(OnRigidPlane):
    """A ball that falls on a smooth level plane and leaves it with the same speed, by Hertz.

    δ = (15 m v² / (16 E* √R))^(2/5), time of contact 2.9432 δ / v (Johnson 1985, section 11.4)."""

    name = "hertz-impact"

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:
        """Return the displacement at the end, when the ball has left the plane."""
        body, plane, _ = self.pair(scene)
        name = next(name for name, one in scene.bodies.items() if one is body)
        ball, (x, down, z) = body.geometry, body.velocity or (0.0, 0.0, 0.0)
        self.need(ball.type == "ball" and plane.geometry.type == "box", "expected a ball on a box")
        self.need(scene.gravity is None and down < 0.0 == x == z, "expected no gravity and a velocity down")
        solid = elasticity(scene, name)
        modulus = solid.young / (1.0 - solid.poisson**2)
        mass = 4.0 / 3.0 * math.pi * solid.density * ball.radius**3
        deepest = (15.0 * mass * down**2 / (16.0 * modulus * math.sqrt(ball.radius))) ** 0.4
        contact, end = -2.9432 * deepest / down, float(scene.time.end)
        way = ball.centre[1] - ball.radius - plane.geometry.bounds[1][1]
        self.need(end >= contact - way / down, f"expected an end after {contact - way / down:.4g} s")
        value = -2.0 * way - down * (end - contact)
        known = measure == "end-displacement" and about.axis in (None, "y")
        says = f"Hertz's impact: approach {deepest:.4g} m, contact for {contact:.4g} s"
        return Exact.number(value if known else None, says)


class CollidingDiscs(Reference):
    """Two elastic discs of Sulsky, Chen & Schreyer (1994) that meet head on and part, by finite elements."""

    name = "colliding-discs"
    restitution: ClassVar[float] = 0.9048  #: of elements of 5 mm, by docs/arena/discs_fem.py; 0.9069 of 10 mm

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:  # noqa: ARG002
        discs: list[Any] = [one for one in scene.bodies.values() if one.geometry.type == "disc"]
        two = len(discs) == len(scene.bodies) == 2 == scene.dim
        self.need(two and float(scene.time.end) == 3.0, "expected two discs, for 3 s")
        apart = np.subtract(discs[1].geometry.centre, discs[0].geometry.centre) / (0.6 * math.sqrt(2.0))
        facts = [np.linalg.norm(apart), *(one.geometry.radius / 0.2 for one in discs)]
        for sign, name in zip((1.0, -1.0), scene.bodies, strict=True):
            solid = elasticity(scene, name)
            facts += [solid.young / 1e3, solid.poisson / 0.3, solid.density / 1e3]
            change = np.subtract(scene.bodies[name].velocity or 0.0, sign * math.sqrt(0.02) * apart)
            facts += [1.0 + one for one in change]
        free = scene.gravity is None and not any(one.sides or one.angular_velocity for one in discs)
        self.need(free and np.allclose(facts, 1.0), "expected the discs of Sulsky, which meet head on")
        found = Exact("reference", "finite elements of 5 mm", lambda _: np.array([self.restitution]))
        return found if measure == "restitution" else None


class StripFooting(Reference):
    """A rough rigid strip on undrained soil: the limit load (2 + π) c B (Prandtl 1920), c = σ_y / √3."""

    name = "strip-footing"

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:  # noqa: ARG002
        strips: list[Any] = [one.geometry for one in scene.bodies.values() if one.prescribed]
        soils: list[Any] = [one for one in scene.materials.values() if one.model == "j2"]
        alike = len(strips) == len(soils) == len(scene.materials) == 1 and strips[0].type == "rectangle"
        self.need(alike and scene.gravity is None, "expected a rigid rectangle on weightless j2")
        cohesion = soils[0].options.yield_stress / math.sqrt(3.0)
        load = (2.0 + math.pi) * cohesion * float(np.ptp(strips[0].bounds[:, 0]))
        return Exact.number(load if measure == "reaction" else None, f"Prandtl's limit load, {load:.4g} N/m")


class TaylorBar(Reference):
    """Taylor's bar of copper, 32.4 mm long, R = 3.2 mm, at 227 m/s, for 80 µs.

    Computations of Kamoulakos (1990), Zhu & Cescotto (1995) and others end at 21.26 to 21.66 mm."""

    name = "taylor-bar"

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:  # noqa: ARG002
        """Return the middle of the published lengths."""
        bars: list[Any] = [one for one in scene.bodies.values() if not one.prescribed]
        self.need(len(bars) == 1 and scene.grid.axisymmetric, "expected one body of revolution")
        (bar,), options = bars, scene.materials[bars[0].material].options
        facts = [*np.ravel(bar.geometry.bounds[1]), *(bar.velocity or ()), float(scene.time.end)]
        keys = ("yield_stress", "hardening_modulus", "hardening_exponent", "rate_factor")
        facts += [getattr(options, key, None) or 0.0 for key in keys]
        expected = [3.2e-3, 32.4e-3, 0.0, -227.0, 80e-6, 400e6, 100e6, 1.0, 0.0]
        alike = len(facts) == 9 and np.allclose(facts, expected, rtol=1e-6)
        self.need(alike, "expected Taylor's bar")
        return Exact.number(
            21.46e-3 if measure == "length" else None, "published computations: 21.26 to 21.66 mm"
        )


class Length(Measure):
    """Extent of a body along y at the end, half a point beyond the outermost ones."""

    name, unit, kind = "length", "m", "number"
    keys, particles = ("body",), True

    def of(self, run: xr.DataTree, scene: Scene, about: About) -> Measured:
        """Return the extent of the named body, or of the first that deforms."""
        name = about.body or next(name for name, one in scene.bodies.items() if not one.prescribed)
        last = run[f"particles/{name}"].to_dataset().isel(time=-1)
        height, stretch = last["position"].sel(axis="y").values, last["deformation_gradient"].values[:, 1, 1]
        half = 0.5 * float(scene.bodies[name].particles.size) * stretch
        return Measured(np.array([float((height + half).max() - (height - half).min())]), np.empty(0))


class Restitution(Measure):
    """Size of two bodies' relative velocity at the end over the start; 0 if they still approach."""

    name, unit, kind = "restitution", "1", "number"

    def of(self, run: xr.DataTree, scene: Scene, about: About) -> Measured:  # noqa: ARG002
        """Return the ratio for the first two bodies."""
        velocity = run["series"].to_dataset()["mean_velocity"].transpose("time", "body", "axis").values
        apart = velocity[:, 1] - velocity[:, 0]
        sizes = np.linalg.norm(apart, axis=1)
        parts = sizes[0] > 0.0 and apart[-1] @ apart[0] < 0.0
        return Measured(np.array([float(sizes[-1] / sizes[0]) if parts else 0.0]), np.empty(0))


class Reaction(Measure):
    """Mean size of a pair's contact force over the last fifth of the run."""

    name, unit, kind = "reaction", "N m-1", "number"
    keys = ("pair",)

    def of(self, run: xr.DataTree, scene: Scene, about: About) -> Measured:  # noqa: ARG002
        """Return the mean of the named pair, or of the first."""
        force = run["series"].to_dataset()["contact_force"].transpose("pair", "time", "axis")
        pair = force.sel(pair=about.pair) if about.pair else force.isel(pair=0)
        late = pair["time"] >= 0.8 * float(pair["time"][-1])
        return Measured(np.array([float(np.linalg.norm(pair.values[late.values].mean(axis=0)))]), np.empty(0))
