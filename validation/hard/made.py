"""Scenes from the few numbers that tell them apart: ``make`` of a place."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

#: Words of a body that are of its material, with what they are where a place does not say.
SOLID = {"E": 1e6, "nu": 0.4, "rho": 1000.0}

Bodies = dict[str, dict[str, Any]]


def box(left: float, bottom: float, right: float, top: float, **body: Any) -> dict[str, Any]:
    """Return a block."""
    return {"box": [left, bottom, right, top], **body}


def plane(left: float, bottom: float, right: float, top: float, **body: Any) -> dict[str, Any]:
    """Return a block that is fixed below."""
    return box(left, bottom, right, top, fixed="bottom", **body)


def disc(x: float, y: float, radius: float, **body: Any) -> dict[str, Any]:
    """Return a disc."""
    return {"disc": [x, y, radius], **body}


def polygon(*points: Sequence[float], **body: Any) -> dict[str, Any]:
    """Return a polygon, anticlockwise."""
    return {"points": list(points), **body}


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

    ``cell`` is the edge of a cell [m], ``end`` the time that is run [s]. Bodies have ``box`` (left, bottom,
    right, top) with ``angle``, ``points``, ``disc`` (x, y, radius) or ``ring`` (x, y, radii) [m]; ``E`` [Pa],
    ``nu``, ``rho`` [kg/m³] as in :data:`SOLID` where they are left out; ``fixed``, a side; everything else as
    a scene has it. ``gravity`` is downwards, a vector, or rows in time [m/s²]. A ``settled`` scene is at rest
    first, under the gravity of time zero. ``outputs`` are how many, ``room`` is the grid beyond the bodies,
    over their whole extent.
    """
    corners = [corner for body in bodies.values() for corner in _extent(body)]
    low, high = ([of(corner[k] for corner in corners) for k in (0, 1)] for of in (min, max))
    beyond = math.ceil(room * max(high[0] - low[0], high[1] - low[1]) / cell) * cell
    lower = [math.floor(v / cell) * cell - beyond for v in low]
    upper = [math.ceil(v / cell) * cell + beyond for v in high]
    made: dict[str, Any] = {
        "grid": {"cell_size": cell, "lower": lower, "upper": upper},
        "time": {"end": end, "output_interval": end / outputs},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": friction},
        "materials": {name: _material(body) for name, body in bodies.items()},
        "bodies": {name: _body(name, body) for name, body in bodies.items()},
        "output": {"particles": False, "ledger": True},
    }
    if gravity:
        made["gravity"] = _gravity(gravity)
    if loads:
        made["loads"] = dict(loads)
    if settled:
        made["settle"] = {"tolerance": 1e-3}
    return made


def _gravity(given: float | Sequence[Any]) -> dict[str, Any]:
    if isinstance(given, float | int):
        return {"vector": [0.0, -given]}
    return {"table" if isinstance(given[0], Sequence) else "vector": given}


def _extent(body: Mapping[str, Any]) -> list[Sequence[float]]:
    if "box" in body:
        return [body["box"][:2], body["box"][2:]]
    if "disc" in body or "ring" in body:
        x, y, *_, radius = body.get("disc") or body["ring"]
        return [(x - radius, y - radius), (x + radius, y + radius)]
    return list(body["points"])


def _material(body: Mapping[str, Any]) -> dict[str, Any]:
    E, nu, rho = (body.get(name, usual) for name, usual in SOLID.items())
    return {"model": "neo_hookean", "density": rho, "youngs_modulus": E, "poissons_ratio": nu}


