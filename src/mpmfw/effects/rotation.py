"""Treatment of every body's rotational inertia: ``spin``, ``exact`` or ``lumped``."""

from __future__ import annotations

from typing import Any

from mpmfw.errors import SceneError
from mpmfw.plugin.setup import Acts, Effect, Setup
from mpmfw.state.structs import Body


def from_setup(setup: Setup) -> Acts:
    """Return the corrections, and import those that a body has."""
    treated: dict[str, list[Body]] = {"spin": [], "exact": [], "lumped": []}
    plugins, lines = list[Any](), []
    for body in setup.state.soft_bodies:
        how, reason = _choice(setup, body)
        lines.append(Effect(f"rotation of {body.name}: {how}", how != "lumped", reason))
        setup.rotations[body.name] = how
        treated[how].append(body)
    if treated["spin"]:
        from mpmfw.effects.local_spin import LocalSpin

        held = any(setup.is_held(body) for body in treated["spin"])
        constraint = setup.plugin("constraint") if held else None
        plugins.append(LocalSpin(tuple(treated["spin"]), setup.half_edges, constraint))
    if treated["exact"]:
        from mpmfw.effects.exact_rotation import ExactRotation

        plugins.append(ExactRotation(tuple(treated["exact"]), setup.half_edges))
    return Acts("", plugins, lines)


def _choice(setup: Setup, body: Body) -> tuple[str, str]:
    """Return the treatment of a body, and why: local spin for a free body with a velocity field of its own.

    The shape function has another default where it turns bodies well by itself.
    """
    model, contact = setup.scene.bodies[body.name], setup.contact
    asked, held = model.rotation, setup.is_held(body)
    if asked == "lumped":
        return "lumped", "given"
    if not setup.field_per_body:
        return "lumped", "shares its velocity field with other bodies"
    if contact is not None and contact.adds_mass:
        return "lumped", f"contact '{contact.name}' adds inertia of its own to the nodes"
    if asked is None and held:
        return "lumped", "prescribed sides or boundary conditions hold it"
    if asked is None:
        how = setup.shape_function.auto_rotation
        if how == "exact" and not model.geometry.is_connected:
            return "lumped", "not connected"
        return how, "free body" if how == "spin" else f"the default of shape function '{setup.shape}'"
    if asked == "exact" and (held or not model.geometry.is_connected):
        kind, has = ("free", "prescribed sides") if held else ("connected", "parts")
        raise SceneError(
            f"'exact' is for a {kind} body, and this one has {has}; expected 'spin' or 'lumped'",
            key=f"bodies.{body.name}.rotation",
        )
    return asked, "given"
