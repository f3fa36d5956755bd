"""Rows, where two bodies may touch; detections, which list them; friction laws."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from mpmfw.kernels import struct, velocity_of_momentum
from mpmfw.kernels.contact import Rows, add_row_forces, couplings, relative_motion
from mpmfw.plugin.base import PlugIn
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.history import IndexMap, NotSaved, check_indices
from mpmfw.state.structs import Grid, Pair, Particles, State, Stencil

#: Arrays of vectors, of integers, and with rows for the entries of B.
_VECTORS = ("normal", "motion", "force", "couple", "tilt")
_INTEGERS = ("pair", "identity", "previous", "start", "dof")
_OF_ENTRIES = ("dof", "weight", "couple", "tilt")
#: For Bᵀ f, which no mass divides.
_NO_MASS = np.zeros(0)


class ContactRows(Rows):
    """The rows of one step (:class:`mpmfw.kernels.contact.Rows`), with room for more than ``count`` of them.

    Parameters
    ----------
    dim
        Number of space dimensions.
    couples, tilts
        Whether a tangential force acts with a couple across the gap, and the normal is varied with the facet.
    spins
        Whether the detection measures how far the sides turn about the normal, in space.
    own
        Arrays of the law (``ContactLaw.row_arrays``).
    """

    history = ("kept",)
    count: int  #: rows of the step
    node_sum: FloatArray = np.zeros(0)  #: scratch, zero for every node of the grid
    own: Any  #: the law's arrays, a :class:`mpmfw.kernels.Struct` with its names
    #: Number of facets, nodes, … by the name of the array that has their indices.
    limits: Mapping[str, int] = {}

    def __init__(
        self, dim: int, *, couples: bool, tilts: bool = False, spins: bool = False,
        own: Mapping[str, int | None] | None = None,
    ) -> None:  # fmt: skip
        has = {"couple": couples, "tilt": tilts, "spin": spins, "friction": False, "cohesion": False}
        without = [name for name in has if not has[name]]
        vars(self).update(dim=dim, count=0, _without=without, _own=dict(own or {}))
        self.make_room(64, 1024)

    def allocate_friction(self, *, cohesion: bool) -> None:
        """Make room for ``friction``, and for ``cohesion`` if it is requested."""
        names = ("friction", "cohesion")[: 1 + cohesion]
        self.__dict__["_without"] = [name for name in self._without if name not in names]
        self.set(**{name: np.zeros(len(self.pair)) for name in names})

    def make_room(self, rows: int, entries: int) -> None:
        """Allocate so many ``rows`` and ``entries``; what was in them is lost."""
        arrays = {}
        for name in self.member_names[:-1]:
            length = entries if name in _OF_ENTRIES else rows + (name == "start")
            shape = (0 if name in self._without else length, *(self.dim,) * (name in _VECTORS))
            arrays[name] = np.zeros(shape, dtype="i8" if name in _INTEGERS else "f8")
        arrays["response"] = getattr(self, "response", np.zeros((0, self.dim, self.dim + 1, self.dim)))
        own = {
            name: np.zeros((0, self.dim) if more is None else (rows, *(self.dim,) * more))
            for name, more in self._own.items()
        }
        self.set(**arrays)
        self.own = struct(**own)

    def copy_history(self, other: ContactRows, index_map: IndexMap) -> None:
        """Copy the rows of ``other`` but B, renumbered by ``index_map``, over the same pairs'."""
        kept = np.flatnonzero(~np.isin(self.pair[: self.count], index_map.pair))
        taken = np.flatnonzero(index_map.pair[other.pair[: other.count]] >= 0)
        ours = {name: array[kept].copy() for name, array in self.of_rows().items() if len(array)}
        theirs = {name: array[taken].copy() for name, array in other.of_rows().items() if len(array)}
        other.renumber(theirs, self, index_map)
        order = np.argsort(np.concatenate([ours["identity"], theirs["identity"]]), kind="stable")
        if len(order) > len(self.pair):
            self.make_room(2 * len(order), len(self.dof))
        self.count = len(order)
        for name, array in self.of_rows().items():
            if len(array):
                none = np.zeros((len(taken), *array.shape[1:]), dtype=array.dtype)
                array[: self.count] = np.concatenate([ours[name], theirs.get(name, none)])[order]

    @property
    def kept(self) -> dict[str, AnyArray]:
        """All arrays of the rows but B, as long as there are rows."""
        return {name: array[: self.count] for name, array in self.of_rows().items() if len(array)}

    @kept.setter
    def kept(self, arrays: dict[str, AnyArray]) -> None:
        for name, limit in self.limits.items():
            check_indices(limit, **{name: arrays[name]})
        count = len(arrays["pair"])
        if any(len(array) != count for array in arrays.values()):
            raise NotSaved("the arrays of the rows are not of one length")
        if count > len(self.pair):
            self.make_room(2 * count, len(self.dof))
        self.count = count
        for name, array in arrays.items():
            self.of_rows()[name][:count] = array

    def of_rows(self) -> dict[str, AnyArray]:
        """Return all arrays with an entry for every row; the law's are called ``own/NAME``."""
        entries = ("start", *_OF_ENTRIES, "response")
        arrays = {name: array for name, array in self.members().items() if name not in entries}
        return arrays | {f"own/{name}": array for name, array in self.own.members().items()}

    def renumber(self, history: dict[str, AnyArray], own: ContactRows, index_map: IndexMap) -> None:  # noqa: ARG002
        """Renumber the pairs in ``history`` by ``index_map``."""
        history["pair"] = index_map.pair[history["pair"]]

    def have(self, count: int) -> None:
        """Set the number of rows, which kernels do not read off the struct."""
        self.__dict__["count"] = count

    def momentary_velocity(self, grid: Grid, out: FloatArray) -> None:
        """Write B v of the grid's present momentum into ``out`` (n, dim) [m/s]."""
        velocity = np.empty_like(grid.momentum)
        velocity_of_momentum(grid.mass, grid.momentum, velocity, grid.spacing)
        self.motion_of(velocity, 1.0, out, grid.spacing)

    def motion_of(
        self, velocity: FloatArray, scale: float, out: FloatArray, spacing: tuple[float, ...]
    ) -> None:
        """Write ``scale`` B v of the nodes' ``velocity`` (n_nodes, dim) into ``out`` (n, dim)."""
        relative_motion(self, self.count, velocity, scale, out, spacing)

    def add_to(self, nodal: FloatArray, spacing: tuple[float, ...]) -> None:
        """Add Bᵀ f of ``force`` to forces or momenta ``nodal`` (n_nodes, dim)."""
        add_row_forces(self, self.count, _NO_MASS, nodal, spacing)

    def couplings(self, stiffness: FloatArray, grid: Grid, out: FloatArray) -> float:
        """Write row sums of ``abs(B) M⁻¹ abs(B)ᵀ K`` into ``out`` (n,); return the largest."""
        return couplings(self, self.count, stiffness, grid.mass, self.sum_of(grid), out)

    def sum_of(self, grid: Grid) -> FloatArray:
        """Return ``node_sum`` for the nodes of ``grid``."""
        if len(self.node_sum) != len(grid.mass):
            self.node_sum = np.zeros(len(grid.mass))
        return self.node_sum


