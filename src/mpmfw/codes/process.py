"""Run another code's process: without a shell, within limits, in a folder of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from mpmfw.codes.outputs import RunCost
from mpmfw.errors import MpmfwError

#: Variables that keep a code to one thread.
_ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA")}


@dataclass(frozen=True)
class ProcessLimits:
    """What a process may take."""

    seconds: float = 3600.0  #: of wall time
    memory: int = 16 * 2**30  #: private memory [B]; on Linux alone


def run_process(command: Sequence[str], folder: Path, log: Path, limits: ProcessLimits) -> RunCost:
    """Run a command to its end and return its cost; raise MpmfwError if it fails or passes a limit.

    Its output goes to the file ``log``. An interruption kills it and all processes that it started."""
    program, begin, passed = Path(command[0]).name, time.monotonic(), threading.Event()
    with log.open("wb") as output:
        try:
            process = subprocess.Popen(
                list(command),
                cwd=folder,
                env={**os.environ, **_ONE_THREAD},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        except OSError as error:
            raise MpmfwError(f"{command[0]} cannot be started: {error.strerror or error}") from error

        def stop() -> None:
            passed.set()
            _kill(process)

        timer = threading.Timer(limits.seconds, stop)
        timer.daemon = True
        timer.start()
        try:
            _limit_memory(process.pid, limits.memory)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        finally:
            timer.cancel()
            if process.returncode is None:
                _kill(process)
                process.wait()
    if passed.is_set():
        raise MpmfwError(f"{program} was stopped after {limits.seconds:g} s, its limit")
    if process.returncode != 0:
        lines = log.read_text(encoding="utf-8", errors="replace").split("\n")
        last = next((line.strip() for line in reversed(lines) if line.strip()), "it printed nothing")
        raise MpmfwError(f"{program} ended with status {process.returncode}: {last[:300]}")
    cpu = usage.ru_utime + usage.ru_stime
    return RunCost(cpu, time.monotonic() - begin, 1024.0 * usage.ru_maxrss)


def _limit_memory(pid: int, memory: int) -> None:
    with suppress(ImportError, AttributeError, OSError):  # another system, or it has ended
        import resource

        resource.prlimit(pid, resource.RLIMIT_DATA, (memory, memory))


def _kill(process: subprocess.Popen[bytes]) -> None:
    with suppress(OSError):
        os.killpg(process.pid, signal.SIGKILL)
