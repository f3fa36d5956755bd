"""The map of stability: stiffness of the contact, or of the bodies, against the time step."""

from __future__ import annotations

import copy
import itertools
import math
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from mpmfw._version import __version__
from mpmfw.campaigns.executors import executor_of
from mpmfw.campaigns.grid import with_option
from mpmfw.campaigns.running import Progress, do, resumable
from mpmfw.campaigns.store import Store
from mpmfw.discovery import load
from mpmfw.errors import SceneError
from mpmfw.fields import FloatArray
from mpmfw.identity import code_of, key_of, package
from mpmfw.results.replacing import check_replaceable, replace_dataset
from mpmfw.scene import Scene, load_scene, located
from mpmfw.scene.specification import specification_of
from mpmfw.simulation import Simulation, chosen_methods
from mpmfw.stability.invariants import Invariants, Probe, probe_once
from mpmfw.stability.ratio import stiffness_ratio
from mpmfw.stability.request import Axis, axis_of, check_overrides, check_values

#: Classes of a point, by number; the bounds are those of the largest energy ratio.
CLASSES = ("no contact", "stable", "bounded", "diverged")
STABLE, BOUNDED = 1.005, 1.05

KAPPA = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
#: Past the limit of every stiffness: without contact it is 1.
CFL = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2)
STEPS = 300


def stability_map(
    scene: Any,
    contact: Any = None,
    shape: Any = None,
    *,
    kappa: Sequence[float] | None = None,
    ratio: Sequence[float] | None = None,
    cfl: Sequence[float] = CFL,
    steps: int = STEPS,
    output: str | os.PathLike[str] | None = None,
    set: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
    jobs: int | None = 1,
    executor: Any = None,
    store: str | os.PathLike[str] | None = None,
) -> xr.Dataset:
    """Run a scene at many stiffnesses and fixed steps, past the limit too, and class every run.

    Parameters
    ----------
    scene
        What ``mpmfw.run`` takes; its bodies must meet within ``steps`` steps.
    contact, shape
        Names of plug-ins or configured strategy objects, in place of the scene's.
    kappa
        Stiffness factors of a contact that has this option; :data:`KAPPA` unless ``ratio`` is given.
    ratio
        Stiffnesses M = K + 4 G / 3 of the second body over that of the first, instead.
    cfl
        Courant numbers c Δt / h of the fastest body.
    steps
        Steps of every run.
    output
        NetCDF file to write; it replaces nothing but another map. Points are kept in the folder ``<output>.runs`` beside
        it: a map that was broken off, or is asked for with more points, goes on from there.
    set
        Values by dotted key, set over the scene's own; not those that the map sets itself.
    progress
        Called with an :class:`mpmfw.campaigns.running.Event` after every run.
    jobs, executor, store
        As :func:`mpmfw.campaign` takes them.

    Returns
    -------
    Dataset
        By (kappa or ratio, cfl): ``class`` (index into the attribute ``classes``), ``energy`` (largest energy plus
        dissipation over that of the start, positions and velocities taken at the same time), ``steps_per_contact``,
        ``steps``. By kappa or ratio: ``limit`` (Courant number of the least limit that the run at the smallest step met,
        from its nodal masses) and ``closed_form`` (of two bodies in line, 2 / √(ω_bulk² + ω²)). Attribute ``courant``:
        past this Courant number, the shape function's, a run is refused whatever its springs.

    Raises
    ------
    SceneError
        The scene or a value is wrong.
    MpmfwError
        The file cannot be written.
    Interrupted
        Ctrl-C or SIGTERM; the points that are done are kept.
    """
    loaded = load_scene(scene, set={**(set or {}), **chosen_methods(contact, shape)})
    objects = {
        kind: one
        for kind, one in (("contact", contact), ("shape", shape))
        if one is not None and not isinstance(one, str)
    }
    axis = axis_of(loaded, objects.get("contact"), kappa, ratio)
    values: Sequence[float] = (KAPPA if kappa is None else kappa) if ratio is None else ratio
    check_values(values, cfl, steps)
    check_overrides(loaded, axis)
    if output is not None:
        check_replaceable(output, "stability", "map of stability")
    points = [_at(loaded, objects, axis, value) for value in values]
    ticks, closed = np.array([_theory(*point) for point in points]).T
    tasks = {
        (i, j): _task(*points[i], courant * float(ticks[i]), steps, f"{axis} {value:g}, cfl {courant:g}")
        for (i, value), (j, courant) in itertools.product(enumerate(values), enumerate(cfl))
    }
    runs = Store(store if store is not None else None if output is None else f"{os.fspath(output)}.runs")
    with resumable(runs, "map of stability"):
        do(
            probe_once,
            tasks.values(),
            runs,
            executor_of(executor, None if executor is not None else jobs),
            progress,
        )
    found = {index: _found(runs, task) for index, task in tasks.items()}
    least = int(np.argmin(cfl))
    limits = np.array([found[i, least].limit for i in range(len(values))]) / ticks
    dataset = _dataset(loaded, axis, values, cfl, steps, found, (limits, closed))
    dataset.attrs |= {kind: _without(one, axis) for kind, one in objects.items()}
    if output is not None:
        replace_dataset(dataset, output)
    return dataset


