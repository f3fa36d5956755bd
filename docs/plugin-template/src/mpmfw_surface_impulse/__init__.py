"""Contact through impulses between surfaces that leave no penetration: a plug-in of mpmfw."""

from mpmfw_surface_impulse.strategy import SurfaceImpulse

__all__ = ["SurfaceImpulse"]
