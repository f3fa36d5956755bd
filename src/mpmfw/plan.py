"""The effect plan: each effect is imported and registered only if the scene calls for it, and says why or why
not."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.build import Build
from mpmfw.errors import SceneError
from mpmfw.pairs import overlapping
from mpmfw.recording import recorded
from mpmfw.state import Body

if TYPE_CHECKING:
    from mpmfw.effects.constraint import PrescribedSide
    from mpmfw.fields import FloatArray
    from mpmfw.scene.tables import Side

AXIS = {"left": 0, "right": 0, "bottom": 1, "top": 1, "back": 2, "front": 2}
UPPER = frozenset({"right", "top", "front"})

#: Distance within which an outline lies on a side [cells].
FLAT = 1e-6


def plan(made: Build) -> None:
    """Decide every effect; fill ``made.effects`` and ``made.plugins``, and make the surface if something
    needs it."""
    made.plugins += [*made.materials.values(), made.shape]
    _transfer(made)
    _domains(made)
    _contact(made)
    _surface(made)
    _gravity(made)
    _settling(made)
    _sides(made)
    _rotation(made)
    recorded(made)


def _transfer(made: Build) -> None:
    transfer = made.transfer
    chosen = "as auto for" if made.scene.stepping.transfer == "auto" else "given, with"
    made.note(
        "affine field",
        transfer.affine is not None,
        f"transfer {transfer.name}, {chosen} shape {made.shape.name}",
    )
    if transfer.affine is not None:
        how = "C is carried along with the motion" if transfer.transported else "C stays as gathered"
        made.note("transported affine gradient", transfer.transported, how)
    stored = transfer.affine == "moment"
    how = "stores B, D⁻¹ comes at the next projection" if stored else "does not store B"
    made.note("affine moments", stored, f"transfer {transfer.name} {how}")


def _domains(made: Build) -> None:
    """Domains with a state of their own, which a shape function moves in every step."""
    moves = hasattr(made.shape, "update_particle_domains")
    how = "moves its domains in every step" if moves else "has no domains that it would move"
    made.note("domain tracking", moves, f"shape {made.shape.name} {how}")


def _contact(made: Build) -> None:
    count = len(made.state.bodies)
    if made.contact is None:
        made.note("contact", False, "one body" if count == 1 else "not named")
        return
    acts = type(made.contact).__name__
    pairs = str(len(made.state.pairs)) if made.state.near is None else "those that come near"
    made.note("contact", True, f"{made.contact.name} ({acts}), pairs: {pairs}")
    per_body = made.contact.velocity_fields == "per_body"
    made.note(
        "velocity field per body",
        per_body,
        f"contact '{made.contact.name}' asks for {made.contact.velocity_fields}",
    )
    if not made.contact.uses_friction:
        made.note("friction", False, f"contact '{made.contact.name}' does not use it")
    else:
        law = made.friction_law
        frictional = "every pair" if law is not None and law.cohesive else _frictional(made)
        by = "" if law is None else f", by {law.label}"
        made.note("friction", bool(frictional), frictional + by if frictional else "μ = 0 in every pair")
    _search(made, made.contact.reach(made.state.grid.cell_size))
    made.plugins += [made.contact, *made.contact.parts()]


def _frictional(made: Build) -> str:
    """The pairs with friction; where pairs are listed as they come near those that the scene names, and all others at once."""
    named = [pair.label for pair in made.state.pairs if pair.friction > 0.0]
    near = made.state.near
    others = (
        [f"μ = {near.friction:g} in pairs without a value of their own"] if near and near.friction else []
    )
    return ", ".join([*named, *others])


def _search(made: Build, reach: float | None) -> None:
    """Whether bodies are near enough to be searched at the start; a strategy without a reach has no search."""
    bodies = made.state.bodies
    if reach is None or len(bodies) < 2:
        return
    if made.state.near is None:
        ends = [(bodies[pair.first], bodies[pair.second]) for pair in made.state.pairs]
    else:
        lower, upper = (np.array([getattr(body, end) for body in bodies]) for end in ("lower", "upper"))
        near = overlapping(lower - 0.5 * reach, upper + 0.5 * reach)
        ends = [(bodies[a], bodies[b]) for a, b in zip(*(index.tolist() for index in near), strict=True)]
    if not ends:
        what = f"no two bodies' boxes are within its reach of {reach:.4g} m at the start"
        made.note("contact search", False, f"asleep until bodies are near: {what}")
        return
    apart = {f"{first.name}-{second.name}": _apart(first, second) for first, second in ends}
    nearest = min(apart, key=lambda label: apart[label])
    awake = apart[nearest] <= reach
    what = f"the boxes of {nearest} are {apart[nearest]:.4g} m apart at the start, its reach is {reach:.4g} m"
    made.note("contact search", awake, what if awake else f"asleep until bodies are near: {what}")


def _apart(first: Body, second: Body) -> float:
    """Distance of two bounding boxes along the axis on which they are farthest apart [m], as a search takes it."""
    gaps = zip(first.lower, first.upper, second.lower, second.upper, strict=True)
    return max(0.0, *(max(low - top, bottom - high) for bottom, top, low, high in gaps))


def _surface(made: Build) -> None:
    """Outlines are tracked if the contact, a pressure or the gap diagnostic needs them."""
    contact, scene, state = made.contact, made.scene, made.state
    pressed = any(side.pressure is not None for body in scene.bodies.values() for side in body.sides)
    measured = _gap(made)
    by_contact = contact is not None and contact.needs_surface
    users = [
        *([f"contact '{contact.name}'"] if by_contact and contact is not None else []),
        *(["pressure"] if pressed else []),
        *(["min_gap"] if measured else []),
    ]
    if not made.note(
        "surfaces", bool(users), "for " + ", ".join(users) if users else "nothing needs outlines"
    ):
        return
    from mpmfw.effects.surface import GapDiagnostic, SurfaceTracker, make_surface

    stage = "contact" if by_contact else "force" if pressed else "gap"
    state.surface = make_surface(state.bodies, state.grid.n_fields, stage)
    chosen = contact.surface_map if by_contact and contact is not None else "auto"
    if chosen == "auto":
        chosen = "mass_weighted" if made.shape.massless_boundary else "plain"
    made.note(f"surface map {chosen}", True, f"shape {made.shape.name}")
    made.plugins.append(SurfaceTracker(chosen, stage))
    if measured:
        made.plugins.append(GapDiagnostic(watched=contact is not None and contact.keeps_apart))


def _gap(made: Build) -> bool:
    """Whether the least distance of every pair is measured."""
    scene = made.scene
    if not scene.output.gap:
        return made.note("least gap", False, "output.gap = false")
    if len(made.state.bodies) == 1:
        return made.note("least gap", False, "one body")
    return made.note("least gap", True, "output.gap")


def _gravity(made: Build) -> None:
    gravity, settle = made.scene.gravity, made.scene.settle
    settling = settle is not None and settle.gravity is not None
    reason = (
        "[gravity]"
        if gravity is not None
        else "[settle.gravity], while settling"
        if settling
        else "no [gravity]"
    )
    if not made.note("gravity", gravity is not None or settling, reason):
        return
    from mpmfw.effects.gravity import Gravity

    if gravity is None:
        times, values = np.zeros(1), np.zeros((1, made.scene.dim))
    elif gravity.is_constant:
        times, values = np.zeros(1), np.array([gravity.at(0.0)])
    else:
        rows = np.array(gravity.table)
        times, values = rows[:, 0], rows[:, 1:]
    made.plugins.append(Gravity(times, values))


def _settling(made: Build) -> None:
    """The damping itself is registered only while the scene settles, so nothing of it is planned here."""
    settle = made.scene.settle
    reason = "no [settle]"
    if settle is not None:
        given_up = "60 crossings" if settle.max_time is None else f"{settle.max_time:g} s"
        reason = f"[settle]: to {settle.tolerance:g} of the first force, for {given_up} at most"
    made.note("settling", settle is not None, reason)


def _sides(made: Build) -> None:
    given = [(body, side) for body in made.state.bodies for side in made.scene.bodies[body.name].sides]
    prescribed = [(body, side) for body, side in given if side.pressure is None]
    pressed = [(body, side) for body, side in given if side.pressure is not None]
    names = ", ".join(f"{body.name} {side.side}" for body, side in prescribed)
    if made.note("prescribed sides", bool(prescribed), names or "no fixed or moving side"):
        from mpmfw.effects.constraint import Constraint

        sides = tuple(_prescribed(made, body, side) for body, side in prescribed)
        made.plugins.append(Constraint(sides, made.shape.boundary_degree))
    names = ", ".join(f"{body.name} {side.side}" for body, side in pressed)
    if made.note("pressure", bool(pressed), names or "no side under pressure"):
        made.plugins.append(_pressure(made, pressed))


def _face(made: Build, body: Body, side: Side) -> tuple[FloatArray, float]:
    """Outward unit normal n of a body's side, and n·x on it [m]; the sides of a turned body are its own."""
    axes = made.scene.bodies[body.name].geometry.axes
    normal = (1.0 if side.side in UPPER else -1.0) * axes[AXIS[side.side]]
    if body.outlines:
        return normal, max(float((loop @ normal).max()) for loop in body.outlines)
    return normal, float(np.maximum(normal * body.lower, normal * body.upper).sum())


