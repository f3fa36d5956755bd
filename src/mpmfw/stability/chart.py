"""The map of stability: stiffness of the contact, or of the bodies, against the time step."""

from __future__ import annotations

import copy
import functools
import itertools
import math
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Unpack

import numpy as np
import xarray as xr

from mpmfw._version import __version__
from mpmfw.campaigns.grid import Combination, Index, RunGrid, make_grid
from mpmfw.campaigns.grid_runs import GridRuns
from mpmfw.campaigns.running import Execution, Running
from mpmfw.errors import ResultsWarning, SceneError
from mpmfw.plugin.discovery import load
from mpmfw.results.replacing import check_replaceable, replace_dataset
from mpmfw.runs.build import chosen_methods
from mpmfw.runs.identity import package
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import Scene, load_scene, located
from mpmfw.scene.specification import specification_of
from mpmfw.stability.invariants import Invariants, probe_once
from mpmfw.stability.request import Axis, axis_of, check_overrides, check_values, stiffness_ratio
from mpmfw.state.fields import FloatArray

#: Classes of a point, by number; the bounds are those of the largest energy ratio.
CLASSES = ("no contact", "stable", "bounded", "diverged")
STABLE, BOUNDED = 1.005, 1.05

KAPPA = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
#: Past the limit of every stiffness: without contact it is 1.
CFL = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2)
STEPS = 300


class Request(Running, total=False):
    """Keywords of :func:`stability_map` beside those of its points."""

    output: str | os.PathLike[str] | None
    set: Mapping[str, Any] | None


def stability_map(
    scene: Any,
    contact: Any = None,
    shape: Any = None,
    *,
    kappa: Sequence[float] | None = None,
    ratio: Sequence[float] | None = None,
    cfl: Sequence[float] = CFL,
    steps: int = STEPS,
    **request: Unpack[Request],
) -> xr.Dataset:
    """Run a scene at many stiffnesses and fixed steps, past the limit too, and class every run.

    Parameters
    ----------
    scene
        What ``mpmfw.run`` takes; its bodies must meet within ``steps`` steps.
    contact, shape
        Names of plug-ins or configured strategy objects, instead of the scene's.
    kappa
        Stiffness factors of a contact that has this option; :data:`KAPPA` unless ``ratio`` is given.
    ratio
        Stiffnesses M = K + 4 G / 3 of the second body over that of the first, instead.
    cfl
        Courant numbers c Δt / h of the fastest body.
    steps
        Steps of every run.
    **request
        ``output``: NetCDF file to write, beside the folder ``<output>.runs``. ``set``: values by dotted key.
        Others are those of :class:`mpmfw.campaigns.running.Execution`.

    Returns
    -------
    Dataset
        By (kappa or ratio, cfl): ``class`` (index into the attribute ``classes``), ``energy`` (largest energy
        plus dissipation over that of the start), ``steps_per_contact``, ``steps``. By kappa or ratio:
        ``limit`` (Courant number of the least limit met at the smallest step) and ``closed_form`` (of two
        bodies in line, 2 / √(ω_bulk² + ω²)). Attribute ``courant``: of the shape function, past which a run
        is refused.

    Raises
    ------
    SceneError
        The scene or a value is wrong.
    """
    output, changes = request.pop("output", None), request.pop("set", None)
    execution = Execution(**request)  # type: ignore[misc]
    loaded = load_scene(scene, set={**(changes or {}), **chosen_methods(contact, shape)})
    chosen = {"contact": contact, "shape": shape}
    objects = {kind: one for kind, one in chosen.items() if one is not None and not isinstance(one, str)}
    axis = axis_of(loaded, objects.get("contact"), kappa, ratio)
    values: Sequence[float] = (KAPPA if kappa is None else kappa) if ratio is None else ratio
    check_values(values, cfl, steps)
    check_overrides(loaded, axis)
    if output is not None:
        check_replaceable(output, "stability")
    points = _points(loaded, objects, axis, values)
    ticks, closed = np.array([_theory(point) for point in points]).T
    grid = _grid(points, ticks, axis, values, cfl, steps)
    runs = GridRuns(grid, "map of stability", execution, output=output)
    runs.do(functools.partial(probe_once, steps=steps))
    found = {index: _invariants(runs, index) for index in grid.combinations}
    least = int(np.argmin(cfl))
    limits = np.array([found[i, least].limit for i in range(len(values))]) / ticks
    dataset = _dataset(grid, found, {"limit": limits, "closed_form": closed})
    dataset.attrs = _attributes(loaded, objects, steps, axis)
    if output is not None:
        replace_dataset(dataset, output)
    return dataset


def _points(
    scene: Scene, objects: Mapping[str, Any], axis: Axis, values: Sequence[float]
) -> list[Combination]:
    time = {"end": scene.time.end, "output_interval": scene.time.output_interval}
    base = scene.with_overrides({"allow_unstable": True, "time": time})
    vary: dict[str, list[Any]] = {kind: [one] for kind, one in objects.items()}
    scenes = {"": base}
    if axis == "kappa":
        vary["kappa"] = [*values]
    else:
        scenes = {str(value): base.with_overrides(stiffness_ratio(base, value)) for value in values}
    points = list(make_grid(scenes, vary, {}).combinations.values())
    refused = next((point for point in points if point.scene is None), None)
    if refused is not None:
        raise SceneError(problems=refused.problems)
    return points


