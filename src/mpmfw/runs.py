"""Run one scene and keep its results."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from mpmfw.errors import ResultsWarning, SceneError, SimulationError
from mpmfw.limits import check_length, remark_on_size
from mpmfw.results import RunWriter
from mpmfw.results.memory import peak_memory, restart_peak_memory
from mpmfw.scene import load_scene, located
from mpmfw.simulation import Simulation, chosen_methods

if TYPE_CHECKING:
    import xarray as xr


def run(
    scene: Any,
    contact: Any = None,
    shape: Any = None,
    output: str | os.PathLike[str] | None = None,
    progress: Callable[[float, int], None] | None = None,
    set: Mapping[str, Any] | None = None,
    force: bool = False,
) -> xr.DataTree:
    """Run a scene.

    Parameters
    ----------
    scene
        A TOML file, the name of a shipped scene, nested mappings, or a :class:`mpmfw.scene.Scene`.
    contact, shape
        A plug-in's name or a configured strategy object, in place of the scene's.
    output
        NetCDF file to write, frame by frame; None keeps the results in memory.
    progress
        Called now and then with the simulated time [s] and the number of steps.
    set
        Values by dotted key, set over the scene's own.
    force
        Begin a run that has more steps or frames than the limits in :mod:`mpmfw.limits`.

    Returns
    -------
    The results: groups ``series``, ``particles/<body>``, ``surface/<body>``; costs as root attributes.

    Raises
    ------
    SceneError
        The request was wrong.
    SimulationError
        The run failed; what it reached is in the file, and in the error's attribute ``results``.
    """
    restart_peak_memory()
    loaded = load_scene(scene, set={**chosen_methods(contact, shape), **(set or {})})
    try:
        simulation = Simulation(loaded, contact=contact, shape=shape)
        if not force:
            check_length(simulation)
    except SceneError as error:
        raise located(error, loaded) from error
    header = simulation.header()
    if output is not None and (said := remark_on_size(simulation, header)):
        warnings.warn(said, ResultsWarning, stacklevel=2)
    with RunWriter(output, header) as writer:
        try:
            simulation.run(writer.write, progress)
        except SimulationError as error:
            writer.finish(_end(simulation, f"failed: {error}"))
            error.results = writer.results()
            raise
        writer.finish(_end(simulation, "ok"))
        for concern in simulation.concerns():
            warnings.warn(concern, ResultsWarning, stacklevel=2)
        return writer.results()


def _end(simulation: Simulation, status: str) -> dict[str, Any]:
    """The attributes that are known at the end."""
    remarks = {name: json.dumps(said) for name, said in simulation.remarks().items() if said}
    return {**simulation.costs(), **remarks, "peak_memory": peak_memory(), "status": status}
