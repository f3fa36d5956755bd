"""Scenes from the few numbers that tell them apart: ``make`` of a place."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import common
from common import disc, elastic, fixed, polygon, rectangle

#: Words of a body that are of its material, with what they are where a place does not say.
SOLID = {"E": 1e6, "nu": 0.4, "rho": 1000.0}
#: Sides of a body that is fixed below.
BELOW = fixed(bottom="xy")

Bodies = dict[str, dict[str, Any]]


def plane(left: float, bottom: float, right: float, top: float, **body: Any) -> dict[str, Any]:
    """Return a block that is fixed below."""
    return rectangle(left, bottom, right, top, sides=BELOW, **body)


def ring(inner: float, outer: float, **body: Any) -> dict[str, Any]:
    """Return a ring about the origin."""
    shape = {"type": "ring", "centre": [0.0, 0.0], "inner_radius": inner, "outer_radius": outer}
    return {"geometry": shape, **body}


def trough(
    half: float, high: float, outer: float, bottom: float, floor: float = 0.0, **body: Any
) -> dict[str, Any]:
    """Return a body of floor and walls, ``half`` and ``outer`` from the middle, that is fixed below."""
    points = [(-outer, bottom), (outer, bottom), (outer, high), (half, high)]
    points += [(half, floor), (-half, floor), (-half, high), (-outer, high)]
    return polygon(points, sides=BELOW, **body)


def force(body: str, *rows: Sequence[float]) -> dict[str, Any]:
    """Return a body force over time: rows of time [s] and vector [N/m³]."""
    return {"model": "body_force", "bodies": [body], "force": list(rows)}


def scene(
    cell: float,
    end: float,
    friction: float = 0.0,
    gravity: float | Sequence[Any] = 9.81,
    settled: bool = False,
    outputs: int = 50,
    room: float = 1.0,
    loads: Mapping[str, Any] | None = None,
    **bodies: Mapping[str, Any],
) -> dict[str, Any]:
    """Return a scene of blocks, polygons and discs.

    ``cell`` is the edge of a cell [m], ``end`` the time that is run [s]. Bodies have ``E`` [Pa], ``nu``,
    ``rho`` [kg/m³] as in :data:`SOLID` where they are left out; everything else as a scene has it.
    ``gravity`` is downwards, a vector, or rows in time [m/s²]. A ``settled`` scene is at rest first, under
    the gravity of time zero. ``outputs`` are how many, ``room`` is the grid beyond the bodies, over their
    whole extent.
    """
    corners = [corner for body in bodies.values() for corner in _extent(body["geometry"])]
    low, high = ([of(corner[k] for corner in corners) for k in (0, 1)] for of in (min, max))
    beyond = math.ceil(room * max(high[0] - low[0], high[1] - low[1]) / cell) * cell
    lower = [math.floor(v / cell) * cell - beyond for v in low]
    upper = [math.ceil(v / cell) * cell + beyond for v in high]
    whole: dict[str, Any] = common.scene(
        *(cell, lower, upper, end, end / outputs, None),
        bodies={name: _body(name, body) for name, body in bodies.items()},
        contact={"friction": friction},
        materials={name: _material(body) for name, body in bodies.items()},
        output={"particles": False, "ledger": True},
        gravity=_gravity(gravity) if gravity else None,
        loads=loads,
        settle={"tolerance": 1e-3} if settled else None,
    )
    return whole


def _gravity(given: float | Sequence[Any]) -> dict[str, Any]:
    if isinstance(given, float | int):
        return {"vector": [0.0, -given]}
    return {"table" if isinstance(given[0], Sequence) else "vector": given}


def _extent(shape: Mapping[str, Any]) -> Sequence[Sequence[float]]:
    if "points" in shape:
        return shape["points"]
    if "lower" in shape:
        return [shape["lower"], shape["upper"]]
    (x, y), radius = shape["centre"], shape.get("radius") or shape["outer_radius"]
    return [(x - radius, y - radius), (x + radius, y + radius)]


def _material(body: Mapping[str, Any]) -> dict[str, Any]:
    E, nu, rho = (body.get(name, usual) for name, usual in SOLID.items())
    return elastic(rho, E, nu, "neo_hookean")


def _body(name: str, body: Mapping[str, Any]) -> dict[str, Any]:
    layout = "lattice" if body["geometry"]["type"] == "polygon" else "fitted"
    made = {key: value for key, value in body.items() if key not in SOLID}
    return {"material": name, "particles": {"layout": layout, "size": "0.5 cells"}, **made}


def incline(friction: float, tilt: float, cell: float = 0.1) -> dict[str, Any]:
    """Return a block settled on a level plane, then tilted to ``tilt`` [°], as a cosine, in 0.15 s."""
    solid = {"E": 15.4e6, "nu": 0.286}
    rows = []
    for k in range(31):
        angle = math.radians(tilt) * 0.5 * (1.0 - math.cos(math.pi * k / 30))
        rows.append([0.005 * k, 10.0 * math.sin(angle), -10.0 * math.cos(angle)])
    bodies = {
        "block": rectangle(0.03, 0.013, 0.63, 0.313, **solid),
        "plane": plane(-0.2, -0.187, 1.1, 0.013, **solid),
    }
    return scene(cell, 0.35, friction, rows, settled=True, outputs=70, **bodies)


def saws(teeth: int, pitch: float = 0.1, cell: float = 0.05) -> dict[str, Any]:
    """A saw falls by a quarter of a tooth into one that is fixed; teeth of 90°, ``pitch`` [m] wide."""
    high = 0.5 * pitch
    edge = [(pitch * (k / 2 - teeth / 2), high if k % 2 else 0.0) for k in range(2 * teeth + 1)]
    half, gap = 0.5 * pitch * teeth, 0.25 * pitch
    lower = [(-half, -0.15), (half, -0.15), *reversed(edge)]
    upper = [*((x, y + gap) for x, y in edge), (half, 0.2 + gap), (-half, 0.2 + gap)]
    bodies = {"lower": polygon(lower, sides=BELOW), "upper": polygon(upper)}
    return scene(cell, 0.25, room=0.2 if teeth > 10 else 1.0, **bodies)


def arch(stones: int, radius: float = 1.0, thickness: float = 0.3, cell: float = 0.08) -> dict[str, Any]:
    """A half circle of stones on two fixed ones, each short of its joint by 1e-4 of the mean radius."""
    joint, bodies = 0.5e-4, {}
    for k in range(stones):
        first, last = (math.pi * (k + j) / stones + sign * joint for j, sign in ((0, 1), (1, -1)))
        turns = ((-1, first), (1, first), (1, last), (-1, last))
        corners = [(radius + sign * 0.5 * thickness, angle) for sign, angle in turns]
        bodies[f"stone_{k}"] = polygon([(r * math.cos(a), r * math.sin(a)) for r, a in corners])
    for name, x in (("right", radius), ("left", -radius)):
        bodies[name] = plane(x - thickness, -0.15, x + thickness, 0.0)
    solid = {"E": 20e6, "nu": 0.2, "rho": 2000.0}
    whole = {name: {**body, **solid} for name, body in bodies.items()}
    return scene(cell, 0.1, 0.5, settled=True, outputs=20, room=0.2, **whole)


def stack(plates: int, speed: float, cell: float = 0.02) -> dict[str, Any]:
    """Return a square of steel that hits a stack of loose plates, 0.02 m thick and 0.002 m apart."""
    steel = {"E": 210e9, "nu": 0.3, "rho": 7850.0}
    bodies: Bodies = {"hammer": rectangle(-0.202, -0.1, -0.002, 0.1, velocity=[speed, 0.0], **steel)}
    for k in range(plates):
        bodies[f"plate_{k}"] = rectangle(0.022 * k, -0.2, 0.022 * k + 0.02, 0.2, **steel)
    return scene(cell, 0.15 / speed, gravity=0.0, **bodies)


def cradle(discs: int, radius: float = 0.1, cell: float = 0.025) -> dict[str, Any]:
    """One disc at 1 m/s meets a row of ``discs`` others, which are 0.004 m apart."""
    pitch = 2.0 * radius + 0.004
    bodies: Bodies = {"first": disc(0.0, 0.0, radius, velocity=[1.0, 0.0])}
    bodies |= {f"disc_{k}": disc(pitch * (k + 1), 0.0, radius) for k in range(discs)}
    return scene(cell, 0.12, gravity=0.0, **bodies)


def cogs(teeth: int, spin: float = 5.0, cell: float = 0.05) -> dict[str, Any]:
    """Two wheels in mesh, of unit size and free: one turns, and takes the other along."""
    sides = {
        "left": polygon(_wheel(0.0, 0.0, teeth, 0.0), angular_velocity=spin, velocity=[0.1, 0.0]),
        "right": polygon(_wheel(0.91, 0.0, teeth, 0.5)),
    }
    return scene(cell, 0.3, 0.1, gravity=0.0, **sides)


def _wheel(x: float, y: float, teeth: int, phase: float) -> list[list[float]]:
    """Return trapezoidal teeth from 0.4 m to 0.5 m; a tooth (phase 0) or a gap (0.5) on the x axis."""
    points = []
    for k in range(teeth):
        for along, radius in ((-0.22, 0.4), (-0.12, 0.5), (0.12, 0.5), (0.22, 0.4)):
            angle = 2.0 * math.pi * (k + phase + along) / teeth
            points.append([x + radius * math.cos(angle), y + radius * math.sin(angle)])
    return points


def piled(rows: Sequence[int], side: float = 0.2, cell: float = 0.05) -> dict[str, Any]:
    """Return layers of squares on a floor, as many in each as ``rows`` says: a tower of ones, a pyramid."""
    wide = max(rows) * 1.2 * side
    bodies: Bodies = {"floor": plane(-wide, -0.1, wide, 0.0)}
    for k, many in enumerate(rows):
        for j in range(many):
            x = (j - many / 2) * 1.1 * side + 0.05 * side
            bodies[f"square_{k}_{j}"] = rectangle(x, k * side, x + side, (k + 1) * side)
    return scene(cell, 0.2, 0.5, settled=True, outputs=20, **bodies)


def filling(discs: int, across: int, radius: float = 0.1, cell: float = 0.08) -> dict[str, Any]:
    """Return a box that is filled with falling discs, ``across`` in a row, every other row aside."""
    pitch = 2.15 * radius
    half = 0.5 * pitch * across + 0.4 * radius
    bodies = {"trough": trough(half, 0.8 * pitch * discs / across, half + 0.15, -0.15, E=1e7)}
    for k in range(discs):
        row, column = divmod(k, across)
        x = pitch * (column - 0.5 * (across - 1)) + (0.3 if row % 2 else -0.3) * radius
        bodies[f"disc_{k}"] = disc(x, 1.1 * radius + pitch * row, radius)
    return scene(cell, 0.2, 0.3, outputs=20, room=0.5, **bodies)


def compactor(across: int = 3, radius: float = 0.1, cell: float = 0.05) -> dict[str, Any]:
    """Nine discs in a box, pressed by a lid that comes down at 1 m/s by a fifth of their height."""
    pitch = 2.02 * radius
    half = 0.5 * pitch * across + 0.02 * radius
    bodies = {"trough": trough(half, pitch * across + 0.2 * radius, half + 0.15, -0.15, E=1e7)}
    for k in range(across**2):
        row, column = divmod(k, across)
        x = pitch * (column - 0.5 * (across - 1))
        bodies[f"disc_{k}"] = disc(x, 1.02 * radius + pitch * row, radius)
    low = pitch * across + 0.04 * radius
    down = [{"side": "top", "velocity": [0.0, -1.0]}]
    bodies["lid"] = rectangle(-half + 0.01, low, half - 0.01, low + 0.15, sides=down)
    return scene(cell, 0.12, 0.1, gravity=0.0, **bodies)


def cards(lean: float, length: float = 0.5, thickness: float = 0.05, cell: float = 0.025) -> dict[str, Any]:
    """Two cards, leant against each other at ``lean`` [°] to the floor."""
    angle = math.radians(lean)
    bodies: Bodies = {"floor": plane(-0.4, -0.05, 0.4, 0.0, E=1e7)}
    for name, sign in (("left", -1), ("right", 1)):
        # The lowest corner is on the floor, and the inner upper one on the axis
        c, s = math.cos(angle), math.sin(angle)
        y = 0.5 * (length * s + thickness * c)
        x = sign * 0.5 * (length * c - thickness * s) + sign * thickness * s
        ends = (x - 0.5 * length, y - 0.5 * thickness, x + 0.5 * length, y + 0.5 * thickness)
        bodies[name] = rectangle(*ends, angle=-sign * angle, E=1e7)
    return scene(cell, 0.1, 0.9, settled=True, outputs=20, **bodies)