class Detection(PlugIn):
    """Base of detections, entry points of the group ``mpmfw.detection``: it fills the rows of a step after
    the projection, before the step's length is chosen."""

    #: What laws may need of its rows: ``facets`` where they lie on facets of surfaces, which are then
    #: tracked, ``nodes`` where a node meets each, ``steady gap`` where gaps do not jump as rows come and go.
    provides: ClassVar[frozenset[str]] = frozenset()
    #: Whether it finds rigid bodies, which have a surface and no material points.
    finds_rigid: bool = True
    #: Whether it finds where a body touches itself, of the pairs of a body with itself.
    finds_own: bool = False
    #: How surface nodes are mapped to the grid: ``auto`` follows the shape function.
    surface_map: Literal["auto", "plain", "mass_weighted"] = "auto"
    #: Whether a part of it adds inertia to the nodes.
    adds_mass: bool = False
    #: Whether rows have an area, which forces and cohesion are made of.
    measures_area: bool = True
    #: Whether gaps are those of means over points, which change also as points enter and leave.
    mean_gaps: ClassVar[bool] = False
    #: Whether bodies at rest may be left out for a while: :meth:`copy_history` copies its history, and rows
    #: renumber theirs.
    leaves_bodies_out: bool = False
    #: Whether :meth:`radii` are known, round which rows of bodies of revolution act.
    has_radius: bool = False
    #: Mean radius of what belongs to a node on the axis [cells].
    mean_radius: float = 1.0 / 6.0
    #: Whether it lists rows of the pairs alone that ``acts_on`` selects.
    selects_pairs: ClassVar[bool] = False
    #: Selects pairs; None selects all.
    acts_on: Callable[[Pair], bool] | None = None
    #: Gap up to which the law acts [m], known once both are prepared.
    law_range: float = 0.0

    state: State  #: to be taken by :meth:`prepare`

    def acting(self, state: State) -> AnyArray:
        """Return True for every pair that it acts on (pair,)."""
        return np.array([self.acts_on is None or self.acts_on(pair) for pair in state.pairs], dtype=bool)

    def parts(self) -> list[Any]:
        """Return the plug-ins that the detection needs."""
        return []

    def range(self, cell_size: float) -> float | None:  # noqa: ARG002
        """Return the gap [m] up to which rows are sure to be listed; None if unknown."""
        return None

    def configure(self, needs: frozenset[str], *, forces: bool) -> None:
        """Choose what follows from the law: its ``needs`` (:attr:`ContactLaw.needs`), and whether it gives
        ``forces``. Raise SceneError if the options do not give that."""

    def fields(self) -> list[Field]:
        """Return the output fields that :meth:`outputs` fills."""
        return []

    def prepare(self, setup: Setup, owner: str) -> None:
        """Take facts of the scene from ``setup``, and list arrays under ``owner``."""
        raise NotImplementedError

    def new_rows(self, own: dict[str, int | None]) -> ContactRows:
        """Return rows without content, with the ``own`` arrays of a law (:class:`ContactRows`); by default
        both sides of a row are at one place, and it has neither couple nor spin."""
        return ContactRows(self.state.grid.dim, couples=False, own=own)

    def list_pairs(self, state: State) -> None:
        """List ``state.pairs`` anew: bodies have come near that were apart."""
        raise NotImplementedError

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:
        """Fill the ``rows`` of this step, all but ``previous``, ``force`` and ``own``."""
        raise NotImplementedError

    def radii(self, rows: ContactRows, grid: Grid) -> FloatArray:
        """Return the radius of every row (n,) [m], x of its place."""
        raise NotImplementedError

    def note_forces(self, rows: ContactRows, scale: float) -> None:
        """Note what the law has written; times ``scale`` they are impulses."""

    def restart(self) -> None:
        """Forget accumulated sums at time zero, after settling."""

    def copy_history(self, other: Any, index_map: IndexMap) -> None:
        """Copy the history of ``other``, of the same class, renumbered by ``index_map``."""

    def outputs(self, rows: ContactRows) -> dict[str, AnyArray]:  # noqa: ARG002
        """Return values of the declared output fields from the ``rows`` of the last step."""
        return {}

    def remarks(self) -> list[str]:
        """Return warnings for a reader of the results, after the last step."""
        return []


class FrictionLaw(PlugIn):
    """Base of friction laws, entry points of the group ``mpmfw.friction``; itself it is Coulomb's.

    The tangential force on a row is at most T = μ N + a, with N the normal one. A friction law gives μ and
    a once a step, by the slip of the step before. A contact law obeys it with
    ``mpmfw.kernels.contact.slip_limit``.
    """

    #: Whether rows hold something without a normal force, a > 0, so that pairs with μ = 0 have friction as
    #: well.
    cohesive: ClassVar[bool] = False
    #: Whether T is μ N with the μ of the pairs, of which closed forms are known.
    is_coulomb: ClassVar[bool] = False

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:  # noqa: ARG002
        """Write ``rows.friction`` (n,) [1], and ``rows.cohesion`` (n,) [N m^(dim−3)] if :attr:`cohesive`.

        ``rows.motion`` is over the last step, of the length ``dt`` [s], 0 before the first; ``friction`` is μ
        of every pair in the scene (n_pairs,) [1].
        """
        n = rows.count
        rows.friction[:n] = friction[rows.pair[:n]]
