"""Arrays of the search: candidate pairs with their history, and linked lists on the background grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.api import Field, FloatArray, Grid, IndexArray, IntArray, Setup, Surface
from mpmfw_contact.penalty import search


@dataclass
class Candidates:
    """Up to ``slots`` candidate segments for every surface node, each of another body, and the contact
    history.

    The tangential force of a node is kept with the body that it touches, so that it survives a change of
    segment.
    """

    slots: int
    master: IntArray  #: (n_s, slots) index of the body touched; −1 without contact
    segment: IntArray  #: (n_s, slots) first node of the segment; −1 if none is near
    coordinate: FloatArray  #: (n_s, slots) ξ
    gap: FloatArray  #: (n_s, slots) g_n [m]
    normal: FloatArray  #: (n_s, slots, 2) e_n
    stiffness: FloatArray  #: (n_s, slots) k [N/m^2]
    damping: FloatArray  #: (n_s, slots) dashpot over the last step, c / Δt [N/m^2]
    tangential: FloatArray  #: (n_s, slots) f_t [N/m]
    share: FloatArray  #: (n_s, slots) part of the tributary length across the normal
    old_master: IntArray
    old_segment: IntArray
    old_coordinate: FloatArray
    old_gap: FloatArray
    old_normal: FloatArray
    old_stiffness: FloatArray
    old_tangential: FloatArray
    old_share: FloatArray
    rest: FloatArray  #: (n_s, slots) gap at which the spring has no force [m]
    old_rest: FloatArray

    @classmethod
    def allocate(
        cls, setup: Setup, owner: str, slots: int, *, friction: bool, damping: bool, shares: bool
    ) -> Candidates:
        """Allocate and list the arrays; those of effects that are off have no nodes, and are not listed."""

        def array(
            name: str,
            unit: str,
            meaning: str,
            dtype: str = "f8",
            dims: tuple[str, ...] = (),
            on: bool = True,
        ) -> np.ndarray:
            if not on:
                return np.zeros((0, slots, *(2 for _ in dims)), dtype=dtype)
            field = Field(name, ("surface_node", "slot", *dims), unit, meaning, "surface", dtype)
            return setup.allocate(owner, field, slot=slots)

        candidates = cls(
            slots=slots,
            master=array("master", "1", "body touched", "i8"),
            segment=array("segment", "1", "closest segment", "i8"),
            coordinate=array("coordinate", "1", "natural coordinate on the segment"),
            gap=array("gap", "m", "normal gap"),
            normal=array("normal", "1", "direction of the normal force", dims=("axis",)),
            stiffness=array("stiffness", "N m-2", "spring stiffness"),
            damping=array("damping", "N m-2", "dashpot over the last step, c / dt", on=damping),
            tangential=array("tangential", "N m-1", "tangential force", on=friction),
            share=array("share", "1", "part of the tributary length across the normal", on=shares),
            old_master=array("old_master", "1", "body touched in the last step", "i8"),
            old_segment=array("old_segment", "1", "segment of the last step", "i8", on=shares),
            old_coordinate=array("old_coordinate", "1", "natural coordinate of the last step", on=shares),
            old_gap=array("old_gap", "m", "normal gap of the last step", on=shares),
            old_normal=array("old_normal", "1", "normal of the last step", dims=("axis",), on=shares),
            old_stiffness=array("old_stiffness", "N m-2", "stiffness of the last step", on=shares),
            old_tangential=array("old_tangential", "N m-1", "tangential force of the last step", on=friction),
            old_share=array("old_share", "1", "share of the last step", on=shares),
            rest=array("rest", "m", "gap at which the spring has no force", on=shares),
            old_rest=array("old_rest", "m", "rest of the last step", on=shares),
        )
        candidates.forget()
        return candidates

    def swap(self) -> None:
        """What was found in the last step becomes the history."""
        self.master, self.old_master = self.old_master, self.master
        self.tangential, self.old_tangential = self.old_tangential, self.tangential
        if len(self.share) == 0:  # the literal form has no other history
            return
        self.segment, self.old_segment = self.old_segment, self.segment
        self.coordinate, self.old_coordinate = self.old_coordinate, self.coordinate
        self.gap, self.old_gap = self.old_gap, self.gap
        self.normal, self.old_normal = self.old_normal, self.normal
        self.stiffness, self.old_stiffness = self.old_stiffness, self.stiffness
        self.share, self.old_share = self.old_share, self.share
        self.rest, self.old_rest = self.old_rest, self.rest

    def forget(self) -> None:
        """No contact, no history."""
        self.segment.fill(-1)
        self.master.fill(-1)
        self.old_master.fill(-1)
        self.tangential.fill(0.0)
        self.old_tangential.fill(0.0)


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
                *where,
                self.owner,
                self.shared,
            ):
                return False
            entries = search.list_segments(
                self.stamp,
                surface.position,
                surface.next,
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
