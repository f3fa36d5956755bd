"""What every shape function must keep, asked by mpmfw's conformance kit."""

from __future__ import annotations

from mpmfw_testing import shape_conformance

from mpmfw_bounded_bspline import BoundedBSpline


@shape_conformance(BoundedBSpline)
def test_modified_at_the_grid_end(check):
    check()


@shape_conformance(BoundedBSpline(grid_end="refuse"))
def test_refused_at_the_grid_end(check):
    check()
