"""Contact strategies of a detection and a law: what acts on the grid, the stable step, the records."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from pydantic import BaseModel

from mpmfw.contact.detection import Detection
from mpmfw.contact.friction import FrictionLaw
from mpmfw.contact.law import ContactLaw, ForceLaw, ImpulseLaw
from mpmfw.contact.reach import refuse_short_reach
from mpmfw.contact.records import PairRecords
from mpmfw.contact.rows import ContactRows
from mpmfw.contact.strategy import ContactStrategy
from mpmfw.errors import SceneError
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.history import check_indices
from mpmfw.state.structs import Grid, Pair, Particles, State, Stencil

if TYPE_CHECKING:
    from mpmfw.state.numbers import Numbers


class RowContact(ContactStrategy):
    """Base of strategies that name a detection and a law; its options are those of both.

    Subclasses are :class:`ForceContact` and :class:`ImpulseContact`, after what the law gives. They name the classes
    ``Detection`` and ``Law``; the hook ``concerns`` is there where the law has something to say.
    """

    Detection: ClassVar[type[Detection]]  #: what lists the rows
    Law: ClassVar[type[ContactLaw]]  #: what acts on them
    velocity_fields = "per_body"
    stage = "contact"
    history: ClassVar[tuple[str, ...]] = ("detection", "law", "friction", "records")
    #: The hook, of laws that have something to say.
    concerns: ClassVar[Any]

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.detection: Detection = _part(self.Detection, self.options)
        self.law: Any = _part(self.Law, self.options)
        self.detection.for_law(needs_gap=self.Law.needs_gap, forces=issubclass(self.Law, ForceLaw))
        self._parts: list[Any] = self.detection.parts(self)
        self.surface_map = self.detection.surface_map
        self.adds_mass = self.detection.adds_mass
        option = self.Law.softness_option
        own = self.name.rpartition("+")[2]  # in a scene a joined law has a table of its own
        self.softer_by = None if option is None else f"contact.{own}.{option}"

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if hasattr(cls, "Detection"):
            cls.needs_surface = cls.Detection.needs_surface
            cls.dimensions = tuple(d for d in cls.Detection.dimensions if d in cls.Law.dimensions)
            cls.dimensions_note = cls.Detection.dimensions_note or cls.Law.dimensions_note
            cls.uses_friction = cls.takes_friction_law = cls.Law.uses_friction
            if cls.Law.remarks is not ContactLaw.remarks:
                cls.concerns = _concerns

    def parts(self) -> list[Any]:
        """Parts of the detection."""
        return self._parts

    def reach(self, cell_size: float) -> float | None:
        """Reach of the detection [m]."""
        return self.detection.reach(cell_size)

    def unused(self, pairs: Sequence[Pair]) -> list[str]:
        """What the law does not look at."""
        return self.law.unused(pairs)  # type: ignore[no-any-return]

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The pairs' series, and what detection and law have beside them."""
        return [*PairRecords.declarations(), *self.law.fields()]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Detection, law, records, and rows of this step and the last."""
        self.state, self.friction = setup.state, setup.friction_law or FrictionLaw()
        self.records = PairRecords(setup, self.name)
        self.detection.prepare(setup, self.name)
        self.law.prepare(setup, self.name)
        refuse_short_reach(self.detection, self.law, self.name, setup.cell_size)
        self.detection.acts_to = self.law.widest_gap()
        own = self.law.row_arrays(friction=setup.has_friction)
        self.rows, self.old = self.detection.new_rows(own), self.detection.new_rows(own)
        if self.friction.cohesive and not self.detection.measures_area:
            raise SceneError(
                f"contact.friction_law = '{self.friction.name}' has cohesion, which acts on an area; detection "
                f"'{self.detection.name}' measures none with its options"
            )
        if setup.has_friction and self.uses_friction:
            for rows in (self.rows, self.old):
                rows.hold(cohesion=self.friction.cohesive)
        self._list_friction(setup.state)
        self._list_thickness(setup.state)
        self.node_sum = np.zeros(0)

    @hookimpl
    def add_pairs(self, state: State) -> None:
        """Facts and records of bodies that have come near."""
        self.detection.list_pairs(state)
        self.law.list_pairs(state)
        self.records.add_pairs(state)
        self._list_friction(state)
        self._list_thickness(state)

    def _list_friction(self, state: State) -> None:
        """μ of every pair, as the scene has it."""
        self.pair_friction = np.array([pair.mu for pair in state.pairs], dtype=float)

    def _list_thickness(self, state: State) -> None:
        """Width over which every pair touches: the lesser thickness of the two; None where no body names one."""
        bodies, self.width = state.bodies, None
        if state.particles.thickness is not None:
            width = [min(bodies[p.first].thickness, bodies[p.second].thickness) for p in state.pairs]
            self.width = np.array(width, dtype=float)

    def find_rows(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """The rows where the bodies are now; areas with the width over which the bodies touch."""
        rows = self.rows
        self.detection.find(grid, phi, particles, rows)
        if self.width is not None:
            width = self.width[rows.pair[: rows.count]]
            for area in (rows.area, rows.whole):
                area[: rows.count] *= width

    def bound_slip(self) -> None:
        """What the rows of this step hold along their planes."""
        if len(self.rows.friction):
            self.friction.bound(self.rows, self.pair_friction, self.state.dt)

    @property
    def last_rows(self) -> ContactRows:
        """The rows of the last step, with what acted on them."""
        return self.rows

    def scratch(self, grid: Grid) -> FloatArray:
        """A number for every node of the grid, all zero."""
        if len(self.node_sum) != len(grid.mass):
            self.node_sum = np.zeros(len(grid.mass))
        return self.node_sum

    def record(self, scale: float, spacing: tuple[float, ...]) -> None:
        """Add the rows' forces times ``scale`` [s] to the pairs' impulses, and count the places where they act.

        ``spacing`` is the cell size h, once for each dimension.
        """
        self.rows.record(scale, self.records, spacing)

    def take_over(self, other: RowContact, numbers: Numbers) -> None:
        """Know of bodies, by other ``numbers``, what ``other`` knows of them from step to step; records are declared arrays."""
        self.detection.take_over(other.detection, numbers)

    def restart(self) -> None:
        """Forget impulse and work of the settling; contacts stay loaded."""
        self.records.restart()
        for each in (self.law, *self._parts):
            if hasattr(each, "restart"):
                each.restart()

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:  # noqa: ARG002
        """The series, and the detection's output fields."""
        return {**self.records.series(interval), **self.law.series()}


