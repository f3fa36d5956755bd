"""Write a run's file, frame by frame."""

from __future__ import annotations

import contextlib
import json
import math
import os
import time
from collections.abc import Iterator, Mapping
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import netCDF4
import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.results import layout
from mpmfw.results.frame import Frame, RunHeader
from mpmfw.results.reading import read_run, tree_of
from mpmfw.results.replacing import check_room
from mpmfw.results.timeline import Timeline
from mpmfw.results.writers import claim, release, replace_claimed
from mpmfw.state.fields import AnyArray, Field

if TYPE_CHECKING:
    import xarray as xr

#: Bytes of frames that are written at once.
WRITTEN_AT_ONCE = 16_000_000

#: Seconds of wall time for which frames of a file wait for others that are written with them: what a kill
#: loses.
WRITTEN_EVERY = 0.25

#: CPU seconds that a writing may take. Where one takes longer, as with the ten thousand variables of a
#: thousand bodies, frames wait longer in proportion.
QUICK = 0.025


class RunWriter:
    """A run's NetCDF-4 file, open for appending frames; ``path`` None keeps the results in memory.

    Frames are written and synced within a quarter of a second, those that follow each other faster together:
    writing a dozen series every other step would take as long as the steps. After the process dies, the
    frames written so far are readable, unless it is killed within a sync, which only a checkpoint outlives.

    The groups are ``series``, ``particles/<body>``, ``surface/<body>``, ``contact/<pair>`` and ``grid``. Each
    has its own dimension and coordinate ``time``: the cost of a shared dimension grows with the square of the
    number of groups. The root's ``time``, along ``output``, is written last and tells which outputs are
    complete.

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
        self._written, self._took = -math.inf, 0.0  #: wall time of the last writing, and its CPU time [s]
        self._groups: dict[str, Timeline] = {}
        self._times: list[float] = []  #: of all outputs
        self._pairs = len(header.pairs)
        self._tree: xr.DataTree | None = None
        self._lock: int | None = None
        self._dataset = self._create()
        self._write_header()

    @property
    def frames(self) -> int:
        """Number of outputs so far."""
        return len(self._times)

    def write(self, frame: Frame) -> None:
        """Append one frame, and write those that wait if it is time.

        Raises
        ------
        MpmfwError
            An array was not declared or does not have the declared shape, or the disk is full.
        """
        with self._telling(self.frames):
            self._add_pairs(frame.pairs)
            places = self._places(frame)
            known = [k for k in self._groups if frame.particles or not k.startswith("particles/")]
            for place in dict.fromkeys(("series", *known, *places)):
                self._timeline(place).add(frame.time, places.get(place, {}))
            self._outputs.add(frame.time, {})
            self._times.append(frame.time)
        if self.is_due(time.monotonic()) or self._waiting_bytes > WRITTEN_AT_ONCE:
            self.flush()

    def repeat(self, content: Any) -> None:
        """Write the outputs of another file of the same run, whose bytes are ``content``.

        Raises
        ------
        MpmfwError
            They are damaged, or of another run.
        """
        try:
            with netCDF4.Dataset("results.nc", memory=content) as old:
                old.set_always_mask(False)
                old.set_auto_maskandscale(False)
                self._repeat(old, content.nbytes)
        except (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError) as error:
            raise MpmfwError("its copy of the results is damaged, or of another run") from error

    def _repeat(self, old: netCDF4.Dataset, size: int) -> None:
        """Write the outputs of a file of some ``size`` [bytes], group after group."""
        pairs: Any = old.variables.get("pair", [])
        if 8 * max(len(old["time"]), len(pairs)) > size:
            raise ValueError("the file is shorter than its dimensions say")
        times = old["time"][:].tolist()
        if not np.isfinite(times).all():
            raise ValueError("outputs are missing")
        self._add_pairs(tuple(map(str, pairs[:])))
        wanted = set(times)
        for group in _with_times(old):
            place = group.path.strip("/")
            columns = self._columns(group, place.partition("/")[0], size)
            for k, at in enumerate(group["time"][:].tolist()):
                if at in wanted:
                    self._timeline(place).add(at, _frame_of(columns, k))
                if self._waiting_bytes > WRITTEN_AT_ONCE:
                    self._write_groups()
        for at in times:
            self._outputs.add(at, {})
        self._times += times
        self.flush()

    def _columns(self, group: netCDF4.Dataset, kind: Any, size: int) -> list[tuple[Field, Any]]:
        """The declared variables of a group of another file, an output of which is no larger than that
        file.
        """
        found = []
        for name, variable in group.variables.items():
            if (field := self._fields.get((kind, name))) is None:
                continue
            of_frame = variable.shape if layout.is_static(field) else variable.shape[1:]
            declared = variable.dimensions == layout.dimensions(field) and variable.dtype == np.dtype(
                field.dtype
            )
            if not declared or math.prod(of_frame) * variable.dtype.itemsize > size:
                raise ValueError(f"{group.path}/{name} is not as it was declared")
            found.append((field, variable))
        return found

    def is_due(self, now: float) -> bool:
        """Return True if frames have waited long enough at a wall time [s]; in memory they never have."""
        wait = WRITTEN_EVERY * max(1.0, self._took / QUICK)
        return self.path is not None and self._outputs.waits > 0 and now - self._written >= wait

    @property
    def _waiting_bytes(self) -> int:
        return sum(each.waiting_bytes for each in self._groups.values())

    def flush(self) -> None:
        """Write the frames that wait, and sync: their times after their arrays.

        Raises
        ------
        MpmfwError
            The disk is full; they are lost.
        """
        if not self._outputs.waits:
            return
        first, begin = self.frames - self._outputs.waits, time.thread_time()
        try:
            with self._telling(first):
                if self.path is not None:
                    os.stat(self.path)  # raises an error if somebody removed it
                    check_room(self.path, 2 * self._waiting_bytes)  # a new chunk takes more
                self._write_groups()
                self._dataset.sync()
                # HDF5 flushes in an order of its own: only a second sync makes an output whose time is at the
                # root a complete one
                self._outputs.write_times()
                self._dataset.sync()
        finally:
            for timeline in (self._outputs, *self._groups.values()):
                timeline.forget()
            del self._times[self._outputs.frames :]
            self._written = time.monotonic()
            self._took = time.thread_time() - begin

    def _write_groups(self) -> None:
        for timeline in self._groups.values():
            if timeline.waits:
                timeline.write_arrays()
                timeline.write_times()

    @contextlib.contextmanager
    def _telling(self, frame: int) -> Iterator[None]:
        """Context in which a failure of the file is one to write a frame."""
        try:
            yield
        except (OSError, RuntimeError) as error:
            reason = getattr(error, "strerror", None) or error
            raise MpmfwError(f"cannot write frame {frame} to '{self.path}': {reason}") from error

    def take_place_of(self, path: str, descriptor: int | None) -> None:
        """Give the file the name of another, which was claimed with ``descriptor``; readers see the old or
        the new one, whole.
        """
        assert self.path is not None
        self.flush()
        replace_claimed(self.path, path, descriptor)
        self.path = path

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Add costs and the like as root attributes; ``status`` is ``ok`` unless they say otherwise."""
        self.flush()
        self._set_attributes({"status": "ok", **attributes})
        self._dataset.sync()

    def _create(self) -> netCDF4.Dataset:
        """Return an empty file."""
        try:
            if self.path is None:
                return netCDF4.Dataset("results.nc", "w", diskless=True, persist=False)
            self._lock = claim(self.path)
            check_room(self.path, 0)
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
        if self.path is not None:
            return read_run(self.path)
        if self._tree is None:
            raise MpmfwError("the results could not be read back from memory")
        return self._tree

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
        self._outputs = self._new_timeline(dataset, along="output")
        self._timeline("series")
        segments = []
        for body, following in header.connectivity.items():
            if header.surface_count.get(body, 0):
                group = self._timeline(f"surface/{body}").group
                group.createDimension("surface_node", header.surface_count[body])
                variable = group.createVariable("next", "i8", ("surface_node",))
                variable.long_name = "surface node at which the segment that starts at this one ends"
                segments.append((variable, following))
        for variable, following in segments:
            variable[:] = following
        dataset.sync()

    def _new_timeline(self, group: netCDF4.Dataset, **options: Any) -> Timeline:
        header = self.header
        return Timeline(
            group, header.dim, more_pairs=header.more_pairs, per_metre=header.per_metre, **options
        )

    def _timeline(self, place: str) -> Timeline:
        """The times and variables of a group; in a new one, all outputs so far lack the variables."""
        if place not in self._groups:
            # Not every output has material points
            times = () if place.startswith("particles/") else tuple(self._times)
            self._groups[place] = self._new_timeline(self._dataset.createGroup(place), times=times)
        return self._groups[place]

    def _places(self, frame: Frame) -> dict[str, dict[str, tuple[Field, AnyArray]]]:
        """The arrays of a frame, with their declarations, by group of the file."""
        places = {"series": self._declared("series", frame.series)}
        if frame.grid:
            places["grid"] = self._declared("grid", frame.grid)
        for pair, arrays in frame.contact.items():
            places[f"contact/{pair}"] = self._declared("contact", arrays)
        counts = {"particles": self.header.particle_count, "surface": self.header.surface_count}
        for group, arrays in (("particles", frame.particles), ("surface", frame.surface)):
            declared, start = self._declared(group, arrays), 0
            for body in self.header.bodies if arrays else ():
                stop = start + counts[group].get(body, 0)
                if stop > start:
                    places[f"{group}/{body}"] = {
                        name: (field, values[start:stop]) for name, (field, values) in declared.items()
                    }
                start = stop
            for name, (_, values) in declared.items():
                if len(values) != start:
                    raise MpmfwError(f"field '{group}/{name}' has {len(values)} points, expected {start}")
        return places

    def _add_pairs(self, labels: tuple[str, ...]) -> None:
        """Make room for pairs that no frame before this had; there they are missing."""
        if len(labels) <= self._pairs:
            return
        if not self.header.more_pairs:
            raise MpmfwError("frame names pairs that the header does not, which says that there are no more")
        self.flush()
        self._dataset["pair"][self._pairs : len(labels)] = np.array(labels[self._pairs :], dtype=object)
        self._pairs = len(labels)
        for timeline in self._groups.values():
            timeline.forget_shapes()

    def _set_attributes(self, attributes: Mapping[str, Any]) -> None:
        for name, value in attributes.items():
            if value is not None:
                self._dataset.setncattr(name, _storable(value))

    def _declared(self, group: Any, arrays: Mapping[str, AnyArray]) -> dict[str, tuple[Field, AnyArray]]:
        declared = {}
        for name, values in arrays.items():
            if (group, name) not in self._fields:
                raise MpmfwError(f"frame holds the undeclared field '{name}' in group '{group}'")
            declared[name] = self._fields[group, name], np.asarray(values)
        return declared


def _with_times(group: netCDF4.Dataset) -> Iterator[netCDF4.Dataset]:
    """The groups below one of a file that have times of their own."""
    for child in group.groups.values():
        if "time" in child.variables:
            yield child
        yield from _with_times(child)


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
