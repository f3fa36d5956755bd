"""The checks of materials, and the points that they deform by hand."""

from __future__ import annotations

from mpmfw.testing.check import Check
from mpmfw.testing.material.bench import Bench
from mpmfw.testing.material.contract import contract_checks
from mpmfw.testing.material.elasticity import elasticity_checks
from mpmfw.testing.material.energy import energy_checks
from mpmfw.testing.sent import SENT


def material_checks() -> list[Check]:
    """All checks of a material: those first whose failure makes others fail as well."""
    return [*contract_checks(), *elasticity_checks(), *energy_checks(), SENT]


__all__ = ["Bench", "material_checks"]
