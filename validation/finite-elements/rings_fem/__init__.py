"""An explicit finite-element program for the collision of two elastic rings, independent of the product.

It shares no kernel with ``mpmfw``: elements, contact and time integration are its own, so that an agreement
of the two is no consequence of a common error. Only :mod:`rings_fem.comparison` reads ``mpmfw``, for the
shipped reference tables and the running average. Plane strain, SI units, per metre of thickness."""

from rings_fem.collision import Collision, Snapshot, collide
from rings_fem.comparison import Distance, distance, regenerate

__all__ = ["Collision", "Distance", "Snapshot", "collide", "distance", "regenerate"]
