"""Checks between the keys of a scene; each yields a problem for each contradiction."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from mpmfw.geometry import SurfaceMesh
from mpmfw.plugin.discovery import REFERENCES, available
from mpmfw.scene.axisymmetry import check_axisymmetry
from mpmfw.scene.bodies import AXIS, Body, RigidBody, Side, check_sides, rows_of
from mpmfw.scene.options import NAMED
from mpmfw.scene.problem import Path, Problem, one_form
from mpmfw.scene.rigid import check_rigid, check_spin
from mpmfw.scene.tables import Gravity, Tables
from mpmfw.scene.wording import unknown_name
from mpmfw.units import problems_in_time, wrong_length

#: Least cell size over the largest coordinate: round-off of a position is then below 1e-6 of a cell.
SMALLEST_CELL = 1e-9

_NAME = re.compile(r"[A-Za-z0-9_]+")

#: Bodies without a plane side.
ROUND = frozenset({"disc", "ring", "ball", "torus"})

#: Mean side of a file's triangles below which they cost much and bring nothing [cells].
FINEST = 0.02

#: Names of dimensions in a run's file: a group beside a dimension of the same name cannot be read back.
_DIMENSIONS = frozenset({"time", "body", "pair", "axis", "axis2", "rotation", "side"})


def check(scene: Tables, plugins: Mapping[Path, type[Any]], options: Mapping[Path, Any]) -> Iterator[Problem]:
    """Yield contradictions between valid keys; ``plugins`` and their ``options`` are by path."""
    yield from _grid(scene)
    yield from _time(scene)
    yield from _stepping(scene, plugins)
    yield from _names(scene)
    yield from _contact(scene)
    yield from _friction_law(scene, plugins)
    yield from _loads(scene)
    yield from _named(scene, plugins, options)
    yield from check_axisymmetry(scene, plugins)
    references = sorted({*REFERENCES, *available("reference")})
    if scene.reference is not None and scene.reference.kind not in references:
        yield unknown_name(("reference", "kind"), scene.reference.kind, references)
    yield from _in_time(scene.output.contact_moment, ("output", "contact_moment"), scene.grid.dim)
    yield from _in_time(scene.output.side_moment, ("output", "side_moment"), scene.grid.dim)
    sides = [side for body in scene.bodies.values() for side in body.sides]
    if scene.output.side_moment is not None and all(side.is_loaded for side in sides):
        yield Problem(("output", "side_moment"), "has no effect: no side is fixed or driven")
    for name, body in scene.bodies.items():
        yield from _body(scene, ("bodies", name), body)
    if all(isinstance(body, RigidBody) for body in scene.bodies.values()):
        yield Problem(("bodies",), "every body is rigid; expected one that deforms")
    if scene.sleep is not None and any(isinstance(body, RigidBody) for body in scene.bodies.values()):
        yield Problem(("sleep",), "does not go with rigid bodies: a body on a moving one cannot rest")

    if scene.sleep is not None and any(body.self_contact for body in scene.bodies.values()):
        yield Problem(("sleep",), "does not go with self_contact; leave one of them out")


def _grid(scene: Tables) -> Iterator[Problem]:
    grid = scene.grid
    if len(grid.lower) != len(grid.upper):
        message = f"has {len(grid.upper)} entries, but grid.lower has {len(grid.lower)}"
        yield Problem(("grid", "upper"), message)
    elif any(a + grid.cell_size > b for a, b in zip(grid.lower, grid.upper, strict=True)):
        yield Problem(("grid", "upper"), "must lie at least one cell above grid.lower in every direction")
    farthest = max(map(abs, (*grid.lower, *grid.upper)))
    if grid.cell_size < SMALLEST_CELL * farthest:
        message = (
            f"{grid.cell_size:g} m is less than {SMALLEST_CELL:g} of the grid's largest coordinate, "
            f"{farthest:g} m: positions would be rounded to a visible part of a cell"
        )
        yield Problem(("grid", "cell_size"), message)


def _time(scene: Tables) -> Iterator[Problem]:
    time = scene.time
    if time.output_interval > time.end:
        message = f"must not be longer than time.end, which is {time.end:g} s"
        yield Problem(("time", "output_interval"), message)
    if time.step is not None and "safety" in time.model_fields_set:
        yield Problem(("time", "safety"), "has no effect with a fixed time.step; leave one of them out")
    if time.safety > 1 and not scene.allow_unstable:
        yield Problem(("time", "safety"), f"{time.safety:g} is past the stability limit; see allow_unstable")


def _stepping(scene: Tables, plugins: Mapping[Path, type[Any]]) -> Iterator[Problem]:
    stepping, transfer, note = scene.stepping, scene.stepping.transfer, ""
    if transfer == "auto":
        shape = plugins.get(("shape", scene.shape.method))
        transfer, note = getattr(shape, "auto_transfer", "aflip"), f" (auto with {scene.shape.method})"
    if stepping.transported is not None and transfer in ("flip", "pic"):
        message = f"has no effect with transfer {transfer}{note}, only with aflip, apic and tpic"
        yield Problem(("stepping", "transported"), message)
    if stepping.pic_fraction is not None and transfer != "flip":
        message = f"has no effect with transfer {transfer}{note}, only with flip"
        yield Problem(("stepping", "pic_fraction"), message)


def _names(scene: Tables) -> Iterator[Problem]:
    for kind, table in (("bodies", scene.bodies), *((g, getattr(scene, g)) for g in NAMED)):
        for name in table:
            if not _NAME.fullmatch(name):
                message = "a name has letters, digits and '_' only ('-' joins the names of a pair)"
                yield Problem((kind, name), message)
            elif kind == "bodies" and name in _DIMENSIONS:
                yield Problem((kind, name), f"'{name}' is a dimension of the results; expected another name")
    for name, body in scene.bodies.items():
        if not isinstance(body, RigidBody) and body.material not in scene.materials:
            yield unknown_name(
                ("bodies", name, "material"), body.material, list(scene.materials), "no such material: "
            )


def _contact(scene: Tables) -> Iterator[Problem]:
    if scene.contact is None:
        if len(scene.bodies) > 1 or any(body.self_contact for body in scene.bodies.values()):
            why, known = "more than one body, or self_contact", ", ".join(available("contact"))
            message = f"missing: name a method for {why} ({known}, …)"
            yield Problem(("contact",), message, "missing")
        return
    seen: dict[frozenset[str], int] = {}
    for index, pair in enumerate(scene.contact.pairs):
        path: Path = ("contact", "pairs", index, "bodies")
        for k, name in enumerate(pair.bodies):
            if name not in scene.bodies:
                yield unknown_name((*path, k), name, list(scene.bodies), "no such body: ")
        itself = scene.bodies.get(pair.bodies[0]) if len(set(pair.bodies)) == 1 else None
        if itself is not None and not itself.self_contact:
            text = f"expected two bodies, not '{pair.bodies[0]}' twice; or self_contact = true of this body"
            yield Problem(path, text)
        elif seen.setdefault(frozenset(pair.bodies), index) != index:
            first = scene.contact.pairs[seen[frozenset(pair.bodies)]]
            yield Problem(path, f"the same bodies as the pair '{'-'.join(first.bodies)}' before")


def _friction_law(scene: Tables, plugins: Mapping[Path, type[Any]]) -> Iterator[Problem]:
    contact = scene.contact
    if contact is None or contact.friction_law is None:
        return
    law = plugins.get(("contact", contact.friction_law))
    rubs = contact.friction or any(pair.friction for pair in contact.pairs)
    if not (rubs or getattr(law, "cohesive", True)):
        yield Problem(("contact", "friction_law"), "has no effect: every pair has friction = 0")


def _loads(scene: Tables) -> Iterator[Problem]:
    if scene.gravity is not None:
        yield from _gravity(scene.gravity, ("gravity",), scene.grid.dim, "table")
        yield from _in_time(scene.gravity.table, ("gravity", "table"), scene.grid.dim)
    if scene.settle is None:
        return
    if scene.settle.gravity is not None:
        yield from _gravity(scene.settle.gravity, ("settle", "gravity"), scene.grid.dim)
        return
    bodies = scene.bodies.values()
    loaded = any(side.is_loaded for body in bodies for side in body.sides)
    loaded |= any(getattr(getattr(body, "rigid", None), "force", None) is not None for body in bodies)
    if not (scene.gravity or scene.loads or scene.allow_overlap or loaded):
        yield Problem(("settle",), "has no effect: the scene has no gravity, load or overlap to settle under")


def _named(
    scene: Tables, plugins: Mapping[Path, type[Any]], options: Mapping[Path, Any]
) -> Iterator[Problem]:
    tables = [((group, name), table) for group in NAMED for name, table in getattr(scene, group).items()]
    for path, table in tables:
        named = getattr(table, "bodies", None) or ()
        for index, body in enumerate(named):
            if body not in scene.bodies:
                yield unknown_name((*path, "bodies", index), body, list(scene.bodies), "no such body: ")
            elif body in named[:index]:
                yield Problem((*path, "bodies", index), f"names '{body}' twice")
            elif path[0] != "outputs" and isinstance(model := scene.bodies[body], RigidBody):
                text = "has no material points to act on; expected bodies that deform"
                if path[0] == "loads":
                    text = "does not move by forces; expected one with a density, or mass and inertia"
                if path[0] == "boundaries" or model.prescribed:
                    yield Problem((*path, "bodies", index), f"'{body}' is rigid, and {text}")
        judge = getattr(plugins.get(path), "problems", None)
        if path in options and judge is not None:
            for key, message in judge(options[path], scene.grid.dim):
                yield Problem((*path, *key), message)


def _gravity(gravity: Gravity, path: Path, dim: int, *others: str) -> Iterator[Problem]:
    yield from one_form(path, gravity.model_fields_set, "vector", "magnitude and tilt", *others)
    yield from _in_time(gravity.vector, (*path, "vector"), dim)
    if gravity.tilt is not None and dim == 3:
        yield Problem((*path, "tilt"), "is for two dimensions; give gravity as a vector in 3D")


def _in_time(given: Any, path: Path, components: int) -> Iterator[Problem]:
    for index, message in problems_in_time(given, components):
        yield Problem((*path, *index), message)


def _body(scene: Tables, path: Path, body: Body) -> Iterator[Problem]:
    dim = scene.grid.dim
    # The dimension of a mesh file is known when it is read
    shape_dim = getattr(body.geometry, "dim", dim)
    if shape_dim != dim:
        message = f"'{body.geometry.type}' is {shape_dim}D, but the grid is {dim}D"
        yield Problem((*path, "geometry", "type"), message)
    if isinstance(body.geometry, SurfaceMesh):
        cells = body.geometry.mean_edge / scene.grid.cell_size
        if cells < FINEST:
            text = f"the sides of the triangles are {cells:.2g} cells long on average"
            yield Problem((*path, "geometry", "path"), f"{text}; expected {FINEST:g} or more")
    if isinstance(body, RigidBody):
        yield from check_rigid(body, path, dim, turns=not scene.grid.axisymmetric)
    elif body.geometry.type == "half_space":
        yield Problem((*path, "geometry", "type"), "a half_space has no points; expected rigid = true")
    elif len(body.particles.offset) > dim:
        yield Problem((*path, "particles", "offset"), wrong_length(len(body.particles.offset), dim))
    yield from _in_time(body.velocity, (*path, "velocity"), dim)
    yield from check_spin(body.angular_velocity, (*path, "angular_velocity"), dim, "rad/s")
    if body.thickness is not None and dim == 3:
        yield Problem((*path, "thickness"), "is for two dimensions; a body of a 3D grid has its own extent")
    wrong = [problem for i in range(len(body.sides)) for problem in _side(body, (*path, "sides", i), i, dim)]
    yield from wrong or check_sides(body, path, dim, scene.time.end)


def _side(body: Body, path: Path, index: int, dim: int) -> Iterator[Problem]:
    side = body.sides[index]
    conditions = [key for key in Side.model_fields if key not in ("side", "within")]
    given = sorted(side.model_fields_set & set(conditions))
    yield from one_form(path, given, *conditions)
    fixed, shape = side.fixed if isinstance(side.fixed, tuple) else (), body.geometry.type
    plane, box = side.side in AXIS, tuple(zip(*(side.within or ()), strict=False))
    rows = () if side.velocity is None else rows_of(side.velocity)
    free = [[value == "free" for value in column] for column in zip(*rows, strict=False)][1:]
    mixed = any(any(each) and not all(each) for each in free)
    refused = (
        (dim == 2 and side.side in ("back", "front"), "side", f"'{side.side}' is a side in 3D"),
        (
            shape in ROUND and plane,
            "side",
            f"a {shape} has no plane side; expected outer or inner, and a load",
        ),
        (not plane and not side.is_loaded, "side", f"'{side.side}' takes a load; expected a plane side"),
        (side.within and not side.is_loaded, "within", "expected a load: a side moves as a whole"),
        (any(low >= high for low, high in box), "within", "the first corner must be below the second"),
        ("z" in fixed and dim == 2, "fixed", "'z' is a component in 3D; expected x or y"),
        (len(set(fixed)) != len(fixed), "fixed", "names a component twice"),
        (bool(free) and np.all(free), "velocity", "has no effect: every component is free"),
        (mixed, "velocity", "leaves a component free in some rows; expected in all of them, or in none"),
    )
    yield from (Problem((*path, key), message) for wrong, key, message in refused if wrong)
    yield from _in_time(side.velocity, (*path, "velocity"), dim)
    for corner in side.within or ():
        yield from _in_time(corner, (*path, "within"), dim)
    for key, components in (("pressure", 1), ("traction", dim), ("force", dim)):
        yield from _in_time(getattr(side, key), (*path, key), components)
    same = [o for o in body.sides[:index] if (o.side, o.within) == (side.side, side.within)]
    before = [other.model_fields_set for other in same]
    if given != ["fixed"] and any(fields & set(given) for fields in before):
        yield Problem(path, f"a second {' and '.join(given)} for side '{side.side}'", keys=(*given,))
