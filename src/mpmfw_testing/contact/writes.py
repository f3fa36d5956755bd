"""What a law leaves alone: points, weights, masses; and what it keeps for the next step."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import fields
from typing import Any

import numpy as np

from mpmfw.api.types import AnyArray, Grid, Particles, Stencil, hookimpl
from mpmfw.runs.simulation import Simulation
from mpmfw_testing.bench import memory_kept
from mpmfw_testing.check import Violation, within
from mpmfw_testing.contact.meeting import Meeting
from mpmfw_testing.saving import remember
from mpmfw_testing.subject import Subject

#: Bytes that a step may add to what is kept, on the mean of a stretch, steps of that, and how many stretches
#: are measured.
GROWTH, STRETCH, STRETCHES = 400.0, 20, 6


class Watch:
    """A plug-in that compares arrays before and after each of the hooks in which contact acts."""

    name = "contact_watch"

    def __init__(self, *, adds_mass: bool) -> None:
        self.nodal = ("position",) if adds_mass else ("position", "mass")
        self.changed: set[str] = set()

    def arrays(
        self, grid: Grid, phi: Stencil | None = None, particles: Particles | None = None
    ) -> dict[str, AnyArray]:
        """What no law may change, by name."""
        found = {f"grid.{name}": getattr(grid, name) for name in self.nodal}
        if phi is not None:
            found |= {f"phi.{name}": getattr(phi, name) for name in ("row", "nodes", "weight", "gradient")}
        if particles is not None:
            held = {f"particles.{each.name}": getattr(particles, each.name) for each in fields(particles)}
            found |= {name: array for name, array in held.items() if isinstance(array, np.ndarray)}
        return found

    def _around(self, hook: str, arrays: dict[str, AnyArray]) -> Generator[None, Any, Any]:
        before = {name: array.copy() for name, array in arrays.items()}
        result = yield
        for name, array in arrays.items():
            if not np.array_equal(array, before[name], equal_nan=True):
                self.changed.add(f"{name} in {hook}")
        return result

    @hookimpl(wrapper=True)
    def detect(self, grid: Grid, phi: Stencil, particles: Particles) -> Generator[None, Any, Any]:
        """Points, weights, positions of nodes; of masses a law may say that it adds some."""
        return (yield from self._around("detect", self.arrays(grid, phi=phi, particles=particles)))

    @hookimpl(wrapper=True)
    def after_momentum_projection(
        self, grid: Grid, phi: Stencil, particles: Particles
    ) -> Generator[None, Any, Any]:
        """As :meth:`detect`, and the forces."""
        arrays = {**self.arrays(grid, phi=phi, particles=particles), "grid.force": grid.force}
        return (yield from self._around("after_momentum_projection", arrays))

    @hookimpl(wrapper=True)
    def add_nodal_force(self, grid: Grid, phi: Stencil) -> Generator[None, Any, Any]:
        """As :meth:`detect`, and momentum: here contact adds to forces alone."""
        arrays = {**self.arrays(grid, phi=phi), "grid.momentum": grid.momentum}
        return (yield from self._around("add_nodal_force", arrays))

    @hookimpl(wrapper=True)
    def after_momentum_update(self, grid: Grid) -> Generator[None, Any, Any]:
        """Masses and places of nodes, and the forces, which have acted."""
        arrays = {**self.arrays(grid), "grid.force": grid.force}
        return (yield from self._around("after_momentum_update", arrays))


def changes_nothing_else(subject: Subject) -> None:
    """It changes forces and momentum of the grid alone. In forty steps of two discs that meet no bit of
    points, weights and nodal masses is another one after any hook of contact.

    Forces may be added to in ``add_nodal_force`` alone, momentum everywhere else. A law that ``adds_mass``
    may add mass.
    """
    mapping = Meeting(form="discs", gap=0.05, slide=0.5, friction=0.3).mapping()
    remember(mapping, 40)
    law = subject.make()
    simulation, watch = Simulation(mapping, contact=law), Watch(adds_mass=getattr(law, "adds_mass", False))
    simulation.start()
    with simulation.extra_plugin(watch):
        simulation.advance(40)
    if watch.changed:
        changed = ", ".join(sorted(watch.changed))
        raise Violation(f"contact changes {changed}", {"bodies": "discs", "steps": 40})


def no_growth(subject: Subject) -> None:
    """What is kept for the next step does not grow. What a step of blocks in steady contact adds to what is
    kept for the next is at most 400 bytes: a run has a million steps.

    Of six stretches of twenty steps the one that adds least counts: arrays that are enlarged once do not
    grow.
    """
    mapping = Meeting(gap=0.05, slide=0.2, friction=0.5).mapping()
    remember(mapping, (STRETCHES + 1) * STRETCH)
    simulation = Simulation(mapping, contact=subject.make())
    sizes = memory_kept(lambda: simulation.advance(STRETCH), STRETCHES, warm=1)
    grown = float(np.diff(sizes).min()) / STRETCH
    within(
        grown,
        GROWTH,
        "the memory that is kept grows with every step [bytes]",
        {"steps": len(sizes) * STRETCH},
    )
