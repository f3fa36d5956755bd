"""The checks of materials, and the points that they deform by hand."""

from __future__ import annotations

from mpmfw_testing.material import contract, elasticity, energy
from mpmfw_testing.sent import sent

#: Those first whose failure makes others fail as well.
CHECKS = (*contract.CHECKS, *elasticity.CHECKS, *energy.CHECKS, sent)
