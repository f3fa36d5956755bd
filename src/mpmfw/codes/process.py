"""Run another code's process: without a shell, within limits, in its folder."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from mpmfw.codes.outputs import RunCost, printable
from mpmfw.errors import MpmfwError

#: Variables that keep a code to one thread.
_ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA")}

#: Largest output that is written and read [B].
LARGEST = 2 * 2**30

#: Bytes of the begin and the end of a log that are read.
_END = 2**16

#: Starts a program on Linux: it ends with its parent, and has limits of memory and of the size of a file.
_START = """
import ctypes, os, resource, signal, sys
parent, memory, file, *command = sys.argv[1:]
ctypes.CDLL(None).prctl(1, signal.SIGKILL)
if os.getppid() != int(parent):
    sys.exit("its parent has ended")
for kind, most in ((resource.RLIMIT_DATA, int(memory)), (resource.RLIMIT_FSIZE, int(file))):
    hard = resource.getrlimit(kind)[1]
    resource.setrlimit(kind, (most if hard < 0 else min(most, hard),) * 2)
signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
signal.signal(signal.SIGPIPE, signal.SIG_DFL)
try:
    os.execvp(command[0], command)
except OSError as error:
    sys.exit(f"{command[0]} cannot be started: {error.strerror}")
"""


@dataclass(frozen=True)
class ProcessLimits:
    """Time and memory that a process may take."""

    seconds: float = 3600.0  #: of wall time
    memory: int = 16 * 2**30  #: private memory [B]; on Linux alone
    file: int = LARGEST  #: of one file that it writes [B]; on Linux alone


def run_process(command: Sequence[str], folder: Path, log: Path, limits: ProcessLimits) -> RunCost:
    """Run a command to its end and return its cost; raise MpmfwError if it fails or passes a limit.

    Its output goes to the file ``log``. An interruption or the limit of time kills it and all processes that
    it started. If this process is killed, the command ends on Linux; processes that it started may not."""
    program, begin, passed = Path(command[0]).name, time.monotonic(), threading.Event()
    with log.open("wb") as output:
        try:
            process = subprocess.Popen(
                _start(command, limits),
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
        lines = map(printable, reversed(read_log(log).split("\n")))
        last = next(filter(None, lines), "it printed nothing")
        raise MpmfwError(f"{program} ended with status {process.returncode}: {last[:300]}")
    cpu = usage.ru_utime + usage.ru_stime
    return RunCost(cpu, time.monotonic() - begin, 1024.0 * usage.ru_maxrss)


def _start(command: Sequence[str], limits: ProcessLimits) -> list[str]:
    if sys.platform != "linux":
        return list(command)
    given = (os.getpid(), limits.memory, limits.file, *command)
    return [sys.executable, "-I", "-S", "-c", _START, *map(str, given)]


def read_log(path: Path) -> str:
    """Return a log, of a long one the first and the last 64 kB."""
    with path.open("rb") as file:
        begin = file.read(_END)
        file.seek(max(_END, path.stat().st_size - _END))
        return (begin + file.read()).decode("utf-8", errors="replace")


def _kill(process: subprocess.Popen[bytes]) -> None:
    with suppress(OSError):
        os.killpg(process.pid, signal.SIGKILL)
