"""Contact of a detection and a law: what all share, whether the law gives forces or impulses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mpmfw.contact.parts import ContactLaw, Detection, make_part, options_of_both
from mpmfw.contact.rows import ContactRows, FrictionLaw
from mpmfw.contact.strategy import ContactStrategy
from mpmfw.errors import SceneError
from mpmfw.kernels.contact import Records
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import CONTACT_SERIES, AnyArray, Field
from mpmfw.state.structs import Grid, Pair, Particles, State, Stencil

if TYPE_CHECKING:
    from mpmfw.state.index_map import IndexMap


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
    """Records of all pairs, written by kernels and read at outputs. Works and impulses count from time
    zero; ``restart`` forgets the settling."""

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
        """Return the series; forces are means over the ``interval`` [s] since the last output."""
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


class RowContact(ContactStrategy):
    """Base of contacts that name the classes ``Detection`` and ``Law``, whose options are those of both."""

    Detection: ClassVar[type[Detection]]  #: what lists the rows
    Law: ClassVar[type[ContactLaw]]  #: what acts on them
    #: Options whose defaults are others than those of the two parts, by name.
    defaults: ClassVar[dict[str, Any]] = {}
    velocity_fields = "per_body"
    stage = "contact"
    history: ClassVar[tuple[str, ...]] = ("detection", "law", "friction", "records")

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.detection: Detection = make_part(self.Detection, self.options)
        self.law: Any = make_part(self.Law, self.options)
        self.detection.configure(self.Law.needs, forces=self.Law.gives_forces)
        self.surface_map = self.detection.surface_map
        self.adds_mass = self.detection.adds_mass
        parts_do = self.law.leaves_bodies_out and self.detection.leaves_bodies_out
        self.leaves_bodies_out = type(self).leaves_bodies_out or parts_do
        option = self.Law.softness_option
        own = self.name.rpartition("+")[2]  # in a scene a joined law has a table of its own
        self.softer_by = None if option is None else f"contact.{own}.{option}"

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if not hasattr(cls, "Detection"):
            return
        detection, law = cls.Detection, cls.Law
        cls.needs_surface = "facets" in detection.provides
        cls.dimensions = tuple(d for d in detection.dimensions if d in law.dimensions)
        cls.dimensions_note = detection.dimensions_note or law.dimensions_note
        cls.uses_friction = cls.takes_friction_law = law.uses_friction
        if "Options" not in vars(cls) and ("Detection" in vars(cls) or "Law" in vars(cls)):
            cls.Options = options_of_both(cls)

    def parts(self) -> list[Any]:
        """Return the parts of the detection."""
        return self.detection.parts()

    def reach(self, cell_size: float) -> float | None:
        """Return the reach of the detection [m]; ``cell_size`` is h [m]."""
        return self.detection.reach(cell_size)

    def unused(self, pairs: Sequence[Pair]) -> list[str]:
        """Return facts of these ``pairs`` that the law does not use."""
        return self.law.unused(pairs)  # type: ignore[no-any-return]

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """Return the declarations of the pairs' series and of the law's."""
        return [*CONTACT_SERIES, *self.law.fields()]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Prepare detection, law and records, and make the rows of this step and the last.

        Raises
        ------
        SceneError
            The law acts across wider gaps than are found, or cohesion has no area to act on.
        """
        self.state, self.friction = setup.state, setup.friction_law or FrictionLaw()
        self.records = PairRecords(setup, self.name)
        self.detection.prepare(setup, self.name)
        self.law.prepare(setup, self.name)
        self.check_range(setup.cell_size)
        self.detection.law_range = self.law.range()
        own = self.law.row_arrays(friction=setup.has_friction)
        self.rows, self.old = self.detection.new_rows(own), self.detection.new_rows(own)
        if self.friction.cohesive and not self.detection.measures_area:
            raise SceneError(
                f"'{self.friction.name}' has cohesion, which acts on an area; detection "
                f"'{self.detection.name}' measures none with its options",
                key="contact.friction_law",
            )
        if setup.has_friction and self.uses_friction:
            for rows in (self.rows, self.old):
                rows.allocate_friction(cohesion=self.friction.cohesive)
        self._list_facts(setup.state)

    def check_range(self, cell_size: float) -> None:
        """Refuse a law that acts across wider gaps than the detection finds, with the cell size h [m]."""
        detection, law = self.detection, self.law
        listed, needed = detection.range(cell_size), law.range()
        if listed is None or needed <= listed or math.isclose(needed, listed):
            return
        finds, expected = f"contact '{self.name}': detection '{detection.name}'", "another detection"
        value = getattr(detection.options, "search_radius", None)
        if value is not None:
            table = self.name.partition("+")[0]  # in a scene a joined detection has a table of its own
            finds = f"contact.{table}.search_radius = {value:g}"
            expected = f"at least {value * needed / listed:.4g}"
        raise SceneError(
            f"{finds} finds gaps of up to {listed:.4g} m, and law '{law.name}' acts across gaps of up to "
            f"{needed:.4g} m; expected {expected}, or a law that acts across none so wide"
        )

    @hookimpl
    def add_pairs(self, state: State) -> None:
        """Add facts and records of bodies that have come near."""
        self.detection.list_pairs(state)
        self.law.list_pairs(state)
        self.records.add_pairs(state)
        self._list_facts(state)

    def _list_facts(self, state: State) -> None:
        """List μ of every pair, and the lesser thickness of its bodies; None where no body has one."""
        bodies, self.width = state.bodies, None
        self.pair_friction = np.array([pair.mu for pair in state.pairs], dtype=float)
        if state.particles.thickness is not None:
            width = [min(bodies[p.first].thickness, bodies[p.second].thickness) for p in state.pairs]
            self.width = np.array(width, dtype=float)

    def find_rows(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Find the rows where the bodies are now, the width over which they touch, and the limit of slip."""
        rows = self.rows
        self.detection.find(grid, phi, particles, rows)
        if self.width is not None:
            width = self.width[rows.pair[: rows.count]]
            for area in (rows.area, rows.tributary_area):
                area[: rows.count] *= width
        if rows.count:
            self.law.measure(rows, grid, phi, particles)
            if len(rows.friction):
                self.friction.slip_limit(rows, self.pair_friction, self.state.dt)

    @property
    def last_rows(self) -> ContactRows:
        """The rows of the last step, with what acted on them."""
        return self.rows

    def copy_history(self, other: RowContact, index_map: IndexMap) -> None:
        """Copy the history of ``other``, renumbered by ``index_map``; records are declared arrays."""
        self.detection.copy_history(other.detection, index_map)

    def restart(self) -> None:
        """Forget impulse and work of the settling; contacts stay loaded."""
        self.records.restart()
        self.law.restart()
        self.detection.restart()

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:  # noqa: ARG002
        """Return the pairs' series and the law's; ``interval`` [s] is since the last output."""
        return {**self.records.series(interval), **self.law.series()}

    @hookimpl
    def concerns(self) -> list[str]:
        """Return the warnings of law and detection."""
        return [*self.law.remarks(), *self.detection.remarks()]
