"""Laws: from rows, their motion and their history to forces or impulses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

from mpmfw.contact.records import PairRecords
from mpmfw.contact.rows import ContactRows
from mpmfw.plugin.base import PlugIn
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Grid, Pair, State


class ContactLaw(PlugIn):
    """Base of laws, announced as entry points of the group ``mpmfw.law``; a law is a :class:`ForceLaw` or an
    :class:`ImpulseLaw`."""

    #: Whether the law uses the pairs' friction.
    uses_friction: ClassVar[bool] = False
    #: Whether it needs a signed gap, which not every detection measures.
    needs_gap: ClassVar[bool] = False
    #: Its option that makes contact softer where it is smaller, for advice; None where there is none.
    softness_option: ClassVar[str | None] = None
    #: Whether it is written for facets alone.
    needs_facets: ClassVar[bool] = False
    #: Whether the conformance kit checks detections that it goes with by joining them with it.
    checks_others: ClassVar[bool] = False
    #: Dimensions that it works in.
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    #: Why it does not work in others, for the message that refuses them.
    dimensions_note: ClassVar[str] = ""

    @classmethod
    def joined_with(cls, detection: type[Any]) -> type[Any]:
        """The contact strategy of a class ``detection`` and this law, ``DETECTION+LAW``.

        Raises
        ------
        SceneError
            They do not go together.
        """
        from mpmfw.contact.joined import joined

        return joined(detection, cls)

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:  # noqa: ARG002
        """Own arrays of every row by name, with the number of further dimensions, or None for one without rows: its history.

        ``friction`` says whether any two bodies have any. They are ``rows.own``, one argument of kernels; one called ``moved``
        is filled with B v Δt at the end of the step.
        """
        return {}

    def unused(self, pairs: Sequence[Pair]) -> list[str]:  # noqa: ARG002
        """Facts of these ``pairs`` that it does not look at, one line each."""
        return []

    def fields(self) -> list[Field]:
        """Series beside those that all contacts have."""
        return []

    def prepare(self, setup: Setup, owner: str) -> None:
        """Facts of the scene, from ``setup``; arrays are listed under ``owner``."""

    def widest_gap(self) -> float:
        """Gap up to which it acts [m], 0 where it acts on bodies that touch alone. Asked after :meth:`prepare`.

        A detection that lists no rows so far apart (:meth:`Detection.widest_gap`) is refused.
        """
        return 0.0

    def list_pairs(self, state: State) -> None:
        """Bodies have come near that were apart: facts of ``state.pairs`` as arrays."""

    def series(self) -> dict[str, AnyArray]:
        """Values of the declared series."""
        return {}

    def restart(self) -> None:
        """Time zero, after settling: forget accumulated work."""

    def remarks(self) -> list[str]:
        """After the last step: what a reader of the results must know, a sentence each."""
        return []


class ForceLaw(ContactLaw):
    """A force on every row, which acts beside internal forces and limits the step."""

    #: Normal dashpot as a fraction of critical.
    damping: float = 0.0

    def expected(self, bulk_frequency: float) -> float:
        """ω² of its springs [1/s²] before anything was detected, for equal bodies; ``bulk_frequency`` is 2 c / h [1/s]."""
        raise NotImplementedError

    def stiffness(self, rows: ContactRows, old: ContactRows) -> FloatArray:
        """Tangent stiffness of every row (n,) [N m^(dim−4)], in contact or not: it limits the step.

        Parameters
        ----------
        rows, old
            Of this step, and of the last one, where ``rows.before`` points.
        """
        raise NotImplementedError

    def longest_step(self, rows: ContactRows, grid: Grid) -> float:  # noqa: ARG002
        """Step [s] that ``rows`` of this step allow beside their stiffness, before the safety factor; infinite unless a law says.

        ``grid`` has the mass and the momentum of the projection, before forces have acted.
        """
        return math.inf

    def forces(self, rows: ContactRows, old: ContactRows, dashpot: float, records: PairRecords) -> None:
        """Write ``rows.force``, and the pairs' works and energies.

        Parameters
        ----------
        rows, old
            As in :meth:`stiffness`, which was called before.
        dashpot
            c / (k Δt) [1] of the last step, with Δt [s], of a dashpot of the fraction :attr:`damping` of critical.
        records
            Of the pairs; impulse and count are not the law's to add.
        """
        raise NotImplementedError


class ImpulseLaw(ContactLaw):
    """An impulse on every row, which corrects the grid's momentum and needs no shorter step."""

    #: Length of the step [s], known whenever impulses are asked for.
    dt: float = 0.0

    def impulses(
        self, rows: ContactRows, grid: Grid, scratch: FloatArray, work: FloatArray | None, *, projected: bool
    ) -> None:
        """Write ``rows.force``, the impulses [N s m^(dim−3)] that the grid's momentum asks for.

        Parameters
        ----------
        rows
            Of this step.
        grid
            Its ``mass`` and ``momentum``; the impulses are added to it by the caller.
        scratch
            A number for every node, zero on entry and on return (n_nodes,).
        work
            Work of friction of every pair, to be added to [J m^(dim−3)]; None where the correction moves no point.
        projected
            Whether the momentum is that of the projection, before forces have acted.
        """
        raise NotImplementedError
