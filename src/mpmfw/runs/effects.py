"""The effects of a scene in the order of their hooks: those that act, and why the others do not."""

from __future__ import annotations

from pkgutil import resolve_name
from typing import Any

from mpmfw.errors import SceneError
from mpmfw.plugin.setup import Acts, Effect, Setup
from mpmfw.state.structs import Body


def add_effects(setup: Setup) -> None:
    """Add the plug-ins of all effects that act, and a line for every effect.

    A file ``module:function`` of the table is imported only if the scene needs it. The function returns
    :class:`mpmfw.plugin.setup.Acts`, or the reason why nothing acts."""
    setup.effects += _of_methods(setup)
    for name, decides, called_for, otherwise in _table(setup):
        answer = resolve_name(f"mpmfw.{decides}")(setup) if called_for else otherwise
        acts = answer if isinstance(answer, Acts) else Acts(answer)
        if name:
            setup.effects.append(Effect(name, acts is answer, acts.reason))
        setup.plugins += acts.plugins
        setup.effects += acts.lines


def _table(setup: Setup) -> list[tuple[str, str, object, str]]:
    """Return name, ``module:function``, whether the scene needs it, and why not.

    The name is empty if the effect writes its lines itself, or has none."""
    scene, output, bodies = setup.scene, setup.scene.output, setup.state.bodies
    several, contact = bool(setup.state.pairs or len(bodies) > 1), setup.contact
    rigid = [getattr(scene.bodies[body.name], "rigid", None) for body in bodies if body.rigid]
    pressed = any(getattr(each, key, None) is not None for each in rigid for key in ("force", "torque"))
    gravity = scene.gravity or (scene.settle and scene.settle.gravity)
    damped = any(scene.materials[name].damping for name in setup.materials)
    surfaces, averaged, held = setup.surface_users, setup.averaged_bodies, setup.held_sides
    slides = setup.whole is None and contact is not None and contact.uses_friction
    slides = slides and setup.friction_law is None and setup.has_friction
    no_gap = "one body" if output.gap else "output.gap = false"
    return [
        ("axisymmetry", "effects.axisymmetry:Axisymmetry.from_setup", scene.grid.axisymmetric,
         "grid.axisymmetric = false"),
        ("rigid bodies", "effects.rigid:RigidBodies.from_setup", rigid, "no rigid body"),
        ("contact", "contact.strategy:from_setup", True, ""),
        ("forces on rigid bodies", "effects.rigid_forces:RigidForces.from_setup", pressed,
         "no rigid body has a force or torque"),
        ("pairs of rigid bodies", "effects.rigid_pairs:RigidPairs.from_setup",
         len(rigid) > 1, "no two rigid bodies"),
        ("reaction", "effects.reaction:Reaction.from_setup", rigid, "no rigid body"),
        ("least gap", "effects.surface:GapDiagnostic.from_setup", output.gap and several, no_gap),
        ("surfaces", "effects.surface:SurfaceTracker.from_setup", surfaces, "nothing needs outlines"),
        ("self-contact", "contact.surfaces.self_contact:SelfContact.from_setup",
         any(scene.bodies[body.name].self_contact for body in bodies), "no body has self_contact"),
        ("material damping", "effects.damping:Damping.from_setup", damped, "no material has damping"),
        ("averaged volume", "effects.averaged_volume:AveragedVolume.from_setup", averaged,
         "no body would lock, and none has volumetric = 'averaged'"),
        ("initial stress", "effects.initial_stress:InitialStress.from_setup",
         any(body.initial_stress for body in scene.bodies.values()), "no body has initial_stress"),
        ("gravity", "effects.gravity:Gravity.from_setup", gravity, "no [gravity]"),
        ("settling", "effects.settling:from_setup", scene.settle, "no [settle]"),
        ("prescribed sides", "effects.constraint:Constraint.from_setup", held, "no fixed or moving side"),
        ("loads on sides", "effects.side_loads:from_setup", setup.loaded_sides,
         "no side has a pressure, traction or force"),
        ("", "runs.effects:_named", True, ""),
        ("", "runs.effects:_rotation", True, ""),
        ("", "effects.series:BodySeries.from_setup", True, ""),
        ("", "effects.verdict:Verdict.from_setup", setup.whole is None, "all are judged together"),
        ("", "effects.flutter:Flutter.from_setup",
         slides and "friction_force" in setup.contact_fields, "no friction"),
        ("contact moment", "effects.contact_moment:ContactMoment.from_setup",
         output.contact_moment is not None, "no output.contact_moment"),
        ("energy ledger", "effects.ledger:EnergyLedger.from_setup", output.ledger, "output.ledger = false"),
        ("stability series", "effects.series:TimeStepSeries.from_setup", output.stability,
         "output.stability = false"),
        ("von Mises stress", "effects.series:VonMises.from_setup", output.particles,
         "output.particles = false"),
        ("sleep", "runs.sleeping:from_setup", scene.sleep, "no [sleep]"),
    ]  # fmt: skip


