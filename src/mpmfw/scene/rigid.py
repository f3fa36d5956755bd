"""Tables of rigid bodies: at rest, moved as prescribed, or free with a mass."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Strict, Tag

from mpmfw.geometry import HalfSpace
from mpmfw.scene.base import Position, SideForce, SpinInTime, Table, TorqueInTime, VelocityInTime
from mpmfw.scene.problem import Path, Problem, one_form
from mpmfw.units import Density, Inertia, Mass, TimeTable, axial_form, problems_in_time

if TYPE_CHECKING:
    from mpmfw.scene.bodies import RigidBody


#: A number in 2D; in 3D about the axes x, y and z.
Inertias = Annotated[
    Annotated[Annotated[Inertia, Field(gt=0)], Tag("single")]
    | Annotated[tuple[Inertia, Inertia, Inertia], Strict(False), Tag("vector")],
    Discriminator(axial_form),
]


class Motion(Table):
    """Prescribed motion: constant, or rows over time, linear in between and constant outside."""

    velocity: VelocityInTime | None = None  #: of the reference point [m/s]
    angular_velocity: SpinInTime | None = None  #: [rad/s]
    about: Position | None = None  #: reference point at the start [m], which moves along; or the centroid
    surface_velocity: VelocityInTime | None = None  #: of a belt over the body, which does not follow [m/s]


#: Components of a free motion; rotations about one axis are for space.
Held = Literal["x", "y", "z", "rotation", "rotation-x", "rotation-y", "rotation-z"]


class Rigid(Table):
    """Motion of a rigid body: a prescribed ``motion``, or free with a mass.

    The mass follows from a ``density`` [kg/m^3], or is given as ``mass`` [kg] with the ``inertia`` [kg m^2]
    about the centroid. Components in ``held`` stay as they are. A ``force`` [N] through the centroid and a
    ``torque`` [N m] are constant or in time."""

    motion: Motion | None = None
    density: Annotated[Density, Field(gt=0)] | None = None
    mass: Annotated[Mass, Field(gt=0)] | None = None
    inertia: Inertias | None = None
    held: Annotated[tuple[Held, ...], Strict(False)] | None = None
    force: SideForce | None = None
    torque: TorqueInTime | None = None


RigidTable = Annotated[
    Annotated[Literal[True], Tag("at rest")] | Annotated[Rigid, Tag("moves")],
    Discriminator(lambda value: "at rest" if isinstance(value, bool) else "moves"),
]


def _refuse(_: Any) -> Any:
    raise ValueError("does not apply to a rigid body: it has no material points, and does not deform")


#: Rotations about single axes, in space.
AXES = ("rotation-x", "rotation-y", "rotation-z")

#: Keys of a rigid body whose motion is that of forces.
OF_FREE = {"held", "force", "torque"}

#: A key of deformable bodies.
OfDeformable = Annotated[Any, BeforeValidator(_refuse)]


def check_rigid(body: RigidBody, path: Path, dim: int, *, turns: bool) -> Iterator[Problem]:
    """Yield the problems of a rigid body's table at ``path``; one that never ``turns`` needs no inertia."""
    at, rigid = (*path, "rigid"), body.rigid
    if body.prescribed:
        for key in ("velocity", "angular_velocity"):
            if getattr(body, key) is not None:
                moves = "the body is at rest" if rigid is True else "rigid.motion says how the body moves"
                yield Problem((*path, key), f"has no effect: {moves}; expected rigid.motion.{key}")
    if body.geometry.type == "half_space" and not body.prescribed:
        yield Problem(at, "a half_space has no mass; expected rigid = true, or rigid.motion")
    if isinstance(rigid, bool):
        return
    given = rigid.model_fields_set - OF_FREE - (set() if turns else {"inertia"})
    of_free, mass = sorted(OF_FREE & rigid.model_fields_set), "mass and inertia" if turns else "mass"
    if of_free and not given:
        yield Problem(at, f"has {' and '.join(of_free)}, and no mass; expected density, or {mass}")
    else:
        yield from one_form(at, given, "motion", "density", mass, "or rigid = true")
    yield from _free(rigid, at, dim)
    if rigid.motion is not None:
        for key in of_free:
            yield Problem((*at, key), "has no effect: rigid.motion says how the body moves")
        yield from _motion(rigid.motion, (*at, "motion"), dim)
        if isinstance(body.geometry, HalfSpace) and body.geometry.dim == dim:
            yield from _belt(rigid.motion, body.geometry, (*at, "motion", "surface_velocity"))