class ForceContact(RowContact):
    """Forces on rows act beside the internal ones (eq. 12 of [H17]), and the step must resolve them.

    A subclass names the classes ``Detection`` and ``Law``; the hook ``concerns`` is there where the law has something to say.
    """

    Law: ClassVar[type[ForceLaw]]  #: what acts on the rows
    history = ("old", "omega_squared", "longest_step")

    def restored(self) -> None:
        """Refuse rows of pairs that there are not.

        Raises
        ------
        NotSaved
            There are some.
        """
        check_indices(len(self.state.pairs), pair=self.old.pair[: self.old.count])

    def monitors(self) -> list[Any]:
        """Steps per contact and deepest penetration."""
        from mpmfw.contact.events import ContactEvents

        return [ContactEvents(self)]

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """Fields of every contact, and the detection's output fields."""
        return [*self.detection.fields(), *super().declare_fields()]

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Series of every contact, and the detection's output fields, from the rows of the last step; ``interval`` [s] is since
        the last output."""
        return {**self.detection.outputs(self.old), **super().diagnostics(state, interval)}

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """As before, and the frequency of the bulk."""
        super().setup(setup)
        self.bulk_frequency = setup.bulk_frequency
        self.omega_squared: float | None = (
            None  #: of the rows of this step [1/s²]; None before any was detected
        )
        self.longest_step = math.inf  #: that the law allows beside it [s]

    @hookimpl
    def detect(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """The rows where the bodies are now, their stiffness, and the highest frequency that they give the grid."""
        rows, old = self.rows, self.old
        self.find_rows(grid, phi, particles)
        self.omega_squared, self.longest_step = 0.0, math.inf
        if rows.count:
            rows.match(old)
            self.bound_slip()
            stiffness = self.law.stiffness(rows, old)
            self.omega_squared = rows.couplings(stiffness, grid, self.scratch(grid), stiffness)
            self.longest_step = self.law.longest_step(rows, grid)
            if not rows.touch():
                # The step in which they touch must not be longer than the next: springs begin with the depth that it leaves,
                # and with its square the energy that nothing paid for
                self.omega_squared = max(self.omega_squared, self.law.expected(self.bulk_frequency))

    @hookimpl
    def add_nodal_force(self, grid: Grid, dt: float) -> None:
        """The law's forces on the rows, mapped by Bᵀ (eq. 9, 11); ``dt`` [s] is the length of the step."""
        rows, old = self.rows, self.old
        if rows.count == 0 and old.count == 0:
            return
        period = math.sqrt(self.omega_squared or 0.0) * self.state.dt
        # c = ζ 2 sqrt(k m) with the mass k / ω² that goes with the highest frequency; per length of the last step
        dashpot = 2.0 * self.law.damping / period if period > 0.0 else 0.0
        self.law.forces(rows, old, dashpot, self.records)
        rows.add_to(grid.force, grid.spacing)
        self.record(dt, grid.spacing)

    def work_over_last_step(self) -> float:
        """Work [J/m] of this step's forces on how far their rows came in the last one; asked before :meth:`advect`."""
        return self.rows.work_over_last_step()

    @hookimpl
    def advect(self, grid: Grid, dt: float) -> None:
        """How far every row's sides move in the step of ``dt`` [s]; its rows are the history of the next."""
        rows = self.rows
        if "moved" in rows.own.member_names and rows.count:
            rows.velocity(grid.velocity, dt, rows.own.moved, grid.spacing)
        self.detection.keep()
        self.rows, self.old = self.old, rows

    def take_over(self, other: RowContact, numbers: Numbers) -> None:
        """Those, and the rows of the last step that ``other`` has, by ``numbers``."""
        super().take_over(other, numbers)
        self.old.take_over(other.last_rows, numbers)

    @property
    def last_rows(self) -> ContactRows:
        """The rows of the last step, with their forces."""
        return self.old

    @hookimpl
    def stable_timestep(self) -> tuple[float, str] | None:
        """2 / sqrt(ω_bulk² + ω²) [s]: bulk and springs act together. Before the first detection, ω² is that of equal bodies.

        It is less where the law allows less.
        """
        omega_squared = self.omega_squared
        if omega_squared is None:
            omega_squared = self.law.expected(self.bulk_frequency)
        if omega_squared == 0.0 and self.longest_step == math.inf:
            return None
        zeta = self.law.damping
        # A dashpot that lags by a step takes away from the limit of its spring: 2 (√(1 + ζ²) − ζ) / ω.
        omega_squared /= (math.sqrt(1.0 + zeta * zeta) - zeta) ** 2
        resolved = 2.0 / math.sqrt(self.bulk_frequency**2 + omega_squared)
        if self.longest_step < resolved:
            return self.longest_step, f"{self.law.name} at the present approach"
        return resolved, f"{self.law.name} springs and bulk"


