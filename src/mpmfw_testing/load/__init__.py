"""The checks of loads, and the square that they act on."""

from __future__ import annotations

from mpmfw_testing.check import Check
from mpmfw_testing.load.contract import contract_checks
from mpmfw_testing.load.force import force_checks
from mpmfw_testing.sent import SENT


def load_checks() -> list[Check]:
    """All checks of a load: those first whose failure makes others fail as well."""
    return [*contract_checks(), *force_checks(), SENT]


__all__ = ["load_checks"]
