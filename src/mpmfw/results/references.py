"""Exact motions that a scene declares by ``[reference] kind``."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from io import StringIO
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.geometry import Ball, Box, Disc, Rectangle, Ring
from mpmfw.plugin.measure import About, Exact
from mpmfw.results.analysis import RollingSolution, rolling_solution
from mpmfw.results.selection import points_of
from mpmfw.results.stored_scene import loaded, own_attributes, scene_of_results
from mpmfw.scene import Body, Scene
from mpmfw.scene.loading import shipped_scenes
from mpmfw.state.fields import FloatArray

#: Source of the cylinder's motion.
EQUATION = " (eq. 13 of Hamad, Giridharan & Moormann 2017, Procedia Engineering 175, 116-123)"


@dataclass(frozen=True)
class Incline:
    """Closed form of a rigid body that runs down a plane along x from rest."""

    body: str  #: its name
    solution: RollingSolution  #: motion of its centre along the plane, and its spin
    distance: float  #: at which the displacement is judged, if the scene lasts that long [m]
    end: float  #: of the scene [s]
    says: str = field(compare=False)  #: the closed form in words

    @property
    def until(self) -> float:
        """Time until which the motion is judged [s]."""
        return min(self.solution.time_to(self.distance), self.end)

    def exact(self, measure: str, about: About) -> Exact | None:
        """Return what is known of a ``measure`` of the body's motion along the plane."""
        if about.axis not in (None, "x") or about.body not in (None, self.body):
            return None
        a, end = self.solution.acceleration, self.until
        if measure == "displacement":
            return Exact("closed-form", self.says, lambda time: 0.5 * a * time**2)
        turned = self.solution.angular_acceleration * end
        numbers = {"end-displacement": 0.5 * a * end * end, "acceleration": a, "spin": turned or None}
        return Exact.number(numbers.get(measure), self.says)


@dataclass(frozen=True)
class RollingReference(Incline):
    """Disc or ball that rolls, with its spin."""


@dataclass(frozen=True)
class SlidingReference(Incline):
    """A block that slides and stays upright."""


@dataclass(frozen=True)
class RingsReference:
    """Collision of two rings, solved by finite elements."""

    first: str  #: the left ring, which is the first of the pair
    second: str  #: the right ring
    end: float = 3.2e-3  #: until which the motions are compared [s]
    says: ClassVar[str] = (
        "explicit total-Lagrangian plane-strain finite elements, nine-node quadrilaterals of 0.5 mm, one "
        "ring against a frictionless wall; four-node quadrilaterals of 2 mm differ by 2.4 % in impulse and "
        "by 0.19 in the L2 norm of the force averaged over 100 µs; outputs every 10 µs have 79 % noise"
    )

    def exact(self, measure: str, about: About) -> Exact | None:
        """Return the impulse of the pair, or the kinetic energy of both, over time."""
        along_x = about.axis in (None, "x")
        if along_x and measure == "impulse" and about.pair in (None, f"{self.first}-{self.second}"):
            table, column = rings_table("force"), "fine_impulse_Ns_per_m"
        elif along_x and measure == "kinetic-energy" and about.body is None:
            table, column = rings_table("energy"), "fine_kinetic_J_per_m"
        else:
            return None
        return Exact("reference", self.says, lambda time: np.interp(time, table["time"], table[column]))


@dataclass(frozen=True)
class PressedBlocks:
    """Two blocks between smooth walls under a pressure from above."""

    lower: str  #: name of a block
    upper: str
    pressure: float  #: on top [Pa]: every vertical stress at rest is its negative

    @property
    def says(self) -> str:
        """The reference in words."""
        return f"a uniform vertical stress of {-self.pressure:.4g} Pa, the pressure from above"

    def exact(self, measure: str, about: About) -> Exact | None:  # noqa: ARG002
        """Return the stress at the interface."""
        return Exact.number(-self.pressure if measure == "interface-stress" else None, self.says)


Reference = RollingReference | SlidingReference | RingsReference | PressedBlocks

#: Measures of which one of these has the value.
KNOWN = frozenset(
    {
        "displacement",
        "end-displacement",
        "acceleration",
        "spin",
        "impulse",
        "kinetic-energy",
        "interface-stress",
    }
)


def described(dataset: xr.Dataset) -> str:
    """Return the reference of a comparison in words, if it has one."""
    texts = (str(array.attrs["against"]) for array in dataset.data_vars.values() if "against" in array.attrs)
    if text := "; ".join(dict.fromkeys(texts)):
        return text
    varied = [dim for dim in dataset["status"].dims if dim not in ("contact", "shape")]
    references = {reference_of(own_attributes(row)) for _, row in points_of(dataset, varied)}
    if len(references) > 1:
        return "each row against its own closed form, as the varied keys change it"
    return "".join(one.says for one in references if one is not None)


