"""Quadratic B-splines that are bounded by the grid, a shape function of mpmfw (Steffen, Kirby & Berzins
2008).
"""

from mpmfw_bounded_bspline.shape import BoundedBSpline, BoundedBSplineOptions

__all__ = ["BoundedBSpline", "BoundedBSplineOptions"]
