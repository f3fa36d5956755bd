"""Several contacts in one scene, each of which acts between its own pairs of bodies.

They act one after the other, those of named pairs last and in the order of the scene: an impulse is not
corrected for one that comes later at the same node. The step is the least of all, though springs of two
contacts may act at one node: it is √2 too long at worst, which the default ``time.safety`` covers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mpmfw.contact.law import PairRecords
from mpmfw.contact.strategy import ContactStrategy
from mpmfw.errors import SceneError
from mpmfw.plugin.hooks import BoundHooks, Observer, Registry
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Grid, Pair, Particles, State, Stencil

#: Hooks that only call those of all contacts in turn.
PASSED_ON = (
    "detect", "after_momentum_projection", "add_nodal_force", "after_second_projection", "advect",
)  # fmt: skip

#: The record that not every contact has.
SPRING_WORK = "spring_work"


class RigidMotion(Observer):
    """Gives rigid bodies a rigid motion between two contacts, prescribed and held as before.

    After the last contact their points have the impulses of all."""

    name = "rigid motion"
    observes = ("after_momentum_projection", "after_momentum_update", "after_second_projection")
    rigid: Any = None

    def before(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:  # noqa: ARG002
        """Copy the momenta of the points before all contacts, and before each."""
        self.last = self.rigid.own(grid.momentum).copy()
        if plugin is None:
            self.sum = self.last.copy()

    def after(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:  # noqa: ARG002
        """Add the impulses of each contact."""
        own = self.rigid.own(grid.momentum)
        if plugin is None:
            own[...] = self.sum
        else:
            self.sum += own - self.last
            self.rigid.make_rigid(grid)


class ContactsByPair(ContactStrategy):
    """The scene's contact ``base``, and others between the pairs of bodies that name one.

    Parameters
    ----------
    base
        Acts between all other pairs.
    named
        Contacts by the names of two bodies; several pairs may share one.
    auto_map
        Map of surfaces to the grid that ``auto`` stands for.

    Raises
    ------
    SceneError
        If a contact cannot act between some pairs alone, or two map surfaces in different ways.
    """

    name = "by_pair"
    stage = "contact"
    history = ("contacts",)

    def __init__(self, base: Any, named: Mapping[tuple[str, str], Any], auto_map: Any) -> None:
        super().__init__()
        self.base = type(base).from_options(base.options)
        self.named = named
        self.names = [self.base.label, *(f"{a}-{b}: {contact.label}" for (a, b), contact in named.items())]
        _check(self.base, "contact.method")
        labels: dict[Any, set[str]] = {contact: set() for contact in named.values()}
        for (a, b), contact in named.items():
            if not labels[contact]:
                _check(contact, f"contact.pairs.{a}-{b}.method")
                for fact in ("name", "law_name"):
                    setattr(contact, fact, f"pairs.{a}-{b}.{getattr(contact, fact)}")
                if contact.softer_by is not None:
                    contact.softer_by = contact.softer_by.replace("contact", f"contact.pairs.{a}-{b}", 1)
            master = getattr(contact.detection.options, "master", None)
            if master not in (None, a, b):
                text = f"the master '{master}' is not of this pair; expected {a} or {b}"
                raise SceneError(text, key=f"contact.pairs.{a}-{b}")
            labels[contact] |= {f"{a}-{b}", f"{b}-{a}"}
        for contact, own in labels.items():
            contact.detection.acts_on = lambda pair, own=own: pair.label in own
        others = set().union(*labels.values())
        self.base.detection.acts_on = lambda pair: pair.label not in others
        self.contacts: tuple[Any, ...] = (self.base, *labels)
        self._combine(auto_map)
        registry = Registry()
        for contact in reversed(self.contacts):  # the last registered is called first
            registry.register(contact, contact.name)
        self.rigid_motion = RigidMotion()
        registry.register(self.rigid_motion, self.rigid_motion.name)
        self.hook: Any = BoundHooks(registry, lambda stage: stage)
        for hook in PASSED_ON:
            setattr(self, hook, hookimpl(getattr(self.hook, hook)))

    def _combine(self, auto_map: Any) -> None:
        """Set the facts that all contacts have together."""
        contacts = self.contacts
        given = {each.surface_map for each in contacts if each.needs_surface}
        maps = {auto_map if each == "auto" else each for each in given}
        if len(maps) > 1:
            raise SceneError(f"contacts with map {' and '.join(sorted(maps))}; expected one", key="contact")
        self.surface_map = maps.pop() if maps else "auto"
        for fact in ("needs_surface", "uses_friction", "takes_friction_law"):
            setattr(self, fact, any(getattr(each, fact) for each in contacts))
        self.softer_by = " or ".join(filter(None, (each.softer_by for each in contacts))) or None
        # the one that lacks a radius, which bodies of revolution need
        self.detection = min((each.detection for each in contacts), key=lambda each: each.has_radius)

    @property
    def label(self) -> str:
        return "; ".join(self.names)

    def parts(self) -> list[Any]:
        found = []
        for contact in self.contacts:
            for part in contact.parts():
                part.name = part.name if contact is self.base else f"{part.name} of {contact.name}"
                found.append(part)
        return found

    def between(self, first: str, second: str) -> Any:
        return self.named.get((first, second), self.named.get((second, first), self.base))

    def monitors(self) -> list[Any]:
        from mpmfw.contact.events import ContactEvents

        forces = [each for each in self.contacts if each.gives_forces]
        return [ContactEvents(*forces)] if forces else []

    def compliance(self) -> FloatArray:
        """Return the overlap under a unit of pressure of every pair [m/Pa], 0 where no springs act."""
        found = np.zeros(len(self.state.pairs))
        for contact in self.contacts:
            own = contact.compliance() if hasattr(contact, "compliance") else None
            acts = [contact.detection.acts_on(pair) for pair in self.state.pairs]
            found += 0.0 if own is None else np.where(acts, own, 0.0)
        return found

    def unused(self, pairs: Sequence[Pair]) -> list[str]:
        lines = []
        for contact in self.contacts:
            own = [pair for pair in pairs if contact.detection.acts_on(pair)]
            lines += contact.unused(own)
            if not contact.uses_friction:
                lines += [f"friction of {p.label}: '{contact.name}' has none" for p in own if p.friction]
        return lines

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """Return the fields of all contacts, once each; the work of springs if all record it."""
        answers = self.hook.declare_fields()
        named = [{field.name: field for field in answer} for answer in answers]
        fields = {name: field for each in named for name, field in each.items()}
        self.omitted = (
            {SPRING_WORK} & fields.keys() if any(SPRING_WORK not in each for each in named) else set()
        )
        return [field for name, field in fields.items() if name not in self.omitted]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Prepare all contacts; raise SceneError for a named pair between which nothing acts."""
        self.state = setup.state
        self.rigid_motion.rigid, self.rigid_motion.running = setup.state.rigid, setup.state.rigid is not None
        labels = {pair.label for pair in setup.pairs}
        for a, b in self.named:
            if not labels & {f"{a}-{b}", f"{b}-{a}"}:
                raise SceneError(
                    "contact between two rigid bodies; expected a law of impulses on surfaces, and a body "
                    "that moves freely",
                    key=f"contact.pairs.{a}-{b}",
                )
        self.hook.setup(setup=setup)
        self.restored()

    def restored(self) -> None:
        """Add up the records of all contacts, each of which has those of its pairs."""
        arrays = self.state.arrays
        for name in (*PairRecords.member_names, SPRING_WORK):
            own = [arrays[key] for each in self.contacts if (key := f"{each.name}/{name}") in arrays]
            if len(own) == len(self.contacts):
                arrays[f"{self.name}/{name}"] = np.sum(own, axis=0)

    @hookimpl
    def add_pairs(self, state: State) -> None:
        self.hook.add_pairs(state=state)
        self.restored()

    @hookimpl
    def after_momentum_update(self, grid: Grid, phi: Stencil, particles: Particles, dt: float) -> None:
        """Correct the updated momentum; forces and impulses of the step are then recorded."""
        self.hook.after_momentum_update(grid=grid, phi=phi, particles=particles, dt=dt)
        self.restored()

    def work_over_last_step(self) -> float:
        """Return the work [J/m] of the forces on the last step's motion, where all contacts have forces."""
        return float(sum(contact.work_over_last_step() for contact in self.contacts))

    @hookimpl
    def stable_timestep(self, state: State) -> tuple[float, str] | None:
        return min(self.hook.stable_timestep(state=state), default=None)

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Return the sums over the contacts, of single numbers the largest."""
        found: dict[str, AnyArray] = {}
        for answer in self.hook.diagnostics(state=state, interval=interval, points=True):
            for name, values in answer.items():
                join = np.add if np.ndim(values) else np.maximum
                found[name] = join(found[name], values) if name in found else values
        return {name: values for name, values in found.items() if name not in self.omitted}

    @hookimpl
    def concerns(self) -> list[str]:
        return [line for answer in self.hook.concerns() for line in answer]

    def restart(self) -> None:
        for contact in self.contacts:
            contact.restart()
        self.restored()


def _check(contact: Any, key: str) -> None:
    """Refuse a contact that cannot act between some pairs alone."""
    detection, problem = getattr(contact, "detection", None), ""
    if detection is None:
        problem = f"'{contact.name}' has no detection and acts between all bodies"
    elif not detection.selects_pairs:
        problem = f"detection '{detection.name}' acts between all bodies"
    elif contact.adds_mass:
        problem = f"'{contact.name}' adds inertia to all surfaces"
    if problem:
        able = "penalty, lcp, impulse, bardenhagen or tied"
        raise SceneError(
            f"{problem}; where pairs have contacts of their own, expected such as {able}", key=key
        )