def _at(
    scene: Scene, objects: Mapping[str, Any], axis: Axis, value: float
) -> tuple[Scene, Mapping[str, Any]]:
    """The scene and the strategy objects at one stiffness."""
    if axis == "kappa" and "contact" in objects:
        return _scene_at(scene, {}), {**objects, "contact": with_option(objects["contact"], "kappa", value)}
    if axis == "ratio":
        return _scene_at(scene, stiffness_ratio(scene, value)), objects
    assert scene.contact is not None
    return _scene_at(scene, {f"contact.{scene.contact.method}.kappa": value}), objects


def _task(scene: Scene, objects: Mapping[str, Any], step: float, steps: int, name: str) -> Probe:
    """The probe of one point; the code that judges it is part of what it is."""
    fixed = scene.with_overrides({"time.step": step})
    key = key_of(fixed, **objects, what=f"{steps} steps judged by {package('mpmfw.stability')}")
    return Probe(key, name, fixed, steps, **objects, code=code_of(fixed, **objects))


def _found(runs: Store, task: Probe) -> Invariants:
    """What came of a point.

    Raises
    ------
    SceneError
        It is refused.
    """
    outcome = runs.outcome(task.key)
    if outcome is None or not outcome.values:  # its process died
        return Invariants("failed", "" if outcome is None else outcome.status)
    found = Invariants(**outcome.values)
    if found.status == "refused":
        raise SceneError(found.message)
    return found


def _without(plugin: Any, axis: str) -> str:
    """Name and options of a strategy object, but for what the map varies."""
    given = plugin.options.model_fields_set - {axis}
    return specification_of(plugin.name, {key: getattr(plugin.options, key) for key in given})


