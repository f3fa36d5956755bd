"""Time of a scene's own simulation."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.benchmark.sampling import quartiles, stage_times
from mpmfw.clock import STEP_STAGES
from mpmfw.simulation import Simulation

#: Steps before the first sample: kernels are compiled, windows laid, contact searched.
WARM_UP = 5


def measure_scene(
    scene: Any,
    repeats: int = 10,
    *,
    steps: int = 50,
    start: int = WARM_UP,
    contact: str | None = None,
    shape: str | None = None,
) -> dict[str, Any]:
    """Cost of a scene's steps from its beginning on, after settling.

    Parameters
    ----------
    scene
        Name, file or table of a scene, as in :func:`mpmfw.load_scene`.
    repeats
        Samples.
    steps
        Steps of a sample.
    start
        Steps before the first sample, so that the bodies are in contact where the scene takes its time.
    contact, shape
        Names of plug-ins in place of the scene's.

    Returns
    -------
    ``scene``, ``contact``, ``shape``, ``dim``, ``particles``; least CPU time over the samples [ns per point
    and step], ``ns_total``, and the stages of the method (``ns_contact``, …); ``ns_median`` of the totals and
    their quartiles ``ns_low`` and ``ns_high``. Output and surfaces tracked for the gap alone are left out.
    """
    simulation = Simulation(scene, contact=contact, shape=shape)
    simulation.advance(max(start, WARM_UP))
    particles, clock = simulation.state.particles, simulation.clock
    wall, cpu = np.zeros((repeats, len(STEP_STAGES))), np.zeros(repeats)
    for repeat in range(repeats):
        clock.restart()
        simulation.advance(steps)
        clock.flush()
        wall[repeat] = [clock.wall[stage] for stage in STEP_STAGES]
        cpu[repeat] = sum(clock.cpu[stage] for stage in STEP_STAGES)
    to_ns = 1e9 / (particles.count * steps)
    low, median, high = quartiles(cpu * to_ns)
    times = stage_times(wall, cpu) * to_ns
    return {
        "scene": simulation.scene.name,
        "contact": "none" if simulation.contact is None else simulation.contact.name,
        "shape": simulation.shape.name,
        "dim": particles.dim,
        "particles": particles.count,
        **{f"ns_{stage}": float(time) for stage, time in zip(STEP_STAGES, times, strict=True)},
        "ns_total": float(cpu.min() * to_ns),
        "ns_median": median,
        "ns_low": low,
        "ns_high": high,
    }
