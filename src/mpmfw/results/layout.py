"""Dimensions, units and chunks of fields in the file."""

from __future__ import annotations

import math

from mpmfw.state.fields import Field

AXES = ("x", "y", "z")

#: Fields that do not change during a run: written with the first frame, without a time.
STATIC = frozenset({("particles", "mass"), ("particles", "initial_volume"), ("surface", "tributary")})

#: Bytes of a chunk of a series. Every sync writes the open chunk of every series again: small enough not to
#: be seen there, large enough that a thousand frames of a history are read at once.
SERIES_CHUNK = 16_384

#: Pairs in a chunk of a series where more pairs may follow.
PAIRS_CHUNK = 1024

#: Declarations state quantities per metre of thickness; in 3D there is none, and bodies may name their own.
_WHOLE = {
    "kg m-1": "kg",
    "m2": "m3",
    "kg m s-1 m-1": "kg m s-1",
    "kg m2 s-1 m-1": "kg m2 s-1",
    "J m-1": "J",
    "N m-1": "N",
    "N m m-1": "N m",
}


def unit(field: Field, dim: int, *, per_metre: bool = True) -> str:
    """Return the unit of a field in 2D or 3D; extensive quantities in 2D are ``per_metre`` of thickness,
    or whole.
    """
    if dim == 2 and (per_metre or field.unit == "m2"):
        return field.unit
    return _WHOLE.get(field.unit, field.unit)


def is_static(field: Field) -> bool:
    """Return whether the field is written once, without a time."""
    return (field.group, field.name) in STATIC


def dimensions(field: Field) -> tuple[str, ...]:
    """Return the names of the variable's dimensions in the file."""
    return field.dims if is_static(field) else ("time", *field.dims)


def chunks(
    field: Field, sizes: tuple[int, ...], itemsize: int, *, more_pairs: bool = False
) -> tuple[int, ...] | None:
    """Return the chunk shape of a variable with ``sizes`` beside the time: one frame a chunk, or many frames
    of a short series; ``more_pairs`` may be added to the dimension ``pair``.
    """
    if is_static(field):
        return None
    if field.group != "series":
        return (1, *sizes)
    if more_pairs:
        sizes = tuple(PAIRS_CHUNK if dim == "pair" else n for dim, n in zip(field.dims, sizes, strict=True))
    return (max(1, SERIES_CHUNK // (itemsize * math.prod(sizes))), *sizes)
