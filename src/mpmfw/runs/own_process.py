"""One run in a process of its own: a segmentation fault, a hang or an exit there ends nothing here."""

from __future__ import annotations

import base64
import json
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

from mpmfw.errors import MpmfwError, ResultsWarning, SceneError, SimulationError
from mpmfw.results.reading import read_run
from mpmfw.runs.interruption import interruptible

if TYPE_CHECKING:
    import xarray as xr

#: Seconds without a sign of life after which a run is taken to hang: the first steps, which compile kernels, included.
PATIENCE = 600.0

#: Not ``multiprocessing``, whose processes import the program's main module again: a script without a guard would start
#: its comparison once more in each of them.
_COMMAND = "from mpmfw.runs.own_process import answer_request; answer_request()"


def run_in_own_process(
    scene: Any,
    output: str | os.PathLike[str] | None = None,
    progress: Callable[[float, int], None] | None = None,
    patience: float | None = None,
    **request: Any,
) -> xr.DataTree:
    """Run a scene as :func:`mpmfw.run` does, in a process that is started for it.

    Parameters
    ----------
    scene, output, progress
        As there.
    patience
        Seconds that may pass between two reports of progress; None is :data:`PATIENCE`.
    request
        The other arguments; plug-ins by name.

    Returns
    -------
    The results.

    Raises
    ------
    SceneError
        The request was wrong.
    SimulationError
        The run failed, or its process died or hung; what it reached is in the error's attribute ``results``.
    MpmfwError
        The results could not be written.
    """
    with tempfile.TemporaryDirectory(prefix="mpmfw-") as folder:
        path = os.path.join(folder, "run.nc") if output is None else os.path.abspath(output)
        request = {"path": sys.path, "arguments": {"scene": scene, "output": path, **request}}
        with interruptible():
            end = _follow(request, progress, PATIENCE if patience is None else patience)
        for text in end.get("notes", ()):
            warnings.warn(text, ResultsWarning, stacklevel=3)
        if "error" not in end:
            return read_run(path)
        kinds = {"SceneError": SceneError, "SimulationError": SimulationError, "MpmfwError": MpmfwError}
        error: MpmfwError = kinds[end["kind"]](end["error"])
        if isinstance(error, SimulationError):
            error.results = _reached(path)
        raise error


def _reached(path: str) -> xr.DataTree | None:
    """What a run that failed has written, or None."""
    try:
        return read_run(path) if Path(path).is_file() else None
    except MpmfwError:
        return None


def _follow(
    request: Mapping[str, Any], progress: Callable[[float, int], None] | None, patience: float
) -> dict[str, Any]:
    """Start the process, hand on its progress, and return how it ended."""
    with subprocess.Popen(
        [sys.executable, "-c", _COMMAND], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        lines: SimpleQueue[str] = SimpleQueue()
        stream = process.stdout

        def listen() -> None:
            for line in stream:
                lines.put(line.decode())
            lines.put("")

        threading.Thread(target=listen, daemon=True).start()
        try:
            process.stdin.write(base64.b64encode(pickle.dumps(request)))
            process.stdin.close()
            while line := lines.get(timeout=patience):
                text: dict[str, Any] = json.loads(line)
                if "steps" not in text:
                    return text
                if progress is not None:
                    progress(text["time"], text["steps"])
            return _failed(f"its process ended: {_how(process.wait())}")
        except Empty:
            return _failed(f"its process did nothing for {patience:g} s, and was ended")
        except BrokenPipeError:
            return _failed(f"its process ended: {_how(process.wait())}")
        finally:
            process.kill()


def _failed(said: str) -> dict[str, Any]:
    return {"kind": "SimulationError", "error": said}


def _how(status: int) -> str:
    """``SIGSEGV`` of a negative exit status."""
    return signal.Signals(-status).name if status < 0 else f"exit status {status}"


def answer_request() -> None:
    """What the process does: read the request, run it, and say on its first standard output how it went."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what plug-ins print is no answer
    request = pickle.loads(base64.b64decode(sys.stdin.buffer.read()))
    sys.path[:] = request["path"]

    def say(**said: Any) -> None:
        answers.write(json.dumps(said) + "\n")
        answers.flush()

    from mpmfw.runs.run import run

    say(time=0.0, steps=0)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("ignore")
        warnings.filterwarnings("always", category=ResultsWarning)
        said: dict[str, Any] = {}
        try:
            run(**request["arguments"], progress=lambda time, steps: say(time=time, steps=steps))
        except MpmfwError as error:
            kinds = (SceneError, SimulationError, MpmfwError)
            kind = next(each.__name__ for each in kinds if isinstance(error, each))
            said = {"kind": kind, "error": str(error)}
        except Exception as error:
            said = _failed(f"{type(error).__name__}: {error}")
    say(**said, notes=[str(warning.message) for warning in caught])
