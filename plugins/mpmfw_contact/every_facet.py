"""Detection of [H17]: every facet that a node of the other body penetrates.

Source: F. Hamad, S. Giridharan, C. Moormann (2017), Procedia Engineering 175, 116-123, section 3.2.
"""

from __future__ import annotations

from typing import ClassVar

from mpmfw.contact.surfaces import FacetOptions, Surfaces
from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.contact.surfaces.outline import Candidates, Outline, hidden, put
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.facets import project, read_corners, read_point
from mpmfw.kernels.types import Float


@device
def keep_penetrated(
    s: int, m: int, other: int, radius: Float, outline: Outline, candidates: Candidates, spacing: tuple[float,
    ...]
) -> None:  # fmt: skip
    """Eq. 10: g_n < 0 and the foot on the facet, with a corner of it within the radius; each facet once."""
    dim = len(spacing)
    x, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    corners = scratch.matrix(spacing, spacing)
    read_point(s, outline.position, x, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    near = False
    if hidden(m, outline.body[s], outline):
        return
    for a in range(dim):
        square = 0.0
        for d in range(dim):
            square += (x[d] - corners[a, d]) ** 2
        near = near or square < radius * radius
    if not near:
        return
    gap = project(x, corners, share, normal, spacing)
    on_it = gap < 0.0
    for a in range(dim):
        on_it = on_it and share[a] >= 0.0
    if not on_it:
        return
    for j in range(candidates.facet.shape[1]):
        if candidates.facet[s, j] == m:
            return
        if candidates.facet[s, j] < 0:
            put(s, j, other, m, gap, share, normal, candidates, spacing)
            return


@kernel
def find_penetrated(
    radius: float, outline: Outline, near: NearFacets, candidates: Candidates, spacing: tuple[float, ...]
) -> int:
    """List for every node the facets that it penetrates, up to the number of slots; return their number."""
    count = 0
    for s in range(len(outline.body)):
        for j in range(candidates.facet.shape[1]):
            candidates.facet[s, j] = -1
        for k in range(near.first[s], near.first[s + 1]):
            m = near.facet[k]
            keep_penetrated(s, m, outline.body[outline.facets[m, 0]], radius, outline, candidates, spacing)
        for j in range(candidates.facet.shape[1]):
            if candidates.facet[s, j] >= 0:
                count += 1
    return count


class EveryFacet(Surfaces):
    """One body of a pair is master; its facets meet every node that they find behind them (eq. 10), normals
    varied (eq. 7)."""

    Options: ClassVar[type[FacetOptions]] = FacetOptions
    every_facet = True
    #: [H17] is of the plane; in space its rows leave a moment where cubes meet face on face (``mpmfw check``:
    #: 0.006 cells).
    dimensions = (2,)

    def search(self) -> int:
        """List the penetrated facets."""
        return find_penetrated(
            self.radius, self.outline, self.near.near, self.candidates, self.state.grid.spacing
        )
