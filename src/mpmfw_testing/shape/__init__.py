"""The checks of shape functions, and the points on a grid that they are made with.

Tests of a shape function's own closed forms can use :func:`place` as well::

    placed = place(subject_of(MyShape, "shape"), [boxes(np.array([[5.3, 6.1]]), 0.5)], cells=12)
    table = placed.table()
"""

from __future__ import annotations

from mpmfw_testing.sent import sent
from mpmfw_testing.shape import contract, deformation, gradients, options, support, surfaces, weights
from mpmfw_testing.shape.placement import Placement, boxes, place
from mpmfw_testing.shape.sums import dense

#: Those first whose failure makes others fail as well.
CHECKS = (
    *contract.CHECKS, *weights.CHECKS, *gradients.CHECKS, *support.CHECKS, *deformation.CHECKS,
    *surfaces.CHECKS,
    *options.CHECKS, sent,
)  # fmt: skip

__all__ = ["Placement", "boxes", "dense", "place"]
