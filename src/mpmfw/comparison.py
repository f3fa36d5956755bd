"""Run a scene with several methods and join the results on new dimensions."""

from __future__ import annotations

import functools
import itertools
import logging
import os
import re
import signal
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import xarray as xr

from mpmfw.discovery import Kind, available, distribution_of
from mpmfw.errors import Interrupted, MpmfwError, ResultsWarning, SceneError, SimulationError
from mpmfw.interruption import interruptible
from mpmfw.joining import Outcome, join
from mpmfw.scene.loading import plain
from mpmfw.scene.requested import check_methods_run, check_requested
from mpmfw.scene.specification import called, known_specification, parse_specification
from mpmfw.scene.toml_text import value_text

_log = logging.getLogger("mpmfw")


@dataclass(frozen=True)
class _Method:
    label: str
    value: Any  # a name or a configured strategy object


def compare(
    scene: Any,
    contact: Sequence[Any],
    shape: Sequence[Any],
    vary: Mapping[str, Sequence[Any]] | None = None,
    *,
    output: str | os.PathLike[str] | None = None,
    progress: Any = None,
    set: Mapping[str, Any] | None = None,
    runner: Callable[..., xr.DataTree] | None = None,
    force: bool = False,
) -> xr.Dataset:
    """Run a scene with every combination of contact and shape (and varied keys) and join what they give.

    Parameters
    ----------
    scene
        A file, the name of a shipped scene, or a mapping.
    contact, shape
        Methods: names of plug-ins, names with options such as ``"penalty(kappa=2)"``, or configured strategy objects, each
        once. Options beside a name are set over those of the scene's own table of the method; an object has its own alone.
        An object is labelled by its ``label``, else its ``name``; a label that occurs again gets ``#2``, ``#3`` …
    vary
        Scene keys and their values, such as ``{"grid.cell_size": [0.4, 0.2]}``; the key's last part names the
        dimension. Values that are not all numbers or all texts, such as vectors, are labelled by their text.
    output
        NetCDF file to write. It is brought up to date after every run, so that a comparison that is broken
        off keeps what it has.
    progress
        Handed to every run.
    set
        Scene keys that all runs share. Particle frames are off unless ``output.particles`` is set here: a
        comparison keeps the series and the first and last outlines.
    runner
        Stands in for ``mpmfw.run``, with its signature.
    force
        Begin runs past the limits of steps and frames, as ``mpmfw.run`` does.

    Returns
    -------
    xarray.Dataset
        Series with dims (contact, shape, *vary, time, body | pair, axis), costs with dims (contact, shape,
        *vary[, stage]), ``status`` ("ok", "failed: …" or "refused: …"). A failing method does not stop the
        others; what it did not reach is NaN.

    Raises
    ------
    SceneError
        The request as a whole is wrong: a misspelt plug-in, a method or value given twice, a key that chooses
        a method, is both set and varied or belongs to a method that does not run, a scene that no combination
        can run.
    MpmfwError
        The output cannot be written.
    Interrupted
        Ctrl-C or SIGTERM; the output keeps the runs that were done.
    """
    methods = {"contact": _methods("contact", contact), "shape": _methods("shape", shape)}
    varied = dict(vary or {})
    _check(methods, set or {}, varied)
    names = _dimension_names(varied)
    coords = {kind: [method.label for method in chosen] for kind, chosen in methods.items()}
    coords |= {names[key]: _value_labels(key, values) for key, values in varied.items()}
    keys = {names[key]: key for key in varied}
    path = None if output is None else os.path.abspath(_writable(os.fspath(output)))
    run = runner or _run()
    if force:
        run = functools.partial(run, force=True)
    shared = {"output.particles": False, **(set or {})}
    outcomes: dict[tuple[int, ...], Outcome] = {}
    refusals: list[SceneError] = []
    with interruptible():
        for index in itertools.product(*(range(len(values)) for values in coords.values())):
            chosen_values = {
                key: values[i] for (key, values), i in zip(varied.items(), index[2:], strict=True)
            }
            choice = (methods["contact"][index[0]].value, methods["shape"][index[1]].value)
            label = "/".join(str(values[i]) for values, i in zip(coords.values(), index, strict=True))
            try:
                with _collected(label) as notes:
                    outcome = _outcome(
                        run, scene, choice, {**shared, **chosen_values}, progress, refusals, varied
                    )
            except KeyboardInterrupt as error:
                raise Interrupted(getattr(error, "number", signal.SIGINT), _kept(outcomes, path)) from None
            outcomes[index] = outcome = replace(outcome, notes=tuple(notes))
            if path is not None and outcome.tree is not None:
                _save(join(coords, outcomes, keys), path)
    if len(refusals) == len(outcomes):
        raise refusals[0]
    dataset = join(coords, outcomes, keys)
    if path is not None:
        _save(dataset, path)
    return dataset


