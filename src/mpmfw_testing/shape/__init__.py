"""The checks of shape functions, and the points on a grid that they are made with.

Tests of a shape function's own closed forms can use :func:`place` as well::

    placed = place(subject_of(MyShape, "shape"), [boxes(np.array([[5.3, 6.1]]), 0.5)], cells=12)
    table = placed.table()
"""

from __future__ import annotations

from mpmfw_testing.generic import no_growth, options, repeatable, runs, saved, sent
from mpmfw_testing.shape import bodies, points, support
from mpmfw_testing.shape.placement import Placement, boxes, openings, place
from mpmfw_testing.shape.sums import dense

#: Those first whose failure makes others fail as well.
CHECKS = (
    runs, support.dimensions, support.structure, repeatable, saved, support.changes_nothing_else, no_growth,
    *points.CHECKS, *support.CHECKS, *bodies.CHECKS, options, sent,
)  # fmt: skip

__all__ = ["Placement", "boxes", "dense", "openings", "place"]
