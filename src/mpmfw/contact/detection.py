"""Detection: lists the rows of a step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from mpmfw.contact.rows import ContactRows
from mpmfw.plugin.base import PlugIn
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray, IntArray
from mpmfw.state.structs import Body, Grid, Particles, State, Stencil

if TYPE_CHECKING:
    from mpmfw.state.index_map import IndexMap


#: Relative difference of wave moduli K + 4 G / 3 up to which two bodies are equally stiff, and of sizes that
#: are equal.
EQUAL = 1e-6


class Detection(PlugIn):
    """Base of detections, announced as entry points of the group ``mpmfw.detection``.

    It fills the rows of a step from where the bodies are, after the projection and before the step's length
    is chosen, and keeps it until :meth:`end_step`.
    """

    #: What laws may need of its rows: ``facets`` where they lie on facets of tracked surfaces, ``nodes``
    #: where a node meets each, ``steady gap`` where gaps do not jump as rows come and go.
    provides: ClassVar[frozenset[str]] = frozenset()
    #: Whether it works on tracked surfaces, ``state.surface``.
    needs_surface: ClassVar[bool] = False
    #: Whether the conformance kit checks laws by joining them with it.
    checks_others: ClassVar[bool] = False
    #: Dimensions that it works in.
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    #: Reason for these dimensions, for the message that refuses others.
    dimensions_note: ClassVar[str] = ""
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
    #: Its option that widens :meth:`range` in proportion, for advice; None where there is none.
    range_option: ClassVar[str | None] = None

    def parts(self, contact: Any) -> list[Any]:  # noqa: ARG002
        """Return the plug-ins that it brings along, beside the strategy ``contact`` that it belongs to."""
        return []

    def reach(self, cell_size: float) -> float | None:  # noqa: ARG002
        """Return the distance of bounding boxes [m] beyond which nothing is searched; None without a search.

        ``cell_size`` is h [m].
        """
        return None

    def range(self, cell_size: float) -> float | None:
        """Return the gap [m] up to which rows are sure to be listed, after :meth:`prepare`; None if that is
        not known.

        ``cell_size`` is h [m]. By default it is :meth:`reach`.
        """
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
        """Return rows without content, with the ``own`` arrays of a law (see :class:`ContactRows`)."""
        raise NotImplementedError

    def list_pairs(self, state: State) -> None:
        """List ``state.pairs`` anew: bodies have come near that were apart."""
        raise NotImplementedError

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:
        """Fill the ``rows`` of this step, all arrays but ``previous``, ``force`` and the law's own.

        ``phi`` is the material points' table of interpolation.
        """
        raise NotImplementedError

    def end_step(self) -> None:
        """Note what the next step needs of this one; nothing by default."""

    def copy_history(self, other: Any, index_map: IndexMap) -> None:
        """Copy the history of ``other``, of the same class, renumbered by ``index_map``.

        Nothing by default."""

    def outputs(self, rows: ContactRows) -> dict[str, AnyArray]:  # noqa: ARG002
        """Return values of the declared output fields from the ``rows`` of the last step."""
        return {}


def stiffness_ranks(bodies: Sequence[Body]) -> IntArray:
    """Rank every body by its wave modulus, (body,): 0 for the softest, the same for equally stiff ones.

    The order of the bodies does not matter.
    """
    return ranks_of(np.array([body.p_wave_modulus for body in bodies]))


def ranks_of(values: FloatArray) -> IntArray:
    """Rank positive values (n,): 0 for the smallest, the same for equal ones."""
    order = np.argsort(values)
    steps = np.diff(values[order], prepend=values[order[:1]]) > EQUAL * values[order]
    ranks = np.zeros(len(values), dtype=np.int64)
    ranks[order] = np.cumsum(steps)
    return ranks
