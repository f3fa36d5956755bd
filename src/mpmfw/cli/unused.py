"""Facts of a scene that have no effect with the chosen methods."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mpmfw.runs.simulation import Simulation


#: Keys of ``[output]`` that an effect records, its name, and the words if it is off.
_DIAGNOSTICS = (
    ("ledger", "energy ledger", "no ledger is kept"),
    ("gap", "least gap", "no gap is measured"),
    ("contact_moment", "contact moment", "no moment is measured"),
)


def unused_facts(simulation: Simulation) -> list[str]:
    """Return the facts that have no effect in this run, one line each."""
    groups = (_alternatives, _friction, _surfaces, _rotation, _diagnostics, _materials)
    return [line for group in groups for line in group(simulation)]


def _alternatives(simulation: Simulation) -> Iterator[str]:
    """Yield options of methods that do not run here; a comparison of several methods may use them."""
    from mpmfw.scene.options import CORE_KEYS

    scene = simulation.scene
    tables = scene.to_mapping()
    for kind, chosen in (("contact", scene.contact), ("shape", scene.shape)):
        runs = None if chosen is None else chosen.method
        used = (*CORE_KEYS[kind], runs, getattr(chosen, "friction_law", None))
        for name, options in tables.get(kind, {}).items():
            if name not in used:
                yield from (f"{kind}.{name}.{key}: {kind} '{runs}' runs, not '{name}'" for key in options)


def _friction(simulation: Simulation) -> Iterator[str]:
    contact = simulation.contact
    if contact is not None and not contact.uses_friction:
        with_friction = [pair.label for pair in simulation.state.pairs if pair.friction]
        yield from (f"friction of {pair}: contact '{contact.name}' has none" for pair in with_friction)
        if simulation.state.near is not None and simulation.state.near.friction:
            yield f"contact.friction: contact '{contact.name}' has none"
    given = simulation.scene.contact
    if contact is not None and given is not None and given.friction_law and not contact.takes_friction_law:
        has = "Coulomb's friction alone" if contact.uses_friction else "no friction"
        yield f"contact.friction_law = '{given.friction_law}': contact '{contact.name}' has {has}"
    if contact is not None:
        yield from contact.unused(simulation.state.pairs)


def _surfaces(simulation: Simulation) -> Iterator[str]:
    scene = simulation.scene
    if simulation.state.surface is None:
        given = [name for name, body in scene.bodies.items() if body.segment is not None]
        yield from (f"bodies.{name}.segment: no surface is tracked" for name in given)
        if _asked(scene, "surface"):
            yield "output.surface: no surface is tracked"


def _rotation(simulation: Simulation) -> Iterator[str]:
    """Yield bodies whose ``rotation`` has no effect beside the other methods."""
    bodies = simulation.scene.bodies
    for effect in simulation.effects:
        name = effect.name.removeprefix("rotation of ").removesuffix(": lumped")
        if name in bodies and bodies[name].rotation not in (None, "lumped"):
            yield f"bodies.{name}.rotation: lumped all the same: {effect.reason}"


def _diagnostics(simulation: Simulation) -> Iterator[str]:
    """Yield diagnostics that the scene names and the run does not record."""
    scene, contact = simulation.scene, simulation.contact
    effects = {effect.name: effect for effect in simulation.effects}
    for key, name, words in _DIAGNOSTICS:
        if _asked(scene, key) and not effects[name].on:
            yield f"output.{key}: {words}: {effects[name].reason}"
    interval = "output.particle_interval: "
    if _asked(scene, "particle_interval") and not scene.output.particles:
        yield f"{interval}no material points are stored: output.particles = false"
    elif _asked(scene, "particle_interval") and scene.output.particle_interval <= scene.time.output_interval:
        yield f"{interval}material points are stored at every output: time.output_interval is no shorter"
    if _asked(scene, "stability") and contact is not None and not contact.monitors():
        yield f"output.stability: of the time step alone: contact '{contact.name}' has no such series"


def _asked(scene: Any, diagnostic: str) -> bool:
    return diagnostic in scene.output.model_fields_set and bool(getattr(scene.output, diagnostic))


def _materials(simulation: Simulation) -> Iterator[str]:
    scene = simulation.scene
    used = {body.material for body in scene.bodies.values()}
    yield from (f"materials.{name}: no body is made of it" for name in scene.materials if name not in used)
