"""Write a run's file, frame by frame."""

from __future__ import annotations

import contextlib
import json
import math
import os
import time
from collections.abc import Iterator, Mapping
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TypeAlias

import netCDF4
import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.fields import AnyArray, Field
from mpmfw.results import layout
from mpmfw.results.frame import Frame, RunHeader
from mpmfw.results.reading import read, tree_of
from mpmfw.results.room import check_room
from mpmfw.results.timeline import Timeline
from mpmfw.results.writers import claim, release, replace_claimed

if TYPE_CHECKING:
    import xarray as xr

#: Arrays of one output with their declarations, by group and name.
Arrays: TypeAlias = Mapping[str, Mapping[str, tuple[Field, AnyArray]]]

#: Bytes of frames that are written at once.
WRITTEN_AT_ONCE = 4_000_000

#: Seconds of wall time for which frames of a file wait for others that are written with them: what a kill loses.
WRITTEN_EVERY = 0.25


class RunWriter:
    """A run's NetCDF-4 file, open for appending frames.

    Frames of a file are written and synced within a quarter of a second, those that follow each other faster together: handing
    each of a dozen series to the file every other step would take as long as the steps. After the process dies, the frames
    written so far are readable, unless it is killed within a sync, which only a checkpoint outlives. The file has its final
    name from the start and may be opened by others while the run goes on.

    Material points of all bodies are one ragged array of the group ``particles``, surface nodes one of ``surface``, body
    after body; ``particle_count`` and ``surface_node_count`` tell them apart (CF: contiguous ragged arrays), and
    :func:`mpmfw.open` gives every body its group. A group of the file for each body would cost with the square of the bodies.

    Parameters
    ----------
    path
        File to create; an existing one is replaced. ``None`` keeps the results in memory.
    header
        What is known of the run before its first step.

    Raises
    ------
    MpmfwError
        The file cannot be created, or another run is writing it.
    """

    def __init__(self, path: str | os.PathLike[str] | None, header: RunHeader) -> None:
        self.header = header
        # A plug-in may change the working folder while the run goes on
        self.path = None if path is None else os.path.abspath(path)
        self._fields = {(field.group, field.name): field for field in header.fields}
        self._written = -math.inf  #: wall time at which nothing waited any more
        self._pairs = len(header.pairs)
        self._tree: xr.DataTree | None = None
        self._lock: int | None = None
        self._dataset = self._create()
        self._write_header()

    @property
    def frames(self) -> int:
        """Number of outputs so far."""
        return self._outputs.frames

    def write(self, frame: Frame) -> None:
        """Append one frame, and write those that wait if it is time.

        Raises
        ------
        MpmfwError
            An array was not declared or does not have the declared shape, or the disk is full.
        """
        with self._telling(self.frames):
            self._add_pairs(frame.pairs)
            points = {
                name: self._declared("particles", name, given) for name, given in frame.particles.items()
            }
            others = {
                place: {name: self._declared(group, name, given) for name, given in arrays.items()}
                for place, group, arrays in _places(frame)
            }
            self._outputs.add(frame.time, others)
            if points:
                self._points.add(frame.time, {"": points})
        if (
            self.is_due(time.monotonic())
            or sum(each.waiting_bytes for each in self._timelines) > WRITTEN_AT_ONCE
        ):
            self.flush()

    def repeat(self, path: str, count: int) -> None:
        """Write the first outputs of another file of the same run.

        Raises
        ------
        MpmfwError
            There are not ``count`` of them, or they are of another run.
        """
        try:
            with netCDF4.Dataset(path) as old:
                old.set_always_mask(False)
                old.set_auto_maskandscale(False)
                self._repeat(old, count, os.path.getsize(path))
        except (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError) as error:
            raise MpmfwError(f"'{path}' does not hold the first {count} outputs of the run") from error

    def _repeat(self, old: netCDF4.Dataset, count: int, size: int) -> None:
        """Write the outputs of a file of some ``size`` [bytes], one after the other."""
        pairs: Any = old.variables.get("pair", [])
        points = old["particles"]["time"]
        if 8 * max(count, len(pairs), len(points)) > size:
            raise ValueError("the file is shorter than its dimensions say")
        times, labels, at = old["time"][:count], tuple(map(str, pairs[:])), points[:]
        if len(times) < count or not np.isfinite(times).all():
            raise ValueError("outputs are missing")
        self._add_pairs(labels)
        places: list[str] = [name for name in ("series", "surface", "grid") if name in old.groups]
        if "contact" in old.groups:
            places += [f"contact/{pair}" for pair in old["contact"].groups]
        outputs = {place: self._columns(old[place], place, size) for place in places}
        of_points = self._columns(old["particles"], "particles", size)
        for k in range(count):
            self._outputs.add(times[k], {place: _frame_of(columns, k) for place, columns in outputs.items()})
            for own in np.flatnonzero(at == times[k]).tolist():
                self._points.add(times[k], {"": _frame_of(of_points, own)})
            if sum(each.waiting_bytes for each in self._timelines) > WRITTEN_AT_ONCE:
                self.flush()
        self.flush()

    def _columns(self, group: netCDF4.Dataset, place: str, size: int) -> list[tuple[Field, Any]]:
        """The declared variables of a group of another file, an output of which is no larger than that file."""
        found = []
        for name, variable in group.variables.items():
            group_of: Any = place.partition("/")[0]
            field = self._fields.get((group_of, name))
            if field is None:
                continue
            own = variable.shape if layout.is_static(field) else variable.shape[1:]
            declared = variable.dimensions == layout.dimensions(field) and variable.dtype == np.dtype(
                field.dtype
            )
            if not declared or math.prod(own) * variable.dtype.itemsize > size:
                raise ValueError(f"{place}/{name} is not as it was declared")
            found.append((field, variable))
        return found

    def is_due(self, now: float) -> bool:
        """Whether frames have waited long enough at a wall time [s]; those in memory, which nobody else reads, never have."""
        return self.path is not None and self._outputs.waits > 0 and now - self._written >= WRITTEN_EVERY

    def flush(self) -> None:
        """Write the frames that wait, and sync: their times after their arrays.

        Raises
        ------
        MpmfwError
            The disk is full; they are lost.
        """
        timelines = [timeline for timeline in self._timelines if timeline.waits]
        if not timelines:
            return
        first = self.frames - self._outputs.waits
        try:
            with self._telling(first):
                if self.path is not None:
                    size = sum(timeline.waiting_bytes for timeline in timelines)
                    check_room(self.path, 2 * size, f"frame {first}")  # a chunk that is begun takes more
                for timeline in timelines:
                    timeline.write_arrays()
                self._points.write_times()
                self._dataset.sync()
                # HDF5 flushes in an order of its own: only a second sync makes an output whose time is there a
                # complete one, and the material points of that time with it.
                self._outputs.write_times()
                self._dataset.sync()
        finally:
            for timeline in timelines:
                timeline.forget()
            self._written = time.monotonic()

    @contextlib.contextmanager
    def _telling(self, frame: int) -> Iterator[None]:
        """Context in which a failure of the file is one to write a frame."""
        try:
            yield
        except (OSError, RuntimeError) as error:
            raise MpmfwError(f"cannot write frame {frame} to '{self.path}': {error}") from error

    def take_place_of(self, path: str, descriptor: int | None) -> None:
        """Give the file the name of another, which was claimed with ``descriptor``; readers see the old or the new one, whole."""
        assert self.path is not None
        self.flush()
        replace_claimed(self.path, path, descriptor)
        self.path = path

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Add what is known at the end as root attributes; ``status`` is ``ok`` unless they say otherwise.

        Parameters
        ----------
        attributes
            steps, material_points, cpu_time, wall_time, peak_memory, settle_time, output_time, gap_time,
            ``cpu_<stage>``, ``wall_<stage>`` [s, bytes] …
        """
        self.flush()
        self._set_attributes({"status": "ok", **attributes})
        self._dataset.sync()

    def _create(self) -> netCDF4.Dataset:
        """An empty file of this writer's own."""
        try:
            if self.path is None:
                return netCDF4.Dataset("results.nc", "w", diskless=True, persist=False)
            self._lock = claim(self.path)
            check_room(self.path, 0, "results", anew=True)
            return netCDF4.Dataset(self.path, "w")
        except OSError as error:
            raise MpmfwError(f"cannot create '{self.path}': {error.strerror or error}") from error

    def close(self) -> None:
        """Close the file; results kept in memory are read first. Closing twice is allowed."""
        if not self._dataset.isopen():
            return
        try:
            self.flush()
            if self.path is None:
                self._tree = tree_of(self._dataset)
        finally:
            self._dataset.close()
            release(self.path, self._lock)

    def results(self) -> xr.DataTree:
        """Close and return what was written, the same whether it is in memory or in a file."""
        self.close()
        return read(self.path) if self.path is not None else _read_back(self._tree)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is not None and self._dataset.isopen() and self._dataset.getncattr("status") == "running":
            self._set_attributes({"status": f"failed: {str(error) or type(error).__name__}"})
        self.close()

    def _write_header(self) -> None:
        header, dataset = self.header, self._dataset
        self._set_attributes(
            {"Conventions": "CF-1.12", "kind": "run", "status": "running", **header.attributes}
        )
        axes = layout.AXES[: header.dim]
        _labels(dataset, "axis", axes)
        _labels(dataset, "axis2", axes)
        _labels(dataset, "rotation", ("z",) if header.dim == 2 else axes)
        _labels(dataset, "body", header.bodies)
        _labels(dataset, "pair", header.pairs, grows=header.more_pairs)
        self._outputs = Timeline(
            dataset, header.dim, more_pairs=header.more_pairs, per_metre=header.per_metre
        )
        dataset.createGroup("series")
        points = self._ragged("particles", "particle", header.particle_count)
        self._points = Timeline(points, header.dim, more_pairs=header.more_pairs, per_metre=header.per_metre)
        self._timelines = self._outputs, self._points
        if any(header.surface_count.values()):
            surface = self._ragged("surface", "surface_node", header.surface_count)
            if header.connectivity:
                following = surface.createVariable("next", "i8", ("surface_node",))
                following.long_name = "surface node at which the segment that starts at this one ends"
                outlined = [body for body in header.bodies if header.surface_count.get(body, 0)]
                following[:] = np.concatenate([header.connectivity[body] for body in outlined])
        dataset.sync()

    def _ragged(self, place: str, dim: str, counts: Mapping[str, int]) -> netCDF4.Dataset:
        """A group of arrays over the points of all bodies."""
        group = self._dataset.createGroup(place)
        group.createDimension(dim, sum(counts.values()))
        count = group.createVariable(f"{dim}_count", "i8", ("body",))
        count.setncatts(
            {"sample_dimension": dim, "long_name": f"{place} of each body, which follow each other"}
        )
        count[:] = [counts.get(body, 0) for body in self.header.bodies]
        return group

    def _add_pairs(self, labels: tuple[str, ...]) -> None:
        """Make room for pairs that no frame before this had; there they are missing."""
        if len(labels) <= self._pairs:
            return
        if not self.header.more_pairs:
            raise MpmfwError("frame names pairs that the header does not, which says that there are no more")
        self.flush()
        self._dataset["pair"][self._pairs : len(labels)] = np.array(labels[self._pairs :], dtype=object)
        self._pairs = len(labels)
        self._outputs.forget_shapes()

    def _set_attributes(self, attributes: Mapping[str, Any]) -> None:
        for name, value in attributes.items():
            if value is not None:
                self._dataset.setncattr(name, _storable(value))

    def _declared(self, group: str, name: str, values: AnyArray) -> tuple[Field, AnyArray]:
        try:
            return self._fields[group, name], np.asarray(values)  # type: ignore[index]
        except KeyError:
            raise MpmfwError(f"frame holds the undeclared field '{name}' in group '{group}'") from None


