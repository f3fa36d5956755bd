"""Faults of what a table is, and of what its filling leaves behind."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import BaseModel, Field

from faulty_plugins.sealed import Sealed
from faulty_plugins.shape.sound import Sound
from mpmfw.api import Grid, Particles, Stencil, hookimpl


class LongNodes(Sound):
    """Node indices of 64 bits: every kernel would be compiled a second time."""

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """int64."""
        table = super().interpolate(particles, grid)
        return table.replace(nodes=table.nodes.astype(np.int64))


class Descending(Sound):
    """Rows from their last node to the first, of which it says that they ascend: threads would lose what a
    point adds.
    """

    rows_ascend = True

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """All entries turned round within their rows."""
        table = super().interpolate(particles, grid)
        order = np.concatenate(
            [np.arange(b - 1, a - 1, -1) for a, b in zip(table.row[:-1], table.row[1:], strict=True)]
        )
        return table.replace(
            nodes=table.nodes[order], weight=table.weight[order], gradient=table.gradient[order]
        )


class Stumbling(Sound):
    """Ends in an error of its own."""

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:  # noqa: ARG002
        """1/0."""
        raise ZeroDivisionError("no weights")


class Remembering(Sound):
    """Weights are mixed with those of the step before."""

    before = None

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """The mean of this filling and the last."""
        table = super().interpolate(particles, grid)
        mixed = table.weight if self.before is None else 0.5 * (table.weight + self.before)
        self.before = table.weight * (1.0 + 1e-15)
        return table.replace(weight=mixed)


#: Steps of whichever object was set up last.
_STEPS = [0]


class KeepsElsewhere(Sound):
    """Weights fade with the steps, which the module counts."""

    @hookimpl
    def setup(self) -> None:
        """Begin to count."""
        _STEPS[0] = 0

    @hookimpl
    def update_particle_domains(self) -> None:
        """Count."""
        _STEPS[0] += 1

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """Fainter by each step."""
        table = super().interpolate(particles, grid)
        return table.replace(weight=table.weight * (1.0 - 1e-9 * _STEPS[0]))


class Clamping(Sound):
    """Points that are near the window's end are put back, quietly."""

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """A rounding of the positions in place."""
        particles.position[:] = np.round(particles.position, 6)
        return super().interpolate(particles, grid)


class Hoarding(Sound):
    """Every table is kept."""

    def __init__(self, **options: object) -> None:
        super().__init__(**options)
        self.kept: list[Stencil] = []

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """Appended to a list."""
        self.kept.append(super().interpolate(particles, grid))
        return self.kept[-1]


class DeafOptions(BaseModel):
    """An option that nobody reads."""

    boundary: Literal["plain", "modified"] = "plain"


class Deaf(Sound):
    """An option is accepted and ignored."""

    Options = DeafOptions


class OrderOptions(BaseModel):
    """An option of which the simplest value is refused."""

    order: int = Field(2, ge=1)


class DeafToOrder(Sound):
    """An option is ignored, except that 0 is refused."""

    Options = OrderOptions


class OddOptions(BaseModel):
    """An option that takes none of the values that come to mind."""

    order: int = Field(2, ge=1, multiple_of=1009)


class DeafBehindRefusals(Sound):
    """An option is ignored, and every value but the default that the kit makes up is refused."""

    Options = OddOptions


class Flatland(Sound):
    """Says that it works in one dimension, in which there is no grid."""

    dimensions = (1, 2)


class Closed(Sealed, Sound):
    """Holds a function."""

    name = "closed"
