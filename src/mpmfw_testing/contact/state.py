"""State: a session of the generic checks, time zero, and the arrays that contact must not change."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from dataclasses import fields
from typing import Any

import numpy as np

from mpmfw.api.types import AnyArray, Grid, Stencil, hookimpl
from mpmfw.plugin.hooks import Observer
from mpmfw_testing.check import Violation, within
from mpmfw_testing.contact.impact import Impact, search_impacts
from mpmfw_testing.contact.motion import Motion, simulate
from mpmfw_testing.generic import require_same
from mpmfw_testing.subject import Subject

#: Scenes in which options and state act: with slip and stick, unequal bodies, at an angle.
SCENES = (
    Impact(form="blocks", slide=0.5, friction=0.3, heavier=2.0, stiffer=4.0),
    Impact(form="discs", slide=0.3, friction=0.9, turn=30.0),
    Impact(form="blocks", speed=2.0, slide=1.0, friction=0.3, turn=90.0, shift=0.4, rise=0.3),
)
#: Steps of a round, in the course of which the bodies meet; and before and after a restart.
ROUND, HALF = 24, 12
#: Series that count since time zero.
ACCUMULATED = ("frictional_work", "damping_work", "spring_work")


class ContactSession:
    """A session of a law in one of the scenes."""

    def __init__(self, impact: Impact, made: Any) -> None:
        self.motion = Motion(made, impact.mapping())

    def advance(self) -> Iterator[tuple[str, AnyArray]]:
        """Take a round of steps; yield the state of the points and all series."""
        self.motion.forget()
        motion = self.motion.advance(ROUND)
        particles = motion.simulation.state.particles
        for name in ("position", "velocity", "stress"):
            yield name, getattr(particles, name)
        yield from ((name, motion.of(name)) for name in motion.series)

    def save(self) -> dict[str, AnyArray]:
        """Return a snapshot of the simulation."""
        return self.motion.simulation.snapshot()

    def load(self, saved: dict[str, AnyArray]) -> None:
        """Restore it."""
        self.motion.simulation.restore(saved)


def openings(subject: Subject) -> Iterator[Callable[[Any], ContactSession]]:  # noqa: ARG001
    """Yield the three scenes."""
    for impact in SCENES:
        yield functools.partial(ContactSession, impact)


def restart(subject: Subject) -> None:
    """restart() forgets work and impulse and keeps the state of contact. ``restart()`` in the middle of
    contact changes no bit of the motion, and sets the recorded work to zero.

    It is called at time zero, after settling: springs stay loaded, work and impulse of the settling are
    forgotten. So the first force reported after it is that of the interval after it.
    """

    def trial(impact: Impact) -> None:
        reference, motion = (simulate(subject, impact.mapping(), HALF) for _ in range(2))
        if motion.simulation.contact is None:
            raise Violation("the scene's contact was dropped though there are two bodies")
        motion.simulation.contact.restart()
        for each in (reference, motion):
            each.advance(HALF)
        expected, found = ({"position": m.positions[-1], "momentum": m.momentum} for m in (reference, motion))
        require_same(expected, found, "restart() changes the motion: the state of contact is lost")
        for name in set(ACCUMULATED) & set(motion.series):
            left = np.abs(motion.series[name][HALF + 1]).max()
            within(left, 0.0, f"restart() does not forget the series {name}")
        if "contact_force" in motion.series:
            before, after = (np.asarray(m.series["contact_force"][HALF + 2]) for m in (reference, motion))
            text = "the first contact force after restart() is not that of the step (share of it)"
            case = {"reported [N/m]": after.tolist(), "without restart() [N/m]": before.tolist()}
            within(np.abs(after - before).max() / max(np.abs(before).max(), 1e-300), 1e-9, text, case)

    sliding: dict[str, Any] = {"friction": (0.3, 0.9, 3), "slide": (0.2, 1.0, 3), "heavier": (1.0, 4.0, 2)}
    search_impacts(trial, **sliding, examples=3)


class Watch(Observer):
    """Compares arrays before and after each of the hooks in which contact acts."""

    name = "contact_watch"
    observes = ("detect", "after_momentum_projection", "add_nodal_force", "after_momentum_update")
    running = True
    phi: Stencil | None = None

    def __init__(self, motion: Motion, *, adds_mass: bool) -> None:
        self.particles, self.adds_mass = motion.simulation.state.particles, adds_mass
        self.changed: set[str] = set()

    @hookimpl
    def detect(self, phi: Stencil) -> None:
        """Keep the table of the step."""
        self.phi = phi

    def arrays(self, hook: str, grid: Grid) -> dict[str, AnyArray]:
        """Return the arrays that no law may change in a hook, by name."""
        names = ["position", *(() if self.adds_mass else ("mass",))]
        names += ["force"] if hook.startswith("after") else []
        names += ["momentum"] if hook == "add_nodal_force" else []
        found = {f"grid.{name}": getattr(grid, name) for name in names}
        found |= {
            f"particles.{each.name}": getattr(self.particles, each.name) for each in fields(self.particles)
        }
        if self.phi is not None:
            names = ["row", "nodes", "weight", "gradient"]
            found |= {f"phi.{name}": getattr(self.phi, name) for name in names}
        return {name: array for name, array in found.items() if isinstance(array, np.ndarray)}

    def before(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:  # noqa: ARG002
        """Copy the arrays."""
        if plugin is None:
            self.copies = {name: array.copy() for name, array in self.arrays(hook, grid).items()}

    def after(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:  # noqa: ARG002
        """Note those that changed."""
        if plugin is None:
            arrays = self.arrays(hook, grid)
            for name, copy in self.copies.items():
                if not np.array_equal(arrays[name], copy, equal_nan=True):
                    self.changed.add(f"{name} in {hook}")


def changes_nothing_else(subject: Subject) -> None:
    """It changes forces and momentum of the grid alone. In forty steps of two discs that meet no bit of
    points, weights and nodal masses is another one after any hook of contact.

    Forces may be added to in ``add_nodal_force`` alone, momentum everywhere else. A law that ``adds_mass``
    may add mass.
    """
    law = subject.make()
    motion = Motion(law, Impact(form="discs", gap=0.05, slide=0.5, friction=0.3).mapping())
    motion.simulation.start()
    watch = Watch(motion, adds_mass=getattr(law, "adds_mass", False))
    with motion.simulation.extra_plugin(watch):
        motion.advance(40)
    if watch.changed:
        raise Violation(f"contact changes {', '.join(sorted(watch.changed))}", {"bodies": "discs"})
