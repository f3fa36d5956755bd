"""Checkpoints: now and then the values of a run, in a file beside its results, from which a run that was killed goes on."""

from __future__ import annotations

import contextlib
import math
import os
import platform
import time
import warnings
from pathlib import Path
from typing import Any

from llvmlite.binding import get_host_cpu_name  # type: ignore[import-untyped]

from mpmfw.errors import MpmfwError, ResultsWarning
from mpmfw.identity import code_of
from mpmfw.interruption import Interruption
from mpmfw.results import RunWriter
from mpmfw.results.memory import peak_memory
from mpmfw.results.replacing import abandoned
from mpmfw.scene.scene import Scene, Source
from mpmfw.simulation import Simulation
from mpmfw.snapshot import write_snapshot

#: Seconds of wall time between two checkpoints.
EVERY = 600.0

#: Age of a run [s] from which it asks what code it runs, which takes the time of a few dozen small steps. Sources that are
#: edited later are another version.
ASKED_AFTER = 1.0


#: How a checkpoint begins, which is a zip archive.
_HEAD = b"PK\x03\x04"


def checkpoint_path(path: str | os.PathLike[str]) -> str:
    """File of the checkpoint of the run that writes ``path``."""
    return f"{os.fspath(path)}.checkpoint"


class Checkpoints:
    """Called after every step of a run: writes a checkpoint when it is time, or when a signal waits.

    Parameters
    ----------
    simulation, writer
        What runs, and what it writes; one in memory has no checkpoints.
    signals
        Those that stop the run: after a checkpoint.
    every
        Seconds of wall time between two; infinite for none at all.
    objects
        Strategy objects in place of the scene's methods, by kind.
    resumed
        Times at which the run was taken up again so far [s].
    """

    def __init__(
        self,
        simulation: Simulation,
        writer: RunWriter,
        signals: Interruption,
        every: float,
        objects: dict[str, Any],
        resumed: list[float],
    ) -> None:
        self.simulation, self.writer, self.signals = simulation, writer, signals
        self.path = None if writer.path is None else checkpoint_path(writer.path)
        self.every, self.objects, self.resumed = every, objects, resumed
        self._wanted = self.path is not None and every < math.inf
        self._code: dict[str, str] = {}
        self._next = time.monotonic() + every
        #: When there is something to do: to ask for the code, or to write.
        self._due = min(self._next, time.monotonic() + ASKED_AFTER) if self._wanted else math.inf

    def __call__(self) -> None:
        """A step is complete.

        Raises
        ------
        Interrupted
            A signal waited.
        """
        if self.signals.waiting is not None:
            self.write()
            self.signals.check()
        now = time.monotonic()
        if self.writer.is_due(now):  # the next output may be far away
            self.simulation.clock("output")
            self.signals.whole(self.writer.flush)()
        if now < self._due:
            return
        if now >= self._next:
            self.write()
        elif not self._code:
            self._ask_for_code()
        self._due = self._next

    def write(self) -> None:
        """Write one in place of the last; where that cannot be, a warning says so once and the run goes on without."""
        if self.path is None or not self._wanted:
            return
        if not self._code:
            self._ask_for_code()
        self.simulation.clock("output")
        try:
            self.writer.flush()
            # A kill within a sync can leave the results' file unreadable: HDF5 changes its tables in place
            write_snapshot(self.path, self.simulation.snapshot(), self._facts(), beside=self.writer.path)
        except MpmfwError as error:
            self._wanted = False
            warnings.warn(f"no checkpoints are written: {error}", ResultsWarning, stacklevel=2)
        self._next = time.monotonic() + self.every

    def forget(self) -> None:
        """Remove it, and what one that was cut short has left; a file that is called so and is none stays."""
        if self.path is not None and not is_foreign(self.path):
            for path in (self.path, *abandoned(self.path), *abandoned(str(self.writer.path))):
                with contextlib.suppress(OSError):
                    os.unlink(path)

    @property
    def written(self) -> bool:
        """Whether there is one."""
        return self.path is not None and os.path.isfile(self.path)

    def _ask_for_code(self) -> None:
        self.simulation.clock("output")
        self._code = dependencies_of(self.simulation.scene, self.objects)

    def _facts(self) -> dict[str, Any]:
        """What is to be known before the values are read."""
        state, source = self.simulation.state, self.simulation.scene.source
        return {
            "kind": "checkpoint",
            "made_by": self._code,
            "objects": {kind: method.label for kind, method in self.objects.items()},
            "scene": {
                "mapping": source.mapping,
                "text": source.text,
                "name": source.name,
                "directory": None if source.directory is None else os.path.abspath(source.directory),
                "overrides": dict(source.overrides),
            },
            "frames": self.writer.frames,
            "time": state.time,
            "resumed": self.resumed,
            "every": self.every,
            "peak_memory": peak_memory(),
        }


def is_foreign(path: str) -> bool:
    """Whether something is there that is no checkpoint, whatever it is called; an empty file is nothing."""
    try:
        if not os.path.isfile(path):
            return os.path.exists(path)
        if not os.path.getsize(path):
            return False
        with open(path, "rb") as file:
            return file.read(len(_HEAD)) != _HEAD
    except OSError:
        return True


def dependencies_of(scene: Scene, objects: dict[str, Any]) -> dict[str, str]:
    """What the bits of a run depend on beside the scene: code, libraries, interpreter and processor, by name."""
    code = code_of(scene, objects.get("contact"), objects.get("shape"))
    return {**code, "python": platform.python_version(), "processor": str(get_host_cpu_name())}


def source_of(facts: dict[str, Any]) -> Source:
    """Where the scene of a checkpoint came from."""
    scene = dict(facts["scene"])
    directory = scene.pop("directory")
    return Source(**scene, directory=None if directory is None else Path(directory))