def reference_of(attributes: Mapping[str, Any]) -> Reference | None:
    """Return the reference of a result's scene, or None."""
    scene = scene_of_results(attributes)
    try:
        return None if scene is None else declared(scene)
    except SceneError:
        return None  # the campaign said why


def declared(scene: Scene) -> Reference | None:
    """Return the bundled reference that a scene declares, or None; a SceneError if it does not apply."""
    kind = None if scene.reference is None else scene.reference.kind
    if kind not in _KINDS:
        return None
    try:
        return _KINDS[kind](scene)
    except SceneError as error:
        raise SceneError(f"reference.kind: '{kind}' does not apply: {error}") from None


def _need(holds: bool, otherwise: str) -> None:
    if not holds:
        raise SceneError(otherwise)


def _one(names: Sequence[str], what: str) -> str:
    _need(len(names) == 1, f"expected one {what}, and the scene has {len(names) or 'none'}")
    return names[0]


def _on_incline(
    scene: Scene, shapes: type[Any] | tuple[type[Any], ...], what: str
) -> tuple[str, float, float, float]:
    """Return the free body on a plane, its friction, gravity [m/s²] and the tilt [rad]."""
    free = [
        name
        for name, body in scene.bodies.items()
        if isinstance(body.geometry, shapes) and not body.sides and not body.prescribed
    ]
    planes = [name for name, body in scene.bodies.items() if _is_plane(body)]
    body = _one(free, f"free {what}")
    _one(planes, "rectangle or box along the axes, held by fixed sides or rigid")
    _need(len(scene.bodies) == 2, "expected two bodies")
    _need(at_rest(scene.bodies[body]), f"'{body}' moves at the start")
    rigid, loaded = getattr(scene.bodies[body], "rigid", None), scene.loads or scene.boundaries
    given = [key for key in ("force", "torque", "held", "inertia") if getattr(rigid, key, None)]
    _need(not given and not loaded, f"'{body}' has {given[0] if given else 'loads or boundaries'}")
    _need(
        scene.contact is not None and scene.has_coulomb_friction, "expected a contact with Coulomb's friction"
    )
    _need(scene.gravity is not None and scene.gravity.is_constant, "expected constant gravity")
    assert scene.gravity is not None
    along, down, *across = scene.gravity.at(0.0)
    _need(along > 0.0 > down and not any(across), "expected gravity towards +x and -y")
    return body, scene.pairs[0][2], float(np.hypot(along, down)), float(np.arctan2(along, -down))


def _rolling(scene: Scene, kind: type[Any], rigid: str, inertia: float) -> RollingReference:
    body, friction, g, tilt = _on_incline(scene, kind, kind.__name__.lower())
    shape: Any = scene.bodies[body].geometry
    gravity: Any = scene.gravity
    if gravity.tilt is not None:  # as it is given, to the last digit
        g, tilt = float(gravity.magnitude), float(gravity.tilt)
    solution = rolling_solution(tilt, friction, g, float(shape.radius), inertia)
    end = float(scene.time.end)
    distance = 10.0 if kind is Disc else float(solution.displacement(end))
    says = (
        f"a rigid {rigid} that {'slips' if solution.slips else 'rolls without slip'}, from rest"
        f"{EQUATION if kind is Disc else ''}: acceleration {solution.acceleration:.4g} m/s², angular "
        "acceleration "
        f"{abs(solution.angular_acceleration):.4g} rad/s², {distance:g} m after "
        f"{solution.time_to(distance):.4g} s"
    )
    return RollingReference(body, solution, distance, end, says)


def _sliding(scene: Scene) -> SlidingReference:
    body, friction, g, tilt = _on_incline(scene, Rectangle, "rectangle")
    block: Any = scene.bodies[body].geometry
    _need(block.angle == 0.0, f"'{body}' is turned against the plane")
    width, height = np.subtract(block.upper, block.lower)
    acceleration = float(g * (np.sin(tilt) - friction * np.cos(tilt)))
    _need(acceleration > 0.0, "the friction holds the block")
    _need(friction <= width / height, "the block tips over: the friction is above its width over its height")
    says = (
        f"a rigid block under Coulomb friction, from rest: g (sin θ − μ cos θ) = {acceleration:.4g} m/s² "
        f"with θ = {np.degrees(tilt):.4g}° and μ = {friction:g}"
    )
    return SlidingReference(
        body, RollingSolution(acceleration, 0.0, True), np.inf, float(scene.time.end), says
    )


