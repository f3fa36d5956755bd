"""Base classes of measures, which campaigns read off a run, and of references, a scene's exact motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.state.fields import FloatArray

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.scene import Scene


@dataclass(frozen=True)
class About:
    """Subject of a quantity; None lets the motion decide."""

    body: str | None = None  #: a body's name
    pair: str | None = None  #: two bodies', ``a-b``
    axis: str | None = None  #: of the grid


@dataclass(frozen=True)
class Measured:
    """A quantity of one run; NaN where it is not known."""

    #: (1,) for a number, (time,) for a curve, (points,) for a field, in the measure's unit, such as [m]
    values: FloatArray
    time: FloatArray  #: of a curve (time,) [s]; empty for others


@dataclass(frozen=True)
class Exact:
    """Exact value of a quantity in SI units."""

    kind: str  #: ``closed-form`` or ``reference``, as a study's ``error.kind``
    says: str  #: what it is, for a reader
    at: Callable[[FloatArray], FloatArray]  #: the value at times (n,) [s]

    @classmethod
    def number(cls, value: float | None, says: str) -> Exact | None:
        """Return a closed form of one ``value``; None of None."""
        return None if value is None else cls("closed-form", says, lambda _: np.array([value]))


class Measure:
    """Base class of measures; the docstring is the meaning of the quantity."""

    name: ClassVar[str]  #: in studies and campaigns
    unit: ClassVar[str]  #: of its values, SI, as ``m s-1``
    kind: ClassVar[Literal["number", "curve", "field"]]  #: a curve in time, a field at points
    #: Of ``body``, ``pair`` and ``axis``, those that it looks at; a study that gives another one is refused.
    keys: ClassVar[tuple[str, ...]] = ()
    norm: ClassVar[Literal["largest", "l2"]] = "largest"  #: of differences, where a study does not say
    particles: ClassVar[bool] = False  #: whether it needs the arrays of the material points
    outputs: ClassVar[tuple[str, ...]] = ()  #: of ``gap`` and ``ledger``, those of ``[output]`` that it reads

    @property
    def meaning(self) -> str:
        """First line of the docstring, for a reader."""
        return (self.__doc__ or self.name).strip().splitlines()[0].rstrip(".")

    def of(self, run: xr.DataTree, scene: Scene, about: About) -> Measured:
        """Return the quantity from the results of a ``run`` of a ``scene``."""
        raise NotImplementedError

    def exact(self, scene: Scene, about: About) -> Exact | None:  # noqa: ARG002
        """Return its exact value in a ``scene``; None where it is not known."""
        return None


class Reference:
    """Base of closed forms, ``[reference] kind = "NAME"``."""

    name: ClassVar[str]  #: in scenes
    example: ClassVar[Mapping[str, Any]] = {}  #: scene of its kind that the checks compare with a run

    def need(self, holds: bool, expected: str) -> None:
        """Refuse the scene unless a condition ``holds``."""
        if not holds:
            raise SceneError(f"reference.kind: '{self.name}' does not apply: {expected}")

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:
        """Return the exact value of a ``measure``; None if it is not known."""
        raise NotImplementedError
