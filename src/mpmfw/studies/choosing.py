"""``mpmfw.choose``: which method and cell size a scene needs for an error, from a few coarse runs."""

from __future__ import annotations

import os
import tempfile
import tomllib
from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files
from typing import Any

import xarray as xr

from mpmfw.campaigns.grid import make_grid
from mpmfw.campaigns.grid_runs import GridRuns
from mpmfw.campaigns.measures import MEASURES, exact_of, measure_of, names_of_measures
from mpmfw.campaigns.running import Progress
from mpmfw.errors import SceneError
from mpmfw.plugin.measure import About, Measure
from mpmfw.results.replacing import check_replaceable, replace_dataset
from mpmfw.scene import Scene, load_scene
from mpmfw.studies.pilots import Pilots
from mpmfw.studies.study import positive, relative_error

#: Methods that are tried where nobody names any; the first of each makes the reference where a scene has none.
_DEFAULTS = tomllib.loads((files("mpmfw") / "reference" / "choose.toml").read_text(encoding="utf-8"))
CONTACTS: tuple[str, ...] = tuple(_DEFAULTS["contact"])
SHAPES: tuple[str, ...] = tuple(_DEFAULTS["shape"])
#: Cell sizes that may be the answer are the coarsest over these, so that grid lines of the coarsest stay grid lines.
DIVISORS = (1, 2, 3, 4, 6, 8)
#: Divisor of the run that errors are against where a scene has no reference.
_OF_REFERENCE = 4


def choose(
    scene: Any,
    error: float | str = 0.01,
    *,
    measure: str | None = None,
    contact: Sequence[Any] | None = None,
    shape: Sequence[Any] | None = None,
    coarsest: float | str | None = None,
    finest: float | str | None = None,
    set: Mapping[str, Any] | None = None,
    output: str | os.PathLike[str] | None = None,
    store: str | os.PathLike[str] | None = None,
    executor: Any = None,
    jobs: int | None = 1,
    progress: Progress | None = None,
    report: Callable[[float, int], None] | None = None,
    force: bool = False,
) -> xr.Dataset:
    """Say which method and cell size bring a scene's error below a target at the least cost, from a few coarse runs.

    Methods run at twice the scene's own cell and at its own, those first that are cheap by what ``mpmfw explain`` predicts and
    likely to meet the target by what has run; a third is run where it decides. Where a run meets the target another is made
    only if it is expected to save more at the next use than it takes; a method that is out of reach of the target is not run.
    Of each method e(h) = e0 + C h^p is fitted and the cost, steps times (a + b points). A method meets the target where a run of
    it did, or where it is predicted to with a probability of 95 %.

    Parameters
    ----------
    scene
        A file, the name of a shipped scene, or a mapping. Sizes of its particles are in cells.
    error
        Relative error that is asked for: 0.01 or ``"1 %"``.
    measure
        Name of the quantity whose error it is; by default the first that the scene's closed form or reference knows. Of one that
        it does not know, errors are against a run at a quarter of the coarsest cell with the first method; what that one is
        off by itself is estimated, and added to every error's bounds.
    contact, shape
        Methods to choose among, as :func:`mpmfw.compare` takes them; every combination is tried. By default those that the
        shipped studies found best: ``penalty``, ``hybrid`` and ``bardenhagen(criterion=position, normal=master)`` with ``cpdi``
        and ``gimp``.
    coarsest, finest
        Cell sizes of the first pilots and of the smallest answer [m]; twice and a quarter of the scene's own by default.
    set
        Values by key that all runs share.
    output
        NetCDF file to write; finished runs are kept in the folder ``<output>.runs`` beside it.
    store, executor, jobs, progress, report, force
        As :func:`mpmfw.campaign` takes them.

    Returns
    -------
    xarray.Dataset
        Over (contact, shape): ``answer`` (true of at most one), ``verdict``, ``cell_size_needed`` [m], ``predicted_error`` with
        ``lower`` and ``upper``, its bounds of 90 % [1], ``cost`` [s], ``limit`` (e0) [1], ``order`` (p) [1], ``why``. Over
        (contact, shape, cell_size), of the pilots: ``error`` [1], ``cpu_time`` [s], settling included, and ``status``.

    Raises
    ------
    SceneError
        The request is wrong, or nothing is known that the measure's error could be of.
    MpmfwError
        A file cannot be written, or the run that errors are against failed.
    Interrupted
        Ctrl-C or SIGTERM; what is done is in the store.
    """
    target = relative_error(error, "error")
    if output is not None:
        check_replaceable(output, "choice", "result of mpmfw choose")
    loaded = load_scene(scene, set=dict(set or {}))
    known = _known(loaded, measure)
    base = _base(loaded, known[0])
    _check_lengths(base)
    ladder = _ladder(base, coarsest, finest, known[1] == "finest")
    vary = {"contact": _contacts(base, contact), "shape": list(shape or SHAPES), "cell_size": ladder}
    grid = make_grid({"": base}, vary, {})
    if all(one.scene is None for one in grid.combinations.values()):
        raise SceneError(next(iter(grid.combinations.values())).why)
    with tempfile.TemporaryDirectory(prefix="mpmfw-choose-") as folder:
        kept = store if store is not None or output is not None else folder
        runs = GridRuns(grid, "choice", output=output, store=kept, executor=executor, jobs=jobs)
        at_once = len(grid.combinations) if executor is not None else jobs or 1
        complete = lambda only: runs.complete(1, progress, report, force, only)  # noqa: E731
        pilots = Pilots(runs, *known, target, complete, at_once)
        pilots.run()
        runs.warn(lambda one: one.name)
        dataset = pilots.dataset()
    if output is not None:
        replace_dataset(dataset, output)
    return dataset


