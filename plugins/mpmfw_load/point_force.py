"""A force at a point of a body, constant or changing in time."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import Field, Strict

from mpmfw.api.load import BodyLoad, shares_near
from mpmfw.api.types import FloatArray, OptionsModel, Particles, SceneError, Setup, hookimpl
from mpmfw.api.units import Force, Length, TimeTable, vector_in_time


class PointForceOptions(OptionsModel):
    """Options of a point force.

    Attributes
    ----------
    at
        Where it acts at the start [m]; it goes with the body.
    force
        [N], in the plane on a body of its thickness: a vector, or rows (t, x, y[, z]).
    """

    at: Annotated[tuple[Length, ...], Strict(False), Field(min_length=2, max_length=3)]
    force: vector_in_time(Force)  # type: ignore[valid-type]


class PointForce(BodyLoad):
    """A force at a point of one body, with the exact moment, spread over material points within 1.5 cells.

    Their shares w_p are linear in the distance within a kernel (moving least squares): Σ w_p = 1 and Σ w_p
    x_p = x at the start. On a rigid body the place may lie anywhere.
    """

    name = "point_force"
    Options = PointForceOptions
    options: PointForceOptions
    vectors = ("at", "force")

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.table = TimeTable.of(self.options.force)

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Find the shares of points near the place; raise SceneError unless there is one body, near it."""
        if len(self.bodies) != 1:
            names = ", ".join(body.name for body in self.bodies)
            raise SceneError(
                f"a point force acts on one body, not on {names}; expected one of them",
                key=f"loads.{self.title}.bodies",
            )
        (body,) = self.bodies
        if body.rigid:
            points = setup.state.rigid.particles_of(body).position
            basis = np.column_stack([np.ones(len(points)), points])
            self.shares = np.linalg.solve(basis.T, [1.0, *self.options.at])
            return
        try:
            position = setup.state.particles.position[body.particles]
            self.shares = shares_near(position, np.array(self.options.at), setup.cell_size)
        except ValueError as error:
            raise SceneError(
                f"{error}; expected a point of {body.name}", key=f"loads.{self.title}.at"
            ) from error

    def forces(self, particles: Particles, own: slice, time: float) -> FloatArray:  # noqa: ARG002
        """w_p F(t), (n, dim) [N]."""
        return np.outer(self.shares, self.table.at(time))
