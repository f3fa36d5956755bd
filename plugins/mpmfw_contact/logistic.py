"""Detection at shared grid nodes with the plane that separates the bodies' points best, by penalised logistic
regression.

Source: J. A. Nairn, C. C. Hammerquist, G. D. Smith (2020), New material point method contact algorithms for
improved accuracy, large-deformation problems, and proper null-space filtering, CMAME 362, 112859. The paper
was not at hand; what follows is that of the public codes of NairnMPM (Nodes/MachineLearning.cpp) and Uintah
(SerialMPM.cc). Points with a weight at the node, all alike, have the class −1 or 1. The squares of the
classes less a logistic function of position are made small by Gauss and Newton, with a penalty of 1e-7 h² on
the slope, until 1 − cos of the normal's turn is below 1e-5 (NairnMPM, 15 iterations) or 1e-7 (Uintah, 50).
The separation is that of the points' outermost reaches along the normal, and bodies touch where it is
negative. (Before, NairnMPM penalised the offset alone, by 5e-4.)

Assumed here. A point reaches as far as the tangent of its ellipse across the normal; in NairnMPM as the
ellipse along it, in Uintah as its corners. Each pair of bodies has planes of its own.
"""

from __future__ import annotations

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from mpmfw.api import ContactRows, Grid, ImpulseContact, Particles, SceneError, Setup, Stencil
from mpmfw.contact.nodes import AtNodes
from mpmfw_contact._regression import Clouds, Domains, list_points, write_regressed_rows
from mpmfw_contact.impulse import Impulse


class LogisticOptions(BaseModel):
    """Settings of the regression, and where bodies touch."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    slope_penalty: float = Field(
        1e-7, gt=0, description="penalty on the slope of the logistic function, with a cell as unit"
    )
    turn: float = Field(
        1e-5, gt=0, lt=1, description="1 - cos of the turn of a normal that ends the regression"
    )
    cut_off: float = Field(0.0, ge=0, description="separation in cells below which bodies touch")


class Logistic(AtNodes):
    """Normal and gap of shared nodes by logistic regression of the points' bodies against their position."""

    name = "logistic"
    Options = LogisticOptions
    options: LogisticOptions

    def configure(self, needs: frozenset[str], *, forces: bool) -> None:  # noqa: ARG002
        """Refuse laws of forces.

        Raises
        ------
        SceneError
            The gap jumps as points come and go, and springs would make energy of that.
        """
        if forces:
            raise SceneError(
                "detection 'logistic' is for laws of impulses: its gap jumps as points come and go, and "
                "springs would make "
                "energy of that"
            )

    def prepare(self, setup: Setup, owner: str) -> None:
        """Domains of the material points, and the bodies of the pairs."""
        particles = setup.state.particles
        self.domains = Domains(
            position=particles.position,
            deformation=particles.deformation_gradient,
            half_edges=setup.half_edges,
        )
        self.cut_off, self.wide = self.options.cut_off * setup.cell_size, (1.0,) * (setup.dim + 1)
        self.clouds = Clouds(**{name: np.zeros(0, dtype=np.int64) for name in Clouds.member_names})
        super().prepare(setup, owner)

    def write(self, listed: int, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> int:
        """Rows of the shared nodes between whose points there is a plane."""
        self._list_points(listed, grid, phi)
        if self.domains.position is not particles.position:
            self.domains.set(position=particles.position, deformation=particles.deformation_gradient)
        return write_regressed_rows(
            listed, self.shared, self.pairs, self.nodes_of(grid), self.clouds, self.domains, grid.position,
            self.options.slope_penalty, self.options.turn, self.cut_off, self.state.dt, rows, grid.spacing,
            self.wide,
        )  # fmt: skip

    def _list_points(self, listed: int, grid: Grid, phi: Stencil) -> None:
        if len(self.clouds.slot) != len(grid.mass):
            self.clouds.set(slot=np.zeros(len(grid.mass), dtype=np.int64))
        if len(self.clouds.start) < 2 * listed + 1:
            self.clouds.set(start=np.zeros(4 * listed + 1, dtype=np.int64))
        total = list_points(listed, self.shared, phi.row, phi.nodes, phi.weight, self.clouds)
        if total > len(self.clouds.point):
            self.clouds.set(point=np.zeros(2 * total, dtype=np.int64))
            list_points(listed, self.shared, phi.row, phi.nodes, phi.weight, self.clouds)


class Nairn(ImpulseContact):
    """Momentum exchange at grid nodes whose two bodies approach and overlap across the plane between their
    points.

    Both the projected and the updated momentum are corrected, as published.
    """

    name = "nairn"
    Detection = Logistic
    Law = Impulse
