"""Which output of a run, which of its bodies: what a reader asks for, found in the stored results."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import did_you_mean
from mpmfw.results import open as open_results
from mpmfw.results.reading import output_times
from mpmfw.state.fields import FloatArray

#: A run's tree or a comparison's dataset, or the name of its file.
Results = xr.DataTree | xr.Dataset | str | os.PathLike[str]


@contextmanager
def opened(results: Results) -> Iterator[xr.DataTree | xr.Dataset]:
    """Context with results; a file is read as it is asked for, and closed at the end.

    Raises
    ------
    MpmfwError
        The file cannot be read.
    """
    if isinstance(results, xr.DataTree | xr.Dataset):
        yield results
        return
    found = open_results(results, lazy=True)
    try:
        yield found
    finally:
        found.close()


@contextmanager
def opened_run(results: Results) -> Iterator[xr.DataTree]:
    """The tree of one run; a file is read as it is asked for, and closed at the end.

    Raises
    ------
    SceneError
        The results are those of a comparison, a study or a stability map, which keep no frames.
    MpmfwError
        The file cannot be read.
    """
    with opened(results) as found:
        if not isinstance(found, xr.DataTree):
            where = f"{os.fspath(results)}: " if isinstance(results, str | os.PathLike) else ""
            kind = str(found.attrs.get("kind", "")) or "unknown"
            raise SceneError(
                f"{where}results of kind '{kind}' keep no frames; expected those of a run (mpmfw run)"
            )
        yield found


def series_of(results: xr.DataTree | xr.Dataset) -> xr.Dataset:
    """Return the series of a run, or the dataset of a comparison."""
    if isinstance(results, xr.Dataset):
        return results
    return results["series"].to_dataset() if "series" in results.children else xr.Dataset()


def bodies_of(tree: xr.DataTree, selection: Sequence[str] | None = None) -> list[str]:
    """Bodies whose material points are stored, in the scene's order; ``selection`` chooses among them, or is
    one's name.

    Raises
    ------
    SceneError
        The run stored no material points, or there is no such body, or none is chosen.
    """
    groups = tree["particles"].children if "particles" in tree.children else {}
    order = tree.coords["body"].values.tolist() if "body" in tree.coords else list(groups)
    present = [str(name) for name in order if name in groups and groups[name].data_vars]
    if not present:
        why = "the run stored no material points; run it with output.particles = true"
        raise SceneError(str(tree.attrs.get("fields", why)))
    if selection is None:
        return present
    names = [selection] if isinstance(selection, str) else list(selection)
    if not names:
        raise SceneError(f"bodies: none is named; expected some of {', '.join(present)}, or None for all")
    for name in names:
        if name not in present:
            raise SceneError(f"no body '{name}'; {did_you_mean(name, present)}")
    return [name for name in present if name in names]


def times_of(tree: xr.DataTree) -> FloatArray:
    """Times of the outputs that hold material points, or of all where none does [s]."""
    points = tree["particles"].children.values() if "particles" in tree.children else ()
    group = next((points for points in points if "time" in points.coords), None)
    times = output_times(tree) if group is None else group.coords["time"]
    return np.asarray(times.values, dtype=float)


def frame_at(tree: xr.DataTree, time: float | None = None) -> int:
    """Index, among those that hold material points, of the output nearest to ``time`` [s]; of the last one by
    default.

    Raises
    ------
    SceneError
        The run has no output, or ``time`` is outside of them by more than half an interval.
    """
    times = times_of(tree)
    if len(times) == 0:
        raise SceneError("the run has no output")
    if time is None:
        return len(times) - 1
    slack = 0.5 * float(np.median(np.diff(times))) if len(times) > 1 else 0.0
    if not times[0] - slack <= time <= times[-1] + slack:
        raise SceneError(
            f"no output at {time:g} s; expected a time from {times[0]:g} to {times[-1]:g} s "
            f"({len(times)} outputs)"
        )
    return int(np.argmin(np.abs(times - time)))


def frame_of(tree: xr.DataTree, place: str, index: int) -> xr.Dataset:
    """Arrays of one group at one output, read from the file where the tree is lazy.

    Parameters
    ----------
    place
        Path of the group, such as ``particles/cylinder``.
    index
        Of the output among those that hold material points.
    """
    group, times = tree[place].to_dataset(), times_of(tree)
    if group.sizes.get("time", len(times)) != len(times):  # a surface has more outputs
        index = int(np.argmin(np.abs(group["time"].values - times[index])))
    return group.isel(time=index, missing_dims="ignore").load()


def chosen_frames(tree: xr.DataTree, every: int) -> range:
    """Indices of the first output that holds material points and of each ``every``-th after it.

    Raises
    ------
    SceneError
        ``every`` is below 1 or no whole number, or the run has no output.
    """
    try:
        every = operator.index(every)
    except TypeError:
        raise SceneError(f"every {every!r}: expected a whole number") from None
    if every < 1:
        raise SceneError(f"every {every}: expected 1 or more")
    return range(0, frame_at(tree) + 1, every)


def checked_name(kind: str, name: str, valid: Sequence[str]) -> str:
    """The name, if it is among the valid ones.

    Raises
    ------
    SceneError
        It is not; the message says what is there and the nearest.
    """
    if name not in valid:
        raise SceneError(f"no {kind} '{name}'; {did_you_mean(name, valid) if valid else 'there is none'}")
    return name


def attribute(tree: xr.DataTree, name: str) -> str:
    """A root attribute as text; empty if it is absent."""
    value: Any = tree.attrs.get(name, "")
    return str(value)
