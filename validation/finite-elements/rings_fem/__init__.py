"""An explicit finite-element program for the collision of two elastic rings, independent of the product.

It shares nothing of ``mpmfw`` but the compilation of loops: elements, contact and time integration are its
own. So the two cannot agree through a common error. ``distance`` reads the shipped
reference tables. Plane strain, SI units, per metre of thickness."""

from rings_fem.collision import Collision, collide, distance

__all__ = ["Collision", "collide", "distance"]
