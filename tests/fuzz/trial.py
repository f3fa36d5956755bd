"""One mutant through load, plan, build and three steps, and what came of it."""

from __future__ import annotations

import time
import traceback
import tracemalloc
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from mutants import Mutant

from mpmfw.errors import MpmfwError, SceneError, SimulationError
from mpmfw.results import Frame
from mpmfw.runs import sizing
from mpmfw.runs.limits import check_length
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene

#: Memory that a mutant may have [bytes]: those that need more must be refused before they have it.
MEMORY = 3e7

#: What a run takes whatever its scene: code, options, figures of the fields [bytes].
BESIDE = 2e7

#: Seconds after which a trial counts as one that hangs.
HANGS = 60.0

STEPS = 3


@dataclass(frozen=True)
class Trial:
    """What came of one mutant.

    Attributes
    ----------
    outcome
        ``ok``, ``refused``, ``failed`` (with an error that says so), or ``wrong``.
    said
        The message, or what is wrong.
    seconds
        Wall time [s].
    """

    outcome: str
    said: str
    seconds: float


def attempt(mutant: Mutant, folder: Path, *, memory: bool = False) -> Trial:
    """Try a mutant; ``memory`` measures what it allocates, at twice the time.

    Parameters
    ----------
    folder
        Where it is written; nothing else may appear there.
    """
    path = folder / "mutant.toml"
    path.write_text(mutant.text, encoding="utf-8", newline="")
    start = time.perf_counter()
    outcome, said = _guarded(lambda: _go(path, memory))
    seconds = time.perf_counter() - start
    if outcome != "wrong" and seconds > HANGS:
        outcome, said = "wrong", f"took {seconds:.0f} s"
    if strange := [entry.name for entry in folder.iterdir() if entry != path]:
        outcome, said = "wrong", f"wrote {strange}"
    return Trial(outcome, said, seconds)


def _guarded(go: Callable[[], tuple[str, str]]) -> tuple[str, str]:
    """The outcome; anything but an error of mpmfw's own is wrong, and so is a message of several thousand
    characters.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.filterwarnings("ignore", category=UserWarning, module="mpmfw")
            from mpmfw.errors import ResultsWarning

            warnings.filterwarnings("ignore", category=ResultsWarning)
            outcome, said = go()
    except SceneError as error:
        outcome, said = "refused", str(error)
    except MpmfwError as error:
        outcome, said = "failed", str(error)
    except BaseException:
        return "wrong", traceback.format_exc()
    if not said.isprintable() and "\0" in said:
        return "wrong", f"the message holds NUL: {said!r}"
    return (
        ("wrong", f"a message of {len(said)} characters: {said[:300]}")
        if len(said) > 5000
        else (outcome, said)
    )


def _go(path: Path, memory: bool) -> tuple[str, str]:
    scene = load_scene(path)
    with mock.patch.object(sizing, "memory_limit", return_value=MEMORY):
        if memory:
            tracemalloc.start()
        try:
            said = _run(scene)
            peak = tracemalloc.get_traced_memory()[1] if memory else 0.0
        finally:
            if memory:
                tracemalloc.stop()
    allowed = sizing.most_memory(scene) + BESIDE
    if peak > allowed:
        return "wrong", f"took {peak:.3g} bytes, {allowed:.3g} were announced"
    return said


def _run(scene: Any) -> tuple[str, str]:
    simulation = Simulation(scene)
    check_length(simulation)
    frames: list[Frame] = []
    simulation.advance(STEPS, frames.append)
    bad = [name for frame in frames for name in not_finite(frame)]
    if bad:
        return "wrong", f"ok, with values that are not finite in {', '.join(sorted(set(bad)))}"
    return "ok", ""


def not_finite(frame: Frame) -> list[str]:
    """Names of the arrays of a frame that hold NaN or inf where they are never meant to."""
    groups = [frame.particles, frame.surface, frame.series]
    meant = {"time_step", "steps_per_contact"}  # no step before the first frame, no contact that ended
    return [
        name
        for arrays in groups
        for name, values in arrays.items()
        if name not in meant and not np.isfinite(values).all()
    ]


__all__ = ["SimulationError", "Trial", "attempt", "not_finite"]
