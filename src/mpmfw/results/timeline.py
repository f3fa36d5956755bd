"""A group of a results' file whose variables share their times: arrays of frames wait, and are written
before the times.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import netCDF4
import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.results import layout
from mpmfw.state.fields import AnyArray, Field


@dataclasses.dataclass(slots=True)
class _Column:
    """A variable of the file, and its arrays of frames that are not in it yet."""

    variable: netCDF4.Variable[Any]
    dtype: Any
    static: bool  #: whether it has no time
    shape: tuple[int, ...] | None = None  #: of one frame
    waiting: list[AnyArray] = dataclasses.field(default_factory=list)


class Timeline:
    """The times of a group of the file, along a dimension ``along``, and the variables that have them.

    ``times`` [s] are those of frames before, in which nothing of the group was recorded; the rest is as of
    :class:`mpmfw.results.RunHeader`.
    """

    def __init__(
        self,
        group: netCDF4.Dataset,
        dim: int,
        *,
        more_pairs: bool,
        per_metre: bool,
        times: Sequence[float] = (),
        along: str = "time",
    ) -> None:
        self.group, self.dim, self.more_pairs, self.per_metre = group, dim, more_pairs, per_metre
        self.frames = 0
        self.waiting_bytes = 0
        self._times: list[float] = []
        self._columns: dict[str, _Column] = {}
        group.createDimension(along, None)
        self._time = _variable(group, "time", "f8", (along,), chunksizes=(1024,))
        self._time.setncatts({"units": "s", "long_name": "time since the motion starts", "axis": "T"})
        for time in times:
            self.add(time, {})

    @property
    def waits(self) -> int:
        """Number of frames that are not written yet."""
        return len(self._times)

    def add(self, time: float, arrays: Mapping[str, tuple[Field, AnyArray]]) -> None:
        """Take one frame: arrays by name, each with its declaration."""
        for field, values in arrays.values():
            self._put(field, values)
        self._times.append(time)
        self.frames += 1

    def forget_shapes(self) -> None:
        """Forget the sizes of dimensions, of which one has grown."""
        for column in self._columns.values():
            column.shape = None

    def write_arrays(self) -> None:
        """Write the arrays that wait, but not yet their times."""
        start = self.frames - self.waits
        for column in self._columns.values():
            if column.waiting and column.static:
                column.variable[...] = column.waiting[0]
            elif column.waiting:
                _write(column.variable, start, np.stack(column.waiting))
            column.waiting.clear()

    def write_times(self) -> None:
        """Write the times of the arrays that :meth:`write_arrays` has written."""
        if self._times:
            _write(self._time, self.frames - self.waits, np.array(self._times))
        self._times.clear()
        self.waiting_bytes = 0

    def forget(self) -> None:
        """Drop the frames that wait."""
        self.frames -= self.waits
        self._times.clear()
        for column in self._columns.values():
            column.waiting.clear()
        self.waiting_bytes = 0

    def _put(self, field: Field, values: AnyArray) -> None:
        static = layout.is_static(field)
        if static and field.name in self._columns:
            return
        column = self._columns.get(field.name)
        if column is None:
            column = _Column(self._define(field, values), np.dtype(field.dtype), static)
            self._columns[field.name] = column
        if column.shape is None:  # asked of the file once, which counts unlimited dimensions
            column.shape = column.variable.shape if static else column.variable.shape[1:]
        if values.shape != column.shape:
            raise MpmfwError(
                f"field '{self._called(field)}' has shape {values.shape}, expected {column.shape}"
            )
        if static:  # written later: to define the next variable after a writing costs with all variables
            column.waiting.append(values.copy())
            return
        while len(column.waiting) < self.waits:  # a field that earlier frames did not hold is missing there
            column.waiting.append(np.full(column.shape, column.variable.get_fill_value()))
        column.waiting.append(values.astype(column.dtype))
        self.waiting_bytes += column.waiting[-1].nbytes

    def _called(self, field: Field) -> str:
        return f"{self.group.path.strip('/')}/{field.name}"

    def _define(self, field: Field, values: AnyArray) -> netCDF4.Variable[Any]:
        """Create the variable of a field; the array gives dimensions that the header does not know."""
        if values.ndim != len(field.dims):
            raise MpmfwError(
                f"field '{self._called(field)}' has shape {values.shape}, declared dims {field.dims}"
            )
        known = tuple(_size(self.group, dim) or n for dim, n in zip(field.dims, values.shape, strict=True))
        if known != values.shape:
            raise MpmfwError(f"field '{self._called(field)}' has shape {values.shape}, expected {known}")
        for dim, size in zip(field.dims, known, strict=True):
            if _size(self.group, dim) is None:
                self.group.createDimension(dim, size)
        dtype: Any = np.dtype(field.dtype)
        chunks = layout.chunks(field, values.shape, dtype.itemsize, more_pairs=self.more_pairs)
        variable = _variable(self.group, field.name, dtype, layout.dimensions(field), chunksizes=chunks)
        if chunks is not None:  # HDF5 keeps 16 MB of every variable, which nobody asks for again
            variable.set_var_chunk_cache(size=dtype.itemsize * math.prod(chunks))
        variable.setncatts(
            {**field.attributes, "units": layout.unit(field, self.dim, per_metre=self.per_metre)}
        )
        return variable


def _variable(
    group: netCDF4.Dataset, name: str, dtype: Any, dims: tuple[str, ...], **layout: Any
) -> netCDF4.Variable[Any]:
    """A variable whose numbers are stored as they are; NaN where none is written.

    Nothing is compressed: deflate takes ten times as long as the writing and saves a sixth of floating-point
    noise.
    """
    missing = np.nan if np.dtype(dtype).kind == "f" else None
    variable: netCDF4.Variable[Any] = group.createVariable(name, dtype, dims, fill_value=missing, **layout)
    variable.set_auto_maskandscale(False)  # costs more than the writing itself
    return variable


def _write(variable: netCDF4.Variable[Any], start: int, values: AnyArray) -> None:
    """Write whole frames from ``start`` on.

    Not by ``variable[start:…] = values``, which takes five times as long to find out where that is.
    """
    at = [start] + [0] * (values.ndim - 1)
    variable._put(np.ascontiguousarray(values), at, list(values.shape), [1] * values.ndim)


def _size(group: netCDF4.Dataset | None, dim: str) -> int | None:
    """Return the size of a dimension seen from a group, or None."""
    while group is not None:
        if dim in group.dimensions:
            return len(group.dimensions[dim])
        group = group.parent
    return None
