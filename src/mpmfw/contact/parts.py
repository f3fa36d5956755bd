"""The two parts of a contact, a detection that lists the rows of a step and a law that acts on them."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import BaseModel, create_model

from mpmfw.contact.rows import ContactRows
from mpmfw.errors import SceneError
from mpmfw.plugin.base import PlugIn
from mpmfw.plugin.checks import bundled
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray, IntArray
from mpmfw.state.structs import Body, Grid, Pair, Particles, State, Stencil

if TYPE_CHECKING:
    from mpmfw.state.index_map import IndexMap


#: Relative difference of wave moduli K + 4 G / 3 up to which two bodies are equally stiff, and of sizes that
#: are equal.
EQUAL = 1e-6


class Detection(PlugIn):
    """Base of detections, announced as entry points of the group ``mpmfw.detection``: it fills the rows of
    a step from where the bodies are, after the projection and before the step's length is chosen."""

    #: What laws may need of its rows: ``facets`` where they lie on facets of surfaces, which are then
    #: tracked, ``nodes`` where a node meets each, ``steady gap`` where gaps do not jump as rows come and go.
    provides: ClassVar[frozenset[str]] = frozenset()
    #: How surface nodes are mapped to the grid: ``auto`` follows the shape function.
    surface_map: Literal["auto", "plain", "mass_weighted"] = "auto"
    #: Whether a part of it adds inertia to the nodes.
    adds_mass: bool = False
    #: Whether rows have an area, which forces and cohesion are made of.
    measures_area: bool = True
    #: Whether bodies at rest may be left out for a while: :meth:`copy_history` copies its history, and rows
    #: renumber theirs.
    leaves_bodies_out: bool = False
    #: Gap up to which the law acts [m], known once both are prepared.
    law_range: float = 0.0

    state: State  #: to be taken by :meth:`prepare`

    def parts(self) -> list[Any]:
        """Return the plug-ins that it brings along."""
        return []

    def reach(self, cell_size: float) -> float | None:  # noqa: ARG002
        """Return the distance of bounding boxes [m] beyond which nothing is searched, with the cell size h
        [m]; None without a search."""
        return None

    def range(self, cell_size: float) -> float | None:
        """Return the gap [m] up to which rows are sure to be listed, after :meth:`prepare`, with the cell
        size h [m]; by default :meth:`reach`, None if not known."""
        return self.reach(cell_size)

    def configure(self, needs: frozenset[str], *, forces: bool) -> None:
        """Choose what follows from the law: its ``needs`` (:attr:`ContactLaw.needs`), and whether it gives
        ``forces``.

        Raises
        ------
        SceneError
            Its options do not give that.
        """

    def fields(self) -> list[Field]:
        """Return the output fields that :meth:`outputs` fills."""
        return []

    def prepare(self, setup: Setup, owner: str) -> None:
        """Take facts of the scene from ``setup``, and list arrays under ``owner``."""
        raise NotImplementedError

    def new_rows(self, own: dict[str, int | None]) -> ContactRows:
        """Return rows without content, with the ``own`` arrays of a law (see :class:`ContactRows`).

        By default both sides of a row are at one place, so that it has no couple, and it has no spin:
        where bodies turn about the normal, the stored friction stays as it is in space.
        """
        return ContactRows(self.state.grid.dim, couples=False, own=own)

    def list_pairs(self, state: State) -> None:
        """List ``state.pairs`` anew: bodies have come near that were apart."""
        raise NotImplementedError

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:
        """Fill the ``rows`` of this step, all arrays but ``previous``, ``force`` and the law's own;
        ``phi`` is the points' table of interpolation."""
        raise NotImplementedError

    def note_forces(self, rows: ContactRows, scale: float) -> None:
        """Note the forces of the ``rows``, or impulses, which the law has just written; times ``scale`` they
        are impulses."""

    def restart(self) -> None:
        """Forget accumulated sums at time zero, after settling."""

    def copy_history(self, other: Any, index_map: IndexMap) -> None:
        """Copy the history of ``other``, of the same class, renumbered by ``index_map``; none by default."""

    def outputs(self, rows: ContactRows) -> dict[str, AnyArray]:  # noqa: ARG002
        """Return values of the declared output fields from the ``rows`` of the last step."""
        return {}

    def remarks(self) -> list[str]:
        """Return warnings for a reader of the results, a sentence each, after the last step."""
        return []


def stiffness_ranks(bodies: Sequence[Body]) -> IntArray:
    """Rank every body by its wave modulus (body,): 0 for the softest, the same for equally stiff ones."""
    return ranks_of(np.array([body.p_wave_modulus for body in bodies]))


