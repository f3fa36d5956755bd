"""The machine that costs were measured on: its processor, and how busy others kept it."""

from __future__ import annotations

import functools
import os
import platform
import time
from pathlib import Path

#: Cores that others may keep busy before a machine counts as loaded: daemons take a few hundredths of one.
LOADED = 0.2


@functools.cache
def processor() -> str:
    """Model of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    named = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(named, platform.processor() or platform.machine())


class Load:
    """Measures, from when it is made, how many cores other processes keep busy."""

    def __init__(self) -> None:
        self._busy, self._own, self._wall = _busy(), _own(), time.perf_counter()

    def others(self) -> float:
        """Cores that other processes kept busy since then, in the mean; NaN where the system does not say
        it.
        """
        wall = time.perf_counter() - self._wall
        busy = _busy() - self._busy - (_own() - self._own)
        # The system counts in hundredths of a second: of shorter spans it says nothing
        return max(0.0, busy / wall) if wall > 0.1 else float("nan")


def _own() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def _busy() -> float:
    """CPU seconds that all processes of the machine have taken since it was started."""
    try:
        first = Path("/proc/stat").read_text(encoding="utf-8").splitlines()[0].split()
    except (OSError, IndexError):
        return float("nan")
    user, nice, system, _, _, irq, softirq = (float(part) for part in first[1:8])
    return (user + nice + system + irq + softirq) / os.sysconf("SC_CLK_TCK")
