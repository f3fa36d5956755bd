"""The stage clock, with a clock of the test's own."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from mpmfw.state import clock as module
from mpmfw.state.clock import Clock


@pytest.fixture
def now(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """Wall and CPU seconds that the test sets."""
    now = SimpleNamespace(wall=100.0, cpu=10.0)
    fake = SimpleNamespace(perf_counter=lambda: now.wall, process_time=lambda: now.cpu)
    monkeypatch.setattr(module, "time", fake)
    return now


def test_cpu_time_is_shared_out_by_wall_time(now: SimpleNamespace) -> None:
    clock = Clock()
    clock("shape")
    now.wall += 1.0
    clock("force")
    now.wall, now.cpu = now.wall + 3.0, now.cpu + 8.0
    clock.flush()
    assert (clock.cpu["shape"], clock.cpu["force"]) == (2.0, 6.0)


def test_excluded_seconds_count_nowhere(now: SimpleNamespace) -> None:
    clock = Clock()
    clock("shape")
    now.wall, now.cpu = now.wall + 10.0, now.cpu + 10.0
    clock.exclude(9.0, 9.0)
    clock.flush()
    assert (sum(clock.wall.values()), sum(clock.cpu.values())) == (1.0, 1.0)
