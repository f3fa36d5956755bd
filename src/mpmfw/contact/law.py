"""Laws of contact, and the records of pairs."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np

from mpmfw.contact.rows import ContactRows, Detection, FrictionLaw
from mpmfw.contact.strategy import ContactStrategy, joined, options_of_both
from mpmfw.errors import PluginError, SceneError
from mpmfw.kernels.contact import Records
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import CONTACT_SERIES, AnyArray, Field
from mpmfw.state.history import IndexMap
from mpmfw.state.structs import Grid, Particles, State, Stencil

_DECLARED = (
    Field("impulse", ("pair", "axis"), "N s m-1", "impulse on the pair's first body", "contact"),
    Field("friction_impulse", ("pair", "axis"), "N s m-1", "its part along the surface", "contact"),
    Field("frictional_work", ("pair",), "J m-1", "energy dissipated by friction", "contact"),
    Field("damping_work", ("pair",), "J m-1", "energy dissipated by dashpots", "contact"),
    Field("energy", ("pair",), "J m-1", "energy stored in contact springs", "contact"),
    Field("count", ("pair",), "1", "nodes in contact", "contact"),
)

#: Records whose mean rates are the forces of the series.
_IMPULSES = ("impulse", "friction_impulse")


class PairRecords(Records):
    """Records of all pairs since time zero; ``restart`` forgets the settling."""

    history = ("_last",)

    def __init__(self, setup: Setup, owner: str) -> None:
        super().__init__(**{field.name: setup.allocate(owner, field) for field in _DECLARED})
        self._last = {name: np.zeros_like(self.impulse) for name in _IMPULSES}
        self._owner = owner

    def add_pairs(self, state: State) -> None:
        """Add zeros for pairs that were added to the state's."""
        count = len(state.pairs)
        self.set(**{name: state.lengthen(f"{self._owner}/{name}", count) for name in self.member_names})
        for name, last in self._last.items():
            self._last[name] = np.concatenate([last, np.zeros((count - len(last), last.shape[1]))])

    def restart(self) -> None:
        """Set the accumulators to zero."""
        for array in (self.impulse, self.friction_impulse, self.frictional_work, self.damping_work):
            array.fill(0.0)
        for last in self._last.values():
            last.fill(0.0)

    def series(self, interval: float) -> dict[str, AnyArray]:
        """Return the series; forces are means over the ``interval`` [s]."""
        forces = {}
        for name, last in self._last.items():
            now = getattr(self, name).copy()
            forces[name] = (now - last) / interval if interval > 0.0 else np.zeros_like(now)
            self._last[name] = now
        return {
            "contact_force": forces["impulse"],
            "friction_force": forces["friction_impulse"],
            "contact_count": self.count.copy(),
            "frictional_work": self.frictional_work.copy(),
            "contact_energy": self.energy.copy(),
            "damping_work": self.damping_work.copy(),
        }


