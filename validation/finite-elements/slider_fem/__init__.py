"""An explicit finite-element program for an elastic block that slides down an incline, independent of the
product.

Elements and mesh are those of :mod:`rings_fem`; contact, time integration and the eigenvalues of the sliding
block are here. Of ``mpmfw`` it has the compilation of loops alone. Plane strain, SI units, per metre of
thickness; x down the incline, y out of it."""
