"""Rigid bodies that no force of contact keeps apart: a run in which they touch ends."""

from __future__ import annotations

import itertools

from mpmfw.contact.rigid_nodes import RigidSurfaces
from mpmfw.errors import SimulationError
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.structs import Body, State


class RigidPairs:
    """Pairs of bodies, of which a surface node of the first must not enter the second."""

    name = "rigid_pairs"
    stage = "contact"

    def __init__(self, pairs: list[tuple[Body, Body, str]]) -> None:
        self.pairs = pairs  #: with the labels of their contacts

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts | str:
        """Return the pairs of rigid bodies but those whose motions are prescribed, which may overlap."""
        contact, rigid = setup.contact, [body for body in setup.bodies if body.rigid]
        ordered = itertools.permutations(rigid, 2)
        free = [(a, b) for a, b in ordered if not (a.prescribed and b.prescribed)]
        found = [(a, b, contact.between(a.name, b.name)) for a, b in free] if contact is not None else []
        pairs = [(a, b, law.label) for a, b, law in found if not law.meets_rigid_pairs]
        if not pairs:
            return "contact acts between them" if free else "no two that move freely"
        names = ", ".join(f"{a.name}-{b.name}" for a, b, _ in pairs if a.index < b.index)
        return Acts(f"{names}: the run ends where they touch", [cls(pairs)])

    @hookimpl
    def end_step(self, state: State) -> None:
        surface = state.tracked_surface
        for first, second, contact in self.pairs:
            own, other = surface.position[surface.of(first.index)], surface.position[surface.of(second.index)]
            near = own[((own >= other.min(axis=0)) & (own <= other.max(axis=0))).all(axis=1)]
            if len(near) == 0:
                continue
            distance, _ = RigidSurfaces(state).measure(near, surface.facets_of(second.index))
            if distance.min() < 0.0:
                raise SimulationError(
                    f"the rigid bodies '{first.name}' and '{second.name}' touch, and contact "
                    f"'{contact}' has no force between them",
                    position=near[distance.argmin()].tolist(),
                    time=state.time,
                    advice="contact lcp or impulse",
                )