class ContactLaw(ContactStrategy):
    """Base of laws, entry points of the group ``mpmfw.law``: a :class:`ForceLaw` or an :class:`ImpulseLaw`.

    A class that names its ``Detection`` is a contact strategy with the options of both. Other classes are
    laws for any detection, ``DETECTION+LAW``.
    """

    Detection: ClassVar[type[Detection]]  #: what lists the rows
    #: Defaults of options, by name, where they differ from those of detection and law.
    defaults: ClassVar[dict[str, Any]] = {}
    #: What it needs of the rows: ``gap`` for a signed gap, ``steady gap`` for one that does not jump as rows
    #: come and go, ``facets``, ``nodes`` for nodes against facets. A law of forces that reads entries of B
    #: needs ``entries``: on surfaces they are not written for others.
    needs: ClassVar[frozenset[str]] = frozenset()
    #: Whether it gives forces, and not impulses.
    gives_forces: ClassVar[bool] = False
    #: Its option that makes contact softer where it is smaller, for advice.
    softness_option: ClassVar[str | None] = None
    stage = "contact"
    history: ClassVar[tuple[str, ...]] = ("detection", "friction_law", "records")

    def __init__(self, **options: Any) -> None:
        if not hasattr(self, "Detection"):
            raise SceneError(f"law '{self.name}' has no detection; expected DETECTION+{self.name}")
        super().__init__(**options)
        own, both = self.Detection.Options.model_fields, type(self.options).model_fields
        chosen = [
            name
            for name in own
            if name in self.options.model_fields_set or both[name].default != own[name].default
        ]
        self.detection = self.Detection(**{name: getattr(self.options, name) for name in chosen})
        self.detection.configure(self.needs, forces=self.gives_forces)
        self.surface_map, self.adds_mass = self.detection.surface_map, self.detection.adds_mass
        # springs have no stiffness between rigid bodies, which have no nodes on the grid
        self.meets_rigid_pairs = not self.gives_forces and "facets" in self.detection.provides
        self.leaves_bodies_out = type(self).leaves_bodies_out and self.detection.leaves_bodies_out
        self.law_name = self.name.rpartition("+")[2]  #: that of its table in a scene
        option = self.softness_option
        self.softer_by = None if option is None else f"contact.{self.law_name}.{option}"

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        cls.takes_friction_law = cls.uses_friction
        if "Detection" not in vars(cls):
            return
        # A contact with another detection is made of its law: of the first one's detection nothing stays
        law = next(base for base in cls.__mro__[1:] if "Detection" not in vars(base))
        options, dimensions, note = (
            vars(cls).get(name, getattr(law, name)) for name in ("Options", "dimensions", "dimensions_note")
        )
        detection = cls.Detection
        cls.needs_surface = "facets" in detection.provides
        cls.dimensions = tuple(d for d in detection.dimensions if d in dimensions)
        cls.dimensions_note = detection.dimensions_note or note
        cls.Options = options_of_both(cls, options)

    @classmethod
    def joined_with(cls, detection: type[Any]) -> type[Any]:
        """Return the contact ``DETECTION+LAW`` of a class ``detection``."""
        return joined(detection, cls)  # type: ignore[arg-type]  # classes are hashable

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:  # noqa: ARG002
        """Return the law's own arrays of the rows, by name: the number of further dimensions, or None for an
        array without rows. ``friction`` is true if any pair has friction.

        They are its history, ``rows.own`` for kernels. One called ``moved`` gets B v Δt of the step."""
        return {}

    def prepare(self, setup: Setup) -> None:
        """Read facts of the scene from ``setup``."""

    def measure(self, rows: ContactRows, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Take what the law needs of the points; ``phi`` is their table."""

    def range(self) -> float:
        """Return the gap up to which the law acts [m]: 0 where bodies must touch."""
        return 0.0

    def list_pairs(self, state: State) -> None:
        """List facts of ``state.pairs`` as arrays, at the start and as bodies come near."""
        bodies, self.width = state.bodies, None
        self.pair_friction = np.array([pair.mu for pair in state.pairs], dtype=float)
        if state.particles.thickness is not None:  # the lesser one of both bodies
            width = [min(bodies[p.first].thickness, bodies[p.second].thickness) for p in state.pairs]
            self.width = np.array(width, dtype=float)

    def parts(self) -> list[Any]:
        return self.detection.parts()

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [*self.detection.fields(), *CONTACT_SERIES]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Prepare records, detection and law, and make the rows of this step and the last.

        Raise SceneError if cohesion has no area to act on."""
        self.state, self.cell_size, self.scheme = setup.state, setup.cell_size, setup.scheme
        self.friction_law = setup.friction_law or FrictionLaw()
        self.records = PairRecords(setup, self.name)
        self.detection.prepare(setup, self.name)
        self.prepare(setup)
        self.list_pairs(setup.state)
        self.detection.law_range = self.range()
        self.check_range(self.detection.law_range)
        own = self.row_arrays(friction=setup.has_friction)
        self.rows, self.old = self.detection.new_rows(own), self.detection.new_rows(own)
        if self.friction_law.cohesive and not self.detection.measures_area:
            raise SceneError(
                f"'{self.friction_law.name}' has cohesion, which acts on an area; detection "
                f"'{self.detection.name}' measures none with its options",
                key="contact.friction_law",
            )
        if setup.has_friction and self.uses_friction:
            for rows in (self.rows, self.old):
                rows.allocate_friction(cohesion=self.friction_law.cohesive)

    def check_range(self, needed: float) -> None:
        """Refuse a detection that does not find gaps of up to ``needed`` [m]."""
        detection = self.detection
        listed = detection.range(self.cell_size) if needed > 0.0 else None
        if listed is None or needed <= listed or math.isclose(needed, listed):
            return
        finds, expected = f"contact '{self.name}': detection '{detection.name}'", "another detection"
        value = getattr(detection.options, "search_radius", None)
        if value is not None:
            table = self.name.partition("+")[0]  # in a scene a joined detection has a table of its own
            finds = f"contact.{table}.search_radius = {value:g}"
            expected = f"at least {value * needed / listed:.4g}"
        raise SceneError(
            f"{finds} finds gaps of up to {listed:.4g} m, and law '{self.law_name}' acts across gaps of up "
            f"to {needed:.4g} m; expected {expected}, or a law that acts across none so wide"
        )

    @hookimpl
    def add_pairs(self, state: State) -> None:
        self.detection.list_pairs(state)
        self.list_pairs(state)
        self.records.add_pairs(state)

    def find_rows(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Find the rows, the width over which bodies touch, and the limit of slip."""
        rows = self.rows
        self.detection.find(grid, phi, particles, rows)
        if self.width is not None:
            if grid.axisymmetric:
                radius = self.detection.radii(rows, grid)
                width = grid.around(radius, self.detection.mean_radius)
                grid.turn_to_axis(radius[:, None], rows.normal[: rows.count])
            else:
                width = self.width[rows.pair[: rows.count]]
            for area in (rows.area, rows.tributary_area):
                area[: rows.count] *= width
        if rows.count:
            self.measure(rows, grid, phi, particles)
            if len(rows.friction):
                self.friction_law.slip_limit(rows, self.pair_friction, self.state.dt)
                limits = np.append(rows.friction[: rows.count], rows.cohesion[: rows.count])
                if not limits.min() >= 0.0:  # NaN fails this too, and bodies would stick
                    text = f"friction law '{self.friction_law.name}' gave friction that is NaN or below 0"
                    raise PluginError(text, step=self.state.steps, time=self.state.time)

    @property
    def last_rows(self) -> ContactRows:
        """The rows of the last step, with what acted on them."""
        return self.rows

    def copy_history(self, other: ContactLaw, index_map: IndexMap) -> None:
        """Copy the history of ``other``, renumbered by ``index_map``."""
        self.detection.copy_history(other.detection, index_map)

    def restart(self) -> None:
        """Forget impulse and work of the settling; contacts stay loaded."""
        self.records.restart()
        self.detection.restart()

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Return the pairs' series, and the detection's output fields of the last step.

        ``interval`` [s] is since the last output."""
        rows = self.last_rows
        if self.gives_forces or rows.count == 0:
            return {**self.detection.outputs(rows), **self.records.series(interval)}
        impulse = rows.force[: rows.count].copy()
        rows.force[: rows.count] /= state.dt
        fields = self.detection.outputs(rows)
        rows.force[: rows.count] = impulse
        return {**fields, **self.records.series(interval)}

    @hookimpl
    def concerns(self) -> list[str]:
        return self.detection.remarks()