def _known(scene: Scene, name: str | None) -> tuple[Measure, str]:
    """The measure, and the kind of what its errors are against.

    Raises
    ------
    SceneError
        There is no such measure, or none is named and the scene has no closed form or reference of any.
    """
    if name is not None:
        measure = measure_of(name)
        exact = exact_of(measure, scene, About())
        if exact is None and measure.kind == "field":
            raise SceneError(
                f"measure {name}: the scene '{scene.name}' has no closed form of it, and a field has no finer run to be compared "
                "with; expected a number or a curve"
            )
        return measure, "finest" if exact is None else exact.kind
    names = [*MEASURES, *(name for name in names_of_measures() if name not in MEASURES)]
    for one in map(measure_of, names):
        if (exact := exact_of(one, scene, About())) is not None:
            return one, exact.kind
    others = ", ".join(one for one in sorted(names) if measure_of(one).kind != "field")
    raise SceneError(
        f"the scene '{scene.name}' has no closed form or reference, so that it does not say what an error is of; "
        f"expected a measure, whose errors are then against the finest run: one of {others}"
    )


def _base(scene: Scene, measure: Measure) -> Scene:
    """The scene with nothing recorded that the error does not need."""
    outputs = dict.fromkeys(["output.surface", "output.gap", "output.ledger"], False)
    return scene.with_overrides({"output.particles": measure.particles} | outputs)


def _contacts(scene: Scene, given: Sequence[Any] | None) -> list[Any]:
    if scene.contact is None:
        if given:
            raise SceneError("contact: the scene has none, so that there is none to choose")
        return ["none"]
    return list(given or CONTACTS)


def _ladder(scene: Scene, coarsest: Any, finest: Any, without_reference: bool) -> list[float]:
    """Cell sizes that may be the answer, falling.

    Raises
    ------
    SceneError
        A size is none, or too few are left.
    """
    own = float(scene.grid.cell_size)
    first = 2.0 * own if coarsest is None else _length("coarsest", coarsest)
    if without_reference:
        if finest is not None:
            raise SceneError(
                "finest: has no effect where nothing is known of the measure: errors are against a run at a quarter of the "
                "coarsest cell, which is the smallest answer"
            )
        last = first / _OF_REFERENCE
    else:
        last = 0.25 * own if finest is None else _length("finest", finest)
    sizes = [first / k for k in DIVISORS if first / k >= last * (1.0 - 1e-9)]
    if len(sizes) < 2:
        raise SceneError(f"finest {last:g} m: must be at most half of the coarsest cell, {first:g} m")
    return sizes


def _check_lengths(scene: Scene) -> None:
    """Refuse particles and segments whose size does not follow the cells."""
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
                raise SceneError(
                    f"bodies.{name}.{key}: is {size:g} m at every cell size, so that finer cells would be another "
                    f'discretisation; expected cells, such as "{size / own:g} cells"'
                )


def _length(name: str, given: float | str) -> float:
    return positive(name, given, "m", "a cell size such as 0.4 or '4 mm'")
