"""Write a run's file, frame by frame."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from types import TracebackType
from typing import Any, Literal, Self

import netCDF4
import numpy as np
import xarray as xr

from mpmfw.errors import MpmfwError
from mpmfw.fields import AnyArray, Field
from mpmfw.results import layout
from mpmfw.results.frame import Frame, RunHeader
from mpmfw.results.reading import read, tree_of
from mpmfw.results.room import check_room
from mpmfw.results.writers import claim, release

#: Deflate level of particle and surface arrays; level 4 takes longer and gains next to nothing on
#: floating-point noise.
COMPRESSION: Literal[1] = 1

#: Bytes of frames that are written at once where nobody else can read them in between.
WRITTEN_AT_ONCE = 4_000_000


class RunWriter:
    """A run's NetCDF-4 file, open for appending frames.

    Every frame of a file is synced: after the process dies, whatever the reason, the frames written so far
    are readable. The file has its final name from the start and may be opened by others while the run goes
    on.

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
        self.frames = 0
        self._fields = {(field.group, field.name): field for field in header.fields}
        self._variables: dict[tuple[str, str], netCDF4.Variable[Any]] = {}
        self._shapes: dict[tuple[str, str], tuple[int, ...]] = {}
        self._pairs = len(header.pairs)
        self._waiting: dict[tuple[str, str], list[AnyArray]] = {}
        self._times: list[float] = []
        self._waiting_bytes = 0
        self._tree: xr.DataTree | None = None
        self._lock: int | None = None
        self._dataset = self._create()
        self._write_header()

    def write(self, frame: Frame) -> None:
        """Append one frame and sync it.

        Raises
        ------
        MpmfwError
            An array was not declared or does not have the declared shape, or the disk is full.
        """
        try:
            self._add_pairs(frame.pairs)
            for place, group, arrays in _places(frame):
                for name, values in arrays.items():
                    self._put(place, self._declared(group, name), np.asarray(values))
            self._times.append(frame.time)
            self.frames += 1
            if self.path is not None or self._waiting_bytes > WRITTEN_AT_ONCE:
                self._flush()
        except (OSError, RuntimeError) as error:
            raise MpmfwError(f"cannot write frame {self.frames - 1} to '{self.path}': {error}") from error

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Add what is known at the end as root attributes; ``status`` is ``ok`` unless they say otherwise.

        Parameters
        ----------
        attributes
            steps, material_points, cpu_time, wall_time, peak_memory, settle_time, output_time, gap_time,
            ``cpu_<stage>``, ``wall_<stage>`` [s, bytes] …
        """
        self._flush()
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
            if self.path is None:
                self._flush()
                self._tree = tree_of(self._dataset)
        finally:
            self._dataset.close()
            release(self.path, self._lock)

    def results(self) -> xr.DataTree:
        """Close and return what was written, the same whether it is in memory or in a file."""
        self.close()
        return read(self.path) if self.path is not None else _known(self._tree)

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
        dataset.createDimension("time", None)
        time = dataset.createVariable("time", "f8", ("time",), fill_value=np.nan, chunksizes=(1024,))
        time.setncatts({"units": "s", "long_name": "time since the motion starts", "axis": "T"})
        axes = layout.AXES[: header.dim]
        _labels(dataset, "axis", axes)
        _labels(dataset, "axis2", axes)
        _labels(dataset, "rotation", ("z",) if header.dim == 2 else axes)
        _labels(dataset, "body", header.bodies)
        _labels(dataset, "pair", header.pairs, grows=header.more_pairs)
        dataset.createGroup("series")
        for body in header.bodies:
            self._own_group(f"particles/{body}").createDimension("particle", header.particle_count[body])
            if header.surface_count.get(body, 0):
                surface = self._own_group(f"surface/{body}")
                surface.createDimension("surface_node", header.surface_count[body])
                if body in header.connectivity:
                    following = surface.createVariable("next", "i8", ("surface_node",))
                    following.long_name = "surface node at which the segment that starts at this one ends"
                    following[:] = header.connectivity[body]
        dataset.sync()

    def _own_group(self, place: str) -> netCDF4.Dataset:
        """A body's group; of many bodies each has dimensions of its own, in the place of the root's.

        HDF5 keeps at every dimension a list of the variables that have it, which it writes anew for each one more, and
        netCDF looks through all of them for the length of the time: both would grow with the square of the bodies.
        """
        group = self._dataset.createGroup(place)
        if self.header.more_pairs:
            group.createDimension("time", None)
            group.createDimension("axis", self.header.dim)
            group.createDimension("axis2", self.header.dim)
        return group

    def _add_pairs(self, labels: tuple[str, ...]) -> None:
        """Make room for pairs that no frame before this had; there they are missing."""
        if len(labels) <= self._pairs:
            return
        if not self.header.more_pairs:
            raise MpmfwError("frame names pairs that the header does not, which says that there are no more")
        self._flush()
        self._dataset["pair"][self._pairs : len(labels)] = np.array(labels[self._pairs :], dtype=object)
        self._pairs = len(labels)
        self._shapes.clear()

    def _set_attributes(self, attributes: Mapping[str, Any]) -> None:
        for name, value in attributes.items():
            if value is not None:
                self._dataset.setncattr(name, _storable(value))

    def _declared(self, group: str, name: str) -> Field:
        try:
            return self._fields[group, name]  # type: ignore[index]
        except KeyError:
            raise MpmfwError(f"frame holds the undeclared field '{name}' in group '{group}'") from None

    def _put(self, place: str, field: Field, values: AnyArray) -> None:
        if layout.is_static(field) and self.frames > 0:
            return
        variable = self._variables.get((place, field.name))
        if variable is None:
            variable = self._variables[place, field.name] = self._define(place, field, values)
        expected = self._shapes.get((place, field.name))
        if expected is None:  # asked of the file once: it looks for the length of the time in every group
            expected = variable.shape if layout.is_static(field) else variable.shape[1:]
            self._shapes[place, field.name] = expected
        if values.shape != expected:
            raise MpmfwError(f"field '{place}/{field.name}' has shape {values.shape}, expected {expected}")
        if layout.is_static(field):
            variable[...] = values
            return
        waiting = self._waiting.setdefault((place, field.name), [])
        # A field that earlier frames did not hold is missing there
        waiting += [
            np.full(expected, variable.get_fill_value()) for _ in range(len(self._times) - len(waiting))
        ]
        waiting.append(values.copy())
        self._waiting_bytes += values.nbytes

    def _flush(self) -> None:
        """Write the frames that wait, and sync: their times after their arrays."""
        if not self._times:
            return
        start = self.frames - len(self._times)
        if self.path is not None:
            # Compressed it is less, and a chunk that is begun anew is more
            check_room(self.path, 2 * self._waiting_bytes, f"frame {start}")
        for key, waiting in self._waiting.items():
            if waiting:
                self._variables[key][start : start + len(waiting)] = np.stack(waiting)
                waiting.clear()
        self._dataset.sync()
        # HDF5 flushes in an order of its own: only a second sync makes a frame whose time is there a
        # complete one.
        self._dataset["time"][start : self.frames] = self._times
        self._dataset.sync()
        self._times.clear()
        self._waiting_bytes = 0

    def _define(self, place: str, field: Field, values: AnyArray) -> netCDF4.Variable[Any]:
        """Create the variable of a field; the array gives dimensions that the header does not know."""
        if values.ndim != len(field.dims):
            raise MpmfwError(
                f"field '{place}/{field.name}' has shape {values.shape}, declared dims {field.dims}"
            )
        group = self._dataset.createGroup(place)
        known = tuple(_size(group, dim) or size for dim, size in zip(field.dims, values.shape, strict=True))
        if known != values.shape:
            raise MpmfwError(f"field '{place}/{field.name}' has shape {values.shape}, expected {known}")
        for dim, size in zip(field.dims, known, strict=True):
            if _size(group, dim) is None:
                group.createDimension(dim, size)
        dtype: Any = np.dtype(field.dtype)
        variable: netCDF4.Variable[Any] = group.createVariable(
            field.name,
            dtype,
            layout.dimensions(field),
            zlib=field.group != "series",
            complevel=COMPRESSION,
            chunksizes=layout.chunks(field, values.shape, dtype.itemsize, more_pairs=self.header.more_pairs),
            fill_value=np.nan if dtype.kind == "f" else None,
        )
        variable.setncatts({**field.attributes, "units": layout.unit(field, self.header.dim)})
        variable.set_auto_maskandscale(False)  # costs more than the writing itself
        return variable


def _places(frame: Frame) -> list[tuple[str, str, Mapping[str, AnyArray]]]:
    """List the frame's arrays as (path of the group in the file, group of the declaration, arrays)."""
    return [
        ("series", "series", frame.series),
        *((f"particles/{body}", "particles", arrays) for body, arrays in frame.particles.items()),
        *((f"surface/{body}", "surface", arrays) for body, arrays in frame.surface.items()),
        *((f"contact/{pair}", "contact", arrays) for pair, arrays in frame.contact.items()),
        *([("grid", "grid", frame.grid)] if frame.grid else []),
    ]


def _labels(dataset: netCDF4.Dataset, name: str, labels: tuple[str, ...], *, grows: bool = False) -> None:
    if not labels and not grows:  # a dimension of size 0 would be an unlimited one
        return
    dataset.createDimension(name, None if grows else len(labels))
    variable = dataset.createVariable(name, str, (name,))
    if labels:
        variable[:] = np.array(labels, dtype=object)


def _size(group: netCDF4.Dataset | None, dim: str) -> int | None:
    """Return the size of a dimension seen from a group, or None."""
    while group is not None:
        if dim in group.dimensions:
            return len(group.dimensions[dim])
        group = group.parent
    return None


def _storable(value: Any) -> Any:
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, Mapping | list | tuple | set | frozenset):
        return json.dumps(sorted(value) if isinstance(value, set | frozenset) else value, default=str)
    return value


def _known(tree: xr.DataTree | None) -> xr.DataTree:
    if tree is None:
        raise MpmfwError("the results could not be read back from memory")
    return tree
