"""Cubic B-splines as a shape function of mpmfw (Steffen, Kirby & Berzins 2008)."""

from mpmfw_cubic_bspline.shape import CubicBSpline, CubicBSplineOptions

__all__ = ["CubicBSpline", "CubicBSplineOptions"]
