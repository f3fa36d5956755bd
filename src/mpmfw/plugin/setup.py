"""What plug-ins are told once, before the first step."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Body, Pair, State

if TYPE_CHECKING:
    from mpmfw.contact.friction import FrictionLaw
    from mpmfw.geometry import Layout


@dataclass
class Setup:
    """Facts of the scene, after discretisation, and the place where plug-ins get their arrays."""

    state: State  #: of time zero
    layouts: tuple[Layout, ...]  #: of each body
    cell_size: float  #: h [m]
    shape: str  #: name of the shape function
    massless_boundary: bool  #: the shape function leaves boundary nodes without mass (linear, GIMP)
    scheme: str  #: usl, musl or usf
    transfer: str  #: flip, pic, apic, tpic or aflip
    bulk_frequency: float  #: largest of 2 c / h over the bodies, of thin ones 2 c / √(h w) [1/s]
    safety: float  #: fraction of the stability limit that a step may take
    allow_unstable: bool = False  #: the scene lets a step exceed the stability limit
    flip: float = 1.0  #: share of FLIP in the transfer
    friction_law: FrictionLaw | None = None  #: that the scene names; None is Coulomb's
    whole: Setup | None = None  #: that of all bodies, where these are those of them that are awake

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All bodies, in the scene's order."""
        return self.state.bodies

    @property
    def pairs(self) -> tuple[Pair, ...]:
        """All pairs of bodies, in the scene's order.

        To a strategy that implements the hook ``add_pairs`` more than a few bodies are given no pair at first
        but those that the scene names, and the others as they come near."""
        return self.state.pairs

    @property
    def has_friction(self) -> bool:
        """Whether any two bodies have friction, be their pair listed yet or not."""
        near = self.state.near
        if self.whole is not None:
            return self.whole.has_friction
        if self.friction_law is not None and self.friction_law.cohesive:
            return True
        return near.has_friction if near is not None else any(pair.mu > 0.0 for pair in self.pairs)

    @property
    def dim(self) -> int:
        """Number of space dimensions."""
        return self.state.grid.dim

    @functools.cached_property
    def half_edges(self) -> FloatArray:
        """Half-edge vectors of the material points' domains at the start, (n, dim, dim) [m]; column a is r_a.

        One array for all who ask, made when the first does.
        """
        array = np.ascontiguousarray(np.concatenate([layout.half_edges for layout in self.layouts]))
        self.state.arrays["layout/half_edges"] = array
        return array

    @functools.cached_property
    def corners(self) -> FloatArray | None:
        """Corners of the four-sided domains at the start, (n, 4, 2) [m], or None where a body has none."""
        if any(layout.corners is None for layout in self.layouts):
            return None
        return np.concatenate([layout.corners for layout in self.layouts if layout.corners is not None])

    def allocate(self, owner: str, declaration: Field, **sizes: int) -> AnyArray:
        """Allocate a declared array and list it under ``owner/name``.

        Parameters
        ----------
        owner
            The plug-in's name.
        declaration
            What :meth:`declare_fields` announced.
        sizes
            Lengths of dimensions other than ``particle``, ``axis``, ``axis2``, ``body``, ``pair`` and
            ``surface_node``, which are known.

        Returns
        -------
        The array, all zero, of the shape that ``declaration.dims`` says.

        Raises
        ------
        KeyError
            The length of a dimension is neither known nor given.
        """
        array = declaration.allocate({**self._sizes, **sizes})
        self.state.arrays[f"{owner}/{declaration.name}"] = array
        self.state.dims[f"{owner}/{declaration.name}"] = declaration.dims
        return array

    @functools.cached_property
    def _sizes(self) -> dict[str, int]:
        """Lengths of the dimensions that are known."""
        state = self.state
        return {
            "particle": state.particles.count,
            "axis": self.dim,
            "axis2": self.dim,
            "body": len(state.bodies),
            "pair": len(state.pairs),
            "surface_node": 0 if state.surface is None else state.surface.count,
        }
