"""The checks of shape functions, and the points on a grid that they are made with.

Tests of a shape function's own closed forms can use :func:`place` as well::

    placed = place(subject_of(MyShape, "shape"), [boxes(np.array([[5.3, 6.1]]), 0.5)], cells=12)
    table = placed.table()
"""

from __future__ import annotations

from mpmfw_testing.check import Check
from mpmfw_testing.sent import SENT
from mpmfw_testing.shape.contract import contract_checks
from mpmfw_testing.shape.deformation import deformation_checks
from mpmfw_testing.shape.gradients import gradient_checks
from mpmfw_testing.shape.options import option_checks
from mpmfw_testing.shape.placement import Placement, boxes, place
from mpmfw_testing.shape.sums import dense
from mpmfw_testing.shape.support import support_checks
from mpmfw_testing.shape.surfaces import surface_checks
from mpmfw_testing.shape.weights import weight_checks


def shape_checks() -> list[Check]:
    """All checks of a shape function: those first whose failure makes others fail as well."""
    return [
        *contract_checks(),
        *weight_checks(),
        *gradient_checks(),
        *support_checks(),
        *deformation_checks(),
        *surface_checks(),
        *option_checks(),
        SENT,
    ]


__all__ = ["Placement", "boxes", "dense", "place", "shape_checks"]
