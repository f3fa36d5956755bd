"""The tracked outlines as one argument of kernels."""

from __future__ import annotations

from mpmfw.api import Surface
from mpmfw.kernels import Struct, device
from mpmfw.kernels.polyline import signed_distance
from mpmfw.kernels.types import Float, Floats, Ints


class Outline(Struct):
    """Closed polylines of all bodies; segment s runs from node s to node ``next[s]``."""

    position: Floats  #: (n_s, 2) [m]
    displacement: Floats  #: (n_s, 2) motion over the last step [m]
    tributary: Floats  #: (n_s,) [m]
    next: Ints  #: (n_s,)
    previous: Ints  #: (n_s,)
    body: Ints  #: (n_s,)
    body_first: Ints  #: (n_bodies + 1,) surface nodes of body b are ``body_first[b]:body_first[b + 1]``
    facets: Ints  #: (n_f, dim) surface nodes of every facet


def outline_of(surface: Surface) -> Outline:
    """The arrays of the tracked ``surface``, which are written in place."""
    return Outline(**{name: getattr(surface, name) for name in Outline.member_names})


@device
def distance_to(s: int, m: int, outline: Outline) -> tuple[Float, Float, Float, Float]:
    """Signed distance of node s from segment m [m], ξ, and the unit direction e_n (:func:`mpmfw.kernels.signed_distance`)."""
    x, y = outline.position[s, 0], outline.position[s, 1]
    return signed_distance(x, y, m, outline.position, outline.next, outline.previous)
