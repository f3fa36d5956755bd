"""Arrays of the search: candidates of the surface nodes, and linked lists on the background grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.api import Field, FloatArray, Grid, IndexArray, IntArray, Setup, Surface
from mpmfw_contact.surfaces import search


@dataclass
class Candidates:
    """Up to ``slots`` candidate segments for every surface node, each of another body, and where it was inside a step ago."""

    master: IntArray  #: (n_s, slots) index of the candidate's body
    segment: IntArray  #: (n_s, slots) first node of the segment; −1 if none is near
    coordinate: FloatArray  #: (n_s, slots) ξ
    gap: FloatArray  #: (n_s, slots) g_n [m]
    normal: FloatArray  #: (n_s, slots, 2) e_n
    inside: IntArray  #: (n_s, slots) body that the node was inside of in the last step; −1 for none
    inside_segment: (
        IntArray  #: (n_s, slots) the segment that it was behind; without nodes where nothing is tracked
    )

    @classmethod
    def allocate(cls, setup: Setup, owner: str, slots: int, *, tracked: bool) -> Candidates:
        """Allocate and list the arrays."""

        def array(
            name: str, unit: str, meaning: str, dtype: str = "i8", dims: tuple[str, ...] = ()
        ) -> np.ndarray:
            field = Field(name, ("surface_node", "slot", *dims), unit, meaning, "surface", dtype)
            return setup.allocate(owner, field, slot=slots)

        def none() -> IntArray:
            return np.full((0, slots), -1)

        candidates = cls(
            master=array("master", "1", "body of the candidate"),
            segment=array("segment", "1", "closest segment"),
            coordinate=array("coordinate", "1", "natural coordinate on the segment", "f8"),
            gap=array("gap", "m", "normal gap", "f8"),
            normal=array("normal", "1", "direction of the normal force", "f8", ("axis",)),
            inside=array("inside", "1", "body that the node was inside of") if tracked else none(),
            inside_segment=array("inside_segment", "1", "segment that it was behind") if tracked else none(),
        )
        for each in (candidates.segment, candidates.master, candidates.inside):
            each.fill(-1)
        return candidates


@dataclass
class SearchGrid:
    """Marks and linked lists on the background grid; stamps that grow spare clearing them."""

    owner: IntArray  #: (n_nodes,) stamp and body of the first surface that reached the node
    shared: IntArray  #: (n_nodes,) stamp of the last step in which two surfaces reached it
    head: IntArray  #: (n_nodes,) first entry of the cell's list
    head_stamp: IntArray  #: (n_nodes,)
    link: IndexArray  #: (n_entries,) next entry
    link_segment: IndexArray  #: (n_entries,) segment
    box_lower: FloatArray  #: (n_bodies, 2) [m]
    box_upper: FloatArray  #: (n_bodies, 2) [m]
    near_lower: FloatArray  #: (n_bodies, 2) box of what of the body may be near another [m]
    near_upper: FloatArray  #: (n_bodies, 2) [m]
    stamp: int = 0

    @classmethod
    def allocate(cls, setup: Setup, owner: str) -> SearchGrid:
        """Allocate and list the arrays."""
        nodes = int(np.prod(setup.state.grid.nodes))
        surface = setup.state.surface
        entries = 4 * (0 if surface is None else surface.count)

        def array(name: str, dims: tuple[str, ...], meaning: str, dtype: str, unit: str = "1") -> np.ndarray:
            sizes = {"grid_node": nodes, "entry": entries}
            return setup.allocate(owner, Field(name, dims, unit, meaning, "contact", dtype), **sizes)

        node, entry, body = ("grid_node",), ("entry",), ("body", "axis")
        return cls(
            owner=array("owner", node, "first body whose surface reached the node", "i8"),
            shared=array("shared", node, "stamp of nodes reached by two surfaces", "i8"),
            head=array("head", node, "first entry of the cell's list of segments", "i8"),
            head_stamp=array("head_stamp", node, "stamp of the list", "i8"),
            link=array("link", entry, "next entry of the list", "i4"),
            link_segment=array("link_segment", entry, "segment of the entry", "i4"),
            box_lower=array("box_lower", body, "lower corner of the body's bounding box", "f8", "m"),
            box_upper=array("box_upper", body, "upper corner of the body's bounding box", "f8", "m"),
            near_lower=array("near_lower", body, "lower corner of what may be near another body", "f8", "m"),
            near_upper=array("near_upper", body, "upper corner of what may be near another body", "f8", "m"),
        )

    def list_segments(self, surface: Surface, grid: Grid, n_bodies: int) -> bool:
        """Lists of the segments in cells that two bodies reach; return whether there are such cells."""
        where = (grid.lower, grid.spacing, grid.nodes)
        while True:
            self.stamp += 1
            if not search.mark_shared_nodes(
                self.stamp,
                n_bodies,
                surface.position,
                surface.next,
                surface.body,
                self.near_lower,
                self.near_upper,
                *where,
                self.owner,
                self.shared,
            ):
                return False
            entries = search.list_segments(
                self.stamp,
                surface.position,
                surface.next,
                surface.body,
                self.near_lower,
                self.near_upper,
                *where,
                self.shared,
                self.head,
                self.head_stamp,
                self.link,
                self.link_segment,
            )
            if entries <= len(self.link):
                return True
            self.grow(2 * entries)

    def grow(self, entries: int) -> None:
        """Make room for more entries; the lists are filled anew afterwards."""
        self.link = np.zeros(entries, dtype=np.int32)
        self.link_segment = np.zeros(entries, dtype=np.int32)
