"""Base of contact strategies, those of a detection and a law, and the contact of a scene as an effect."""

from __future__ import annotations

import copy
import functools
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import BaseModel, create_model

from mpmfw.errors import SceneError
from mpmfw.plugin.base import PlugIn
from mpmfw.plugin.checks import bundled, raise_named
from mpmfw.plugin.setup import Acts, Effect, Setup
from mpmfw.state.fields import FloatArray, IntArray
from mpmfw.state.structs import Body, Pair

if TYPE_CHECKING:
    from mpmfw.contact.law import ContactLaw
    from mpmfw.contact.rows import Detection


class ContactStrategy(PlugIn):
    """Base of contact strategies: subclasses implement the hooks of their place in the step, and declare
    the series of :data:`mpmfw.state.fields.CONTACT_SERIES` that they have."""

    #: One velocity field for all bodies, or one per body.
    velocity_fields: ClassVar[Literal["single", "per_body"]] = "per_body"
    #: Whether the strategy acts through tracked outlines (``state.surface``).
    needs_surface: ClassVar[bool] = False
    #: How surface nodes are mapped to the grid: ``auto`` follows the shape function.
    surface_map: Literal["auto", "plain", "mass_weighted"] = "auto"
    #: Whether the strategy adds inertia to the nodes.
    adds_mass: bool = False
    #: Whether the strategy keeps bodies apart: results then warn of deep penetration.
    keeps_apart: ClassVar[bool] = True
    #: Whether it acts between two rigid bodies; where it does not, a run in which they touch ends.
    meets_rigid_pairs: bool = False
    #: Whether the strategy uses the pairs' friction.
    uses_friction: ClassVar[bool] = False
    #: Whether the scene's ``contact.friction_law`` sets that friction, and not Coulomb's law alone.
    takes_friction_law: ClassVar[bool] = False
    #: Whether bodies at rest may be left out for a while (``[sleep]``): its history is in declared arrays, or
    #: copied by ``copy_history``.
    leaves_bodies_out: bool = False
    #: Key of the scene that makes the strategy softer, for advice.
    softer_by: str | None = None

    def parts(self) -> list[Any]:
        """Return plug-ins that the strategy's options call for beside it."""
        return []

    def unused(self, pairs: Sequence[Pair]) -> list[str]:  # noqa: ARG002
        """Return facts of these pairs without effect under its options, one line each, for ``explain``."""
        return []

    def between(self, first: str, second: str) -> ContactStrategy:  # noqa: ARG002
        """Return the contact that acts between the bodies of two names."""
        return self

    def monitors(self) -> list[Any]:
        """Return plug-ins that watch the strategy's stability (``output.stability``)."""
        return []

    def restart(self) -> None:
        """Forget accumulated work and impulse after settling; the state of contact stays."""


def from_setup(setup: Setup) -> Acts | str:
    """Return the contact with its parts; velocity fields and friction have lines too."""
    contact, law = setup.contact, setup.friction_law
    if contact is None:
        return "one body" if len(setup.bodies) == 1 else "not named"
    try:
        asked = f"contact '{contact.name}' requires {contact.velocity_fields}"
        frictional, why = "", f"contact '{contact.name}' does not use it"
        if contact.uses_friction:
            frictional = "every pair" if law is not None and law.cohesive else _frictional(setup)
            by = "" if law is None else f", by {law.label}"
            why = frictional + by if frictional else "μ = 0 in every pair"
        lines = [
            Effect("velocity field per body", contact.velocity_fields == "per_body", asked),
            Effect("friction", bool(frictional), why),
        ]
        pairs = str(len(setup.pairs)) if setup.state.near is None else "those that come near"
        reason = f"{contact.name} ({type(contact).__name__}), pairs: {pairs}"
        return Acts(reason, [contact, *contact.parts()], lines)
    except BaseException as error:
        raise_named(error, contact, "its planning")


