"""The frames of a run's file, as they were handed to its writer: what a run that goes on writes again."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

import netCDF4
import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.fields import AnyArray, Field
from mpmfw.results.frame import Frame, RunHeader
from mpmfw.results.layout import is_static

#: Arrays of one output by group and name.
Output: TypeAlias = Mapping[tuple[str, str], AnyArray]


def frames_of(path: str | os.PathLike[str], count: int, header: RunHeader) -> Iterator[Frame]:
    """The first frames of a file, one after the other.

    Parameters
    ----------
    path
        Of the file; its run may have been killed.
    count
        How many.
    header
        Of the run that goes on; it may have more pairs, or fewer, than the file.

    Raises
    ------
    MpmfwError
        The file does not have so many.
    """
    with netCDF4.Dataset(os.fspath(path)) as dataset:
        dataset.set_always_mask(False)
        dataset.set_auto_maskandscale(False)
        times = dataset["time"][:]
        complete = int(np.isfinite(times).sum())
        if complete < count:
            raise MpmfwError(f"'{os.fspath(path)}' holds {complete} outputs; expected {count} or more")
        fields = {(field.group, field.name): field for field in header.fields}
        points = dataset["particles/time"][:]
        places = [place for place in _places(dataset) if place != "particles"]
        for k in range(count):
            time, output = float(times[k]), _output(dataset, places, k, fields)
            if k == 0:
                output = {**output, **_static(dataset, "surface", fields)}
            yield _frame(time, output, _points(dataset, points, time, fields), header, fields)


def _places(dataset: netCDF4.Dataset) -> list[str]:
    """Paths of the groups that have arrays, without the leading slash."""
    found = []
    for name, group in dataset.groups.items():
        found += [f"{name}/{child}" for child in group.groups]
        found.append(name)
    return found


def _group(place: str) -> str:
    """The group of the declarations of what lies at a place of the file."""
    return place.partition("/")[0]


def _output(
    dataset: netCDF4.Dataset, places: list[str], k: int, fields: Mapping[tuple[Any, str], Field]
) -> Output:
    """Arrays of output ``k`` that have a time."""
    return {
        (place, name): variable[k]
        for place in places
        for name, variable in dataset[place].variables.items()
        if (_group(place), name) in fields and variable.dimensions[:1] == ("time",)
    }


def _static(dataset: netCDF4.Dataset, place: str, fields: Mapping[tuple[Any, str], Field]) -> Output:
    """Arrays of a group without a time."""
    if place not in dataset.groups:
        return {}
    return {
        (place, name): variable[...]
        for name, variable in dataset[place].variables.items()
        if (place, name) in fields and is_static(fields[place, name])
    }


def _points(
    dataset: netCDF4.Dataset, times: AnyArray, time: float, fields: Mapping[tuple[Any, str], Field]
) -> Output:
    """Arrays of the material points at the time of an output; nothing where it has none."""
    at = np.flatnonzero(times == time)
    if not len(at):
        return {}
    first = _static(dataset, "particles", fields) if at[0] == 0 else {}
    return {**_output(dataset, ["particles"], int(at[0]), fields), **first}


def _frame(
    time: float, output: Output, points: Output, header: RunHeader, fields: Mapping[tuple[Any, str], Field]
) -> Frame:
    frame = Frame(time, pairs=header.pairs if header.more_pairs else ())
    contact: dict[str, dict[str, AnyArray]] = {}
    groups: dict[str, dict[str, AnyArray]] = {"series": {}, "surface": {}, "grid": {}, "particles": {}}
    for (place, name), values in {**output, **points}.items():
        group, _, pair = place.partition("/")
        if group == "contact":
            contact.setdefault(pair, {})[name] = values
        else:
            groups[group][name] = _with_pairs(values, fields[group, name], len(header.pairs))
    frame.series, frame.surface, frame.grid = groups["series"], groups["surface"], groups["grid"]
    frame.particles, frame.contact = groups["particles"], contact
    return frame


def _with_pairs(values: AnyArray, field: Field, count: int) -> AnyArray:
    """The array with so many pairs: those that came near later are missing, or left out."""
    if "pair" not in field.dims:
        return values
    axis = field.dims.index("pair")
    more = count - values.shape[axis]
    if more <= 0:
        return np.take(values, range(count), axis)
    missing = np.full((*values.shape[:axis], more, *values.shape[axis + 1 :]), np.nan, values.dtype)
    return np.concatenate([values, missing], axis)
