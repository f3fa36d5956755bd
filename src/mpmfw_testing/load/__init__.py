"""The checks of loads, and the square that they act on."""

from __future__ import annotations

from mpmfw_testing.load import contract, force
from mpmfw_testing.sent import sent

#: Those first whose failure makes others fail as well.
CHECKS = (*contract.CHECKS, *force.CHECKS, sent)
