"""Bodies that two simulations have by different numbers: one has all of them, the other some."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mpmfw.state.fields import AnyArray, IntArray
from mpmfw.state.history import history_of
from mpmfw.state.structs import OF_BODIES, State


@dataclass(frozen=True)
class IndexMap:
    """Index here of everything that another simulation has, −1 of what is not here."""

    body: IntArray  #: (n_bodies,)
    particle: IntArray  #: (n,) material points
    surface_node: IntArray  #: (n_s,)
    facet: IntArray  #: (n_f,)
    pair: IntArray  #: (n_pairs,) pairs that are listed in both

    @classmethod
    def between(cls, other: State, own: State) -> IndexMap:
        """Return the map of bodies that have the same names."""
        index = {body.name: body.index for body in own.bodies}
        body = np.array([index.get(each.name, -1) for each in other.bodies], dtype=np.int64)
        shared = [(each, own.bodies[b]) for each, b in zip(other.bodies, body, strict=True) if b >= 0]
        listed = {(pair.first, pair.second): pair.index for pair in own.pairs}
        pair = [listed.get((int(body[p.first]), int(body[p.second])), -1) for p in other.pairs]
        points = [(theirs.particles, ours.particles) for theirs, ours in shared]
        nodes, facets, n_nodes, n_facets = [], [], 0, 0
        if (here := own.surface) is not None and (there := other.surface) is not None:
            nodes = [(there.of(theirs.index), here.of(ours.index)) for theirs, ours in shared]
            facets = [(there.facets_of(theirs.index), here.facets_of(ours.index)) for theirs, ours in shared]
            n_nodes, n_facets = there.count, len(there.facets)
        return cls(
            body=body,
            particle=_indices(other.particles.count, points),
            surface_node=_indices(n_nodes, nodes),
            facet=_indices(n_facets, facets),
            pair=np.array(pair, dtype=np.int64),
        )


def _indices(count: int, slices: Sequence[tuple[slice, slice]]) -> IntArray:
    found = np.full(count, -1, dtype=np.int64)
    for theirs, ours in slices:
        found[theirs] = np.arange(ours.start, ours.stop)
    return found


def copy_history(own: State, other: State, index_map: IndexMap) -> None:
    """Copy declared history and declared arrays of the bodies that both have."""
    for dim, ours, theirs in _arrays(own, other):
        if ours.shape[1:] == theirs.shape[1:]:  # else they have room for so many bodies: scratch
            index = getattr(index_map, dim)
            ours[index[index >= 0]] = theirs[index >= 0]


def _arrays(own: State, other: State) -> Iterator[tuple[str, AnyArray, AnyArray]]:
    """Arrays that both have, with the dimension that they are numbered by."""
    points, surfaces = (own.particles, other.particles), (own.surface, other.surface)
    for dim, ours, theirs in (("particle", *points), ("surface_node", *surfaces)):
        for name in history_of(ours) or ():
            if getattr(ours, name) is not None and theirs is not None:
                yield dim, getattr(ours, name), getattr(theirs, name)
    for key, dims in own.dims.items():
        if dims and dims[0] in OF_BODIES and key in other.arrays:
            yield dims[0], own.arrays[key], other.arrays[key]