def _scene_at(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """The scene with changes, allowed to go past its limit; a safety factor of its own gives way."""
    time = {"end": scene.time.end, "output_interval": scene.time.output_interval}
    return scene.with_overrides({**changes, "allow_unstable": True, "time": time})


def _theory(scene: Scene, objects: Mapping[str, Any]) -> tuple[float, float]:
    """h / c of the fastest body [s], and the Courant number of the closed form."""
    simulation = _simulation(scene, objects)
    bulk, bodies = simulation.limits()[0][0], simulation.state.bodies
    kappa = getattr(getattr(simulation.contact, "options", None), "kappa", 0.0)
    # ω² = 2 κ M (1/ρ_1 + 1/ρ_2) / h², ω_bulk = 2 c / h
    first, second = bodies[0], bodies[min(1, len(bodies) - 1)]
    modulus = min(first.p_wave_modulus, second.p_wave_modulus)
    softness = 0.5 * modulus * (1.0 / first.density + 1.0 / second.density)
    fastest = simulation.state.grid.cell_size / bulk
    return bulk, 1.0 / math.sqrt(1.0 + kappa * softness / fastest**2)


def _simulation(scene: Scene, objects: Mapping[str, Any]) -> Simulation:
    try:
        return Simulation(scene, **copy.deepcopy(dict(objects)))
    except SceneError as error:
        raise located(error, scene) from error


_AXES = {
    "kappa": "stiffness factor of the contact springs",
    "ratio": "stiffness of the second body over that of the first",
}


def _said(meaning: str) -> dict[str, str]:
    """Attributes of a variable; all are numbers without a unit."""
    return {"units": "1", "long_name": meaning}


def classed(found: Invariants) -> int:
    """Index into :data:`CLASSES` of a run."""
    if found.status == "failed" or not found.energy <= BOUNDED:
        return 3
    if not found.touched:
        return 0
    return 1 if found.energy <= STABLE else 2


def _dataset(
    scene: Scene,
    axis: str,
    values: Sequence[float],
    cfl: Sequence[float],
    steps: int,
    found: Mapping[tuple[int, int], Invariants],
    limits: Sequence[FloatArray],
) -> xr.Dataset:
    def table(pick: Callable[[Invariants], float], kind: type = float) -> Any:
        return np.array([[pick(found[i, j]) for j in range(len(cfl))] for i in range(len(values))], kind)

    picks: dict[str, tuple[Callable[[Invariants], float], type, str]] = {
        "class": (classed, int, "index into the attribute classes"),
        "energy": (lambda o: o.energy, float, "largest energy plus dissipation over the energy at the start"),
        "steps_per_contact": (lambda o: o.contact_steps, float, "fewest steps that a contact lasted"),
        "steps": (lambda o: o.steps, int, "steps that were run"),
    }
    lines = {
        "limit": "Courant number of the least limit met at the smallest step (Gershgorin's bound of springs and bulk)",
        "closed_form": "Courant number of the closed form of two bodies in line",
    }
    dataset = xr.Dataset(
        {
            **{n: ((axis, "cfl"), table(pick, kind), _said(text)) for n, (pick, kind, text) in picks.items()},
            **{n: (axis, line, _said(text)) for (n, text), line in zip(lines.items(), limits, strict=True)},
        },
        {
            axis: (axis, list(values), _said(_AXES[axis])),
            "cfl": ("cfl", list(cfl), _said("Courant number of the fixed step")),
        },
    )
    dataset.attrs = _attributes(scene, steps, axis)
    return dataset


def _attributes(scene: Scene, steps: int, axis: str) -> dict[str, Any]:
    return {
        "kind": "stability",
        "title": scene.title or scene.name,
        "contact": "" if scene.contact is None else _named(scene.contact, axis),
        "shape": _named(scene.shape, axis),
        "classes": ", ".join(CLASSES),
        "courant": float(load("shape", scene.shape.method).courant),
        "bounds": f"stable up to {STABLE}, bounded up to {BOUNDED} of the energy at the start",
        "steps_asked": steps,
        "scene": scene.text,
        "version": __version__,
    }


def _named(table: Any, axis: str) -> str:
    """A method with the options that the scene sets, but for what the map varies."""
    options = table.options
    given = set() if options is None else options.model_fields_set - {axis}
    return specification_of(table.method, {key: getattr(options, key) for key in given})


def largest_stable(dataset: xr.Dataset) -> FloatArray:
    """Per stiffness the largest Courant number up to which every point is stable; NaN if the first is not."""
    order = np.argsort(dataset["cfl"].values)
    cfl, stable = dataset["cfl"].values[order], dataset["class"].values[:, order] == 1
    held = np.cumprod(stable, axis=1).sum(axis=1)
    return np.asarray(np.where(held > 0, cfl[np.maximum(held - 1, 0)], np.nan), dtype=float)
