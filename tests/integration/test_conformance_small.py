"""The conformance kit on friction laws, boundary conditions and outputs: sound ones pass, planted faults are caught."""

from __future__ import annotations

from typing import Any

import pytest

from faulty_plugins.small import boundary, friction, output
from mpmfw.testing import examine, subject_of
from mpmfw.testing.parametrised import checks_of

MODULES: dict[Any, Any] = {"friction": friction, "boundary": boundary, "output": output}
FAULTS = [(kind, fault, meant) for kind, module in MODULES.items() for fault, meant in module.FAULTS.items()]


@pytest.mark.parametrize(("kind", "fault", "meant"), FAULTS, ids=lambda value: getattr(value, "name", value))
def test_every_fault_is_caught_by_the_check_meant_for_it(kind: Any, fault: Any, meant: str) -> None:
    checks = [check for check in checks_of(kind) if check.name == meant]
    (outcome,) = examine(subject_of(fault, kind), checks)
    assert outcome.status == "failed", outcome.report


@pytest.mark.parametrize(
    ("kind", "plugin"),
    [
        *((kind, module.Sound) for kind, module in MODULES.items()),
        ("friction", "coulomb"),
        ("friction", "stribeck(velocity=0.5)"),
        ("friction", "mohr_coulomb(cohesion=10)"),
    ],
)
def test_sound_ones_pass(kind: Any, plugin: Any) -> None:
    outcomes = examine(subject_of(plugin, kind), checks_of(kind))
    assert [outcome.report for outcome in outcomes if outcome.wrong] == []


@pytest.mark.parametrize("kind", MODULES)
def test_every_check_has_a_fault_planted_for_it(kind: Any) -> None:
    assert set(MODULES[kind].FAULTS.values()) == {check.name for check in checks_of(kind)}