def _body(name: str, body: Mapping[str, Any]) -> dict[str, Any]:
    short = {"box", "points", "disc", "ring", "angle", "fixed", *SOLID}
    made = {key: value for key, value in body.items() if key not in short}
    layout = "fitted"
    if "box" in body:
        corners = {"lower": body["box"][:2], "upper": body["box"][2:]}
        made["geometry"] = {"type": "rectangle", **corners, "angle": body.get("angle", 0.0)}
    elif "disc" in body:
        *centre, radius = body["disc"]
        made["geometry"] = {"type": "disc", "centre": centre, "radius": radius}
    elif "ring" in body:
        *centre, inner, outer = body["ring"]
        made["geometry"] = {"type": "ring", "centre": centre, "inner_radius": inner, "outer_radius": outer}
    else:
        made["geometry"], layout = {"type": "polygon", "points": body["points"]}, "lattice"
    if "fixed" in body:
        made["sides"] = [{"side": body["fixed"], "fixed": True}]
    return {"material": name, "particles": {"layout": layout, "size": "0.5 cells"}, **made}


def incline(friction: float, tilt: float, cell: float = 0.1) -> dict[str, Any]:
    """Return a block settled on a level plane, then tilted to ``tilt`` [°], as a cosine, in 0.15 s."""
    solid = {"E": 15.4e6, "nu": 0.286}
    rows = []
    for k in range(31):
        angle = math.radians(tilt) * 0.5 * (1.0 - math.cos(math.pi * k / 30))
        rows.append([0.005 * k, 10.0 * math.sin(angle), -10.0 * math.cos(angle)])
    bodies = {
        "block": box(0.03, 0.013, 0.63, 0.313, **solid),
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
    bodies = {"lower": {"points": _lists(lower), "fixed": "bottom"}, "upper": {"points": _lists(upper)}}
    return scene(cell, 0.25, room=0.2 if teeth > 10 else 1.0, **bodies)


def arch(stones: int, radius: float = 1.0, thickness: float = 0.3, cell: float = 0.08) -> dict[str, Any]:
    """A half circle of stones on two fixed ones, each short of its joint by 1e-4 of the mean radius."""
    joint, bodies = 0.5e-4, {}
    for k in range(stones):
        first, last = (math.pi * (k + j) / stones + sign * joint for j, sign in ((0, 1), (1, -1)))
        turns = ((-1, first), (1, first), (1, last), (-1, last))
        corners = [(radius + sign * 0.5 * thickness, angle) for sign, angle in turns]
        bodies[f"stone_{k}"] = {"points": _lists((r * math.cos(a), r * math.sin(a)) for r, a in corners)}
    for name, x in (("right", radius), ("left", -radius)):
        bodies[name] = {"box": [x - thickness, -0.15, x + thickness, 0.0], "fixed": "bottom"}
    solid = {"E": 20e6, "nu": 0.2, "rho": 2000.0}
    whole = {name: {**body, **solid} for name, body in bodies.items()}
    return scene(cell, 0.1, 0.5, settled=True, outputs=20, room=0.2, **whole)


def stack(plates: int, speed: float, cell: float = 0.02) -> dict[str, Any]:
    """Return a square of steel that hits a stack of loose plates, 0.02 m thick and 0.002 m apart."""
    steel = {"E": 210e9, "nu": 0.3, "rho": 7850.0}
    bodies: Bodies = {"hammer": {"box": [-0.202, -0.1, -0.002, 0.1], "velocity": [speed, 0.0], **steel}}
    for k in range(plates):
        bodies[f"plate_{k}"] = {"box": [0.022 * k, -0.2, 0.022 * k + 0.02, 0.2], **steel}
    return scene(cell, 0.15 / speed, gravity=0.0, **bodies)


def cradle(discs: int, radius: float = 0.1, cell: float = 0.025) -> dict[str, Any]:
    """One disc at 1 m/s meets a row of ``discs`` others, which are 0.004 m apart."""
    pitch = 2.0 * radius + 0.004
    bodies: Bodies = {"first": {"disc": [0.0, 0.0, radius], "velocity": [1.0, 0.0]}}
    bodies |= {f"disc_{k}": {"disc": [pitch * (k + 1), 0.0, radius]} for k in range(discs)}
    return scene(cell, 0.12, gravity=0.0, **bodies)


def cogs(teeth: int, spin: float = 5.0, cell: float = 0.05) -> dict[str, Any]:
    """Two wheels in mesh, of unit size and free: one turns, and takes the other along."""
    sides = {
        "left": {"points": _wheel(0.0, 0.0, teeth, 0.0), "angular_velocity": spin, "velocity": [0.1, 0.0]},
        "right": {"points": _wheel(0.91, 0.0, teeth, 0.5)},
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
    bodies: Bodies = {"floor": {"box": [-wide, -0.1, wide, 0.0], "fixed": "bottom"}}
    for k, many in enumerate(rows):
        for j in range(many):
            x = (j - many / 2) * 1.1 * side + 0.05 * side
            bodies[f"square_{k}_{j}"] = {"box": [x, k * side, x + side, (k + 1) * side]}
    return scene(cell, 0.2, 0.5, settled=True, outputs=20, **bodies)


def filling(discs: int, across: int, radius: float = 0.1, cell: float = 0.08) -> dict[str, Any]:
    """Return a box that is filled with falling discs, ``across`` in a row, every other row aside."""
    pitch = 2.15 * radius
    half = 0.5 * pitch * across + 0.4 * radius
    bodies = _walls(half, 0.8 * pitch * discs / across)
    for k in range(discs):
        row, column = divmod(k, across)
        x = pitch * (column - 0.5 * (across - 1)) + (0.3 if row % 2 else -0.3) * radius
        bodies[f"disc_{k}"] = {"disc": [x, 1.1 * radius + pitch * row, radius]}
    return scene(cell, 0.2, 0.3, outputs=20, room=0.5, **bodies)


def compactor(across: int = 3, radius: float = 0.1, cell: float = 0.05) -> dict[str, Any]:
    """Nine discs in a box, pressed by a lid that comes down at 1 m/s by a fifth of their height."""
    pitch = 2.02 * radius
    half = 0.5 * pitch * across + 0.02 * radius
    bodies = _walls(half, pitch * across + 0.2 * radius)
    for k in range(across**2):
        row, column = divmod(k, across)
        x = pitch * (column - 0.5 * (across - 1))
        bodies[f"disc_{k}"] = disc(x, 1.02 * radius + pitch * row, radius)
    low = pitch * across + 0.04 * radius
    down = [{"side": "top", "velocity": [0.0, -1.0]}]
    bodies["lid"] = box(-half + 0.01, low, half - 0.01, low + 0.15, sides=down)
    return scene(cell, 0.12, 0.1, gravity=0.0, **bodies)


def _walls(half: float, high: float) -> Bodies:
    """Floor and walls round a box of the width 2 ``half``, of one piece: a trough."""
    outer = half + 0.15
    points = [(-outer, -0.15), (outer, -0.15), (outer, high), (half, high)]
    points += [(half, 0.0), (-half, 0.0), (-half, high), (-outer, high)]
    return {"trough": {"points": _lists(points), "fixed": "bottom", "E": 1e7}}


def cards(lean: float, length: float = 0.5, thickness: float = 0.05, cell: float = 0.025) -> dict[str, Any]:
    """Two cards, leant against each other at ``lean`` [°] to the floor."""
    angle = math.radians(lean)
    bodies: Bodies = {"floor": {"box": [-0.4, -0.05, 0.4, 0.0], "fixed": "bottom", "E": 1e7}}
    for name, sign in (("left", -1), ("right", 1)):
        # The lowest corner is on the floor, and the inner upper one on the axis
        c, s = math.cos(angle), math.sin(angle)
        y = 0.5 * (length * s + thickness * c)
        x = sign * 0.5 * (length * c - thickness * s) + sign * thickness * s
        ends = (x - 0.5 * length, y - 0.5 * thickness, x + 0.5 * length, y + 0.5 * thickness)
        bodies[name] = box(*ends, angle=-sign * angle, E=1e7)
    return scene(cell, 0.1, 0.9, settled=True, outputs=20, **bodies)


def _lists(points: Iterable[tuple[float, float]]) -> list[list[float]]:
    return [[float(x), float(y)] for x, y in points]
