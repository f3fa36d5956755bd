"""How far bodies may travel towards each other in a step: a node must not pass the band in which it is
searched."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mpmfw.contact.surfaces.boxes import Boxes
from mpmfw.contact.surfaces.outline import Outline
from mpmfw.kernels import kernel
from mpmfw.kernels.gaps import bounding_boxes
from mpmfw.kernels.types import Ints
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.structs import State

#: Share of the search radius that bodies near each other may travel in a step, before the safety factor.
SHARE = 0.5


@kernel
def fewest_steps(
    first: Ints, second: Ints, outline: Outline, begins: bool, boxes: Boxes, motions: Boxes, band: float
) -> float:
    """Least (distance of the boxes + ``band``) / relative motion over all pairs: steps like the last that are
    left to them.

    ``motions`` bound the displacements of the last step, since bodies may turn and deform [m]. They are
    filled, but in the step that ``begins`` the run, which has none yet.
    """
    lower, upper, slowest, fastest = boxes.lower, boxes.upper, motions.lower, motions.upper
    bounding_boxes(outline.body_first, outline.position, lower, upper)
    if not begins:
        bounding_boxes(outline.body_first, outline.displacement, slowest, fastest)
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
    detection
        The detection, which has a search radius and a list of near facets.
    """

    name = "surface_travel"
    stage = "contact"

    def __init__(self, detection: Any) -> None:
        self.detection, self.share = detection, SHARE * detection.options.search_radius

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Allocate the bounds of the motions."""
        self.band = self.share * setup.cell_size
        shape = (len(setup.bodies), setup.dim)
        self.motions = Boxes(lower=np.zeros(shape), upper=np.zeros(shape))

    @hookimpl
    def stable_timestep(self, state: State) -> tuple[float, str]:
        """Time in which some pair of bodies comes nearer by its distance and half of the search radius, as it
        moved last.

        Before the first step the material points tell how bodies move; infinite if none does.
        """
        near, unit, begins = self.detection.near, state.dt, state.steps == 0
        if begins:
            unit = 1.0
            for body in state.bodies:
                velocity = state.particles.velocity[body.particles]
                self.motions.lower[body.index] = velocity.min(axis=0)
                self.motions.upper[body.index] = velocity.max(axis=0)
        steps = fewest_steps(
            near.first, near.second, near.outline, begins, near.boxes, self.motions, self.band
        )
        return steps * unit, f"travel of {self.share:g} cells towards each other"
