"""Detection of [H17]: every facet that a node of the other body penetrates.

Source: F. Hamad, S. Giridharan, C. Moormann (2017), Procedia Engineering 175, 116-123, section 3.2.
"""

from __future__ import annotations

from typing import ClassVar

from mpmfw.api.types import Surface
from mpmfw.contact.surfaces import FacetOptions, Surfaces
from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.contact.surfaces.outline import Candidates, clear, hidden
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.facets import project, read_corners, read_point
from mpmfw.kernels.types import Float


@device
def is_behind(s: int, m: int, radius: Float, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Gap by eq. 10: g_n < 0 with the foot of node s on facet m, a corner within the radius; else 0."""
    dim, near, on_it = len(spacing), False, True
    x, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    corners = scratch.matrix(spacing, spacing)
    read_point(s, outline.position, x, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    gap = project(x, corners, share, normal, spacing)
    for a in range(dim):
        square = 0.0
        for d in range(dim):
            square += (x[d] - corners[a, d]) ** 2
        near, on_it = near or square < radius * radius, on_it and share[a] >= 0.0
    return min(gap, 0.0) if near and on_it else 0.0


@kernel
def find_penetrated(
    radius: float, outline: Surface, near: NearFacets, candidates: Candidates, spacing: tuple[float, ...]
) -> int:
    """List for every node the facets that it penetrates, up to the number of slots; return their number."""
    count, slots = 0, candidates.facet.shape[1]
    for s in range(len(outline.body)):
        clear(s, candidates)
        j = 0
        for k in range(near.first[s], near.first[s + 1]):
            m, gap = near.facet[k], 0.0
            if j < slots and not hidden(m, outline.body[s], outline):
                gap = is_behind(s, m, radius, outline, spacing)
            if gap < 0.0:
                candidates.facet[s, j], candidates.gap[s, j] = m, gap
                j += 1
        count += j
    return count


class EveryFacet(Surfaces):
    """One body of a pair is master; its facets act on every node behind them (eq. 10 and 7)."""

    Options: ClassVar[type[FacetOptions]] = FacetOptions
    every_facet = True
    #: [H17] is of the plane; in space its rows leave a moment where cubes meet face on face (``mpmfw check``:
    #: 0.006 cells).
    dimensions = (2,)

    def search(self) -> int:
        """List the penetrated facets; return their number."""
        if not self.near.update():
            return 0
        return find_penetrated(
            self.radius, self.surface, self.near.near, self.candidates, self.state.grid.spacing
        )
