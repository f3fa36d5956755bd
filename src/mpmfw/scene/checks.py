"""What must hold between the keys of a scene; each check yields one problem for each thing that is wrong."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from mpmfw.discovery import REFERENCES, announced, available, nearest
from mpmfw.scene.gravity import ConstantGravity
from mpmfw.scene.locator import Path
from mpmfw.scene.problem import Problem
from mpmfw.scene.sides import check_sides
from mpmfw.scene.tables import Body, Side, Tables
from mpmfw.scene.wording import choice_message

#: Least cell size over the largest coordinate: round-off of a position is then below 1e-6 of a cell.
SMALLEST_CELL = 1e-9

_NAME = re.compile(r"[A-Za-z0-9_]+")


#: Bodies without a plane side.
ROUND = frozenset({"disc", "ring", "ball"})

#: Names of dimensions in a run's file: a group beside a dimension of the same name cannot be read back.
_DIMENSIONS = frozenset({"time", "body", "pair", "axis", "axis2", "rotation"})


def check(scene: Tables, plugins: Mapping[Path, type[Any]]) -> Iterator[Problem]:
    """All problems between keys that are valid by themselves."""
    yield from _grid(scene)
    yield from _time(scene)
    yield from _stepping(scene, plugins)
    yield from _names(scene)
    yield from _contact(scene)
    yield from _friction_law(scene, plugins)
    yield from _loads(scene)
    yield from _reference(scene)
    for name, body in scene.bodies.items():
        yield from _body(scene, ("bodies", name), body)


def _reference(scene: Tables) -> Iterator[Problem]:
    """A kind that is neither bundled nor announced; whether the scene is one of it is asked where it is judged."""
    if scene.reference is not None:
        known = sorted({*REFERENCES, *announced("reference")})
        if scene.reference.kind not in known:
            yield Problem(("reference", "kind"), choice_message(scene.reference.kind, known))


def _grid(scene: Tables) -> Iterator[Problem]:
    grid = scene.grid
    if len(grid.lower) != len(grid.upper):
        yield Problem(
            ("grid", "upper"), f"has {len(grid.upper)} entries, but grid.lower has {len(grid.lower)}"
        )
    elif any(a + grid.cell_size > b for a, b in zip(grid.lower, grid.upper, strict=True)):
        yield Problem(("grid", "upper"), "must lie at least one cell above grid.lower in every direction")
    farthest = max(map(abs, (*grid.lower, *grid.upper)))
    if grid.cell_size < SMALLEST_CELL * farthest:
        message = (
            f"{grid.cell_size:g} m is less than {SMALLEST_CELL:g} of the grid's largest coordinate, {farthest:g} m: "
            "positions would be rounded to a visible part of a cell"
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
    for kind, table in (("bodies", scene.bodies), ("materials", scene.materials)):
        for name in table:
            if not _NAME.fullmatch(name):
                message = "a name has letters, digits and '_' only ('-' joins the names of a pair)"
                yield Problem((kind, name), message)
            elif kind == "bodies" and name in _DIMENSIONS:
                yield Problem((kind, name), f"'{name}' is a dimension of the results; expected another name")
    for name, body in scene.bodies.items():
        if body.material not in scene.materials:
            yield _no_such("material", ("bodies", name, "material"), body.material, scene.materials)


def _no_such(what: str, path: Path, name: str, valid: Mapping[str, Any]) -> Problem:
    close = nearest(name, valid)
    hint = f"did you mean '{close}'?" if close else f"the scene has {', '.join(valid)}"
    return Problem(path, f"no {what} '{name}'; {hint}")


def _contact(scene: Tables) -> Iterator[Problem]:
    if scene.contact is None:
        if len(scene.bodies) > 1:
            message = f"missing: name a method for more than one body ({', '.join(available('contact'))}, …)"
            yield Problem(("contact",), message, "missing")
        return
    seen: dict[frozenset[str], int] = {}
    for index, pair in enumerate(scene.contact.pairs):
        path: Path = ("contact", "pairs", index, "bodies")
        for k, name in enumerate(pair.bodies):
            if name not in scene.bodies:
                yield _no_such("body", (*path, k), name, scene.bodies)
        if len(set(pair.bodies)) == 1:
            yield Problem(path, f"a pair is two bodies, not '{pair.bodies[0]}' twice")
        elif seen.setdefault(frozenset(pair.bodies), index) != index:
            first = seen[frozenset(pair.bodies)]
            yield Problem(path, f"the same bodies as contact.pairs[{first}]")


def _friction_law(scene: Tables, plugins: Mapping[Path, type[Any]]) -> Iterator[Problem]:
    """A law of friction where there is none."""
    contact = scene.contact
    if contact is None or contact.friction_law is None:
        return
    law = plugins.get(("contact", contact.friction_law))
    if not (
        contact.friction or any(pair.friction for pair in contact.pairs) or getattr(law, "cohesive", True)
    ):
        yield Problem(("contact", "friction_law"), "has no effect: every pair has friction = 0")


def _loads(scene: Tables) -> Iterator[Problem]:
    if scene.gravity is not None:
        yield from _gravity(scene.gravity, ("gravity",), scene.grid.dim)
        yield from _gravity_table(scene)
    if scene.settle is None:
        return
    if scene.settle.gravity is not None:
        yield from _gravity(scene.settle.gravity, ("settle", "gravity"), scene.grid.dim)
    elif scene.gravity is None and not any(
        side.is_loaded for body in scene.bodies.values() for side in body.sides
    ):
        yield Problem(
            ("settle",), "has no effect: the scene has no gravity and no load on a side to settle under"
        )


def _gravity(gravity: ConstantGravity, path: Path, dim: int) -> Iterator[Problem]:
    given = set(gravity.model_fields_set)
    forms = [{"vector"}, {"magnitude", "tilt"}, {"table"}][
        : 3 if "table" in type(gravity).model_fields else 2
    ]
    if given not in forms:
        allowed = ", or ".join(" and ".join(sorted(form)) for form in forms)
        yield Problem(
            path, f"has {' and '.join(sorted(given)) or 'no key'}; expected exactly one of: {allowed}"
        )
    elif gravity.vector is not None and len(gravity.vector) != dim:
        yield Problem((*path, "vector"), _wrong_length(len(gravity.vector), dim))
    elif "tilt" in given and dim == 3:
        yield Problem((*path, "tilt"), "is for two dimensions; give gravity as a vector in 3D")


def _gravity_table(scene: Tables) -> Iterator[Problem]:
    rows = (scene.gravity.table if scene.gravity else None) or ()
    yield from _rows_in_time(rows, ("gravity", "table"), scene.grid.dim)


def _rows_in_time(rows: Sequence[tuple[float, ...]], path: Path, components: int) -> Iterator[Problem]:
    """Rows of a time and so many components, with times that increase."""
    for index, row in enumerate(rows):
        if len(row) != components + 1:
            message = f"has {len(row)} entries; expected the time and {components} components"
            yield Problem((*path, index), message)
    for index, (before, after) in enumerate(itertools.pairwise(rows)):
        if after[0] <= before[0]:
            yield Problem(
                (*path, index + 1), f"times must increase, but {after[0]:g} s follows {before[0]:g} s"
            )


def _wrong_length(given: int, dim: int) -> str:
    return f"has {given} entries; expected {dim}, because the grid is {dim}D"


def _body(scene: Tables, path: Path, body: Body) -> Iterator[Problem]:
    dim = scene.grid.dim
    # The dimension of a mesh file is known when it is read
    shape_dim = getattr(body.geometry, "dim", dim)
    if shape_dim != dim:
        message = f"'{body.geometry.type}' is {shape_dim}D, but the grid is {dim}D"
        yield Problem((*path, "geometry", "type"), message)
    if len(body.particles.offset) > dim:
        yield Problem((*path, "particles", "offset"), _wrong_length(len(body.particles.offset), dim))
    if body.velocity is not None and len(body.velocity) != dim:
        yield Problem((*path, "velocity"), _wrong_length(len(body.velocity), dim))
    if body.angular_velocity is not None and isinstance(body.angular_velocity, tuple) != (dim == 3):
        expected = "an array of 3 components in rad/s" if dim == 3 else "a number in rad/s"
        yield Problem((*path, "angular_velocity"), f"expected {expected}, because the grid is {dim}D")
    wrong = [problem for i in range(len(body.sides)) for problem in _side(body, (*path, "sides", i), i, dim)]
    yield from wrong or check_sides(body, path, dim, scene.time.end)


def _load_in_time(side: Side, path: Path, dim: int) -> Iterator[Problem]:
    """Tables of a load, and the components of a traction."""
    if isinstance(side.pressure, tuple):
        yield from _rows_in_time(side.pressure, (*path, "pressure"), 1)
    if side.traction is not None and isinstance(side.traction[0], tuple):
        yield from _rows_in_time(side.traction, (*path, "traction"), dim)
    elif side.traction is not None and len(side.traction) != dim:
        yield Problem((*path, "traction"), _wrong_length(len(side.traction), dim))


def _side(body: Body, path: Path, index: int, dim: int) -> Iterator[Problem]:
    side = body.sides[index]
    given = sorted(side.model_fields_set & {"fixed", "velocity", "pressure", "traction"})
    if len(given) != 1:
        has = " and ".join(given) or "none of them"
        yield Problem(path, f"has {has}; expected exactly one of: fixed, velocity, pressure, traction")
    if dim == 2 and side.side in ("back", "front"):
        yield Problem(
            (*path, "side"), f"'{side.side}' is a side in 3D; expected one of left, right, bottom, top"
        )
    if body.geometry.type in ROUND:
        yield Problem(
            (*path, "side"), f"a {body.geometry.type} has no plane side; expected a body that has one"
        )
    if isinstance(side.fixed, tuple) and "z" in side.fixed and dim == 2:
        yield Problem((*path, "fixed"), "'z' is a component in 3D; expected x or y")
    if isinstance(side.fixed, tuple) and len(set(side.fixed)) != len(side.fixed):
        yield Problem((*path, "fixed"), "names a component twice")
    if side.velocity is not None and len(side.velocity) != dim:
        yield Problem((*path, "velocity"), _wrong_length(len(side.velocity), dim))
    yield from _load_in_time(side, path, dim)
    if side.velocity is not None and all(component == "free" for component in side.velocity):
        yield Problem((*path, "velocity"), "has no effect: every component is free")
    same = [
        other
        for other in body.sides[:index]
        if other.side == side.side and other.model_fields_set & set(given)
    ]
    if same and given != ["fixed"]:
        yield Problem(path, f"a second {' and '.join(given)} for side '{side.side}'")