def _pressed(scene: Scene) -> PressedBlocks:
    _need(scene.dim == 2 and len(scene.bodies) == 2, "expected two bodies in the plane")
    _need(scene.gravity is None, "the scene has gravity")
    ends: dict[str, tuple[str, float]] = {}
    for name, body in scene.bodies.items():
        sides = {side.side: side for side in body.sides}
        walls = all(s in sides and sides[s].fixed in (("x",), ["x"]) for s in ("left", "right"))
        _need(walls, f"the sides left and right of '{name}' are not fixed in x alone")
        upright = isinstance(body.geometry, Rectangle) and body.geometry.angle == 0.0
        _need(upright, f"'{name}' is not a rectangle along the axes")
        top, bottom = sides.get("top"), sides.get("bottom")
        if top is not None and isinstance(top.pressure, float) and not top.within and bottom is None:
            ends["upper"] = (name, top.pressure)
        elif bottom is not None and bottom.fixed and top is None:
            ends["lower"] = (name, 0.0)
    _need(ends.keys() == {"lower", "upper"}, "expected a constant pressure on top, and a fixed bottom")
    return PressedBlocks(ends["lower"][0], ends["upper"][0], ends["upper"][1])


def _rings(scene: Scene) -> RingsReference:
    shipped = loaded(shipped_scenes()["colliding-rings"])
    assert shipped is not None
    _need(scene.gravity is None, "the scene has gravity")
    _need(len(scene.bodies) == 2, "expected two bodies")
    # contact_force is on the pair's first body, the left one of the reference
    for name, known in zip(scene.bodies, shipped.bodies, strict=True):
        _need(isinstance(scene.bodies[name].geometry, Ring), f"'{name}' is not a ring")
        found, expected = _ring_facts(scene, name), _ring_facts(shipped, known)
        for key, value in expected.items():
            given = found.get(key)
            same = given == value if isinstance(value, str) else np.allclose(given or 0.0, value, rtol=1e-9)
            _need(bool(same), f"the {key} of '{name}' is {given}, and {value} in the finite elements")
    (first, left), (second, right) = scene.bodies.items()
    apart = np.subtract(right.geometry.centre, left.geometry.centre)  # type: ignore[union-attr]
    along_x = np.allclose(apart, [0.084, 0.0], atol=1e-9)
    _need(bool(along_x), f"expected '{first}' at the left of '{second}', 4 mm apart along x")
    return RingsReference(first, second)


def _ring_facts(scene: Scene, name: str) -> dict[str, Any]:
    body = scene.bodies[name]
    material, ring = scene.materials[body.material], body.geometry
    options: Any = material.options
    return {
        "model": material.model,
        "density": material.density,
        **{key: getattr(options, key, None) for key in ("energy", "bulk_modulus", "shear_modulus")},
        **{key: getattr(ring, key) for key in ("inner_radius", "outer_radius")},
        "velocity": body.velocity or (0.0, 0.0),
        "angular_velocity": body.angular_velocity or 0.0,
        "number of sides that are held or loaded": len(body.sides),
    }


_KINDS: dict[str | None, Callable[[Scene], Reference]] = {
    "rolling-cylinder": lambda scene: _rolling(scene, Disc, "cylinder", 0.5),
    "rolling-sphere": lambda scene: _rolling(scene, Ball, "sphere", 0.4),
    "sliding-block": _sliding,
    "colliding-rings": _rings,
    "pressed-blocks": _pressed,
}


def _is_plane(body: Body) -> bool:
    shape = body.geometry
    straight = isinstance(shape, Rectangle) and shape.angle == 0.0
    straight = straight or (isinstance(shape, Box) and not any(shape.angles))
    held = [side.fixed for side in body.sides]
    fixed = (all(held) and True in held) or getattr(body, "rigid", False) is True
    return straight and fixed and at_rest(body)


def at_rest(body: Body) -> bool:
    """Return True if a body neither moves nor turns at the start."""
    spin = body.angular_velocity
    return not any(body.velocity or ()) and not np.any(0.0 if spin is None else spin)


@functools.cache
def rings_table(name: str) -> dict[str, FloatArray]:
    """Return a shipped table, ``force`` or ``energy``, with ``time`` in s."""
    text = files("mpmfw").joinpath("reference", f"rings_fem_{name}.csv").read_text(encoding="utf-8")
    table = np.genfromtxt(StringIO(text), delimiter=",", names=True)
    return {**{column: table[column] for column in table.dtype.names or ()}, "time": 1e-3 * table["time_ms"]}