def _frictional(setup: Setup) -> str:
    """Return the pairs with friction; those that are listed later count together."""
    named = [pair.label for pair in setup.state.pairs if pair.mu > 0.0]
    near = setup.state.near
    if near and near.friction:
        named.append(f"μ = {near.friction:g} in pairs without another value")
    return ", ".join(named)


#: Relative difference of wave moduli K + 4 G / 3 up to which two bodies are equally stiff, and of sizes that
#: are equal.
EQUAL = 1e-6


#: What a rigid body counts for, whose modulus is infinite [Pa].
STIFFEST = 1e300


def stiffness_ranks(bodies: Sequence[Body]) -> IntArray:
    """Rank every body by its wave modulus (body,): 0 for the softest, equals alike."""
    return ranks_of(np.array([min(body.p_wave_modulus, STIFFEST) for body in bodies]))


def ranks_of(values: FloatArray) -> IntArray:
    """Rank positive values (n,): 0 for the smallest, the same for equal ones."""
    order = np.argsort(values)
    steps = np.diff(values[order], prepend=values[order[:1]]) > EQUAL * values[order]
    ranks = np.zeros(len(values), dtype=np.int64)
    ranks[order] = np.cumsum(steps)
    return ranks


#: What a law may need of a detection, as messages name it.
NEEDS = {
    "facets": "facets of surfaces",
    "nodes": "surface nodes against facets",
    "steady gap": "gaps that do not jump",
}


def options_of_both(contact: type[ContactLaw], law: type[BaseModel]) -> type[BaseModel]:
    """Make the model of a contact's options: those of the ``law`` and of the detection."""
    models = tuple(dict.fromkeys((law, contact.Detection.Options)))
    fields: dict[str, Any] = {}
    for model in models:
        for name in model.model_fields.keys() & contact.defaults.keys():
            info = copy.copy(model.model_fields[name])
            info.default = contact.defaults[name]
            fields[name] = (info.annotation, info)
    text = f"Options of {contact.__qualname__}: those of the law and of detection '{contact.Detection.name}'."
    made: type[BaseModel] = create_model(
        "Options", __base__=models, __module__=contact.__module__, __doc__=text, **fields
    )
    made.__qualname__ = f"{contact.__qualname__}.Options"
    return made


@functools.cache
def joined(detection: type[Detection], law: type[ContactLaw]) -> type[Any]:
    """Make the contact of a detection and a law; it can be pickled, and so can its options.

    Raise SceneError if they do not go together, or have an option of one name."""
    for need in sorted((law.needs & NEEDS.keys()) - detection.provides):
        raise SceneError(
            f"law '{law.name}' acts on {NEEDS[need]}, and detection '{detection.name}' lists none"
        )
    twice = sorted(set(detection.Options.model_fields) & set(law.Options.model_fields))
    if twice:
        raise SceneError(
            f"detection '{detection.name}' and law '{law.name}' both have an option '{twice[0]}'"
        )

    def parts_of(options: BaseModel, *, contact: bool = False) -> tuple[Any, ...]:
        return _made_again, (detection, law, options.model_dump(exclude_unset=True), contact)

    name = f"{detection.name}+{law.name}"
    body = {
        "name": name,
        "Detection": detection,
        "__reduce__": lambda self: parts_of(self.options, contact=True),
        # of the part that is not mpmfw's own, since its distribution answers for errors
        "__module__": (detection if bundled(law) else law).__module__,
        "__doc__": f"Detection '{detection.name}' with law '{law.name}'.",
    }
    made: type[Any] = type(name, (law,), body)
    made.Options.__reduce__ = parts_of
    return made


def _made_again(
    detection: type[Detection], law: type[ContactLaw], options: dict[str, Any], contact: bool
) -> Any:
    """Make a joined ``contact``, or its options alone, in another process."""
    kind = law.joined_with(detection)
    return kind(**options) if contact else kind.Options(**options)