def _prescribed(made: Build, body: Body, side: Side) -> PrescribedSide:
    """A fixed or moving side.

    Raises
    ------
    SceneError
        Nothing of the outline lies along it: it would hold a corner.
    """
    from mpmfw.effects.constraint import PrescribedSide

    normal, place = _face(made, body, side)
    tolerance = FLAT * made.state.grid.cell_size
    at_side = [np.abs(loop @ normal - place) <= tolerance for loop in body.outlines]
    along = (on[corners].all(axis=1).any() for on, corners in zip(at_side, body.facets, strict=True))
    if body.outlines and not any(along):
        raise SceneError(
            f"bodies.{body.name}.sides: no part of the outline lies along the side '{side.side}'"
        )
    axes = made.scene.bodies[body.name].geometry.axes
    alone = made.state.grid.n_fields == len(made.state.bodies)
    return PrescribedSide(body, normal, place, axes, _velocity(side, made.scene.dim), alone)


def _velocity(side: Side, dim: int) -> Any:
    """Prescribed velocity of a side, NaN where a component is free."""
    if side.velocity is not None:
        return np.array([np.nan if isinstance(v, str) or v is None else float(v) for v in side.velocity])
    fixed = np.zeros(dim)
    if side.fixed is not None and side.fixed is not True:
        for d, name in enumerate("xyz"[:dim]):
            if name not in side.fixed:
                fixed[d] = np.nan
    return fixed