def _kept(outcomes: Mapping[tuple[int, ...], Outcome], path: str | None) -> str:
    """What an interrupted comparison leaves."""
    done = sum(outcome.tree is not None for outcome in outcomes.values())
    kept = f"{path} keeps the {done} runs that were done" if path is not None and done else "nothing is kept"
    return f"interrupted: {kept}; the comparison begins anew if it is started again"


def _outcome(
    run: Callable[..., xr.DataTree],
    scene: Any,
    choice: tuple[Any, Any],
    overrides: Mapping[str, Any],
    progress: Any,
    refusals: list[SceneError],
    varied: Iterable[str],
) -> Outcome:
    """Run one combination and say how it went; only what the user broke off is raised."""
    contact, shape = choice
    try:
        apart = {"apart": True} if _is_strange(contact, shape) else {}
        tree = run(
            scene, contact=contact, shape=shape, output=None, progress=progress, set=overrides, **apart
        )
    except SceneError as error:
        refusals.append(_named(error, varied, {"contact": contact, "shape": shape}))
        return Outcome(f"refused: {refusals[-1]}")
    except SimulationError as error:
        return Outcome(f"failed: {error}", getattr(error, "results", None))
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a stranger's method may raise anything, hours into a comparison
        _log.exception("contact %r with shape %r failed", contact, shape)
        return Outcome(f"failed: {type(error).__name__}: {error}")
    return Outcome(str(tree.attrs.get("status", "ok")), tree)


def _is_strange(contact: Any, shape: Any) -> bool:
    """Whether a plug-in that is not mpmfw's own runs, which may bring down its process; objects cannot leave this one."""
    chosen: tuple[tuple[Kind, Any], ...] = (("contact", contact), ("shape", shape))
    if not all(isinstance(method, str) for _, method in chosen):
        return False
    names = [(kind, parse_specification(method).name) for kind, method in chosen]
    entries = [available(kind)[name] for kind, name in names if name in available(kind)]
    return any(distribution_of(entry) != "mpmfw" for entry in entries)


def _named(error: SceneError, varied: Iterable[str], methods: Mapping[str, Any]) -> SceneError:
    """The error with methods and the keys that are varied called so: to a run they are set as others are."""
    text = called(str(error), {kind: f"{kind} {method}" for kind, method in methods.items()})
    for key in varied:
        text = re.sub(rf"^--set (?={re.escape(key)}(?::|$))", "--vary ", text, flags=re.MULTILINE)
    return error if text == str(error) else SceneError(text)


@contextmanager
def _collected(label: str) -> Iterator[list[str]]:
    """Collect what a run wants its reader to know, and say whose it is; other warnings are shown as ever."""
    notes: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.filterwarnings("always", category=ResultsWarning)
        yield notes
    for warning in caught:
        if issubclass(warning.category, ResultsWarning):
            notes.append(str(warning.message))
            warnings.warn(f"{label}: {warning.message}", ResultsWarning, stacklevel=4)
        else:
            warnings.showwarning(warning.message, warning.category, warning.filename, warning.lineno)