def _of_methods(setup: Setup) -> list[Effect]:
    transfer, shape = setup.exchange, setup.shape
    chosen = "as auto for" if setup.scene.stepping.transfer == "auto" else "given, with"
    carried = ", carried along with the motion" if transfer.transported else ""
    stored = ", stored as moments B" if transfer.affine == "moment" else ""
    moves = hasattr(setup.shape_function, "update_particle_domains")
    tracks = "moves its domains in every step" if moves else "moves no domains"
    reason = f"transfer {transfer.name}, {chosen} shape {shape}{carried}{stored}"
    return [
        Effect("affine field", transfer.affine is not None, reason),
        Effect("domain tracking", moves, f"shape {shape} {tracks}"),
    ]


def _named(setup: Setup) -> Acts:
    """Return the loads, boundary conditions and outputs that act."""
    acting, lines = list[Any](), []
    for group, plugins in setup.named.items():
        texts, before = [], len(acting)
        for name, plugin in plugins.items():
            answer, text = plugin.from_setup(setup), f"{name} ({plugin.label})"
            if isinstance(answer, str):
                text += f": {answer}"
            else:
                acting.append(answer)
            texts.append(text)
        lines.append(Effect(group, len(acting) > before, ", ".join(texts) or f"no [{group}]"))
    return Acts("", acting, lines)


def _rotation(setup: Setup) -> Acts:
    """Return the corrections of rotational inertia, and import those that a body has."""
    treated: dict[str, list[Body]] = {"spin": [], "exact": [], "lumped": []}
    plugins, lines = list[Any](), []
    held = {body.name for body, _ in setup.held_sides}
    held |= {body.name for boundary in setup.named["boundaries"].values() for body in boundary.bodies}
    for body in setup.state.soft_bodies:
        how, reason = _treatment(setup, body, body.name in held)
        lines.append(Effect(f"rotation of {body.name}: {how}", how != "lumped", reason))
        setup.rotations[body.name] = how
        treated[how].append(body)
    if treated["spin"]:
        from mpmfw.effects.local_spin import LocalSpin

        constraint = (
            setup.plugin("constraint") if any(body.name in held for body in treated["spin"]) else None
        )
        plugins.append(LocalSpin(tuple(treated["spin"]), setup.half_edges, constraint))
    if treated["exact"]:
        from mpmfw.effects.exact_rotation import ExactRotation

        plugins.append(ExactRotation(tuple(treated["exact"]), setup.half_edges))
    return Acts("", plugins, lines)


def _treatment(setup: Setup, body: Body, held: bool) -> tuple[str, str]:
    """Return ``spin``, ``exact`` or ``lumped``, and why."""
    model, contact = setup.scene.bodies[body.name], setup.contact
    asked = model.rotation
    if setup.state.grid.axisymmetric:
        return "lumped", "a body of revolution does not turn"
    if asked == "lumped":
        return "lumped", "given"
    if model.self_contact and asked != "exact":
        if asked == "spin":
            text = "'spin' would join parts that touch; expected 'exact' or 'lumped' with self_contact"
            raise SceneError(text, key=f"bodies.{body.name}.rotation")
        return "lumped", "parts of its surface may touch each other"
    if not setup.field_per_body:
        return "lumped", "shares its velocity field with other bodies"
    if contact is not None and contact.adds_mass:
        return "lumped", f"contact '{contact.name}' adds inertia to the nodes"
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
