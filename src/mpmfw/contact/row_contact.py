"""Contact of a detection and a law: what both share, whether the law gives forces or impulses."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from pydantic import BaseModel, create_model

from mpmfw.contact.detection import Detection
from mpmfw.contact.friction import FrictionLaw
from mpmfw.contact.records import PairRecords
from mpmfw.contact.rows import ContactRows
from mpmfw.contact.strategy import ContactStrategy
from mpmfw.errors import SceneError
from mpmfw.plugin.base import PlugIn
from mpmfw.plugin.checks import bundled
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Grid, Pair, Particles, State, Stencil

if TYPE_CHECKING:
    from mpmfw.state.index_map import IndexMap

#: What a law may need of a detection, as messages name it.
NEEDS = {
    "facets": "facets of surfaces",
    "nodes": "surface nodes against facets",
    "steady gap": "gaps that do not jump",
}


class ContactLaw(PlugIn):
    """Base of laws, announced as entry points of the group ``mpmfw.law``; a law is a :class:`ForceLaw` or an
    :class:`ImpulseLaw`."""

    #: What it needs of the rows: ``gap`` for a signed gap, ``steady gap`` for one that does not jump as rows
    #: come and go, ``facets``, ``nodes`` for nodes against facets.
    needs: ClassVar[frozenset[str]] = frozenset()
    #: Whether it gives forces, and not impulses.
    gives_forces: ClassVar[bool] = False
    #: Whether the law uses the pairs' friction.
    uses_friction: ClassVar[bool] = False
    #: Its option that makes contact softer where it is smaller, for advice; None where there is none.
    softness_option: ClassVar[str | None] = None
    #: Whether the conformance kit checks detections by joining them with it.
    checks_others: ClassVar[bool] = False
    #: Whether bodies at rest may be left out for a while: its history is in its rows.
    leaves_bodies_out: ClassVar[bool] = False
    #: Dimensions that it works in.
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    #: Reason for these dimensions, for the message that refuses others.
    dimensions_note: ClassVar[str] = ""

    @classmethod
    def strategy(cls) -> type[RowContact]:
        """Return the base of contacts with this law."""
        raise NotImplementedError

    @classmethod
    def joined_with(cls, detection: type[Any]) -> type[Any]:
        """Return the contact strategy of a class ``detection`` and this law, ``DETECTION+LAW``.

        Raises
        ------
        SceneError
            They do not go together.
        """
        return joined(detection, cls)

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:  # noqa: ARG002
        """Return the law's own arrays of the rows, by name: the number of further dimensions, or None for an
        array without rows.

        They are its history, ``rows.own`` as one argument of kernels. ``friction`` is true if any pair has
        friction. An array called ``moved`` is filled with B v Δt at the end of the step.
        """
        return {}

    def unused(self, pairs: Sequence[Pair]) -> list[str]:  # noqa: ARG002
        """Return facts of these ``pairs`` that have no effect with its options, one line each."""
        return []

    def fields(self) -> list[Field]:
        """Return the declarations of series beside those that all contacts have."""
        return []

    def prepare(self, setup: Setup, owner: str) -> None:
        """Take facts of the scene from ``setup``, and list arrays under ``owner``."""

    def measure(self, rows: ContactRows, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Take what the law needs of the material points, once the rows of the step are there; nothing by
        default.

        ``phi`` is the table of interpolation of the points.
        """

    def range(self) -> float:
        """Return the gap up to which the law acts [m], after :meth:`prepare`; 0 where it acts on bodies that
        touch alone.

        A detection that lists no rows so far apart (:meth:`Detection.range`) is refused.
        """
        return 0.0

    def list_pairs(self, state: State) -> None:
        """Take facts of ``state.pairs`` as arrays: bodies have come near that were apart."""

    def series(self) -> dict[str, AnyArray]:
        """Return values of the declared series."""
        return {}

    def restart(self) -> None:
        """Forget accumulated work at time zero, after settling."""

    def remarks(self) -> list[str]:
        """Return warnings for a reader of the results, a sentence each, after the last step."""
        return []