def _pressure(made: Build, pressed: list[tuple[Body, Side]]) -> Any:
    from mpmfw.effects.pressure import Pressure, facets_on_side

    surface = made.state.surface
    if surface is None:
        raise RuntimeError("pressure needs tracked surfaces")
    loads = []
    for body, side in pressed:
        normal, place = _face(made, body, side)
        tolerance = FLAT * made.state.grid.cell_size
        own = surface.facets_of(body.index)
        loaded = facets_on_side(surface.position, surface.facets, own, normal, place, tolerance)
        if len(loaded) == 0:
            raise SceneError(f"bodies.{body.name}.sides: no surface facet lies on the side '{side.side}'")
        loads.append((float(side.pressure or 0.0), loaded))
    return Pressure(tuple(loads))


def _rotation(made: Build) -> None:
    """Local spin for a free body with a velocity field of its own, unless the shape function or the scene says otherwise."""
    treated: dict[str, list[Body]] = {"spin": [], "exact": [], "local": [], "lumped": []}
    for body in made.state.bodies:
        how, reason = _rotation_of(made, body)
        made.note(f"rotation of {body.name}: {how}", how != "lumped", reason)
        treated[how].append(body)
    if treated["spin"]:
        from mpmfw.effects.local_spin import LocalSpin

        made.plugins.append(LocalSpin(tuple(treated["spin"]), _constraint_on(made, treated["spin"])))
    if treated["exact"]:
        from mpmfw.effects.rotation import ExactRotation

        made.plugins.append(ExactRotation(tuple(treated["exact"])))
    if treated["local"]:
        from mpmfw.effects.local_inertia import LocalInertia

        made.plugins.append(LocalInertia(tuple(treated["local"]), _constraint_on(made, treated["local"])))


def _is_held(made: Build, body: Body) -> bool:
    """Whether the body has prescribed sides."""
    return any(side.pressure is None for side in made.scene.bodies[body.name].sides)


def _constraint_on(made: Build, bodies: list[Body]) -> Any:
    """The boundary conditions, if one of the bodies has any."""
    if not any(_is_held(made, body) for body in bodies):
        return None
    return next(plugin for plugin in made.plugins if plugin.name == "constraint")


def _rotation_of(made: Build, body: Body) -> tuple[str, str]:
    model = made.scene.bodies[body.name]
    if model.rotation == "lumped":
        return "lumped", "given"
    if made.state.grid.n_fields < len(made.state.bodies):
        return "lumped", "shares its velocity field with other bodies"
    if made.contact is not None and made.contact.adds_mass:
        return "lumped", f"contact '{made.contact.name}' adds inertia of its own to the nodes"
    if model.rotation is None and _is_held(made, body):
        return "lumped", "prescribed sides hold it"
    if model.rotation is None:
        how = made.shape.auto_rotation
        if how == "exact" and not model.geometry.is_connected:
            return "lumped", "not connected"
        return how, "free body" if how == "spin" else f"the default of shape function '{made.shape.name}'"
    if model.rotation == "exact" and _is_held(made, body):
        raise SceneError(
            f"bodies.{body.name}.rotation: 'exact' is for a free body, and this one has prescribed sides; "
            "expected 'spin', 'local' or 'lumped'"
        )
    if model.rotation == "exact" and not model.geometry.is_connected:
        raise SceneError(
            f"bodies.{body.name}.rotation: 'exact' is for a connected body, and this one has parts; "
            "expected 'spin', 'local' or 'lumped'"
        )
    return model.rotation, "given"
