"""Transfers between material points and grid: the velocity that a point keeps, and its affine field."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

#: How the affine field is formed: C = Σ v ∇φᵀ, C = B D⁻¹, or B stored and D⁻¹ applied at the next projection.
AffineKind = Literal["gradient", "least_squares", "moment"]


@dataclass(frozen=True, slots=True)
class Transfer:
    """One way to carry velocity between points and grid."""

    name: str  #: as in the scene
    flip: float  #: from 0, the grid's velocity (PIC), to 1, the point's and the grid's increment (FLIP)
    affine: AffineKind | None = None  #: kind of the affine field
    transported: bool = False  #: whether C is carried along with the motion, C ← C (1 + Δt C)⁻¹
    inverse_spread: float = 0.0  #: d⁻¹ [1/m²] where D = d 1 at every point; 0 where it has to be summed


#: ``apic``: Jiang et al. 2015; ``tpic``: Nakamura, Matsumura & Mizutani 2023; ``aflip``: FLIP velocity with
#: affine gradient.
TRANSFERS = {
    "flip": Transfer("flip", 1.0),
    "pic": Transfer("pic", 0.0),
    "apic": Transfer("apic", 0.0, "moment"),
    "tpic": Transfer("tpic", 0.0, "gradient"),
    "aflip": Transfer("aflip", 1.0, "least_squares", transported=True),
}


def make_transfer(
    name: str,
    *,
    singular_spread: bool,
    spread: float | None = None,
    transported: bool | None = None,
    pic_fraction: float | None = None,
) -> Transfer:
    """Return the transfer called ``name``, fitted to a shape function.

    With ``singular_spread``, D = Σ φ q qᵀ can be singular (linear shape functions on grid lines): C is then
    Σ v ∇φᵀ. ``spread`` is d [m²] where D = d 1 at every point. A ``transported`` ``apic`` applies D⁻¹ at
    once. ``pic_fraction`` is the share of PIC in ``flip``.
    """
    transfer = replace(TRANSFERS[name], inverse_spread=0.0 if spread is None else 1.0 / spread)
    if pic_fraction is not None:
        transfer = replace(transfer, flip=1.0 - pic_fraction)
    if transported is not None:
        transfer = replace(transfer, transported=transported)
        if transported and transfer.affine == "moment":
            transfer = replace(transfer, affine="least_squares")
    if transfer.affine == "least_squares" and singular_spread:
        transfer = replace(transfer, affine="gradient")
    return transfer
