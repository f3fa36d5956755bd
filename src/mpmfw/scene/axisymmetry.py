"""What cannot be in a scene of bodies of revolution: motion across the axis, and turning."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from mpmfw.scene.problem import Path, Problem
from mpmfw.scene.tables import Body, Gravity, RigidBody, Tables


def check_axisymmetry(scene: Tables, plugins: Mapping[Path, type[Any]]) -> Iterator[Problem]:
    """Yield the problems of a scene with ``grid.axisymmetric``."""
    grid, shape = scene.grid, scene.shape.method
    if not grid.axisymmetric:
        return
    if grid.dim != 2:
        yield Problem(("grid", "axisymmetric"), "is for two dimensions: x is the radius and y the axis")
        return
    if grid.lower[0] < 0.0:
        yield Problem(("grid", "lower"), "begins at a negative radius; expected x from 0 on")
    if not getattr(plugins.get(("shape", shape)), "axisymmetric", True):
        message = f"'{shape}' has no form for grid.axisymmetric; expected another shape function"
        yield Problem(("shape", "method"), message)
    if scene.sleep is not None:
        yield Problem(("sleep",), "does not go with grid.axisymmetric: hoop stress is not kept aside")
    if scene.output.contact_moment is not None:
        message = "has no meaning with grid.axisymmetric: moments round a ring cancel"
        yield Problem(("output", "contact_moment"), message)
    of_settling = None if scene.settle is None else scene.settle.gravity
    for at, gravity in ((("gravity",), scene.gravity), (("settle", "gravity"), of_settling)):
        if gravity is not None and _pulls_sideways(gravity):
            yield Problem(at, "pulls across the axis, which is y; expected gravity along it")
    for name, body in scene.bodies.items():
        yield from _body(body, ("bodies", name))


def _pulls_sideways(gravity: Gravity) -> bool:
    times = [0.0] if gravity.table is None else [row[0] for row in gravity.table]
    return any(gravity.at(time)[0] != 0.0 for time in times)


def _body(body: Body, path: Path) -> Iterator[Problem]:
    """Yield what a body of revolution cannot have."""
    refused: list[tuple[bool, str, str]] = [
        (body.thickness is not None, "thickness", "does not go with grid.axisymmetric: a ring has its own"),
        (bool(body.angular_velocity), "angular_velocity", "does not go with grid.axisymmetric"),
        (body.rotation in ("spin", "exact"), "rotation", "a body of revolution does not turn; leave it out"),
    ]
    if isinstance(body, RigidBody):
        motion = None if isinstance(body.rigid, bool) else body.rigid.motion
        for at, table in ((path, body), ((*path, "rigid", "motion"), motion)):
            velocity = getattr(table, "velocity", None)
            rows = velocity if velocity and isinstance(velocity[0], tuple) else [(0.0, *(velocity or (0.0,)))]
            if any(row[1] != 0.0 for row in rows):
                yield Problem((*at, "velocity"), "across the axis; expected x = 0 with grid.axisymmetric")
        turns = any(
            getattr(each, key, None) for each, key in ((motion, "angular_velocity"), (body.rigid, "torque"))
        )
        refused.append((turns, "rigid", "turns; expected a motion along y with grid.axisymmetric"))
    else:
        left = float(body.geometry.bounds[0][0])
        refused.append((left < 0.0, "geometry", "reaches a negative radius; expected x from 0 on"))
        moves = left <= 0.0 and body.velocity is not None and body.velocity[0] != 0.0
        refused.append((moves, "velocity", "across the axis, on which the body lies; expected x = 0"))
    yield from (Problem((*path, key), message) for wrong, key, message in refused if wrong)
