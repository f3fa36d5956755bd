"""Contact of a scene as an effect: its friction, its search, and the plug-ins that go with it."""

from __future__ import annotations

import numpy as np

from mpmfw.plugin.checks import naming
from mpmfw.plugin.setup import Acts, Effect, Setup
from mpmfw.state.pairs import overlapping
from mpmfw.state.structs import Body


def from_setup(setup: Setup) -> Acts | str:
    """Return the contact with its parts; its velocity fields, friction and search have lines of their own."""
    contact, law = setup.contact, setup.friction_law
    if contact is None:
        return "one body" if len(setup.bodies) == 1 else "not named"
    with naming(contact, "its planning"):
        asked = f"contact '{contact.name}' asks for {contact.velocity_fields}"
        frictional, why = "", f"contact '{contact.name}' does not use it"
        if contact.uses_friction:
            frictional = "every pair" if law is not None and law.cohesive else _frictional(setup)
            by = "" if law is None else f", by {law.label}"
            why = frictional + by if frictional else "μ = 0 in every pair"
        lines = [
            Effect("velocity field per body", contact.velocity_fields == "per_body", asked),
            Effect("friction", bool(frictional), why),
            *_search(setup, contact.reach(setup.cell_size)),
        ]
        pairs = str(len(setup.pairs)) if setup.state.near is None else "those that come near"
        reason = f"{contact.name} ({type(contact).__name__}), pairs: {pairs}"
        return Acts(reason, [contact, *contact.parts()], lines)


def _frictional(setup: Setup) -> str:
    """The pairs with friction; where pairs are listed as they come near those that the scene names, and all
    others at once."""
    named = [pair.label for pair in setup.state.pairs if pair.mu > 0.0]
    near = setup.state.near
    others = (
        [f"μ = {near.friction:g} in pairs without a value of their own"] if near and near.friction else []
    )
    return ", ".join([*named, *others])


def _search(setup: Setup, reach: float | None) -> list[Effect]:
    """Return whether bodies are near enough to be searched at the start; nothing without a reach."""
    bodies = setup.state.bodies
    if reach is None or len(bodies) < 2:
        return []
    if setup.state.near is None:
        ends = [(bodies[pair.first], bodies[pair.second]) for pair in setup.state.pairs]
    else:
        lower, upper = (np.array([getattr(body, end) for body in bodies]) for end in ("lower", "upper"))
        near = overlapping(lower - 0.5 * reach, upper + 0.5 * reach)
        ends = [(bodies[a], bodies[b]) for a, b in zip(*(index.tolist() for index in near), strict=True)]
    what = f"no two bodies' boxes are within its reach of {reach:.4g} m at the start"
    awake = False
    if ends:
        apart = {f"{first.name}-{second.name}": _box_distance(first, second) for first, second in ends}
        nearest = min(apart, key=lambda label: apart[label])
        awake = apart[nearest] <= reach
        what = f"the boxes of {nearest} are {apart[nearest]:.4g} m apart at the start, "
        what += f"its reach is {reach:.4g} m"
    return [Effect("contact search", awake, what if awake else f"asleep until bodies are near: {what}")]


def _box_distance(first: Body, second: Body) -> float:
    """Distance of two bounding boxes along the axis on which they are farthest apart [m], as a search takes
    it."""
    gaps = zip(first.lower, first.upper, second.lower, second.upper, strict=True)
    return max(0.0, *(max(low - top, bottom - high) for bottom, top, low, high in gaps))
