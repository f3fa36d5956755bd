"""What is known of a scene without running it: closed forms, and the reference that ships with mpmfw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.geometry import Rectangle
from mpmfw.results.references import at_rest, rings, rolling, rolling_sphere, tilt_of
from mpmfw.scene import Scene


@dataclass(frozen=True)
class Incline:
    """A body that leaves rest and runs down a plane along x under tilted gravity.

    Attributes
    ----------
    body
        Its name.
    acceleration, angular_acceleration
        Of the centre along the plane [m/s²], and counter-clockwise [rad/s²].
    until
        Time until which its motion is judged [s]: 10 m of a cylinder's way, or the end of the scene.
    says
        The closed form in words.
    """

    body: str
    acceleration: float
    angular_acceleration: float
    until: float
    says: str


def incline(scene: Scene) -> Incline | None:
    """Recognise a cylinder, a sphere or a block on an inclined plane; None for any other scene."""
    known, end = rolling(scene) or rolling_sphere(scene), float(scene.time.end)
    if known is not None:
        found = known.solution
        until = min(found.time_to(known.distance), end)
        return Incline(known.body, found.acceleration, found.angular_acceleration, until, known.describe())
    return _sliding(scene, end)


def _sliding(scene: Scene, end: float) -> Incline | None:
    """A free block on a fixed rectangle along x, steep enough to slide and too flat to tip over."""
    tilted = tilt_of(scene)
    if len(scene.bodies) != 2 or tilted is None or not scene.has_coulomb_friction:
        return None
    blocks = [name for name, body in scene.bodies.items() if not body.sides and at_rest(body)]
    planes = [name for name, body in scene.bodies.items() if body.sides and all(s.fixed for s in body.sides)]
    along = all(isinstance(b.geometry, Rectangle) and b.geometry.angle == 0.0 for b in scene.bodies.values())
    if len(blocks) != 1 or len(planes) != 1 or not along:
        return None
    friction = scene.pairs[0][2]
    block = scene.bodies[blocks[0]].geometry
    width, height = np.subtract(block.upper, block.lower)  # type: ignore[union-attr]
    g, tilt = tilted
    acceleration = g * (np.sin(tilt) - friction * np.cos(tilt))
    if acceleration <= 0.0 or friction > width / height:
        return None
    says = (
        f"a rigid block under Coulomb friction, from rest: g (sin θ − μ cos θ) = {acceleration:.4g} m/s² "
        f"with θ = {np.degrees(tilt):.4g}° and μ = {friction:g}"
    )
    return Incline(blocks[0], float(acceleration), 0.0, end, says)


def kind_of(scene: Scene) -> str | None:
    """Which of the bundled kinds of references a scene is; None of others."""
    known = incline(scene)
    if known is not None:
        if not known.angular_acceleration:
            return "sliding-block"
        return "rolling-cylinder" if scene.dim == 2 else "rolling-sphere"
    if rings(scene) is not None:
        return "colliding-rings"
    return "pressed-blocks" if column(scene) is not None else None


@dataclass(frozen=True)
class PressedBlocks:
    """Two blocks, one on the other between smooth walls, under a pressure from above.

    Attributes
    ----------
    lower, upper
        Names of the blocks.
    pressure
        On top [Pa]: every vertical stress at rest is its negative.
    """

    lower: str
    upper: str
    pressure: float


def column(scene: Scene) -> PressedBlocks | None:
    """Recognise two pressed blocks; None for any other scene."""
    if scene.dim != 2 or len(scene.bodies) != 2 or scene.gravity is not None:
        return None
    ends: dict[str, tuple[str, float]] = {}
    for name, body in scene.bodies.items():
        sides = {side.side: side for side in body.sides}
        walls = all(s in sides and sides[s].fixed in (("x",), ["x"]) for s in ("left", "right"))
        if not walls or not isinstance(body.geometry, Rectangle) or body.geometry.angle != 0.0:
            return None
        top, bottom = sides.get("top"), sides.get("bottom")
        if top is not None and isinstance(top.pressure, float) and bottom is None:
            ends["upper"] = (name, top.pressure)
        elif bottom is not None and bottom.fixed and top is None:
            ends["lower"] = (name, 0.0)
    if ends.keys() != {"lower", "upper"}:
        return None
    return PressedBlocks(ends["lower"][0], ends["upper"][0], ends["upper"][1])
