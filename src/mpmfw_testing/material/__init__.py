"""The checks of materials, and the points that they deform by hand."""

from __future__ import annotations

from mpmfw_testing.check import Check
from mpmfw_testing.material.bench import Bench
from mpmfw_testing.material.contract import contract_checks
from mpmfw_testing.material.elasticity import elasticity_checks
from mpmfw_testing.material.energy import energy_checks
from mpmfw_testing.sent import SENT


def material_checks() -> list[Check]:
    """All checks of a material: those first whose failure makes others fail as well."""
    return [*contract_checks(), *elasticity_checks(), *energy_checks(), SENT]


__all__ = ["Bench", "material_checks"]
