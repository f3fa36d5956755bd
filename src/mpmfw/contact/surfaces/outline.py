"""Tracked surfaces, the bodies searched against each other, and candidates, as arguments of kernels."""

from __future__ import annotations

import numpy as np

from mpmfw.errors import SceneError, SimulationError
from mpmfw.kernels import Struct, device, scratch
from mpmfw.kernels.facets import area_vector, read_corners, read_point, squared_distance
from mpmfw.kernels.surfaces import signed_distance
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import Field, IntArray
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
        raise SceneError(f"'{owner}' needs bodies with outlines", key="contact.method")
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
    """Return True if a third body covers facet m, so that ``body`` cannot touch it."""
    return len(outline.covered) > 0 and outline.covered[m] >= 0 and outline.covered[m] != body


class Partners(Struct):
    """Bodies that each body is searched against, in ascending order."""

    first: Ints  #: (n_bodies + 1,) partners of body a are ``body[first[a]:first[a + 1]]``
    body: Ints  #: (n,)


def partners_of(first: IntArray, second: IntArray, rank: IntArray) -> Partners:
    """Return the bodies that each body is searched against: of its pairs those of no lower ``rank`` (body,).

    ``first`` and ``second`` are the bodies of all pairs (pair,).
    """
    body, other = np.concatenate([first, second]), np.concatenate([second, first])
    searched = rank[body] <= rank[other]
    body, other = body[searched], other[searched]
    order = np.lexsort((other, body))
    return Partners(first=np.searchsorted(body[order], np.arange(len(rank) + 1)), body=other[order])


class Candidates(Struct):
    """Up to ``slots`` candidate facets for every surface node, each of another body, and where it was inside
    a step ago."""

    master: Ints  #: (n_s, slots) index of the candidate's body
    facet: Ints  #: (n_s, slots) facet; −1 if none is near
    share: Floats  #: (n_s, slots, dim) barycentric coordinates on it
    gap: Floats  #: (n_s, slots) g_n [m]
    normal: Floats  #: (n_s, slots, dim) e_n
    inside: Ints  #: (n_s, slots) body that the node was inside of in the last step; −1 for none
    inside_facet: Ints  #: (n_s, slots) the facet that it was behind; without nodes where nothing is tracked


def no_candidates(setup: Setup, owner: str, slots: int, *, tracked: bool) -> Candidates:
    """Allocate and list the arrays, without a candidate."""
    arrays = {}
    for name in Candidates.member_names:
        axes = ("axis",) if name in ("share", "normal") else ()
        kind, unit = ("f8", "m" if name == "gap" else "1") if axes or name == "gap" else ("i8", "1")
        field = Field(
            name, ("surface_node", "slot", *axes), unit, "candidates of surface nodes", "surface", kind
        )
        if tracked or not name.startswith("inside"):
            arrays[name] = setup.allocate(owner, field, slot=slots)
        else:
            arrays[name] = np.zeros((0, slots), dtype=kind)
    candidates = Candidates(**arrays)
    for each in (candidates.facet, candidates.master, candidates.inside):
        each.fill(-1)
    return candidates


@device
def put(
    s: int,
    j: int,
    master: int,
    m: int,
    gap: Float,
    share: Floats,
    normal: Floats,
    candidates: Candidates,
    spacing: tuple[float, ...],
) -> None:
    """Write the candidate in slot j of node s: facet m of body ``master``."""
    candidates.master[s, j], candidates.facet[s, j], candidates.gap[s, j] = master, m, gap
    for d in range(len(spacing)):
        candidates.share[s, j, d], candidates.normal[s, j, d] = share[d], normal[d]
