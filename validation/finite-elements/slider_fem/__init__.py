"""An explicit finite-element program for an elastic block that slides down an incline, independent of the
product.

Elements and mesh are those of :mod:`rings_fem`; contact, time integration and the eigenvalues of the sliding
block are here. Of ``mpmfw`` it has the compilation of loops alone. Plane strain, SI units, per metre of
thickness; x down the incline, y out of it."""

from slider_fem.bodies import Incline, incline
from slider_fem.flutter import Sliding, contact_matrix, growth, slide_steadily, stiffness_matrix
from slider_fem.motion import Slide, acceleration_of, slide

__all__ = [
    "Incline",
    "Slide",
    "Sliding",
    "acceleration_of",
    "contact_matrix",
    "growth",
    "incline",
    "slide",
    "slide_steadily",
    "stiffness_matrix",
]
