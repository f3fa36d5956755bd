"""The tracked surfaces as one argument of kernels."""

from __future__ import annotations

import numpy as np

from mpmfw.errors import SceneError, SimulationError
from mpmfw.kernels import Struct, device, scratch
from mpmfw.kernels.facets import area_vector, read_corners, read_point, signed_distance, squared_distance
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw.plugin.setup import Setup
from mpmfw.state.structs import State, Surface


class Outline(Struct):
    """Closed surfaces of all bodies, with the members of :class:`mpmfw.kernels.Facets`."""

    position: Floats  #: (n_s, dim) [m]
    displacement: Floats  #: (n_s, dim) motion over the last step [m]
    tributary: Floats  #: (n_s,) [m^(dim−1)]
    body: Ints  #: (n_s,)
    body_first: Ints  #: (n_bodies + 1,) surface nodes of body b are ``body_first[b]:body_first[b + 1]``
    facet_first: Ints  #: (n_bodies + 1,) its facets ``facet_first[b]:facet_first[b + 1]``
    facets: Ints  #: (n_f, dim) surface nodes of every facet
    neighbours: Ints  #: (n_f, dim) facet across the side opposite each corner
    star_first: Ints  #: (n_s + 1,) facets round node s are ``star[star_first[s]:star_first[s + 1]]``
    star: Ints  #: (n_f dim,)
    #: (n_f,) body that lies flush on the facet near a third body, −1 for none; (0,) with two bodies
    covered: Ints


def outline_of(surface: Surface) -> Outline:
    """The arrays of the tracked ``surface``, which are written in place; more than two bodies may cover each
    other's facets."""
    if len(surface.body_first) > 3 and len(surface.covered) == 0:
        surface.covered = np.full(len(surface.facets), -1)
    return Outline(**{name: getattr(surface, name) for name in Outline.member_names})


def tracked_surface(setup: Setup, owner: str) -> Surface:
    """Return the tracked surfaces, which contact ``owner`` works on.

    Raises
    ------
    SceneError
        There are none.
    """
    if setup.state.surface is None:
        raise SceneError(f"contact '{owner}' needs bodies with outlines")
    return setup.state.surface


def node_error(state: State, surface: Surface, node: int, text: str, *, advice: str) -> SimulationError:
    """Return what ends a run because of a surface ``node``: its body, index and place, with ``text``."""
    body = state.bodies[int(surface.body[node])]
    return SimulationError(
        text,
        body=body.name,
        index=node - int(surface.body_first[body.index]),
        position=surface.position[node].tolist(),
        time=state.time,
        advice=advice,
    )


@device
def dot(a: Floats, b: Floats, spacing: tuple[float, ...]) -> Float:
    """Σ a_d b_d."""
    total = 0.0
    for d in range(len(spacing)):
        total += a[d] * b[d]
    return total


@device
def distance_to(
    s: int, m: int, outline: Outline, share: Floats, normal: Floats, spacing: tuple[float, ...]
) -> Float:
    """Signed distance of node s from facet m [m]; barycentric coordinates into ``share``, the unit direction
    e_n into ``normal`` (:func:`mpmfw.kernels.signed_distance`)."""
    x = scratch.vector(spacing)
    read_point(s, outline.position, x, spacing)
    return signed_distance(x, m, outline, share, normal, spacing)


@device
def area_of(m: int, outline: Outline, out: Floats, spacing: tuple[float, ...]) -> None:
    """Outward normal of facet m times its measure, into ``out``, by :func:`.facets.area_vector`."""
    corners = scratch.matrix(spacing, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    area_vector(corners, out, spacing)


@device
def square_of(s: int, m: int, outline: Outline, spacing: tuple[float, ...]) -> Float:
    """Squared distance of node s from facet m [m²]."""
    x, corners = scratch.vector(spacing), scratch.matrix(spacing, spacing)
    read_point(s, outline.position, x, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    return squared_distance(x, corners, spacing)


@device
def hidden(m: int, body: int, outline: Outline) -> bool:
    """Whether a third body covers facet m, so that ``body`` cannot touch it."""
    return len(outline.covered) > 0 and outline.covered[m] >= 0 and outline.covered[m] != body
