"""Linear shape functions: the original material point method (Sulsky, Chen & Schreyer 1994)."""

from __future__ import annotations

from mpmfw_shape._tables import AtPoints


class Linear(AtPoints):
    """φ_ip = N_i(x_p): 4 nodes in 2D, 8 in 3D. ∇φ jumps at cell faces ("grid-crossing noise"); MUSL is the
    stable scheme. The correction of spin by cells would feed the noise (impacts gain up to 20 % of their
    energy), and with lumped inertia a fast spin gains up to 9 %: a body turns as a whole."""

    name = "linear"
    massless_boundary = True
    axisymmetric = True
    singular_spread = True
    auto_scheme = "musl"
    auto_transfer = "flip"
    auto_rotation = "exact"
    compiles_length = True
