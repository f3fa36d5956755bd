"""The base class of shape functions, and what their plug-ins share."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from mpmfw.plugin.base import PlugIn
from mpmfw.state.structs import OutsideGrid, Stencil


class ShapeFunction(PlugIn):
    """Base of shape functions.

    Subclasses implement the hooks ``particle_reach``, ``interpolate`` and ``interpolate_surface``.
    """

    #: Whether boundary nodes may carry no mass of the body whose surface touches them (point-like particles).
    massless_boundary: ClassVar[bool] = False
    #: Degree of the B-splines that are the boundary basis: 1 bilinear.
    boundary_degree: ClassVar[int] = 1
    #: Whether nodes with mass are those of two grids, whose indices are all even or all odd; the boundary
    #: basis is then the compact kernel of each, over two cells to either side.
    staggered: ClassVar[bool] = False
    #: Whether Σ φ q qᵀ may be singular, so that the affine field must be taken from Σ v ∇φᵀ.
    singular_spread: ClassVar[bool] = False
    #: Whether the nodes of every row of its tables ascend: then several threads share the nodes out when they
    #: project.
    rows_ascend: ClassVar[bool] = False
    #: Largest Courant number c Δt / h that is not refused.
    courant: ClassVar[float] = 0.8
    auto_scheme: ClassVar[str] = "usl"  #: what ``auto`` means for the scheme
    auto_transfer: ClassVar[str] = "aflip"  #: what ``auto`` means for the transfer
    #: Treatment of a free body's rotational inertia where the scene says none: ``spin``, ``exact`` or
    #: ``lumped``.
    auto_rotation: ClassVar[str] = "spin"


def empty_stencil(points: int, entries: int, dim: int, *, gradient: bool = True) -> Stencil:
    """Return an interpolation table to be filled, all zero, with the same number of entries for every point.

    ``points`` is the number n of material points or surface nodes, ``entries`` that of the nodes that a point
    touches, such as 2**dim with linear functions. Surface nodes need no ``gradient``, (n entries, dim) [1/m],
    and get an array of length 0."""
    return Stencil(
        row=np.arange(points + 1, dtype=np.int64) * entries,
        nodes=np.zeros(points * entries, dtype=np.int32),
        weight=np.zeros(points * entries),
        gradient=np.zeros((points * entries if gradient else 0, dim)),
    )


def check_inside(index: int) -> None:
    """Raise OutsideGrid for the ``index`` of the first point outside its window, unless it is −1.

    Fill kernels return it. The core then lays the window anew and fills the table again."""
    if index >= 0:
        raise OutsideGrid(index)
