"""Detection: lists the rows of a step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

from mpmfw.contact.rows import ContactRows
from mpmfw.plugin.base import PlugIn
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, Field
from mpmfw.state.structs import Grid, Particles, State, Stencil

if TYPE_CHECKING:
    from mpmfw.state.numbers import Numbers


class Detection(PlugIn):
    """Base of detections, announced as entry points of the group ``mpmfw.detection``.

    It fills the rows of a step from where the bodies are, after the projection and before the step's length is chosen, and
    forgets nothing until :meth:`keep`.
    """

    #: Whether rows lie on facets of tracked surfaces.
    facets: ClassVar[bool] = False
    #: Whether it works on tracked surfaces, ``state.surface``.
    needs_surface: ClassVar[bool] = False
    #: Whether the conformance kit checks laws that it goes with by joining them with it.
    checks_others: ClassVar[bool] = False
    #: Dimensions that it works in.
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    #: Why it does not work in others, for the message that refuses them.
    dimensions_note: ClassVar[str] = ""
    #: How surface nodes are mapped to the grid: ``auto`` follows the shape function.
    surface_map: Literal["auto", "plain", "mass_weighted"] = "auto"
    #: Whether a part of it adds inertia to the nodes.
    adds_mass: bool = False
    #: Whether rows have an area, which forces and cohesion are made of.
    measures_area: bool = True
    #: Gap up to which the law acts [m], known once both are prepared.
    acts_to: float = 0.0
    #: Its option that widens :meth:`widest_gap` in proportion, for advice; None where there is none.
    gap_option: ClassVar[str | None] = None

    def parts(self, contact: Any) -> list[Any]:  # noqa: ARG002
        """Plug-ins that it brings along, beside the strategy ``contact`` that it belongs to."""
        return []

    def reach(self, cell_size: float) -> float | None:  # noqa: ARG002
        """Distance of bounding boxes [m] beyond which nothing is searched; None without a search.

        ``cell_size`` is h [m].
        """
        return None

    def widest_gap(self, cell_size: float) -> float | None:
        """Gap [m] up to which rows are sure to be listed; None if that is not known. Asked after :meth:`prepare`.

        ``cell_size`` is h [m]. By default it is :meth:`reach`.
        """
        return self.reach(cell_size)

    def for_law(self, *, needs_gap: bool, forces: bool) -> None:
        """Know what the law needs: a signed gap (``needs_gap``), and rows that ``forces`` may act on.

        Raises
        ------
        SceneError
            Its options do not give that.
        """

    def fields(self) -> list[Field]:
        """Output fields that :meth:`outputs` fills."""
        return []

    def prepare(self, setup: Setup, owner: str) -> None:
        """Facts of the scene, from ``setup``, and arrays listed under ``owner``."""
        raise NotImplementedError

    def new_rows(self, own: dict[str, int | None]) -> ContactRows:
        """Rows without content, with the ``own`` arrays of a law (see :class:`ContactRows`)."""
        raise NotImplementedError

    def list_pairs(self, state: State) -> None:
        """Bodies have come near that were apart."""
        raise NotImplementedError

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:
        """Fill the ``rows`` of this step, all arrays but ``before``, ``force`` and the law's own.

        ``phi`` is the material points' table of interpolation.
        """
        raise NotImplementedError

    def keep(self) -> None:
        """The step has ended: what was detected in it is the past."""

    def take_over(self, other: Any, numbers: Numbers) -> None:
        """Know of bodies, by other ``numbers``, what ``other`` of the same class remembers of them; nothing by default."""

    def outputs(self, rows: ContactRows) -> dict[str, AnyArray]:  # noqa: ARG002
        """Values of the declared output fields from the ``rows`` of the last step."""
        return {}