class ImpulseContact(RowContact):
    """Impulses on rows correct the grid's momentum: the projected and the updated one, and MUSL's second.

    A subclass names the classes ``Detection`` and ``Law``; the hook ``concerns`` is there where the law has something to say.
    """

    Law: ClassVar[type[ImpulseLaw]]  #: what acts on the rows

    @hookimpl
    def detect(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """The rows where the bodies are now."""
        self.find_rows(grid, phi, particles)
        self.scratch(grid)
        self.bound_slip()
        self.cohesion = (
            self.rows.cohesion.copy()
        )  #: forces; in the rows stand the impulses of each correction

    @hookimpl
    def after_momentum_projection(self, grid: Grid, dt: float) -> None:
        """Correct the projected momentum; cohesion holds against the forces of the step, which have not acted yet.

        ``dt`` [s] is the length of the step.
        """
        self.law.dt = dt
        self.rows.cohesion[:] = 0.0
        self._correct(grid, projected=True)

    @hookimpl
    def after_momentum_update(self, grid: Grid, dt: float) -> None:
        """Correct the updated momentum, at the same rows; ``dt`` [s] is the length of the step."""
        self.rows.cohesion[:] = dt * self.cohesion
        self._correct(grid, projected=False)

    @hookimpl
    def after_second_projection(self, grid: Grid) -> None:
        """Correct MUSL's second momentum, from which the strain is taken, at the same rows.

        Else bodies that no longer approach are strained as if they did, and what the strain takes up has no work
        against it. No point moves with this momentum: its impulse and work are in no record.
        """
        if self.rows.count:
            self.law.impulses(self.rows, grid, self.node_sum, None, projected=False)
            self.rows.add_to(grid.momentum, grid.spacing)

    def _correct(self, grid: Grid, *, projected: bool) -> None:
        rows, records = self.rows, self.records
        if rows.count == 0:
            records.count.fill(0.0)
            return
        self.law.impulses(rows, grid, self.node_sum, records.frictional_work, projected=projected)
        rows.add_to(grid.momentum, grid.spacing)
        self.record(1.0, grid.spacing)

    @hookimpl
    def advect(self) -> None:
        """What was detected is the past."""
        self.detection.keep()


@hookimpl
def _concerns(self: RowContact) -> list[str]:
    """What a reader must know of the law's work, of those laws that have to say something."""
    return self.law.remarks()  # type: ignore[no-any-return]


def _part(kind: type[Any], options: BaseModel) -> Any:
    """A detection or law from the options of the whole: those that were set, and those with a default of the whole's own."""
    own, whole = kind.Options.model_fields, type(options).model_fields
    given = [
        name for name in own if name in options.model_fields_set or whole[name].default != own[name].default
    ]
    return kind(**{name: getattr(options, name) for name in given})
