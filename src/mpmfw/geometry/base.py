"""What a geometry of any dimension answers; a distribution of one's own brings more of them."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np
from pydantic import BaseModel, ConfigDict

from mpmfw.geometry.layout import FloatArray, IntArray, Layout


class BodyGeometry(BaseModel):
    """Base of geometries: a model of the keys of a body's table ``geometry``.

    A class of one's own derives from :class:`PlaneGeometry` or :class:`SolidGeometry`, gives the field ``type`` its name as the
    only value and the default, and is announced as an entry point of the group ``mpmfw.geometry``.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    #: The value of ``type``, which is what scenes call it.
    name: ClassVar[str] = ""
    #: Number of space dimensions.
    dim: ClassVar[int]

    type: str  #: what scenes call it; ``name`` is read off it

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Read the name off the field ``type``."""
        default = cls.model_fields["type"].default
        cls.name = default if isinstance(default, str) else ""

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
        """Smallest extent of the true shape [m], or thickness of its thinnest wall: that of its bounding box, unless a shape says
        better. Below a cell it shortens the stable step."""
        return float(np.ptp(self.bounds, axis=0).min())

    @property
    @abstractmethod
    def axes(self) -> FloatArray:
        """Unit vectors along which the body's sides are named, one a row (dim, dim)."""

    @abstractmethod
    def surfaces(self, edge: float) -> tuple[tuple[FloatArray, IntArray], ...]:
        """Nodes (m, dim) [m] and facets (k, dim) of every closed surface, with sides up to ``edge`` [m]."""

    @abstractmethod
    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """Cells of edge ``size`` [m], shifted by ``offset`` (fractions), cut by the surface."""

    def fitted(self, size: float) -> Layout:
        """Domains of edges up to ``size`` [m] that follow the surface; a ValueError where there are none, as here."""
        raise ValueError(f"a {self.type} has no fitted layout (size {size} m): choose layout = 'lattice'")
