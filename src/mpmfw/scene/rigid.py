"""Tables of rigid bodies: at rest, moved as prescribed, or free with a mass."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Strict, Tag

from mpmfw.scene.base import Position, Table, VelocityInTime
from mpmfw.scene.problem import Path, Problem, one_form
from mpmfw.units import AngularVelocity, Density, Inertia, Mass, Time, length_of_row, problems_in_time

if TYPE_CHECKING:
    from mpmfw.scene.tables import RigidBody


def _kind_of_spin(value: Any) -> str:
    if not isinstance(value, list | tuple):
        return "single"
    return "rows" if value and isinstance(value[0], list | tuple) else "vector"


_Row = Annotated[
    Annotated[tuple[Time, AngularVelocity], Strict(False), Tag("two")]
    | Annotated[tuple[Time, AngularVelocity, AngularVelocity, AngularVelocity], Strict(False), Tag("three")],
    Discriminator(length_of_row),
]
#: A number in 2D, a vector in 3D; or rows of a time and either.
SpinInTime = Annotated[
    Annotated[AngularVelocity, Tag("single")]
    | Annotated[tuple[AngularVelocity, AngularVelocity, AngularVelocity], Strict(False), Tag("vector")]
    | Annotated[tuple[_Row, ...], Strict(False), Field(min_length=2), Tag("rows")],
    Discriminator(_kind_of_spin),
]
#: A number in 2D; in 3D about the axes x, y and z.
Inertias = Annotated[
    Annotated[Annotated[Inertia, Field(gt=0)], Tag("single")]
    | Annotated[tuple[Inertia, Inertia, Inertia], Strict(False), Tag("vector")],
    Discriminator(_kind_of_spin),
]


class Motion(Table):
    """Prescribed motion: constant, or rows in time, linear in between and constant outside."""

    velocity: VelocityInTime | None = None  #: of the reference point [m/s]
    angular_velocity: SpinInTime | None = None  #: [rad/s]
    about: Position | None = None  #: reference point at the start [m], which moves along; or the centroid


class Rigid(Table):
    """Motion of a rigid body: a prescribed ``motion``, or that of forces on its mass.

    The mass is that of a ``density`` [kg/m^3], or ``mass`` [kg] with the ``inertia`` [kg m^2] about the
    centroid."""

    motion: Motion | None = None
    density: Annotated[Density, Field(gt=0)] | None = None
    mass: Annotated[Mass, Field(gt=0)] | None = None
    inertia: Inertias | None = None


RigidTable = Annotated[
    Annotated[Literal[True], Tag("at rest")] | Annotated[Rigid, Tag("moves")],
    Discriminator(lambda value: "at rest" if isinstance(value, bool) else "moves"),
]


def _refuse(_: Any) -> Any:
    raise ValueError("does not apply to a rigid body: it has no material points, and does not deform")


#: A key of deformable bodies.
OfDeformable = Annotated[Any, BeforeValidator(_refuse)]


def check_rigid(body: RigidBody, path: Path, dim: int) -> Iterator[Problem]:
    """Yield the problems of a rigid body's table at ``path``."""
    at, rigid = (*path, "rigid"), body.rigid
    if body.prescribed:
        for key in ("velocity", "angular_velocity"):
            if getattr(body, key) is not None:
                moves = "the body is at rest" if rigid is True else "rigid.motion says how the body moves"
                yield Problem((*path, key), f"has no effect: {moves}; expected rigid.motion.{key}")
    if isinstance(rigid, bool):
        return
    forms = ("motion", "density", "mass and inertia", "or rigid = true")
    yield from one_form(at, rigid.model_fields_set, *forms)
    yield from check_spin(rigid.inertia, (*at, "inertia"), dim, "kg m^2")
    if rigid.motion is not None:
        yield from _motion(rigid.motion, (*at, "motion"), dim)


def _motion(motion: Motion, at: Path, dim: int) -> Iterator[Problem]:
    if motion.velocity is None and motion.angular_velocity is None:
        yield Problem(at, "moves nothing; expected velocity or angular_velocity, or rigid = true")
    for key in ("velocity", "about"):
        for index, message in problems_in_time(getattr(motion, key), dim):
            yield Problem((*at, key, *index), message)
    spin, axes = motion.angular_velocity, 1 if dim == 2 else 3
    if _kind_of_spin(spin) == "rows":
        for index, message in problems_in_time(spin, axes):
            yield Problem((*at, "angular_velocity", *index), message)
    else:
        yield from check_spin(spin, (*at, "angular_velocity"), dim, "rad/s")


def check_spin(given: Any, at: Path, dim: int, unit: str) -> Iterator[Problem]:
    """Refuse other spins than a number in the plane, and three components in space."""
    if given is not None and isinstance(given, tuple) != (dim == 3):
        expected = f"an array of 3 components in {unit}" if dim == 3 else f"a number in {unit}"
        yield Problem(at, f"expected {expected}, because the grid is {dim}D")
