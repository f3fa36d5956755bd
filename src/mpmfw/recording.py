"""The part of the effect plan that records: energies, the ledger and its terms, stability, frames."""

from __future__ import annotations

from typing import Any

from mpmfw.build import Build
from mpmfw.series import BodySeries, StrainEnergies, VonMises

#: Hooks by which a contact strategy moves bodies; one that implements none of them does no work.
CONTACT_HOOKS = ("after_momentum_projection", "add_nodal_force", "after_momentum_update")

#: Steps between two looks at the strain energy by what stops a run whose energy grows.
CHECK_EVERY = 20


def recorded(made: Build) -> None:
    """Decide what a run measures and records beside its motion."""
    materials = tuple(made.material_of(body) for body in made.state.bodies)
    energy = made.scene.output.energy
    made.note("energies", energy, "series of every body" if energy else "output.energy = false")
    strain = StrainEnergies(materials)
    made.plugins.append(BodySeries(strain, affine=made.transfer.affine is not None, energy=energy))
    _ledger(made, strain)
    _stability(made)
    _frames(made, materials)


def _ledger(made: Build, strain: StrainEnergies) -> None:
    asked = made.scene.output.ledger
    reason = "output.ledger = false"
    if asked:
        stops = (
            "runs on whatever it shows"
            if made.scene.allow_unstable
            else "stops within 20 steps where energy grows"
        )
        reason = f"output.ledger; works and transfer measured in every step; {stops}"
    contact = made.contact
    if asked and contact is not None and contact.adds_mass:
        # Its inertia is on the nodes and on no material point: every term would be that of two bodies.
        asked, reason = False, f"contact '{contact.name}' adds inertia of its own to the nodes"
    if not made.note("energy ledger", asked, reason):
        return
    from mpmfw.effects.energy_guard import EnergyGuard
    from mpmfw.effects.ledger import EnergyLedger
    from mpmfw.effects.ledger_impulses import AfterImpulses, BeforeImpulses

    named = {plugin.name: plugin for plugin in made.plugins}
    declared = [] if contact is None or not hasattr(contact, "declare_fields") else contact.declare_fields()
    accounted = "spring_work" in [field.name for field in declared]
    guard = (
        None if made.scene.allow_unstable else EnergyGuard.of(made.state, getattr(contact, "softer_by", None))
    )
    ledger = EnergyLedger(
        strain,
        terms=_terms(made, named),
        contact="" if contact is None else contact.name,
        accounted=accounted,
        guard=guard,
        check_every=CHECK_EVERY,
    )
    made.plugins.append(ledger)
    after = AfterImpulses(ledger, named.get("gravity"), named.get("pressure"))
    # Round all others: what is registered last is the first of those that ask to be first, the last of those to be last.
    made.plugins[:0] = [BeforeImpulses(ledger), after]


def _terms(made: Build, named: dict[str, Any]) -> tuple[str, ...]:
    """Works that the ledger can meet in this scene; the others have no series."""
    sources = {
        "gravity": {"gravity": "gravity"},
        "external": {"pressure": "pressures", "constraint": "prescribed sides"},
        "inertia": {
            "local_spin": "local spin",
            "rotation": "exact rotation",
            "local_inertia": "local inertia",
        },
    }
    contact = made.contact
    acts = contact is not None and any(hasattr(contact, hook) for hook in CONTACT_HOOKS)
    found = {term: [said for name, said in by.items() if name in named] for term, by in sources.items()}
    found["contact"] = [f"contact '{contact.name}'"] if contact is not None and acts else []
    for term, hook in (("inertia", "correct_inertia"), ("external", "constrain_momentum")):
        if contact is not None and hasattr(contact, hook):  # work counts by the place where it is done
            found[term].append(f"contact '{contact.name}'")
    terms = ("gravity", "external", "contact", "inertia")
    for term in terms:
        by = ", ".join(found[term])
        made.note(f"ledger: {term} work", bool(by), by or "nothing in the scene does any")
    return tuple(term for term in terms if found[term])


def _stability(made: Build) -> None:
    asked = made.scene.output.stability
    if not made.note("stability series", asked, f"output.stability = {str(asked).lower()}"):
        return
    from mpmfw.effects.time_step_series import TimeStepSeries

    watching = made.contact.monitors() if made.contact is not None else []
    made.plugins += [TimeStepSeries(), *watching]


def _frames(made: Build, materials: tuple[Any, ...]) -> None:
    """Fields of material points and surface nodes in the results' file."""
    points = made.scene.output.particles
    if made.note(
        "von Mises stress", points, "frames hold material points" if points else "output.particles = false"
    ):
        made.plugins.append(VonMises(materials))
    asked, tracked = made.scene.output.surface, made.state.surface is not None
    reason = (
        "output.surface = false" if not asked else "output.surface" if tracked else "no surface is tracked"
    )
    made.note("surface frames", asked and tracked, reason)
