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
from mpmfw.results.reading import checked_tree, read_run, tree_of
from mpmfw.results.replacing import check_room, claim, release, replacement
from mpmfw.results.timeline import Frame, RunHeader, Timeline
from mpmfw.state.fields import AnyArray, Field

if TYPE_CHECKING:
    import xarray as xr

AXES = ("x", "y", "z")

_CONNECTIVITY = {
    "next": "end node of the segment that starts at this surface node",
    "triangles": "surface nodes of each triangle, counter-clockwise as seen from outside",
}

#: Bytes of frames that are written at once.
WRITTEN_AT_ONCE = 16_000_000

#: Seconds of wall time that frames wait, to be written together: what a kill loses.
WRITTEN_EVERY = 0.25

#: CPU seconds of one writing, above which frames wait longer in proportion.
QUICK = 0.025


class RunWriter:
    """A run's NetCDF-4 file, open for appending frames; ``path`` None keeps the results in memory.

    Frames within a quarter of a second are written together. Written frames survive a kill, except during a
    sync. Each group, such as ``particles/<body>``, has its own ``time``: the cost of a shared dimension grows
    with the square of the number of groups. The root's ``time``, along ``output``, is written last and marks
    the complete outputs.

    ``content`` is a file of the same run in bytes; the new file starts with its outputs. Raises MpmfwError if
    it is damaged, or if the file cannot be written.
    """

    def __init__(
        self, path: str | os.PathLike[str] | None, header: RunHeader, content: AnyArray | None = None
    ) -> None:
        self.header = header
        # A plug-in may change the working folder
        self.path = None if path is None else os.path.abspath(path)
        self._fields = {(field.group, field.name): field for field in header.fields}
        self._written, self._took = -math.inf, 0.0  #: wall time of the last writing, and its CPU time [s]
        self._groups: dict[str, Timeline] = {}
        self._times: list[float] = []  #: of all outputs
        self._pairs = len(header.pairs)
        self._tree: xr.DataTree | None = None
        self._lock: int | None = None
        self._dataset = self._create(content)
        self._set_attributes(
            {"Conventions": "CF-1.12", "kind": "run", "status": "running", **header.attributes}
        )
        if content is None:
            self._define()
        self._outputs = Timeline(self._dataset, header, along="output")
        self._timeline("series")
        self._dataset.sync()

    @property
    def frames(self) -> int:
        """Number of outputs so far."""
        return len(self._times)

    def write(self, frame: Frame) -> None:
        """Append one frame."""
        with self._failing(self.frames):
            self._add_pairs(frame.pairs)
            places = self._places(frame)
            known = [k for k in self._groups if frame.particles or not k.startswith("particles/")]
            for place in dict.fromkeys(("series", *known, *places)):
                self._timeline(place).add(frame.time, places.get(place, {}))
            self._outputs.add(frame.time, {})
            self._times.append(frame.time)
        if self.is_due(time.monotonic()) or self._waiting_bytes() > WRITTEN_AT_ONCE:
            self.flush()

    def is_due(self, now: float) -> bool:
        """Return True if frames have waited long enough at a wall time [s]."""
        wait = WRITTEN_EVERY * max(1.0, self._took / QUICK)
        return self.path is not None and self._outputs.waits > 0 and now - self._written >= wait

    def _waiting_bytes(self) -> int:
        return sum(each.waiting_bytes for each in self._groups.values())

    def flush(self) -> None:
        """Write the frames that wait, and sync."""
        if not self._outputs.waits:
            return
        begin = time.thread_time()
        try:
            with self._failing(self._outputs.written):
                if self.path is not None:
                    os.stat(self.path)  # raises an error if somebody removed it
                    check_room(self.path, 2 * self._waiting_bytes())  # a new chunk takes more
                for timeline in self._groups.values():
                    timeline.write()
                self._dataset.sync()
                # HDF5 flushes in any order: times follow in a second sync
                self._outputs.write()
                self._dataset.sync()
        finally:
            for timeline in (self._outputs, *self._groups.values()):
                timeline.forget()
            del self._times[self._outputs.written :]
            self._written = time.monotonic()
            self._took = time.thread_time() - begin

    @contextlib.contextmanager
    def _failing(self, frame: int) -> Iterator[None]:
        try:
            yield
        except (OSError, RuntimeError) as error:
            reason = getattr(error, "strerror", None) or error
            raise MpmfwError(f"cannot write frame {frame} to '{self.path}': {reason}") from error

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Add root attributes; ``status`` is ``ok`` by default."""
        self.flush()
        self._set_attributes({"status": "ok", **attributes})
        self._dataset.sync()

    def close(self) -> None:
        """Close the file; a second call has no effect."""
        if not self._dataset.isopen():
            return
        try:
            self.flush()
            if self.path is None:
                self._tree = tree_of(self._dataset)
        finally:
            self._dataset.close()
            release(self._lock)

    def results(self) -> xr.DataTree:
        """Close and return the results."""
        self.close()
        if self.path is not None:
            return read_run(self.path)
        assert self._tree is not None
        return self._tree

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is not None and self._dataset.isopen() and self._dataset.getncattr("status") == "running":
            self._set_attributes({"status": f"failed: {str(error) or type(error).__name__}"})
        self.close()

    def _create(self, content: AnyArray | None) -> netCDF4.Dataset:
        if self.path is None:
            return netCDF4.Dataset("results.nc", "w", diskless=True, persist=False)
        try:
            self._lock = claim(self.path)
            check_room(self.path, 0)
            if content is None:
                return netCDF4.Dataset(self.path, "w")
            with replacement(self.path) as growing, RunWriter(growing, self.header) as copy:
                copy._repeat(content)
            release(self._lock)
            self._lock = claim(self.path)
        except OSError as error:
            raise MpmfwError(f"cannot create '{self.path}': {error.strerror or error}") from error
        except MpmfwError:
            release(self._lock)
            raise
        dataset = netCDF4.Dataset(self.path, "a")
        self._times, self._pairs = copy._times, copy._pairs
        self._groups = {place: Timeline(dataset[place], self.header) for place in copy._groups}
        return dataset

    def _repeat(self, content: Any) -> None:
        """Write the complete outputs of another file of the same run.

        Appending to that file would be unsafe: HDF5 follows its links and would write to other files.
        """
        try:
            with netCDF4.Dataset("results.nc", memory=content) as old:
                tree: Any = checked_tree(old, content.nbytes, load=False)
                times = tree["time"].values.tolist()
                if len(times) < len(old["time"]):
                    raise ValueError("outputs are missing")
                self._add_pairs(tuple(map(str, tree["pair"].values)) if "pair" in tree.coords else ())
                for node in tree.descendants:
                    if "time" in (group := node.to_dataset(inherit=False)):
                        self._repeat_group(node.path.strip("/"), group)
                for at in times:
                    self._outputs.add(at, {})
                self._times += times
                self.flush()
        except (
            MpmfwError,
            OSError,
            RuntimeError,
            LookupError,
            ValueError,
            TypeError,
            AttributeError,
        ) as error:
            raise MpmfwError("its copy of the results is damaged, or belongs to another run") from error

    def _repeat_group(self, place: str, group: xr.Dataset) -> None:
        kind, columns = place.partition("/")[0], []
        for field in (one for (of, name), one in self._fields.items() if of == kind and name in group):
            if group[field.name].dtype != field.dtype:
                raise ValueError(f"{place}/{field.name} differs from its declaration")
            columns.append((field, group[field.name], "time" in group[field.name].dims))
        for k, at in enumerate(group["time"].values.tolist()):
            arrays = {
                field.name: (field, (values[k] if moves else values).values)
                for field, values, moves in columns
            }
            self._timeline(place).add(at, arrays)
            if self._waiting_bytes() > WRITTEN_AT_ONCE:
                self._timeline(place).write()

    def _define(self) -> None:
        header, dataset = self.header, self._dataset
        axes = AXES[: header.dim]
        _labels(dataset, "axis", axes)
        _labels(dataset, "axis2", axes)
        _labels(dataset, "rotation", ("z",) if header.dim == 2 else axes)
        _labels(dataset, "side", header.sides)
        _labels(dataset, "body", header.bodies)
        _labels(dataset, "pair", header.pairs, grows=header.more_pairs)
        variables = []
        for body, facets in header.connectivity.items():
            if header.surface_count.get(body, 0):
                group = self._timeline(f"surface/{body}").group
                group.createDimension("surface_node", header.surface_count[body])
                dims = ("surface_node",) if header.dim == 2 else ("triangle", "corner")
                for dim, size in zip(dims, facets.shape, strict=True):
                    if dim not in group.dimensions:
                        group.createDimension(dim, size)
                name = "next" if header.dim == 2 else "triangles"
                variables.append((group.createVariable(name, "i8", dims), facets))
        for variable, facets in variables:
            variable.long_name = _CONNECTIVITY[variable.name]
            variable[:] = facets

    def _timeline(self, place: str) -> Timeline:
        if place not in self._groups:
            # Not every output has material points
            times = () if place.startswith("particles/") else tuple(self._times)
            self._groups[place] = Timeline(self._dataset.createGroup(place), self.header, times)
        return self._groups[place]

    def _places(self, frame: Frame) -> dict[str, dict[str, tuple[Field, AnyArray]]]:
        places = {"series": self._declared("series", frame.series)}
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
        if len(labels) <= self._pairs:
            return
        if not self.header.more_pairs:
            raise MpmfwError("frame names more pairs than the header allows")
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
