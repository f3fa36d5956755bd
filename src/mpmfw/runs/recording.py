"""The part of the effect plan that records: energies, the ledger and its terms, stability, frames."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmfw.effects.series import BodySeries, StrainEnergies, VonMises
from mpmfw.plugin.effect import Plan
from mpmfw.runs.build import Build

Limits = Callable[[], list[tuple[float, str]]]


def plan_records(made: Build, plan: Plan, limits: Limits) -> None:
    """Decide what a run measures and records beside its motion."""
    materials = tuple(made.materials[made.scene.bodies[body.name].material] for body in made.state.bodies)
    energy = made.scene.output.energy
    plan.note("energies", energy, "series of every body" if energy else "output.energy = false")
    strain = StrainEnergies(materials)
    plan.plugins.append(BodySeries(strain, affine=made.transfer.affine is not None, energy=energy))
    _verdict(made, plan, strain)
    _moment(made, plan)
    _ledger(made, plan, strain)
    _stability(made, plan, limits)
    _frames(made, plan, materials)


def _moment(made: Build, plan: Plan) -> None:
    """Moment of contact on every body, where each has nodes of its own that contact acts on."""
    asked, contact = made.scene.output.contact_moment, made.contact
    if asked is None:
        plan.note("contact moment", False, "no output.contact_moment")
        return
    if contact is None:
        plan.note("contact moment", False, "no contact acts")
        return
    if made.state.grid.n_fields < len(made.state.bodies):
        plan.note("contact moment", False, f"contact '{contact.name}' gives bodies one velocity field")
        return
    from mpmfw.effects.contact_moment import CONTACT_HOOKS, ContactMoment

    if not any(hasattr(contact, hook) for hook in CONTACT_HOOKS):
        plan.note(
            "contact moment", False, f"contact '{contact.name}' neither exerts forces nor changes momenta"
        )
        return
    about = None if asked == "centre_of_mass" else asked
    plan.note("contact moment", True, "about " + ("centres of mass" if about is None else f"{about} m"))
    plan.plugins.append(ContactMoment(contact, about, made.state))


def _verdict(made: Build, plan: Plan, strain: StrainEnergies) -> None:
    """Every run is judged; one of the bodies that are awake is a part of a run."""
    if made.whole is not None:
        return
    from mpmfw.effects.verdict import planned

    plan.plugins.append(planned(made, plan, strain))
    contact, near = made.contact, made.state.near
    if contact is None or made.friction_law is not None or not contact.uses_friction:
        return
    declared = contact.declare_fields() if hasattr(contact, "declare_fields") else []
    frictional = near.has_friction if near is not None else any(pair.mu > 0.0 for pair in made.state.pairs)
    if frictional and "friction_force" in [field.name for field in declared]:
        from mpmfw.effects.flutter import Flutter

        plan.plugins.append(Flutter(contact.name, made.scene.dim))


def _ledger(made: Build, plan: Plan, strain: StrainEnergies) -> None:
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
    if not plan.note("energy ledger", asked, reason):
        return
    from mpmfw.effects.ledger import planned

    plan.plugins.append(planned(made, plan, strain))


def _stability(made: Build, plan: Plan, limits: Limits) -> None:
    asked = made.scene.output.stability
    if not plan.note("stability series", asked, f"output.stability = {str(asked).lower()}"):
        return
    from mpmfw.effects.time_step_series import TimeStepSeries

    watching = made.contact.monitors() if made.contact is not None else []
    plan.plugins += [TimeStepSeries(limits), *watching]


def _frames(made: Build, plan: Plan, materials: tuple[Any, ...]) -> None:
    """Fields of material points and surface nodes in the results' file."""
    points = made.scene.output.particles
    if plan.note(
        "von Mises stress", points, "frames hold material points" if points else "output.particles = false"
    ):
        plan.plugins.append(VonMises(materials))
    asked, tracked = made.scene.output.surface, made.state.surface is not None
    reason = (
        "output.surface = false" if not asked else "output.surface" if tracked else "no surface is tracked"
    )
    plan.note("surface frames", asked and tracked, reason)
