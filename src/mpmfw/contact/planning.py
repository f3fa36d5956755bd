"""What a scene calls for of its contact: friction, search, and the plug-ins that go with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.plugin.effect import Plan
from mpmfw.state.pairs import overlapping
from mpmfw.state.structs import Body

if TYPE_CHECKING:
    from mpmfw.runs.build import Build


def planned(made: Build, plan: Plan) -> None:
    """Whether bodies act on each other, and how."""
    count = len(made.state.bodies)
    if made.contact is None:
        plan.note("contact", False, "one body" if count == 1 else "not named")
        return
    acts = type(made.contact).__name__
    pairs = str(len(made.state.pairs)) if made.state.near is None else "those that come near"
    plan.note("contact", True, f"{made.contact.name} ({acts}), pairs: {pairs}")
    per_body = made.contact.velocity_fields == "per_body"
    plan.note(
        "velocity field per body",
        per_body,
        f"contact '{made.contact.name}' asks for {made.contact.velocity_fields}",
    )
    if not made.contact.uses_friction:
        plan.note("friction", False, f"contact '{made.contact.name}' does not use it")
    else:
        law = made.friction_law
        frictional = "every pair" if law is not None and law.cohesive else _frictional(made)
        by = "" if law is None else f", by {law.label}"
        plan.note("friction", bool(frictional), frictional + by if frictional else "μ = 0 in every pair")
    _search(made, plan, made.contact.reach(made.state.grid.cell_size))
    plan.plugins += [made.contact, *made.contact.parts()]


def _frictional(made: Build) -> str:
    """The pairs with friction; where pairs are listed as they come near those that the scene names, and all
    others at once."""
    named = [pair.label for pair in made.state.pairs if pair.mu > 0.0]
    near = made.state.near
    others = (
        [f"μ = {near.friction:g} in pairs without a value of their own"] if near and near.friction else []
    )
    return ", ".join([*named, *others])


def _search(made: Build, plan: Plan, reach: float | None) -> None:
    """Note whether bodies are near enough to be searched at the start; without a reach there is no search."""
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
        plan.note("contact search", False, f"asleep until bodies are near: {what}")
        return
    apart = {f"{first.name}-{second.name}": _box_distance(first, second) for first, second in ends}
    nearest = min(apart, key=lambda label: apart[label])
    awake = apart[nearest] <= reach
    what = f"the boxes of {nearest} are {apart[nearest]:.4g} m apart at the start, its reach is {reach:.4g} m"
    plan.note("contact search", awake, what if awake else f"asleep until bodies are near: {what}")


def _box_distance(first: Body, second: Body) -> float:
    """Distance of two bounding boxes along the axis on which they are farthest apart [m], as a search takes
    it."""
    gaps = zip(first.lower, first.upper, second.lower, second.upper, strict=True)
    return max(0.0, *(max(low - top, bottom - high) for bottom, top, low, high in gaps))
