"""Refuse motion across the axis, and turning, in scenes of bodies of revolution."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from mpmfw.scene.bodies import Body, RigidBody, rows_of
from mpmfw.scene.problem import Path, Problem
from mpmfw.scene.rigid import acts_along
from mpmfw.scene.tables import Gravity, Tables


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
        yield Problem(("sleep",), "does not go with grid.axisymmetric: sleeping bodies keep no hoop stress")
    for key in ("contact_moment", "side_moment"):
        if getattr(scene.output, key) is not None:
            message = "has no meaning with grid.axisymmetric: moments round a ring cancel"
            yield Problem(("output", key), message)
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
    """Yield keys that a body of revolution cannot have."""
    refused: list[tuple[bool, str, str]] = [
        (body.thickness is not None, "thickness", "does not go with grid.axisymmetric: a ring has its own"),
        (bool(body.angular_velocity), "angular_velocity", "does not go with grid.axisymmetric"),
        (body.rotation in ("spin", "exact"), "rotation", "a body of revolution does not turn; leave it out"),
    ]
    left = float(body.geometry.bounds[0][0])
    crosses = left < 0.0 and not body.prescribed
    refused.append((crosses, "geometry", f"reaches a negative radius, {left:g} m; expected x from 0 on"))
    if isinstance(body, RigidBody):
        yield from _rigid(body, path)
    elif left <= 0.0:
        moves = acts_along(body.velocity, 0)
        refused.append((moves, "velocity", "across the axis, on which the body lies; expected x = 0"))
        yield from _sides(body, path)
    yield from (Problem((*path, key), message) for wrong, key, message in refused if wrong)


def _rigid(body: RigidBody, path: Path) -> Iterator[Problem]:
    """Yield keys of a rigid body's table that act across the axis, or have no effect."""
    at, rigid = (*path, "rigid"), None if isinstance(body.rigid, bool) else body.rigid
    motion = None if rigid is None else rigid.motion
    for where, key, table in (
        (path, "velocity", body), ((*at, "motion"), "velocity", motion), (at, "force", rigid),
        ((*at, "motion"), "surface_velocity", motion),
    ):  # fmt: skip
        if acts_along(getattr(table, key, None), 0):
            yield Problem((*where, key), "across the axis; expected x = 0 with grid.axisymmetric")
    if getattr(motion, "angular_velocity", None) or getattr(rigid, "torque", None):
        yield Problem(at, "turns; expected a motion along y with grid.axisymmetric")
    if "y" in (held := getattr(rigid, "held", None) or ()):
        yield Problem((*at, "held"), "holds the whole motion; expected rigid = true, or rigid.motion")
    elif held:
        message = "has no effect with grid.axisymmetric: a body moves along y alone; leave it out"
        yield Problem((*at, "held"), message)
    if getattr(rigid, "inertia", None) is not None:
        message = "has no effect with grid.axisymmetric: a body does not turn; leave it out"
        yield Problem((*at, "inertia"), message)


def _sides(body: Body, path: Path) -> Iterator[Problem]:
    """Refuse to drive the side on the axis of a body that begins there."""
    if not np.array_equal(body.geometry.axes, np.eye(2)):
        return
    for index, side in enumerate(body.sides):
        rows = rows_of(side.velocity) if side.side == "left" and side.velocity is not None else ()
        if given := next((row[1] for row in rows if row[1] not in (0.0, "free")), None):
            message = (
                f"{given:g} m/s along x, but the side lies on the axis, which does not move; expected 0 or "
                "'free'"
            )
            yield Problem((*path, "sides", index, "velocity"), message)
