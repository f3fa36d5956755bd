"""Tracked surfaces, partners and candidates, as arguments of kernels."""

from __future__ import annotations

import numpy as np

from mpmfw.errors import SimulationError
from mpmfw.kernels import Struct, device, scratch
from mpmfw.kernels.facets import dot, length_of, read_corners, read_point, squared_distance
from mpmfw.kernels.surfaces import add_normal, area_of, signed_distance
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import Field, IntArray
from mpmfw.state.structs import State, Surface


def node_error(state: State, surface: Surface, node: int, text: str, *, advice: str) -> SimulationError:
    """Return the error of a surface ``node``: body, index, place and ``text``."""
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
def distance_to(
    s: int, m: int, outline: Surface, share: Floats, normal: Floats, spacing: tuple[float, ...]
) -> Float:
    """Signed distance of node s from facet m [m]; coordinates into ``share``, e_n into ``normal``."""
    x = scratch.vector(spacing)
    read_point(s, outline.position, x, spacing)
    return signed_distance(x, m, outline, share, normal, spacing)


@device
def square_of(s: int, m: int, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Squared distance of node s from facet m [m²]."""
    x, corners = scratch.vector(spacing), scratch.matrix(spacing, spacing)
    read_point(s, outline.position, x, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    return squared_distance(x, corners, spacing)


@device
def body_of(m: int, outline: Surface) -> int:
    """Body of facet m."""
    body: int = outline.body[outline.facets[m, 0]]
    return body


@device
def hidden(m: int, body: int, outline: Surface) -> bool:
    """Return True if a third body covers facet m, so that ``body`` cannot touch it."""
    return len(outline.covered) > 0 and outline.covered[m] >= 0 and outline.covered[m] != body


#: Least cosine between a slave node's reversed normal and that of a facet that faces it: at the right angles
#: of blocks neither rounding nor elastic lean must decide. The sides of a wedge of 2.3° face nothing.
LEAST_COSINE = 0.02


@device
def opposition(outward: Floats, m: int, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Cosine between the reversed ``outward`` normal of a node or facet and that of facet m."""
    area = scratch.vector(spacing)
    area_of(m, outline, area, spacing)
    return -dot(outward, area, spacing) / (length_of(outward, spacing) * length_of(area, spacing))


@device
def opposes(outward: Floats, m: int, outline: Surface, spacing: tuple[float, ...]) -> bool:
    """Return true if facet m faces a node or facet with the normal ``outward``."""
    facing: bool = opposition(outward, m, outline, spacing) > LEAST_COSINE
    return facing


@device
def node_outward(s: int, other: int, outline: Surface, outward: Floats, spacing: tuple[float, ...]) -> None:
    """Normal of surface node s for body ``other``, without covered facets."""
    for d in range(len(spacing)):
        outward[d] = 0.0
    for k in range(outline.star_first[s], outline.star_first[s + 1]):
        if not hidden(outline.star[k], other, outline):
            add_normal(s, outline.star[k], outline, outward, spacing)


class Partners(Struct):
    """Bodies that each body is searched against, in ascending order."""

    first: Ints  #: (n_bodies + 1,) partners of body a are ``body[first[a]:first[a + 1]]``
    body: Ints  #: (n,)


def partners_of(first: IntArray, second: IntArray, rank: IntArray) -> Partners:
    """Return each body's partners of no lower ``rank`` (body,), of the pairs ``first``, ``second``."""
    body, other = np.concatenate([first, second]), np.concatenate([second, first])
    searched = rank[body] <= rank[other]
    body, other = body[searched], other[searched]
    order = np.lexsort((other, body))
    return Partners(first=np.searchsorted(body[order], np.arange(len(rank) + 1)), body=other[order])


class Candidates(Struct):
    """Facets that every surface node may touch; until the search those of the last step."""

    facet: Ints  #: (n_s, slots) −1 if none is near
    gap: Floats  #: (n_s, slots) g_n [m], infinite if none is near


def no_candidates(setup: Setup, owner: str, slots: int) -> Candidates:
    """Allocate and list the arrays, without a candidate."""
    axes, text = ("surface_node", "slot"), "candidates of surface nodes"
    facet = setup.allocate(owner, Field("facet", axes, "1", text, "surface", "i8"), slot=slots)
    gap = setup.allocate(owner, Field("gap", axes, "m", text, "surface"), slot=slots)
    facet.fill(-1)
    gap.fill(np.inf)
    return Candidates(facet=facet, gap=gap)


@device
def clear(s: int, candidates: Candidates) -> None:
    """Empty the slots of node s."""
    for j in range(candidates.facet.shape[1]):
        candidates.facet[s, j], candidates.gap[s, j] = -1, np.inf
