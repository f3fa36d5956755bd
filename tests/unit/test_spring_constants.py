"""What each constant of springs that change is for: which way the spring fails without it."""

from __future__ import annotations

import pytest

from mpmfw_contact import _springs

CELL = 0.1  # m
REST = 1e-3 * CELL  #: a depth at which bodies lie at rest [m]


def changed(part: float, old_part: float, rest: float, gap: float) -> tuple[float, float]:
    """Share and rest by the function as Python runs it, with the constants of this moment."""
    return _springs.changed_spring.py_func(part, old_part, rest, 0.0, gap, CELL)


def held_after(flickers: int) -> float:
    """Part of its force that a spring at rest still has when its share went up and down by 1 % so often."""
    share, rest = 0.5, 0.0
    for number in range(flickers):
        share, rest = changed(0.5 * (1.0 + 0.01 * (-1) ** number), share, rest, -REST)
    return share * (rest + REST) / (0.5 * REST)


def test_without_the_allowance_for_noise_a_spring_at_rest_lets_go(monkeypatch):
    assert held_after(500) == pytest.approx(1.0, abs=0.02)
    monkeypatch.setattr(_springs, "NOISE", 0.0)
    assert held_after(500) < 0.01


def force_of_a_node_from_the_side(depth: float) -> float:
    """Of one with a twentieth of its share by the side, when a face takes it: over the force of all of its share."""
    share, rest = changed(1.0, 0.05, 0.0, -depth)
    return share * (rest + depth) / depth


@pytest.mark.parametrize(("constant", "without"), [("WEAK", 0.0), ("SHALLOW", 0.0)])
def test_without_the_exception_a_node_from_the_side_bears_next_to_nothing(monkeypatch, constant, without):
    """Under the face it then has half of its length: the corner's slope was 6 % too small."""
    assert force_of_a_node_from_the_side(REST) == pytest.approx(0.5)
    monkeypatch.setattr(_springs, constant, without)
    assert force_of_a_node_from_the_side(REST) == pytest.approx(0.05)


def energy_from_nothing(old_part: float, depth: float) -> float:
    """What a node gains whose whole share a face takes, over the energy of all of its share, if it gains."""
    share, rest = changed(1.0, old_part, 0.0, -depth)
    return share * ((rest + depth) / depth) ** 2 - old_part


def test_with_a_wider_exception_nodes_gain_energy(monkeypatch):
    """Deep ones, as in 3 of 200 random impacts at twice the depth, and those that had a share to keep."""
    assert energy_from_nothing(0.05, 1.5 * 0.01 * CELL) < 0.0
    assert energy_from_nothing(0.2, REST) < 0.0
    monkeypatch.setattr(_springs, "SHALLOW", 0.02)
    assert energy_from_nothing(0.05, 1.5 * 0.01 * CELL) > 0.1
    monkeypatch.setattr(_springs, "WEAK", 0.3)
    assert energy_from_nothing(0.2, REST) > 0.04