def _methods(kind: Kind, chosen: Sequence[Any]) -> list[_Method]:
    """Label methods uniquely; a name that is not installed is an error at once."""
    if isinstance(chosen, str) or len(chosen) == 0:
        raise SceneError(f"{kind}: expected a list of at least one method, got {chosen!r}")
    methods: list[_Method] = []
    for k, method in enumerate(chosen):
        base = _known(kind, method) if isinstance(method, str) else _label(method)
        if any(
            method is other
            or (isinstance(method, str) and isinstance(other, str) and base == _known(kind, other))
            for other in chosen[:k]
        ):
            raise SceneError(f"{kind}: {base} is given twice")
        label, count = base, 1
        while any(other.label == label for other in methods):
            count += 1
            label = f"{base}#{count}"
        methods.append(_Method(label, base if isinstance(method, str) else method))
    return methods


def _known(kind: Kind, text: str) -> str:
    """A name or a name with options, in the one way of writing that labels have."""
    try:
        return str(known_specification(kind, text))
    except SceneError as error:
        raise SceneError(f"{kind} {error}") from error


def _label(method: Any) -> str:
    """What tables and figures call a method; a formula between two $ would be set, and one that is none fails the figure."""
    given = str(getattr(method, "label", None) or getattr(method, "name", None) or type(method).__name__)
    return "".join(c for c in given.replace("$", "") if c.isprintable())


def _check(
    methods: Mapping[str, Sequence[_Method]], shared: Mapping[str, Any], varied: Mapping[str, Any]
) -> None:
    """Refuse keys that choose methods, have no effect on those that run, or take each other's place."""
    names = {kind: [_plugin(one.value) for one in chosen] for kind, chosen in methods.items()}
    check_requested(shared, varied)
    check_methods_run(shared, names, "set")
    check_methods_run(varied, names, "vary")


def _plugin(method: Any) -> str:
    if isinstance(method, str):
        return parse_specification(method).name
    return str(getattr(method, "name", type(method).__name__))


def _value_labels(key: str, values: Sequence[Any]) -> list[Any]:
    """The values of a varied key as coordinates; text where they are not of one scalar type.

    Raises
    ------
    SceneError
        There is no value, or one is given twice.
    """
    if isinstance(values, str) or not hasattr(values, "__len__"):
        raise SceneError(f"vary {key}: expected a list of values, got {values!r}")
    if len(values) == 0:
        raise SceneError(f"vary: {key} has no values")
    labels = [plain(value) for value in values]
    of_one_type = any(
        all(
            isinstance(label, kinds) and not (kinds != (bool,) and isinstance(label, bool))
            for label in labels
        )
        for kinds in ((bool,), (int, float), (str,))
    )
    if not of_one_type:
        labels = [label if isinstance(label, str) else value_text(label) for label in labels]
    for k, label in enumerate(labels):
        if label in labels[:k]:
            raise SceneError(f"vary {key}: {label} is given twice")
    return labels


def _dimension_names(varied: Mapping[str, Sequence[Any]]) -> dict[str, str]:
    """Name each varied key's dimension by its last part, or by the whole where that is taken."""
    last = [key.rpartition(".")[2] for key in varied]
    taken = {"contact", "shape", "time", "body", "pair", "axis", "rotation", "stage", "frame"}
    return {
        key: name if last.count(name) == 1 and name not in taken else key.replace(".", "_")
        for key, name in zip(varied, last, strict=True)
    }


def _run() -> Callable[..., xr.DataTree]:
    from mpmfw.runs import run  # here, so that the import of one does not need the other

    return run


def _writable(path: str) -> str:
    """Say before the first run that a file cannot be written."""
    folder = os.path.dirname(path) or "."
    if not os.path.isdir(folder):
        raise MpmfwError(f"cannot create '{path}': there is no folder '{folder}'")
    if not os.access(folder, os.W_OK) or os.path.isdir(path):
        raise MpmfwError(f"cannot create '{path}': not writable")
    return path


def _save(dataset: xr.Dataset, path: str) -> None:
    """Replace the file in one step: readers see the old one or the new one, whole."""
    growing = f"{path}.part"
    packed = {
        str(name): {"zlib": True, "complevel": 1}
        for name, array in dataset.data_vars.items()
        if array.dtype.kind == "f"
    }
    try:
        dataset.to_netcdf(growing, engine="netcdf4", encoding=packed)
        os.replace(growing, path)
    except OSError as error:
        raise MpmfwError(f"cannot write '{path}': {error}") from error