def ranks_of(values: FloatArray) -> IntArray:
    """Rank positive values (n,): 0 for the smallest, the same for equal ones."""
    order = np.argsort(values)
    steps = np.diff(values[order], prepend=values[order[:1]]) > EQUAL * values[order]
    ranks = np.zeros(len(values), dtype=np.int64)
    ranks[order] = np.cumsum(steps)
    return ranks


#: What a law may need of a detection, as messages name it.
NEEDS = {
    "facets": "facets of surfaces",
    "nodes": "surface nodes against facets",
    "steady gap": "gaps that do not jump",
}


class ContactLaw(PlugIn):
    """Base of laws, announced as entry points of the group ``mpmfw.law``: a law is a :class:`ForceLaw` or
    an :class:`ImpulseLaw`."""

    #: What it needs of the rows: ``gap`` for a signed gap, ``steady gap`` for one that does not jump as rows
    #: come and go, ``facets``, ``nodes`` for nodes against facets.
    needs: ClassVar[frozenset[str]] = frozenset()
    #: Base of contacts with this law.
    Contact: ClassVar[type[Any]]
    #: Whether it gives forces, and not impulses.
    gives_forces: ClassVar[bool] = False
    #: Whether the law uses the pairs' friction.
    uses_friction: ClassVar[bool] = False
    #: Its option that makes contact softer where it is smaller, for advice; None where there is none.
    softness_option: ClassVar[str | None] = None
    #: Whether bodies at rest may be left out for a while: its history is in its rows.
    leaves_bodies_out: ClassVar[bool] = False

    @classmethod
    def joined_with(cls, detection: type[Any]) -> type[Any]:
        """Return the contact strategy of a class ``detection`` and this law, called ``DETECTION+LAW``.

        Raises
        ------
        SceneError
            The law cannot act on what the detection lists, or both have an option of one name.
        """
        if (detection, cls) in _JOINED:
            return _JOINED[detection, cls]
        for need in sorted((cls.needs & NEEDS.keys()) - detection.provides):
            raise SceneError(
                f"law '{cls.name}' acts on {NEEDS[need]}, and detection '{detection.name}' lists none"
            )
        twice = sorted(set(detection.Options.model_fields) & set(cls.Options.model_fields))
        if twice:
            raise SceneError(
                f"detection '{detection.name}' and law '{cls.name}' both have an option '{twice[0]}'"
            )
        return _JOINED.setdefault((detection, cls), _joined(detection, cls))

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
        """Take what the law needs of the material points, once the rows of the step are there; ``phi`` is
        their table of interpolation."""

    def range(self) -> float:
        """Return the gap up to which the law acts [m], after :meth:`prepare`: 0 where bodies must touch. A
        detection that lists no rows so far apart (:meth:`Detection.range`) is refused."""
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


def make_part(kind: type[Any], options: BaseModel) -> Any:
    """Make a detection or law of the options of both: those that were set, and those with a default of the
    contact's."""
    own, both = kind.Options.model_fields, type(options).model_fields
    given = [
        name for name in own if name in options.model_fields_set or both[name].default != own[name].default
    ]
    return kind(**{name: getattr(options, name) for name in given})


def options_of_both(contact: type[Any]) -> type[BaseModel]:
    """Make the model of a contact's options of both parts' models, with the contact's own defaults."""
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
_JOINED: dict[tuple[type[Any], type[Any]], type[Any]] = {}


def _joined(detection: type[Detection], law: type[ContactLaw]) -> type[Any]:
    """Make the contact of a detection and a law; it can be pickled, and so can its options."""

    def parts_of(options: BaseModel, *, contact: bool = False) -> tuple[Any, ...]:
        return _made_again, (detection, law, options.model_dump(exclude_unset=True), contact)

    name = f"{detection.name}+{law.name}"
    body = {
        "name": name,
        "Detection": detection,
        "Law": law,
        "__reduce__": lambda self: parts_of(self.options, contact=True),
        # of the part that is not mpmfw's own, since its distribution answers for errors
        "__module__": (detection if bundled(law) else law).__module__,
        "__doc__": f"Detection '{detection.name}' with law '{law.name}'.",
    }
    made: type[Any] = type(name, (law.Contact,), body)
    made.Options.__reduce__ = parts_of
    return made


def _made_again(
    detection: type[Detection], law: type[ContactLaw], options: dict[str, Any], contact: bool
) -> Any:
    """Make a joined ``contact``, or its options alone, in another process."""
    kind = law.joined_with(detection)
    return kind(**options) if contact else kind.Options(**options)
