"""Header and frames of a results' file: one header a run, one frame an output."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from mpmfw.state.fields import AnyArray, Field, IntArray


@dataclass(frozen=True)
class RunHeader:
    """All that is known of a run before its first step.

    Parameters
    ----------
    dim
        Number of space dimensions, 2 or 3.
    bodies, pairs
        Names of the bodies and labels ``a-b`` of the pairs, in the scene's order.
    particle_count
        Number of material points of each body.
    fields
        The declarations of every array that frames hold; the ``output`` flag is not read.
    surface_count
        Number of surface nodes of each body; a body that is absent or has 0 has no surface.
    connectivity
        For each body with a surface, the node ``next[s]`` at which the segment that starts at node ``s``
        ends, counted within the body, shape (surface_node,).
    attributes
        Root attributes: scene text, title, contact, shape, scheme, transfer, effects, plug-ins, versions …
        Mappings and sequences of mixed type are stored as JSON; a value of ``None`` is left out.
    per_metre
        Whether masses, forces and energies in 2D are those of a metre of thickness; else of the thickness
        that bodies name.
    more_pairs
        Whether frames may name pairs that the header does not: bodies of many that come near each other.
    """

    dim: int
    bodies: tuple[str, ...]
    pairs: tuple[str, ...]
    particle_count: Mapping[str, int]
    fields: tuple[Field, ...]
    surface_count: Mapping[str, int] = field(default_factory=dict)
    connectivity: Mapping[str, IntArray] = field(default_factory=dict)
    attributes: Mapping[str, Any] = field(default_factory=dict)
    more_pairs: bool = False
    per_metre: bool = True


@dataclass
class Frame:
    """Arrays of one output, by group and name.

    The writer copies what it is given to the file before it returns, so views of the state are welcome. A
    declared field that a frame does not hold is missing (NaN) at that time.

    Parameters
    ----------
    time
        [s].
    particles, surface
        ``{field: array}`` over the points of all bodies, which follow each other as in the header; shapes as
        declared, without the time. Particles may be absent from any frame, and have times of their own then.
    series
        ``{field: array}`` of shape (body,), (body, axis), (body, rotation), (pair,) or (pair, axis).
    contact
        For each pair, ``{field: array}``.
    grid
        ``{field: array}``.
    pairs
        Labels of all pairs so far, the header's first, where the header says that there may be more.
    """

    time: float
    particles: Mapping[str, AnyArray] = field(default_factory=dict)
    surface: Mapping[str, AnyArray] = field(default_factory=dict)
    series: Mapping[str, AnyArray] = field(default_factory=dict)
    contact: Mapping[str, Mapping[str, AnyArray]] = field(default_factory=dict)
    grid: Mapping[str, AnyArray] = field(default_factory=dict)
    pairs: tuple[str, ...] = ()
