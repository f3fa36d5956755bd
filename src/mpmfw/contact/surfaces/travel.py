"""How far bodies may travel towards each other in a step: a node must not pass the band in which it is
searched."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.kernels import Struct, kernel
from mpmfw.kernels.gaps import bounding_boxes
from mpmfw.kernels.types import Floats, Ints
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.structs import Pair, State, Surface

#: Share of the search radius that bodies near each other may travel in a step, before the safety factor.
SHARE = 0.5


class Boxes(Struct):
    """Where bodies are, and how they move: they may turn and deform."""

    lower: Floats  #: (n_bodies, dim) [m]
    upper: Floats
    slowest: Floats  #: least components of the nodes' displacements, (n_bodies, dim) [m]
    fastest: Floats  #: largest


@kernel
def fewest_steps(
    first: Ints, second: Ints, body_first: Ints, position: Floats, displacement: Floats, begins: bool,
    boxes: Boxes, band: float
) -> float:  # fmt: skip
    """Least (distance of the boxes + ``band``) / relative motion over all pairs: steps like the last that are
    left to them.

    ``position`` and ``displacement`` are those of the surface nodes, (n_s, dim) [m]. In the step that
    ``begins`` the run there are no displacements yet, and the boxes have the motion already.
    """
    lower, upper, slowest, fastest = boxes.lower, boxes.upper, boxes.slowest, boxes.fastest
    bounding_boxes(body_first, position, lower, upper)
    if not begins:
        bounding_boxes(body_first, displacement, slowest, fastest)
    steps = math.inf
    for c in range(len(first)):
        a, b = first[c], second[c]
        distance, motion = 0.0, 0.0
        for d in range(lower.shape[1]):
            distance = max(distance, lower[a, d] - upper[b, d], lower[b, d] - upper[a, d])
            most = max(abs(fastest[a, d] - slowest[b, d]), abs(fastest[b, d] - slowest[a, d]))
            motion += most * most
        if motion > 0.0:
            steps = min(steps, (distance + band) / math.sqrt(motion))
    return steps


class TravelLimit:
    """The part of the time step's limit that comes of speed alone.

    Parameters
    ----------
    radius
        Of the search, in cells.
    """

    name = "surface_travel"
    stage = "contact"

    def __init__(self, radius: float) -> None:
        self.share = SHARE * radius

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Pairs and scratch."""
        surface = setup.state.surface
        if surface is None:
            raise RuntimeError("no surface to follow")
        self.surface: Surface = surface
        self.band = self.share * setup.cell_size
        self.owner = f"travel of {self.share:g} cells towards each other"
        self._list(setup.pairs)
        empty = {name: np.zeros((len(setup.bodies), setup.dim)) for name in Boxes.member_names}
        self.boxes = Boxes(**empty)

    def _list(self, pairs: tuple[Pair, ...]) -> None:
        self.first = np.array([pair.first for pair in pairs], dtype=np.int64)
        self.second = np.array([pair.second for pair in pairs], dtype=np.int64)

    @hookimpl
    def add_pairs(self, state: State) -> None:
        """Bodies that have come near."""
        self._list(state.pairs)

    @hookimpl
    def stable_timestep(self, state: State) -> tuple[float, str]:
        """Time in which some pair of bodies comes nearer by its distance and half of the search radius, as it
        moved last.

        Before the first step the material points tell how bodies move; infinite if none does.
        """
        surface, boxes, unit, begins = self.surface, self.boxes, state.dt, state.steps == 0
        if begins:
            unit = 1.0
            for body in state.bodies:
                own = state.particles.velocity[body.particles]
                boxes.slowest[body.index], boxes.fastest[body.index] = own.min(axis=0), own.max(axis=0)
        steps = fewest_steps(
            self.first, self.second, surface.body_first, surface.position, surface.displacement, begins,
            boxes, self.band
        )  # fmt: skip
        return steps * unit, self.owner