def _free(rigid: Rigid, at: Path, dim: int) -> Iterator[Problem]:
    """Yield the problems of the forces on a free body and of its mass."""
    yield from _held(rigid.held, (*at, "held"), dim)
    for index, message in problems_in_time(rigid.force, dim):
        yield Problem((*at, "force", *index), message)
    yield from _axial(rigid.torque, (*at, "torque"), dim, "N m")
    for name in rigid.held or ():
        if name == "rotation" and rigid.torque is not None:
            yield Problem((*at, "torque"), "has no effect: the rotation is held")
        elif name in AXES and dim == 3 and acts_along(rigid.torque, AXES.index(name)):
            yield Problem((*at, "torque"), f"has no effect: {name} is held; expected 0 there")
        elif name in "xyz" and acts_along(rigid.force, "xyz".index(name)):
            yield Problem((*at, "force"), f"has no effect along {name}, which is held; expected 0 there")
    yield from check_spin(rigid.inertia, (*at, "inertia"), dim, "kg m^2")
    if dim == 3 and isinstance(rigid.inertia, tuple):
        *others, largest = sorted(rigid.inertia)
        if largest > (1.0 + 1e-9) * sum(others):
            text = f"{largest:g} kg m^2 exceeds the other two together; expected at most {sum(others):g}"
            yield Problem((*at, "inertia"), text)
        elif others[0] < 1e-8 * largest and set(AXES).intersection(rigid.held or ()):
            text = f"{others[0]:g} kg m^2 does not go with a rotation that is held about one axis"
            yield Problem((*at, "inertia"), f"{text}; expected at least {1e-8 * largest:g}")


def acts_along(given: Any, axis: int) -> bool:
    """Return True if a vector or rows (t, x, y[, z]) have a component along ``axis`` that is not 0."""
    rows = [] if not given else given if isinstance(given[0], tuple) else [(0.0, *given)]
    return any(value != 0.0 for row in rows for value in row[axis + 1 : axis + 2])


def _belt(motion: Motion, geometry: HalfSpace, at: Path) -> Iterator[Problem]:
    """Refuse a belt velocity that is not along the plane at all times."""
    if motion.surface_velocity is None or any(problems_in_time(motion.surface_velocity, geometry.dim)):
        return
    if motion.angular_velocity is not None:
        yield Problem(at, "does not go with angular_velocity: the belt of a half_space runs along its plane")
    values = TimeTable.of(motion.surface_velocity).values
    across = np.abs(values @ geometry.axes[-1])
    if (across > 1e-6 * np.linalg.norm(values, axis=1)).any():
        text = f"{across.max():g} m/s along the normal of the half_space; expected a vector along its plane"
        yield Problem(at, text)


def _held(held: tuple[str, ...] | None, at: Path, dim: int) -> Iterator[Problem]:
    names = set(held or ())
    if len(names) < len(held or ()):
        yield Problem(at, "names a component twice")
    turns = names.intersection(AXES)
    if dim == 2 and (wrong := names.intersection(("z", *AXES))):
        yield Problem(at, f"'{min(wrong)}' is a component in 3D; expected x, y or rotation")
    elif turns and ("rotation" in names or len(turns) == len(AXES)):
        yield Problem(at, "holds rotations about all axes; expected 'rotation' alone for these")
    elif len(names) == dim + 1 and not turns:
        yield Problem(at, "holds the whole motion; expected rigid = true, or rigid.motion")


def _motion(motion: Motion, at: Path, dim: int) -> Iterator[Problem]:
    if motion.velocity is None and motion.angular_velocity is None and motion.surface_velocity is None:
        expected = "velocity, angular_velocity or surface_velocity, or rigid = true"
        yield Problem(at, f"moves nothing; expected {expected}")
    for key in ("velocity", "about", "surface_velocity"):
        for index, message in problems_in_time(getattr(motion, key), dim):
            yield Problem((*at, key, *index), message)
    yield from _axial(motion.angular_velocity, (*at, "angular_velocity"), dim, "rad/s")


def _axial(given: Any, at: Path, dim: int, unit: str) -> Iterator[Problem]:
    if axial_form(given) == "rows":
        for index, message in problems_in_time(given, 1 if dim == 2 else 3):
            yield Problem((*at, *index), message)
    else:
        yield from check_spin(given, at, dim, unit)


def check_spin(given: Any, at: Path, dim: int, unit: str) -> Iterator[Problem]:
    """Refuse spins other than a number in the plane, and three components in space."""
    if given is not None and isinstance(given, tuple) != (dim == 3):
        expected = f"an array of 3 components in {unit}" if dim == 3 else f"a number in {unit}"
        yield Problem(at, f"expected {expected}, because the grid is {dim}D")
