"""The points of a grid: each a scene to run, or why it cannot be run."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.campaigns.keys import (
    OWN_OPTION,
    dimension_names,
    full_key,
    is_numerical,
    is_own_method,
    overrides_of,
    written_alike,
)
from mpmfw.campaigns.work import Task
from mpmfw.codes.code import Code
from mpmfw.errors import SceneError, SceneProblem
from mpmfw.plugin.discovery import load
from mpmfw.runs.identity import code_of, key_of
from mpmfw.scene import Scene, load_scene
from mpmfw.scene.sources import plain
from mpmfw.scene.specification import parse_specification
from mpmfw.scene.toml_text import value_text

Index = tuple[int, ...]


@dataclass(frozen=True)
class Combination:
    """One cell of the grid."""

    labels: Mapping[str, Any]  #: its place in words, by dimension
    scene: Scene | None  #: what runs; None if the scene refuses the combination
    problems: tuple[SceneProblem, ...] = ()  #: why it is refused
    contact: Any = None  #: a strategy object instead of the scene's method
    shape: Any = None  #: as ``contact``
    what: str = ""  #: what is done with the scene, where it is not simply run

    @property
    def name(self) -> str:
        """``penalty, cpdi, cell_size 0.4``."""
        return in_words(self.labels) or "the run"

    @functools.cached_property
    def key(self) -> str:
        """Key of its run; empty if it is refused."""
        return "" if self.scene is None else key_of(self.scene, self.contact, self.shape, self.what)

    @property
    def why(self) -> str:
        """Reason why it is refused, the first if an option has several."""
        first, *others = self.problems
        return "\n".join([first.plain] if first.override else [str(one) for one in (first, *others)])


@dataclass(frozen=True)
class RunGrid:
    """All combinations."""

    scenes: Mapping[str, Any]  #: what they are of, by label, as it was given
    coords: Mapping[str, list[Any]]  #: labels of each dimension, in order
    keys: Mapping[str, str]  #: keys that vary, by dimension
    combinations: Mapping[Index, Combination]  #: by index into the coordinates

    @property
    def runnable(self) -> dict[Index, Scene]:
        """Scenes of the combinations that can be run."""
        return {index: one.scene for index, one in self.combinations.items() if one.scene is not None}

    @property
    def problem_dims(self) -> list[str]:
        """Dimensions that change the problem."""
        return [dim for dim in self.coords if dim == "scene" or not is_numerical(self.keys[dim])]

    def array(
        self, values: Mapping[Index, Any], meaning: str, unit: str | None = None, **attributes: str
    ) -> xr.DataArray:
        """Return numbers with a unit, or words without one, over the grid."""
        kind, empty = (object, "") if unit is None else (float, np.nan)
        filled = np.full([len(labels) for labels in self.coords.values()], empty, dtype=kind)
        for index, value in values.items():
            filled[index] = value
        text = {"long_name": meaning, **attributes} | ({} if unit is None else {"units": unit})
        return xr.DataArray(filled, dims=tuple(self.coords), attrs=text)

    def tasks(self, force: bool = False, threads: int = 1) -> dict[str, Task]:
        """Return the different runs by key."""
        found = {}
        for one in self.combinations.values():
            if one.scene is not None:
                methods = one.scene, one.contact, one.shape
                task = Task(one.key, one.name, *methods, code_of(*methods), force=force, threads=threads)
                found[one.key] = task
        return found


def make_grid(
    scenes: Mapping[str, Any], vary: Mapping[str, Sequence[Any]], shared: Mapping[str, Any]
) -> RunGrid:
    """Expand ``vary``, values by key, over scenes by label; ``shared`` are values of all runs.

    The values of ``contact`` may include adapters to other codes."""
    names = dimension_names(vary)
    coords: dict[str, list[Any]] = {"scene": list(scenes)} if list(scenes) != [""] else {}
    offset = len(coords)
    coords |= {names[key]: labels_of(written_alike(key, list(values))) for key, values in vary.items()}
    combinations = {}
    for index in itertools.product(*(range(len(labels)) for labels in coords.values())):
        labels = {dim: coords[dim][k] for dim, k in zip(coords, index, strict=True)}
        values = {key: vs[k] for (key, vs), k in zip(vary.items(), index[offset:], strict=True)}
        combinations[index] = _combination(scenes[labels.get("scene", "")], labels, values, shared)
    return RunGrid(scenes, coords, {names[key]: key for key in vary}, _without_twins(combinations))


def _combination(
    scene: Any, labels: Mapping[str, Any], values: Mapping[str, Any], shared: Mapping[str, Any]
) -> Combination:
    methods = {full_key(key): value for key, value in values.items()}
    objects = {
        kind: value
        for kind in ("contact", "shape")
        if (value := methods.get(f"{kind}.method")) is not None and not isinstance(value, str)
    }
    if isinstance(objects.get("contact"), Code):  # it has its own methods
        values = {key: value for key, value in values.items() if not is_own_method(key)}
    try:
        overrides = dict(shared)
        for key, value in values.items():
            full = full_key(key)
            if full == OWN_OPTION:
                overrides |= _of_contact(scene, objects, methods, value)
            elif full.removesuffix(".method") not in objects:
                loaded = load_scene(scene, set=shared) if "*" in full else None
                bodies, dim = ((), 0) if loaded is None else (loaded.bodies, loaded.dim)
                overrides |= overrides_of(bodies, dim, key, value)
        said = {full_key(short): f"--vary {short}" for short in values}
        said |= {
            f"{kind}.method": f"{kind} {labels[kind]}" for kind in ("contact", "shape") if kind in values
        }
        loaded = load_scene(scene, set=overrides, said=said)
        code = objects.get("contact")
        if isinstance(code, Code):
            code.identify()
            if problems := code.problems(loaded):
                return Combination(labels, None, problems)
        return Combination(labels, loaded, **objects)
    except SceneError as error:
        return Combination(labels, None, error.problems)


def _of_contact(
    scene: Any, objects: dict[str, Any], methods: Mapping[str, Any], value: Any
) -> dict[str, Any]:
    own = objects.get("contact")
    if own is not None:
        if has_option("contact", own, "kappa"):
            given = {key: getattr(own.options, key) for key in own.options.model_fields_set}
            objects["contact"] = type(own)(**{**given, "kappa": value})
        return {}
    named = methods.get("contact.method")
    if named is None:
        contact = load_scene(scene).contact
        named = contact.method if contact is not None else "none"
    name = parse_specification(named).name
    return {f"contact.{name}.kappa": value} if has_option("contact", name, "kappa") else {}


def has_option(kind: Any, method: Any, name: str) -> bool:
    """Return True if a plug-in has an option of this name."""
    plugin = load(kind, method) if isinstance(method, str) else type(method)
    return name in getattr(getattr(plugin, "Options", None), "model_fields", {})


def _without_twins(combinations: Mapping[Index, Combination]) -> dict[Index, Combination]:
    """Refuse settings that repeat an earlier run of the same method."""
    first: dict[tuple[str, ...], Combination] = {}
    kept = {}
    for index, one in combinations.items():
        if one.scene is not None:
            dims = ("scene", "contact") if isinstance(one.contact, Code) else ("scene", "contact", "shape")
            chosen = (one.key, *(str(one.labels.get(dim, "")) for dim in dims))
            twin = first.setdefault(chosen, one)
            if twin is not one:
                changed = [dim for dim in one.labels if one.labels[dim] != twin.labels[dim]]
                settings = " and ".join(f"{dim} {one.labels[dim]}" for dim in changed)
                message = f"{settings} changes nothing here: it is the run of {twin.name}"
                one = replace(one, scene=None, problems=(SceneProblem(message),))
        kept[index] = one
    return kept


def in_words(labels: Mapping[str, Any]) -> str:
    """Return a point of a grid in words: ``penalty, cpdi, cell_size 0.4``."""
    bare = ("scene", "contact", "shape", "scheme", "transfer")
    return ", ".join(str(label) if dim in bare else f"{dim} {label}" for dim, label in labels.items())


def given_twice(values: Iterable[Any]) -> list[int]:
    """Return indices of repeated values; booleans are not numbers."""
    plainly = [plain(value) if is_value(value) else value for value in values]
    told = [(isinstance(value, bool), value) for value in plainly]
    return [k for k, one in enumerate(told) if one in told[:k]]


def labels_of(values: list[Any]) -> list[Any]:
    """Return values as coordinates of one type."""
    labels = [plain(value) if is_value(value) else label_of(value) for value in values]
    twice = [labels[:k].count(label) for k, label in enumerate(labels)]
    labels = [f"{label}#{n + 1}" if n else label for label, n in zip(labels, twice, strict=True)]
    for kinds in ((bool,), (int, float), (str,)):
        if all(isinstance(v, kinds) and (kinds == (bool,) or not isinstance(v, bool)) for v in labels):
            return labels
    return [label if isinstance(label, str) else value_text(label) for label in labels]


def is_value(value: Any) -> bool:
    """Return True if a value is not a strategy object."""
    return (
        value is None
        or isinstance(value, bool | int | float | str | list | tuple | Mapping)
        or hasattr(value, "tolist")
    )


def label_of(method: Any) -> str:
    """Return the name of a strategy object, without the $ of a formula."""
    given = str(getattr(method, "label", None) or getattr(method, "name", None) or type(method).__name__)
    return "".join(c for c in given.replace("$", "") if c.isprintable())
