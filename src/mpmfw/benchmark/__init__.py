"""Cost of time steps: nanoseconds per material point by stage, and what several threads gain."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np

from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import STEP_STAGES, FloatArray

__all__ = ["measure_scene", "measure_threads"]

#: Steps before the first sample: kernels are compiled, windows laid, contact searched.
WARM_UP = 5
#: Steps of a sample, and between two turns with one thread and with several.
STEPS, TURN = 50, 20


def measure_scene(scene: Any, repeats: int = 10, *, start: int = WARM_UP) -> dict[str, Any]:
    """Cost of a scene's steps from its beginning on, after settling.

    Parameters
    ----------
    scene
        Name, file or table of a scene, as in :func:`mpmfw.load_scene`.
    repeats
        Samples, of :data:`STEPS` steps each.
    start
        Steps before the first sample, after which the bodies are in contact.

    Returns
    -------
    ``scene``, ``contact``, ``shape``, ``particles``; least CPU time over the samples [ns per point and step],
    ``ns_total``, and the stages of the method (``ns_contact``, …); ``ns_median`` of the totals. Output and
    surfaces tracked for the gap alone are left out.
    """
    simulation = Simulation(scene)
    simulation.advance(max(start, WARM_UP))
    particles, clock = simulation.state.particles, simulation.clock
    wall, cpu = np.zeros((repeats, len(STEP_STAGES))), np.zeros(repeats)
    for repeat in range(repeats):
        clock.restart()
        simulation.advance(STEPS)
        clock.flush()
        wall[repeat] = [clock.wall[stage] for stage in STEP_STAGES]
        cpu[repeat] = sum(clock.cpu[stage] for stage in STEP_STAGES)
    to_ns = 1e9 / (particles.count * STEPS)
    times = stage_times(wall, cpu) * to_ns
    return {
        **_methods(simulation),
        "particles": particles.count,
        **{f"ns_{stage}": float(time) for stage, time in zip(STEP_STAGES, times, strict=True)},
        "ns_total": float(cpu.min() * to_ns),
        "ns_median": float(np.median(cpu) * to_ns),
    }


def measure_threads(scene: Any, threads: int, repeats: int = 10, *, start: int = WARM_UP) -> dict[str, Any]:
    """Wall time of a scene's steps with one thread and with several, at least 2 ``threads``, in turns.

    Other parameters are those of :func:`measure_scene`. Return ``scene``, ``contact``, ``shape``,
    ``particles``, ``threads``; ``ns_one`` and ``ns_shared``, the least wall time of a step with one and with
    all threads [ns per point], and their ``ratio``. Outputs are left out."""
    both = [Simulation(scene, threads=each) for each in (1, threads)]
    for simulation in both:
        simulation.advance(max(start, WARM_UP))
    least = [math.inf, math.inf]
    for _ in range(repeats):
        for which, simulation in enumerate(both):
            for _ in range(TURN):
                begin = time.perf_counter()
                simulation.step()
                least[which] = min(least[which], time.perf_counter() - begin)
    count = both[0].state.particles.count
    return {
        **_methods(both[0]),
        "particles": count,
        "threads": threads,
        "ns_one": 1e9 * least[0] / count,
        "ns_shared": 1e9 * least[1] / count,
        "ratio": least[0] / least[1],
    }


def _methods(simulation: Simulation) -> dict[str, str]:
    contact = "none" if simulation.contact is None else simulation.contact.name
    return {"scene": simulation.scene.name, "contact": contact, "shape": simulation.shape.name}


def stage_times(wall: FloatArray, cpu: FloatArray) -> FloatArray:
    """Return the least CPU time of a sample, shared out by the stages' least wall times (n_stages,).

    The CPU timer is too slow for every stage. ``wall`` (n_samples, n_stages), ``cpu`` (n_samples,) [s].
    """
    least = wall.min(axis=0)
    times: FloatArray = least * (cpu.min() / least.sum())
    return times