def _grid(
    points: Sequence[Combination],
    ticks: FloatArray,
    axis: Axis,
    values: Sequence[float],
    cfl: Sequence[float],
    steps: int,
) -> RunGrid:
    what = f"{steps} steps judged by {package('mpmfw.stability')}"
    combinations: dict[Index, Combination] = {}
    for (i, value), (j, courant) in itertools.product(enumerate(values), enumerate(cfl)):
        scene = points[i].scene
        assert scene is not None
        fixed = scene.with_overrides({"time.step": courant * float(ticks[i])})
        labels = {axis: f"{value:g}", "cfl": f"{courant:g}"}
        combinations[i, j] = replace(points[i], labels=labels, scene=fixed, what=what)
    coords, keys = {axis: [*values], "cfl": [*cfl]}, {axis: axis, "cfl": "time.step"}
    return RunGrid({"": points[0].scene}, coords, keys, combinations)


def _invariants(runs: GridRuns, index: Index) -> Invariants:
    """Return the invariants of a run, with a warning if it is suspect or broken."""
    outcome = runs.outcome(index)
    values = outcome.values if outcome is not None else {}
    found = Invariants(**values) if values else Invariants("broken", runs.statuses()[index])
    if found.status == "refused":
        raise SceneError(found.message)
    if found.status == "broken" or (found.status == "suspect" and found.energy <= STABLE):
        warnings.warn(f"{runs.grid.combinations[index].name}: {found.message}", ResultsWarning, stacklevel=3)
    return found


def _theory(point: Combination) -> tuple[float, float]:
    """Return h / c of the fastest body [s], and the closed form."""
    assert point.scene is not None
    try:
        contact, shape = copy.deepcopy(point.contact), copy.deepcopy(point.shape)
        simulation = Simulation(point.scene, contact=contact, shape=shape)
    except SceneError as error:
        raise located(error, point.scene) from error
    bulk, bodies = simulation.limits()[0][0], simulation.state.bodies
    named = getattr(getattr(simulation.contact, "options", None), "kappa", 0.0)
    kappa = getattr(simulation.contact, "kappa", named)
    # ω² = 2 κ M (1/ρ_1 + 1/ρ_2) / h², ω_bulk = 2 c / h
    first, second = bodies[0], bodies[min(1, len(bodies) - 1)]
    modulus = min(first.p_wave_modulus, second.p_wave_modulus)
    softness = 0.5 * modulus * (1.0 / first.density + 1.0 / second.density)
    fastest = simulation.state.grid.cell_size / bulk
    return bulk, 1.0 / math.sqrt(1.0 + kappa * softness / fastest**2)


#: Variables and coordinates: what they mean. All are numbers without a unit.
_MEANINGS = {
    "kappa": "stiffness factor of the contact springs",
    "ratio": "stiffness of the second body over that of the first",
    "cfl": "Courant number of the fixed step",
    "class": "index into the attribute classes; -1 of a run that died",
    "energy": "largest energy plus dissipation over the energy at the start",
    "steps_per_contact": "fewest steps that a contact lasted",
    "steps": "steps that were run",
    "limit": "Courant number of the least limit met at the smallest step (Gershgorin's bound)",
    "closed_form": "Courant number of the closed form of two bodies in line",
}


def classed(found: Invariants) -> int:
    """Return the index into :data:`CLASSES` of a run, −1 of a broken one."""
    if found.status == "broken":
        return -1
    if found.status == "failed" or not found.energy <= BOUNDED:
        return 3
    if not found.touched:
        return 0
    return 1 if found.energy <= STABLE and found.status != "suspect" else 2


def _dataset(grid: RunGrid, found: Mapping[Index, Invariants], lines: Mapping[str, FloatArray]) -> xr.Dataset:
    picks: dict[str, tuple[Callable[[Invariants], float], type]] = {
        "class": (classed, int),
        "energy": (lambda one: one.energy, float),
        "steps_per_contact": (lambda one: one.contact_steps, float),
        "steps": (lambda one: one.steps, int),
    }
    tables: dict[str, Any] = {
        name: grid.array({index: pick(one) for index, one in found.items()}, "").astype(kind)
        for name, (pick, kind) in picks.items()
    }
    along = next(iter(grid.coords))
    dataset = xr.Dataset({**tables, **{name: (along, line) for name, line in lines.items()}}, grid.coords)
    for name in dataset.variables:
        dataset[name].attrs = {"units": "1", "long_name": _MEANINGS[str(name)]}
    return dataset


def _attributes(scene: Scene, objects: Mapping[str, Any], steps: int, axis: str) -> dict[str, Any]:
    tables = {"contact": scene.contact, "shape": scene.shape}
    named = {
        kind: "" if table is None else _named(table.method, table, axis) for kind, table in tables.items()
    }
    return {
        "kind": "stability",
        "title": scene.title or scene.name,
        **named,
        **{kind: _named(one.name, one, axis) for kind, one in objects.items()},
        "classes": ", ".join(CLASSES),
        "courant": float(load("shape", scene.shape.method).courant),
        "bounds": f"stable up to {STABLE}, bounded up to {BOUNDED} of the energy at the start",
        "steps_asked": steps,
        "scene": scene.text,
        "version": __version__,
    }


def _named(name: str, holder: Any, axis: str) -> str:
    options = holder.options
    given = set() if options is None else options.model_fields_set - {axis}
    return specification_of(name, {key: getattr(options, key) for key in given})


def largest_stable(dataset: xr.Dataset) -> FloatArray:
    """Return per stiffness the Courant number up to which all is stable."""
    order = np.argsort(dataset["cfl"].values)
    cfl, stable = dataset["cfl"].values[order], dataset["class"].values[:, order] == 1
    held = np.cumprod(stable, axis=1).sum(axis=1)
    return np.asarray(np.where(held > 0, cfl[np.maximum(held - 1, 0)], np.nan), dtype=float)
