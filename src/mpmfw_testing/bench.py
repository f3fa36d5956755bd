"""Points and plug-ins that are set up by hand, and the memory that they keep."""

from __future__ import annotations

import gc
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np

from mpmfw.plugin.hooks import BoundHooks, make_manager
from mpmfw.plugin.setup import Setup
from mpmfw.state.clock import Clock
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Particles, State


def points_at_rest(position: FloatArray, volume: FloatArray, first: Any, stress: float = 0.0) -> Particles:
    """Return points of unit density with a ``stress`` [Pa] in all components.

    ``position`` is (n, dim) [m], ``volume`` (n,) [m^dim]; ``first`` begins the velocity fields, as in
    ``Particles``.
    """
    n, dim = position.shape
    tensor = (n, dim, dim)
    return Particles(
        position=position.copy(),
        velocity=np.zeros((n, dim)),
        mass=volume.copy(),
        initial_volume=volume.copy(),
        volume=volume.copy(),
        deformation_gradient=np.tile(np.eye(dim), (n, 1, 1)),
        velocity_gradient=np.zeros(tensor),
        stress=np.full(tensor, stress),
        affine=np.zeros(tensor),
        moment=None,
        first=np.asarray(first, dtype=np.int64),
    )


def set_up(plugin: Any, state: State, **facts: Any) -> tuple[Setup, BoundHooks]:
    """Set a plug-in up alone; ``facts`` replace or add to those of the setup. Return it and the hooks."""
    frequency = 2.0 * state.bodies[0].wave_speed / state.grid.cell_size
    setup = Setup(state=state, **{"bulk_frequency": frequency, **facts})
    manager = make_manager()
    manager.register(plugin)
    manager.check_pending()
    hook = BoundHooks(manager, Clock())
    hook.declare_fields()
    hook.setup(setup=setup)
    return setup, hook


def memory_kept(action: Callable[[], Any], times: int, warm: int = 0) -> FloatArray:
    """Return what Python holds [bytes] before an action and after each of so many, (times + 1,).

    Before that it is done ``warm`` times, while Python and NumPy fill their own caches.
    """
    held = np.zeros(times + 1)  # made before anything is counted
    tracemalloc.start()
    try:
        for k in range(-warm, times + 1):
            if k != 0:
                action()
            if k >= 0:
                gc.collect()  # what is waiting to be collected is not kept
                held[k] = tracemalloc.get_traced_memory()[0]
    finally:
        tracemalloc.stop()
    return held