class RowContact(ContactStrategy):
    """Base of contacts that name the classes ``Detection`` and ``Law``; their options are those of both.

    Subclasses are :class:`ForceContact` and :class:`ImpulseContact`, after what the law gives. The hook
    ``concerns`` is there where the law has warnings.
    """

    Detection: ClassVar[type[Detection]]  #: what lists the rows
    Law: ClassVar[type[ContactLaw]]  #: what acts on them
    #: Options whose defaults are others than those of the two parts, by name.
    defaults: ClassVar[dict[str, Any]] = {}
    velocity_fields = "per_body"
    stage = "contact"
    history: ClassVar[tuple[str, ...]] = ("detection", "law", "friction", "records")
    #: The hook, of laws that have warnings.
    concerns: ClassVar[Any]

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.detection: Detection = _part(self.Detection, self.options)
        self.law: Any = _part(self.Law, self.options)
        self.detection.configure(self.Law.needs, forces=self.Law.gives_forces)
        self._parts: list[Any] = self.detection.parts(self)
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
        cls.needs_surface = detection.needs_surface
        cls.dimensions = tuple(d for d in detection.dimensions if d in law.dimensions)
        cls.dimensions_note = detection.dimensions_note or law.dimensions_note
        cls.uses_friction = cls.takes_friction_law = law.uses_friction
        if law.remarks is not ContactLaw.remarks:
            cls.concerns = _concerns
        if "Options" not in vars(cls) and ("Detection" in vars(cls) or "Law" in vars(cls)):
            cls.Options = _options_of_both(cls)

    def parts(self) -> list[Any]:
        """Return the parts of the detection."""
        return self._parts

    def reach(self, cell_size: float) -> float | None:
        """Return the reach of the detection [m]; ``cell_size`` is h [m]."""
        return self.detection.reach(cell_size)

    def unused(self, pairs: Sequence[Pair]) -> list[str]:
        """Return facts of these ``pairs`` that the law does not use."""
        return self.law.unused(pairs)  # type: ignore[no-any-return]

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """Return the declarations of the pairs' series and of the law's."""
        return [*PairRecords.declarations(), *self.law.fields()]

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
                f"contact.friction_law = '{self.friction.name}' has cohesion, which acts on an area; "
                f"detection '{self.detection.name}' measures none with its options"
            )
        if setup.has_friction and self.uses_friction:
            for rows in (self.rows, self.old):
                rows.allocate_friction(cohesion=self.friction.cohesive)
        self._list_facts(setup.state)
        self.node_sum = np.zeros(0)

    def check_range(self, cell_size: float) -> None:
        """Refuse a law that acts across wider gaps than the detection finds; both are prepared.

        ``cell_size`` is h [m].

        Raises
        ------
        SceneError
            They do not go together with these options.
        """
        detection, law = self.detection, self.law
        listed, needed = detection.range(cell_size), law.range()
        if listed is None or needed <= listed or math.isclose(needed, listed):
            return
        finds, expected = f"contact '{self.name}': detection '{detection.name}'", "another detection"
        if detection.range_option is not None:
            value = getattr(detection.options, detection.range_option)
            table = self.name.partition("+")[0]  # in a scene a joined detection has a table of its own
            finds = f"contact.{table}.{detection.range_option} = {value:g}"
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
        """List μ of every pair, and the lesser thickness of the two bodies; None where no body names one."""
        bodies, self.width = state.bodies, None
        self.pair_friction = np.array([pair.mu for pair in state.pairs], dtype=float)
        if state.particles.thickness is not None:
            width = [min(bodies[p.first].thickness, bodies[p.second].thickness) for p in state.pairs]
            self.width = np.array(width, dtype=float)

    def find_rows(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Find the rows where the bodies are now; areas with the width over which the bodies touch."""
        rows = self.rows
        self.detection.find(grid, phi, particles, rows)
        if self.width is not None:
            width = self.width[rows.pair[: rows.count]]
            for area in (rows.area, rows.tributary_area):
                area[: rows.count] *= width
        if rows.count:
            self.law.measure(rows, grid, phi, particles)

    def limit_slip(self) -> None:
        """Write what the rows of this step hold along their planes."""
        if len(self.rows.friction):
            self.friction.slip_limit(self.rows, self.pair_friction, self.state.dt)

    @property
    def last_rows(self) -> ContactRows:
        """The rows of the last step, with what acted on them."""
        return self.rows

    def scratch(self, grid: Grid) -> FloatArray:
        """Return a number for every node of the grid, all zero."""
        if len(self.node_sum) != len(grid.mass):
            self.node_sum = np.zeros(len(grid.mass))
        return self.node_sum

    def copy_history(self, other: RowContact, index_map: IndexMap) -> None:
        """Copy the history of ``other``, renumbered by ``index_map``; records are declared arrays."""
        self.detection.copy_history(other.detection, index_map)

    def restart(self) -> None:
        """Forget impulse and work of the settling; contacts stay loaded."""
        self.records.restart()
        for each in (self.law, *self._parts):
            if hasattr(each, "restart"):
                each.restart()

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:  # noqa: ARG002
        """Return the pairs' series and the law's; ``interval`` [s] is since the last output."""
        return {**self.records.series(interval), **self.law.series()}


@hookimpl
def _concerns(self: RowContact) -> list[str]:
    """Return the law's warnings."""
    return self.law.remarks()  # type: ignore[no-any-return]


def _part(kind: type[Any], options: BaseModel) -> Any:
    """Make a detection or law from the options of both: those that were set, and those with a default of the
    contact's own."""
    own, both = kind.Options.model_fields, type(options).model_fields
    given = [
        name for name in own if name in options.model_fields_set or both[name].default != own[name].default
    ]
    return kind(**{name: getattr(options, name) for name in given})


def _options_of_both(contact: type[RowContact]) -> type[BaseModel]:
    """Make the model of a contact's options from both parts' models, with the contact's own defaults."""
    models = tuple(dict.fromkeys((contact.Law.Options, contact.Detection.Options)))
    fields: dict[str, Any] = {}
    for model in models:
        for name in model.model_fields.keys() & contact.defaults.keys():
            info = copy.copy(model.model_fields[name])
            info.default = contact.defaults[name]
            fields[name] = (info.annotation, info)
    text = f"Options of law '{contact.Law.name}' and of detection '{contact.Detection.name}'."
    made: type[BaseModel] = create_model(
        "Options", __base__=models, __module__=contact.__module__, __doc__=text, **fields
    )
    made.__qualname__ = f"{contact.__qualname__}.Options"
    return made


#: Classes that were joined, each once.
_JOINED: dict[tuple[type[Any], type[Any]], type[RowContact]] = {}


def joined(detection: type[Detection], law: type[ContactLaw]) -> type[RowContact]:
    """Return the contact of a detection and a law, called ``DETECTION+LAW``.

    Raises
    ------
    SceneError
        The law cannot act on what the detection lists, or both have an option of one name.
    """
    if (detection, law) in _JOINED:
        return _JOINED[detection, law]
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

    # The classes are in no module, where pickle would look for them. Theirs is that of the part which is not
    # mpmfw's own: what it does wrong is its distribution's.
    name = f"{detection.name}+{law.name}"
    body = {
        "name": name,
        "Detection": detection,
        "Law": law,
        "__reduce__": lambda self: parts_of(self.options, contact=True),
        "__module__": (detection if bundled(law) else law).__module__,
        "__doc__": f"Detection '{detection.name}' with law '{law.name}'.",
    }
    made: type[RowContact] = type(name, (law.strategy(),), body)
    made.Options.__reduce__ = parts_of  # type: ignore[assignment]
    _JOINED[detection, law] = made
    return made


def _made_again(
    detection: type[Detection], law: type[ContactLaw], options: dict[str, Any], contact: bool
) -> BaseModel | RowContact:
    """Make a joined ``contact``, or its options alone, in another process."""
    kind = joined(detection, law)
    return kind(**options) if contact else kind.Options(**options)
