"""Header and frames of a results' file, and its groups, whose variables share their times."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import netCDF4
import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.state.fields import AnyArray, Field, IntArray

#: Fields that do not change during a run: written with the first frame, without a time.
STATIC = frozenset({("particles", "mass"), ("particles", "initial_volume"), ("surface", "tributary")})

#: Bytes of a chunk of a series: every sync writes the open chunk of every series again.
SERIES_CHUNK = 16_384

#: Pairs in a chunk of a series where more pairs may follow.
PAIRS_CHUNK = 1024

#: Units in 3D, or of whole bodies, of quantities that are declared per metre of thickness.
_WHOLE = {
    "kg m-1": "kg",
    "m2": "m3",
    "kg m s-1 m-1": "kg m s-1",
    "kg m2 s-1 m-1": "kg m2 s-1",
    "J m-1": "J",
    "N m-1": "N",
    "N m m-1": "N m",
}


@dataclasses.dataclass(frozen=True)
class RunHeader:
    """Data of a run before its first step."""

    dim: int  #: number of space dimensions, 2 or 3
    bodies: tuple[str, ...]  #: names, in the scene's order
    pairs: tuple[str, ...]  #: labels ``a-b``, in the scene's order
    particle_count: Mapping[str, int]  #: material points of each body
    fields: tuple[Field, ...]  #: declarations of all arrays of frames; the flag ``output`` is not read
    #: surface nodes, of bodies that have any
    surface_count: Mapping[str, int] = dataclasses.field(default_factory=dict)
    #: by body, in 2D the node (surface_node,) at which each node's segment ends, in 3D triangles (k, 3)
    connectivity: Mapping[str, IntArray] = dataclasses.field(default_factory=dict)
    #: root attributes; mappings and sequences are stored as JSON, a value of None is left out
    attributes: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    sides: tuple[str, ...] = ()  #: labels ``body-side`` of prescribed sides
    more_pairs: bool = False  #: whether frames may name further pairs
    per_metre: bool = True  #: whether quantities in 2D are of a metre of thickness, else of the bodies' own


@dataclasses.dataclass
class Frame:
    """Arrays of one output with the declared shapes, without the time; an absent field is NaN."""

    time: float  #: [s]
    #: fields over the points of all bodies, in the header's order; a frame may have none
    particles: Mapping[str, AnyArray] = dataclasses.field(default_factory=dict)
    #: as ``particles``, over surface nodes
    surface: Mapping[str, AnyArray] = dataclasses.field(default_factory=dict)
    #: fields (body,), (body, axis), (body, rotation), (pair,) or (pair, axis)
    series: Mapping[str, AnyArray] = dataclasses.field(default_factory=dict)
    contact: Mapping[str, Mapping[str, AnyArray]] = dataclasses.field(default_factory=dict)  #: fields by pair
    pairs: tuple[str, ...] = ()  #: all so far, the header's first, where the header allows more


@dataclasses.dataclass(slots=True)
class _Column:
    """A variable and its buffered arrays, one a frame."""

    variable: netCDF4.Variable[Any]
    static: bool  #: whether it has no time
    shape: tuple[int, ...] | None = None  #: of one frame
    waiting: list[AnyArray] = dataclasses.field(default_factory=list)


class Timeline:
    """Times and variables of a group along a dimension; those that exist are continued.

    ``times`` [s] are those of earlier frames, for which the group has no values.
    """

    def __init__(
        self, group: netCDF4.Dataset, header: RunHeader, times: Sequence[float] = (), along: str = "time"
    ) -> None:
        self.group, self.header = group, header
        self.waiting_bytes = 0
        self._times: list[float] = []
        self._columns: dict[str, _Column] = {}
        if "time" in group.variables:
            self._time = group["time"]
            self._time.set_auto_maskandscale(False)
        else:
            group.createDimension(along, None)
            self._time = _variable(group, "time", "f8", (along,), chunksizes=(1024,))
            self._time.setncatts({"units": "s", "long_name": "time since the motion starts", "axis": "T"})
        self.written = len(self._time)  #: frames in the file
        for time in times:
            self.add(time, {})

    @property
    def waits(self) -> int:
        """Number of buffered frames."""
        return len(self._times)

    def add(self, time: float, arrays: Mapping[str, tuple[Field, AnyArray]]) -> None:
        """Buffer one frame: arrays by name, each with its declaration."""
        for field, values in arrays.values():
            self._put(field, values)
        self._times.append(time)

    def forget_shapes(self) -> None:
        """Forget the sizes of dimensions after one has grown."""
        for column in self._columns.values():
            column.shape = None

    def write(self) -> None:
        """Write the buffered frames: first the arrays, then the times."""
        for column in self._columns.values():
            if column.waiting and column.static:
                column.variable[...] = column.waiting[0]
            elif column.waiting:
                _write(column.variable, self.written, np.stack(column.waiting))
        if self._times:
            _write(self._time, self.written, np.array(self._times))
        self.written += len(self._times)
        self.forget()

    def forget(self) -> None:
        """Drop the buffered frames."""
        self._times.clear()
        for column in self._columns.values():
            column.waiting.clear()
        self.waiting_bytes = 0

    def _put(self, field: Field, values: AnyArray) -> None:
        static = _is_static(field)
        if static and field.name in self.group.variables:
            return
        if (column := self._columns.get(field.name)) is None:
            column = self._columns[field.name] = _Column(self._define(field, values), static)
        if column.shape is None:  # to count an unlimited dimension takes long
            column.shape = column.variable.shape[0 if column.static else 1 :]
        if values.shape != column.shape:
            raise MpmfwError(f"field '{self._path(field)}' has shape {values.shape}, expected {column.shape}")
        if column.static:  # written later: a definition after a writing takes long
            column.waiting.append(values.copy())
            return
        while len(column.waiting) < self.waits:  # earlier frames lack the field
            column.waiting.append(np.full(column.shape, column.variable.get_fill_value()))
        column.waiting.append(values.astype(column.variable.dtype))
        self.waiting_bytes += column.waiting[-1].nbytes

    def _path(self, field: Field) -> str:
        return f"{self.group.path.strip('/')}/{field.name}"

    def _define(self, field: Field, values: AnyArray) -> netCDF4.Variable[Any]:
        if (known := self.group.variables.get(field.name)) is not None:
            known.set_auto_maskandscale(False)
            return known
        if values.ndim != len(field.dims):
            raise MpmfwError(f"field '{self._path(field)}' has shape {values.shape}, dims {field.dims}")
        for dim, size in zip(field.dims, values.shape, strict=True):
            if _size(self.group, dim) is None:
                self.group.createDimension(dim, size)
        dims = field.dims if _is_static(field) else ("time", *field.dims)
        dtype: Any = np.dtype(field.dtype)
        chunks = self._chunks(field, values.shape, dtype.itemsize)
        variable = _variable(self.group, field.name, dtype, dims, chunksizes=chunks)
        if chunks is not None:  # HDF5 would keep 16 MB of every variable
            variable.set_var_chunk_cache(size=dtype.itemsize * math.prod(chunks))
        plane = self.header.dim == 2 and (self.header.per_metre or field.unit == "m2")
        unit = field.unit if plane else _WHOLE.get(field.unit, field.unit)
        variable.setncatts({**field.attributes, "units": unit})
        return variable

    def _chunks(self, field: Field, sizes: tuple[int, ...], itemsize: int) -> tuple[int, ...] | None:
        if _is_static(field):
            return None
        if field.group != "series":
            return (1, *sizes)
        if self.header.more_pairs:
            sizes = tuple(
                PAIRS_CHUNK if dim == "pair" else n for dim, n in zip(field.dims, sizes, strict=True)
            )
        return (max(1, SERIES_CHUNK // (itemsize * math.prod(sizes))), *sizes)


def _is_static(field: Field) -> bool:
    return (field.group, field.name) in STATIC


def _variable(
    group: netCDF4.Dataset, name: str, dtype: Any, dims: tuple[str, ...], **layout: Any
) -> netCDF4.Variable[Any]:
    """Return a new variable filled with NaN; compression would be slow and save a sixth."""
    missing = np.nan if np.dtype(dtype).kind == "f" else None
    variable: netCDF4.Variable[Any] = group.createVariable(name, dtype, dims, fill_value=missing, **layout)
    variable.set_auto_maskandscale(False)  # takes longer than the writing itself
    return variable


def _write(variable: netCDF4.Variable[Any], start: int, values: AnyArray) -> None:
    """Write frames from ``start`` on; faster than assignment by index."""
    at = [start] + [0] * (values.ndim - 1)
    variable._put(np.ascontiguousarray(values), at, list(values.shape), [1] * values.ndim)


def _size(group: netCDF4.Dataset | None, dim: str) -> int | None:
    while group is not None:
        if dim in group.dimensions:
            return len(group.dimensions[dim])
        group = group.parent
    return None