def _places(frame: Frame) -> list[tuple[str, str, Mapping[str, AnyArray]]]:
    """List the arrays of every output as (path of the group in the file, group of the declaration, arrays)."""
    return [
        ("series", "series", frame.series),
        ("surface", "surface", frame.surface),
        *((f"contact/{pair}", "contact", arrays) for pair, arrays in frame.contact.items()),
        ("grid", "grid", frame.grid),
    ]


def _frame_of(columns: list[tuple[Field, Any]], k: int) -> dict[str, tuple[Field, AnyArray]]:
    """Arrays of output ``k`` of another file; those without a time come with the first."""
    return {
        field.name: (field, variable[...] if layout.is_static(field) else variable[k])
        for field, variable in columns
        if k == 0 or not layout.is_static(field)
    }


def _labels(dataset: netCDF4.Dataset, name: str, labels: tuple[str, ...], *, grows: bool = False) -> None:
    if not labels and not grows:  # a dimension of size 0 would be an unlimited one
        return
    dataset.createDimension(name, None if grows else len(labels))
    variable = dataset.createVariable(name, str, (name,))
    if labels:
        variable[:] = np.array(labels, dtype=object)


def _storable(value: Any) -> Any:
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, str):
        return value.encode("utf-8", "replace").decode()  # names of files may be no text
    if isinstance(value, Mapping | list | tuple | set | frozenset):
        return json.dumps(sorted(value) if isinstance(value, set | frozenset) else value, default=str)
    return value


def _read_back(tree: xr.DataTree | None) -> xr.DataTree:
    if tree is None:
        raise MpmfwError("the results could not be read back from memory")
    return tree
