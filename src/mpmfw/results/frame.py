"""Header and frames of a results' file: one header a run, one frame an output."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from mpmfw.state.fields import AnyArray, Field, IntArray


@dataclass(frozen=True)
class RunHeader:
    """All that is known of a run before its first step."""

    dim: int  #: number of space dimensions, 2 or 3
    bodies: tuple[str, ...]  #: names, in the scene's order
    pairs: tuple[str, ...]  #: labels ``a-b``, in the scene's order
    particle_count: Mapping[str, int]  #: material points of each body
    fields: tuple[Field, ...]  #: declarations of all arrays of frames; the flag ``output`` is not read
    surface_count: Mapping[str, int] = field(default_factory=dict)  #: surface nodes, of bodies that have any
    #: by body, in 2D the node (surface_node,) at which each node's segment ends, in 3D triangles (k, 3)
    connectivity: Mapping[str, IntArray] = field(default_factory=dict)
    #: root attributes; mappings and sequences are stored as JSON, a value of None is left out
    attributes: Mapping[str, Any] = field(default_factory=dict)
    more_pairs: bool = False  #: whether frames may name further pairs
    per_metre: bool = True  #: whether quantities in 2D are of a metre of thickness, else of the bodies' own


@dataclass
class Frame:
    """Arrays of one output with the declared shapes, without the time; a field that is absent is NaN."""

    time: float  #: [s]
    #: fields over the points of all bodies, in the header's order; a frame may have none
    particles: Mapping[str, AnyArray] = field(default_factory=dict)
    surface: Mapping[str, AnyArray] = field(default_factory=dict)  #: as ``particles``, over surface nodes
    #: fields (body,), (body, axis), (body, rotation), (pair,) or (pair, axis)
    series: Mapping[str, AnyArray] = field(default_factory=dict)
    contact: Mapping[str, Mapping[str, AnyArray]] = field(default_factory=dict)  #: fields by pair
    grid: Mapping[str, AnyArray] = field(default_factory=dict)
    pairs: tuple[str, ...] = ()  #: all so far, the header's first, where the header allows more
