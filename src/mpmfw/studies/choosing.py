"""``mpmfw.choose``: the method and cell size that a scene needs for an error."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any, Unpack

import numpy as np
import xarray as xr

from mpmfw.campaigns.grid import make_grid
from mpmfw.campaigns.grid_runs import GridRuns
from mpmfw.campaigns.judging import ErrorTable, Judge, check_names
from mpmfw.campaigns.measures import MEASURES, exact_of, measure_of, names_of_measures, outputs_for
from mpmfw.campaigns.running import Execution, Running
from mpmfw.codes.code import codes_of
from mpmfw.errors import SceneError
from mpmfw.plugin.measure import About, Measure
from mpmfw.results.provenance import provenance
from mpmfw.results.replacing import check_replaceable, replace_dataset
from mpmfw.scene import Scene, load_scene
from mpmfw.studies.ladder import Ladder
from mpmfw.studies.study import positive, relative_error

#: Default methods, cheap ones first.
_MASTER = "bardenhagen(criterion=position, normal=master)"
CONTACTS: tuple[str, ...] = (_MASTER, "penalty", "lcp", "penalty(kappa=16)", "hybrid")
SHAPES: tuple[str, ...] = ("gimp", "cpdi")


class Request(Running, total=False):
    """Keywords of :func:`choose` beside those of the methods."""

    body: str | None
    pair: str | None
    axis: str | None
    set: Mapping[str, Any] | None
    output: str | os.PathLike[str] | None


def choose(
    scene: Any,
    error: float | str = 0.01,
    *,
    measure: str | None = None,
    contact: Sequence[Any] | None = None,
    shape: Sequence[Any] | None = None,
    code: Sequence[Any] = (),
    coarsest: float | str | None = None,
    finest: float | str | None = None,
    **request: Unpack[Request],
) -> xr.Dataset:
    """Find a method and a cell size whose error is below a target, at low cost.

    Methods run from coarse to fine cells, the cheapest first, until one meets the target. Without a closed
    form the reference is the limit on which laws agree; its uncertainty is added to every error.

    Parameters
    ----------
    scene
        A file, the name of a shipped scene, or a mapping. Sizes of its particles are in cells.
    error
        Target of the relative error: 0.01 or ``"1 %"``.
    measure
        Name of the quantity; by default the first that has a reference in the scene.
    contact, shape
        Methods to choose among, as :func:`mpmfw.compare` takes them, the cheap ones first. By default
        ``CONTACTS`` and ``SHAPES``.
    code
        Other codes to choose among as well, as :func:`mpmfw.compare` takes them.
    coarsest, finest
        Largest and smallest cell size [m], by default twice and a quarter of the scene's; each is half of the
        one before.
    **request
        ``body``, ``pair``, ``axis``: subject of the quantity, by default from the motion. ``set``: values by
        key that all runs share. ``output``: NetCDF file to write, beside the folder ``<output>.runs``. Others
        are those of :class:`mpmfw.campaigns.running.Execution`; ``repeats`` has no effect.

    Returns
    -------
    xarray.Dataset
        Over (contact, shape, cell_size): ``status`` (often ``not run``), ``error`` [1], ``cpu_time`` [s],
        settling included, ``meets``, and ``answer`` (true of at most one). Attribute ``uncertainty``: that
        of the reference.

    Raises
    ------
    SceneError
        The request is wrong, or the measure has no reference.
    """
    target, output = relative_error(error, "error"), request.pop("output", None)
    shared = dict(request.pop("set", None) or {})
    about = About(request.pop("body", None), request.pop("pair", None), request.pop("axis", None))
    request["repeats"] = 1
    execution = Execution(**request)  # type: ignore[misc]
    if output is not None:
        check_replaceable(output, "choice")
    loaded = load_scene(scene, set=shared)
    check_names(about, loaded, _error_at)
    chosen, kind = _known(loaded, measure, about)
    base = loaded.with_overrides(outputs_for(chosen))
    _check_lengths(base)
    sizes = _sizes(float(base.grid.cell_size), coarsest, finest)
    if base.contact is None and contact:
        raise SceneError("contact: the scene has none, so there is nothing to choose")
    contacts = ["none"] if base.contact is None else list(contact or CONTACTS)
    contacts += codes_of(code)
    vary = {"contact": contacts, "shape": list(shape or SHAPES), "cell_size": sizes}
    grid = make_grid({"": base}, vary, {})
    if not grid.runnable:
        raise SceneError(next(iter(grid.combinations.values())).why)
    given = {"quantity": chosen.name, "kind": kind, **asdict(about)}
    judge = Judge(ErrorTable.model_validate(given), grid, _error_at)
    runs = GridRuns(grid, "choice", execution, output=output)
    at_once = len(grid.combinations) if execution.executor is not None else execution.jobs or 1
    ladder = Ladder(runs, judge, target, at_once)
    ladder.run()
    runs.warn()
    dataset = _dataset(ladder)
    dataset.attrs |= {"title": base.title or base.name, "scene": base.text}
    if output is not None:
        replace_dataset(dataset, output)
    return dataset


def _error_at(path: tuple[str, ...], message: str) -> SceneError:
    return SceneError(f"{path[-1]}: {message}")


def _dataset(ladder: Ladder) -> xr.Dataset:
    grid, answer, judge = ladder.runs.grid, ladder.answer(), ladder.judge
    points, known = grid.combinations, ladder.runs.statuses()
    status = dict.fromkeys(points, "not run") | {i: known[i] for i in ladder.asked}
    dataset = xr.Dataset(coords={dim: list(labels) for dim, labels in grid.coords.items()})
    dataset["status"] = grid.array(status, "ok, or why it is suspect or has no result")
    dataset["error"] = grid.array(ladder.errors, f"relative error of: {judge.measure.meaning}", "1")
    costs = ladder.costs().where(dataset["status"] != "not run")
    dataset["cpu_time"] = costs.assign_attrs(units="s", long_name="CPU time of the steps and of settling")
    meets, best = {i: ladder.meets(i) for i in points}, {i: i == answer for i in points}
    dataset["meets"] = grid.array(meets, "whether it meets the target").astype(bool)
    dataset["answer"] = grid.array(best, "the cheapest run that does").astype(bool)
    dataset.attrs = {
        "kind": "choice",
        "quantity": judge.says(),
        "error_against": ladder.against(),
        "uncertainty": ladder.slack,
        "target": ladder.target,
        "versions": json.dumps(provenance()["versions"]),
        **ladder.runs.conditions(),
    }
    return dataset


def _known(scene: Scene, name: str | None, about: About) -> tuple[Measure, str]:
    if name is not None:
        measure = measure_of(name)
        exact = exact_of(measure, scene, about)
        if exact is None and measure.kind == "field":
            raise SceneError(f"measure {name}: is a field; expected a number or a curve")
        return measure, "finest" if exact is None else exact.kind
    names = [*MEASURES, *(name for name in names_of_measures() if name not in MEASURES)]
    for one in map(measure_of, names):
        if (exact := exact_of(one, scene, about)) is not None:
            return one, exact.kind
    others = ", ".join(one for one in sorted(names) if measure_of(one).kind != "field")
    text = f"the scene '{scene.name}' has no closed form or reference"
    raise SceneError(f"{text}; expected [reference] kind = …, or a measure: one of {others}")


def _sizes(own: float, coarsest: Any, finest: Any) -> list[float]:
    example = "a cell size such as 0.4 or '4 mm'"
    first = 2.0 * own if coarsest is None else positive("coarsest", coarsest, "m", example)
    last = 0.25 * own if finest is None else positive("finest", finest, "m", example)
    count = int(np.floor(np.log2(first / last) + 1e-9)) + 1
    if count < 2:
        raise SceneError(f"finest {last:g} m: must be at most half of the coarsest cell, {first:g} m")
    return [first / 2**k for k in range(count)]


def _check_lengths(scene: Scene) -> None:
    """Refuse points and segments whose size does not follow the cells."""
    own = float(scene.grid.cell_size)
    other = scene.with_overrides({"grid.cell_size": 2.0 * own})
    for name, body in scene.bodies.items():
        twin = other.bodies[name]
        sizes = {
            "particles.size": (getattr(body.particles, "size", None), getattr(twin.particles, "size", None)),
            "segment": (body.segment, twin.segment),
        }
        for key, (size, of_twin) in sizes.items():
            if size is not None and size == of_twin:
                text = f"bodies.{name}.{key}: is {size:g} m at every cell size"
                raise SceneError(f'{text}; expected cells, such as "{size / own:g} cells"')
