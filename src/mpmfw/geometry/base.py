"""Base of geometries of any dimension, and of those that are round or have a lower and an upper corner."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    model_validator,
)

from mpmfw.geometry.layout import FloatArray, IntArray, Layout
from mpmfw.units import Length

PositiveLength = Annotated[Length, Field(gt=0)]
Point2D = tuple[Length, Length]
Point3D = tuple[Length, Length, Length]


_CELL_SIZE: TypeAdapter[float] = TypeAdapter(PositiveLength)
_CELLS = re.compile(r"\s*([0-9]*\.?[0-9]+(?:[eE][+-]?[0-9]+)?)\s*cells?\s*")


def context_of_cells(tables: Mapping[str, Any]) -> dict[str, float]:
    """Return the validation context of lengths in cells; a wrong cell size counts as 1 m."""
    try:
        return {"cell_size": _CELL_SIZE.validate_python(tables["grid"]["cell_size"])}
    except (TypeError, LookupError, ValidationError):
        return {"cell_size": 1.0}


def _from_cells(value: Any, info: ValidationInfo) -> Any:
    """Convert a text such as ``0.5 cells`` to metres; other values pass through."""
    context, cells = info.context, _CELLS.fullmatch(value) if isinstance(value, str) else None
    return value if context is None or cells is None else float(cells[1]) * context["cell_size"]


#: A positive length that may follow the cell size: ``"0.5 cells"``.
LengthInCells = Annotated[
    PositiveLength, BeforeValidator(_from_cells), Field(json_schema_extra={"unit": "m", "cells": True})
]


class BodyGeometry(BaseModel):
    """Base of geometries: a model of the keys of a body's table ``geometry``.

    A subclass derives from :class:`PlaneGeometry` or :class:`SolidGeometry`, gives the field ``type``
    its name as the only value and the default, and is announced as an entry point of the group
    ``mpmfw.geometry``.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    #: The value of ``type``, which is what scenes call it.
    name: ClassVar[str] = ""
    #: Number of space dimensions.
    dim: ClassVar[int]
    #: Fields of which the first must be below the second, if there are such.
    rising: ClassVar[tuple[str, str] | None] = None

    type: str  #: what scenes call it; ``name`` is read off it

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Read the name off the field ``type``."""
        default = cls.model_fields["type"].default
        cls.name = default if isinstance(default, str) else ""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.rising is not None:
            low, high = (getattr(self, key) for key in self.rising)
            if not np.less(low, high).all():
                raise ValueError(f"{self.rising[0]} {low} m must be below {self.rising[1]} {high} m")
        return self

    @property
    @abstractmethod
    def exact_volume(self) -> float:
        """Area or volume of the true shape [m^dim]."""

    @property
    @abstractmethod
    def centroid(self) -> FloatArray:
        """Centroid of the true shape (dim,) [m]."""

    @property
    @abstractmethod
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, dim) [m]."""

    @property
    def width(self) -> float:
        """Smallest extent of the true shape [m], or thickness of its thinnest wall.

        It is that of its bounding box, unless a shape overrides it. Below a cell it shortens the stable step.
        """
        return float(np.ptp(self.bounds, axis=0).min())

    @property
    def axes(self) -> FloatArray:
        """Unit vectors along which the body's sides are named, one a row (dim, dim)."""
        return np.eye(self.dim)

    @property
    def is_connected(self) -> bool:
        """Return True if the body is one piece."""
        return True

    @abstractmethod
    def surfaces(self, edge: float) -> tuple[tuple[FloatArray, IntArray], ...]:
        """Nodes (m, dim) [m] and facets (k, dim) of every closed surface, with sides up to ``edge`` [m]."""

    @abstractmethod
    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """Cells of edge ``size`` [m], shifted by ``offset`` (fractions), cut by the surface."""

    def fitted(self, size: float) -> Layout:
        """Domains of edges up to ``size`` [m] that follow the surface; a ValueError where there are none."""
        raise ValueError(f"a {self.type} has no fitted layout (size {size} m): choose layout = 'lattice'")


class Centred(BodyGeometry):
    """Base of bodies given by their centre."""

    centre: tuple[Length, ...]

    @property
    def centroid(self) -> FloatArray:
        return np.array(self.centre)


class Round(Centred):
    """Base of discs and balls."""

    radius: PositiveLength

    @property
    def width(self) -> float:
        return float(2.0 * self.radius)

    @cached_property
    def bounds(self) -> FloatArray:
        return np.add(self.centre, [[-self.radius], [self.radius]])


class Cornered(BodyGeometry):
    """Base of rectangles and boxes."""

    lower: tuple[Length, ...]
    upper: tuple[Length, ...]
    rising: ClassVar[tuple[str, str]] = ("lower", "upper")

    @property
    def exact_volume(self) -> float:
        return float(np.prod(np.subtract(self.upper, self.lower)))

    @property
    def centroid(self) -> FloatArray:
        return 0.5 * np.add(self.lower, self.upper)

    @property
    def width(self) -> float:
        return float(np.subtract(self.upper, self.lower).min())
