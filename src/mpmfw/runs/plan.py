"""The effect plan: each effect is imported and made only if the scene calls for it, and says why or why not.

What an effect is made of is in its own file; here is when it is called for, and their order.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mpmfw.contact import planning
from mpmfw.effects.settling import called_for
from mpmfw.errors import SceneError
from mpmfw.plugin.checks import naming
from mpmfw.plugin.effect import Plan
from mpmfw.runs.build import Build
from mpmfw.runs.recording import plan_records
from mpmfw.state.structs import Body


def plan_effects(made: Build, limits: Callable[[], list[tuple[float, str]]]) -> Plan:
    """Decide every effect, and make the plug-ins that act, and the surface if something needs it.

    Parameters
    ----------
    made
        What was built of the scene.
    limits
        Every stable time step [s] with its owner, for those who record it.
    """
    plan = Plan(plugins=[*made.materials.values(), made.shape])
    _transfer(made, plan)
    _domains(made, plan)
    with naming(made.contact, "its planning"):
        planning.planned(made, plan)
    _surface(made, plan)
    _gravity(made, plan)
    plan.note("settling", *called_for(made.scene.settle))
    _sides(made, plan)
    _named(made, plan)
    _rotation(made, plan)
    plan_records(made, plan, limits)
    _sleep(made, plan)
    return plan


def _transfer(made: Build, plan: Plan) -> None:
    transfer = made.transfer
    chosen = "as auto for" if made.scene.stepping.transfer == "auto" else "given, with"
    plan.note(
        "affine field",
        transfer.affine is not None,
        f"transfer {transfer.name}, {chosen} shape {made.shape.name}",
    )
    if transfer.affine is not None:
        how = "C is carried along with the motion" if transfer.transported else "C stays as gathered"
        plan.note("transported affine gradient", transfer.transported, how)
    stored = transfer.affine == "moment"
    how = "stores B, D⁻¹ comes at the next projection" if stored else "does not store B"
    plan.note("affine moments", stored, f"transfer {transfer.name} {how}")


def _domains(made: Build, plan: Plan) -> None:
    """Domains with a state of their own, which a shape function moves in every step."""
    moves = hasattr(made.shape, "update_particle_domains")
    how = "moves its domains in every step" if moves else "has no domains that it would move"
    plan.note("domain tracking", moves, f"shape {made.shape.name} {how}")


def _surface(made: Build, plan: Plan) -> None:
    """Outlines are tracked if the contact, a load or the gap diagnostic needs them."""
    contact = made.contact
    on_surfaces = [f"'{plugin.title}'" for plugin in made.named_plugins if plugin.needs_surface]
    loaded = any(side.is_loaded for body in made.scene.bodies.values() for side in body.sides)
    measured = _gap(made, plan)
    users = [
        *([f"contact '{contact.name}'"] if contact is not None and contact.needs_surface else []),
        *(["loads on sides"] if loaded else []),
        *on_surfaces,
        *(["min_gap"] if measured else []),
        *(["all bodies"] if made.whole is not None and made.whole.state.surface is not None else []),
    ]
    if not plan.note(
        "surfaces", bool(users), "for " + ", ".join(users) if users else "nothing needs outlines"
    ):
        return
    from mpmfw.effects.surface import planned

    chosen, plugins = planned(made, loaded=loaded or bool(on_surfaces), measured=measured)
    plan.note(f"surface map {chosen}", True, f"shape {made.shape.name}")
    plan.plugins += plugins


def _gap(made: Build, plan: Plan) -> bool:
    """Whether the least distance of every pair is measured."""
    scene = made.scene
    if not scene.output.gap:
        return plan.note("least gap", False, "output.gap = false")
    if len(made.state.bodies) == 1:
        return plan.note("least gap", False, "one body")
    return plan.note("least gap", True, "output.gap")


def _gravity(made: Build, plan: Plan) -> None:
    settle, acts = made.scene.settle, made.scene.gravity is not None
    settling = settle is not None and settle.gravity is not None
    reason = "[gravity]" if acts else "[settle.gravity], while settling" if settling else "no [gravity]"
    if plan.note("gravity", acts or settling, reason):
        from mpmfw.effects.gravity import planned

        plan.plugins.append(planned(made))


def _sides(made: Build, plan: Plan) -> None:
    given = [(body, side) for body in made.state.bodies for side in made.scene.bodies[body.name].sides]
    held = ", ".join(f"{body.name} {side.side}" for body, side in given if not side.is_loaded)
    if plan.note("prescribed sides", bool(held), held or "no fixed or moving side"):
        from mpmfw.effects import constraint

        plan.plugins.append(constraint.planned(made))
    loaded = ", ".join(f"{body.name} {side.side}" for body, side in given if side.is_loaded)
    if plan.note("loads on sides", bool(loaded), loaded or "no side has a pressure, traction or force"):
        from mpmfw.effects import side_loads

        plan.plugins += side_loads.planned(made)


def _named(made: Build, plan: Plan) -> None:
    """Loads, boundary conditions and outputs that the scene names; loads on surfaces act on all facets of
    their bodies.
    """
    for group, plugins in made.named.items():
        acting = [f"{name} ({plugin.label})" for name, plugin in plugins.items()]
        plan.note(group, bool(acting), ", ".join(acting) or f"no [{group}]")
        plan.plugins += plugins.values()
    for load in made.named["loads"].values():
        if load.needs_surface and (surface := made.state.surface) is not None:
            own = [surface.facets_of(body.index) for body in load.bodies]
            load.facets = np.concatenate([np.arange(each.start, each.stop) for each in own])  # type: ignore[attr-defined]


def _rotation(made: Build, plan: Plan) -> None:
    """Local spin for a free body with a velocity field of its own, unless the shape function or the scene
    says otherwise.
    """
    treated: dict[str, list[Body]] = {"spin": [], "exact": [], "lumped": []}
    for body in made.state.bodies:
        how, reason = _rotation_of(made, body)
        plan.note(f"rotation of {body.name}: {how}", how != "lumped", reason)
        plan.rotations[body.name] = how
        treated[how].append(body)

    if treated["spin"]:
        from mpmfw.effects.local_spin import LocalSpin

        held = any(_is_held(made, body) for body in treated["spin"])
        plan.plugins.append(LocalSpin(tuple(treated["spin"]), plan.plugin("constraint") if held else None))
    if treated["exact"]:
        from mpmfw.effects.rotation import ExactRotation

        plan.plugins.append(ExactRotation(tuple(treated["exact"])))


def _sleep(made: Build, plan: Plan) -> None:
    """Bodies at rest are left out of the steps."""
    asked = made.scene.sleep
    if asked is None:
        plan.note("sleep", False, "no [sleep]")
        return
    from mpmfw.runs.sleeping import check

    check(made, plan.plugins)
    reason = f"[sleep]: below {asked.strain:g} of the wave speed for {asked.crossings:g} crossings"
    plan.note("sleep", True, reason)


def _is_held(made: Build, body: Body) -> bool:
    """Whether the body has prescribed sides, or a boundary condition."""
    named = any(body in boundary.bodies for boundary in made.named["boundaries"].values())
    return named or any(not side.is_loaded for side in made.scene.bodies[body.name].sides)


def _rotation_of(made: Build, body: Body) -> tuple[str, str]:
    model = made.scene.bodies[body.name]
    if model.rotation == "lumped":
        return "lumped", "given"
    if made.state.grid.n_fields < len(made.state.bodies):
        return "lumped", "shares its velocity field with other bodies"
    if made.contact is not None and made.contact.adds_mass:
        return "lumped", f"contact '{made.contact.name}' adds inertia of its own to the nodes"
    if model.rotation is None and _is_held(made, body):
        return "lumped", "prescribed sides or boundary conditions hold it"
    if model.rotation is None:
        how = made.shape.auto_rotation
        if how == "exact" and not model.geometry.is_connected:
            return "lumped", "not connected"
        return how, "free body" if how == "spin" else f"the default of shape function '{made.shape.name}'"
    if model.rotation == "exact" and _is_held(made, body):
        raise SceneError(
            f"bodies.{body.name}.rotation: 'exact' is for a free body, and this one has prescribed sides; "
            "expected 'spin' or 'lumped'"
        )
    if model.rotation == "exact" and not model.geometry.is_connected:
        raise SceneError(
            f"bodies.{body.name}.rotation: 'exact' is for a connected body, and this one has parts; "
            "expected 'spin' or 'lumped'"
        )
    return model.rotation, "given"
