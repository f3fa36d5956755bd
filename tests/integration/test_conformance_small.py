"""The conformance kit on what is small: sound ones pass, planted faults are caught."""

from __future__ import annotations

from typing import Any

import pytest

from faulty_plugins.small import friction, geometry, other_kinds
from mpmfw.campaigns.measures import MEASURES
from mpmfw_testing import examine, subject_of
from mpmfw_testing.parametrised import checks_of

MODULES: dict[Any, Any] = {"friction": friction, "geometry": geometry}
OTHERS: Any = other_kinds.KINDS
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
        ("friction", friction.OneNumberNeedsAnother),
        ("friction", "coulomb"),
        ("friction", "stribeck(velocity=0.5)"),
        ("friction", "mohr_coulomb(cohesion=10)"),
        ("geometry", geometry.SoundSolid),
        ("geometry", "disc(centre=[0, 0], radius=1)"),
        ("geometry", "ring(centre=[0.3, 0.2], inner_radius=0.5, outer_radius=0.8)"),
        ("geometry", "rectangle(lower=[0, 0], upper=[1, 0.4], angle=0.3)"),
        ("geometry", "polygon(points=[[0, 0], [2, 0], [1, 1], [1, 2]])"),
        ("geometry", "box(lower=[0, 0, 0], upper=[1, 2, 1])"),
        ("geometry", "ball(centre=[0, 0, 0], radius=1)"),
        ("geometry", "cylinder(centre=[0, 0, 0], radius=1, length=2)"),
        ("geometry", "torus(centre=[0, 0, 0], radius=1, tube_radius=0.3)"),
        *((kind, sound) for kind, (sound, _) in OTHERS.items()),
        *(("measure", name) for name in MEASURES),
    ],
)
def test_sound_ones_pass(kind: Any, plugin: Any) -> None:
    outcomes = examine(subject_of(plugin, kind), checks_of(kind))
    assert [outcome.report for outcome in outcomes if outcome.wrong] == []


@pytest.mark.parametrize("kind", MODULES)
def test_every_check_has_a_fault_planted_for_it(kind: Any) -> None:
    assert set(MODULES[kind].FAULTS.values()) == {check.name for check in checks_of(kind)}


@pytest.mark.parametrize("kind", OTHERS)
def test_random_values_are_caught_in_kinds_with_the_generic_check(kind: Any) -> None:
    outcomes = examine(subject_of(OTHERS[kind][1], kind), checks_of(kind))
    assert [outcome.check for outcome in outcomes if outcome.wrong] == ["repeatable"]
