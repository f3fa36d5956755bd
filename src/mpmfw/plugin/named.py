"""Plug-ins that a scene names as it likes, as many as it wants: loads, boundary conditions and outputs."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, Self

import numpy as np

from mpmfw.errors import PluginError
from mpmfw.plugin.base import PlugIn
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Effect, Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Body, State
from mpmfw.units import problems_in_time


class NamedPlugIn(PlugIn):
    """Base of plug-ins with a table of options in the scene, such as ``[loads.NAME]``."""

    #: Whether surfaces must be tracked for it.
    needs_surface: ClassVar[bool] = False
    #: Options that are vectors, constant or in time (``mpmfw.api.units.vector_in_time``).
    vectors: ClassVar[tuple[str, ...]] = ()
    #: What the scene calls it.
    title: str = ""
    #: Bodies that it concerns.
    bodies: tuple[Body, ...] = ()

    @classmethod
    def problems(cls, options: Any, dim: int) -> Iterable[tuple[tuple[str | int, ...], str]]:
        """Yield vectors of another dimension than ``dim`` and times that do not increase: key, with an index
        where there is one, and text."""
        for key in cls.vectors:
            for index, text in problems_in_time(getattr(options, key), dim):
                yield (key, *index), text

    def from_setup(self, setup: Setup) -> Self | str:  # noqa: ARG002
        """Return the plug-in, ready for the bodies, or why it does not act."""
        return self

    def checked(
        self, answer: Any, shape: tuple[int, ...], state: State, *, missing: bool = False
    ) -> FloatArray:
        """Return the answer of a method as an array of this ``shape``; NaN may stand for ``missing`` values.

        Raise PluginError if the shape differs or a value is not finite.
        """
        array: AnyArray = np.asarray(answer, dtype=float)
        if array.shape != shape:
            raise self.refusal(f"an array of shape {array.shape}; expected {shape}", state)
        if np.isinf(array).any() or (not missing and np.isnan(array).any()):
            raise self.refusal("what is not finite", state)
        return np.ascontiguousarray(array)

    def refusal(self, answer: str, state: State) -> PluginError:
        """Return the error for a wrong ``answer`` of a method."""
        text = f"'{self.title}' ({self.name}) answered with {answer}"
        return PluginError(text, step=state.steps, time=state.time)


class OutputSeries(NamedPlugIn):
    """Base of diagnostics: one instance for each table ``[outputs.NAME]`` of the scene.

    Subclasses declare their series, :meth:`series`, and give their values, :meth:`values`. In the results
    each is called ``NAME_series``.
    """

    stage = "output"

    def series(self) -> list[Field]:
        """Declarations: name, dims, unit and meaning; may be asked more than once."""
        raise NotImplementedError

    def values(self, state: State, interval: float) -> Mapping[str, Any]:
        """Return the numbers of every declared series by name; ``state`` may not be changed.

        ``interval`` [s] is the time since the last output, 0 at the first: there a sum begins."""
        raise NotImplementedError

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The series, under the names that the results have for them."""
        return [
            dataclasses.replace(field, name=f"{self.title}_{field.name}", group="series", output=True)
            for field in self.series()
        ]

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Return the values of all declared series."""
        values = dict(self.values(state, interval))
        declared = {field.name for field in self.series()}
        if values.keys() != declared:
            found, expected = (", ".join(sorted(names)) for names in (values, declared))
            raise self.refusal(f"values of {found or 'nothing'}; expected {expected}", state)
        return {f"{self.title}_{name}": value for name, value in values.items()}


def from_setup(setup: Setup) -> Acts:
    """Return the loads, boundary conditions and outputs that act."""
    acting, lines = [], []
    for group, plugins in setup.named.items():
        answers = {f"{name} ({each.label})": each.from_setup(setup) for name, each in plugins.items()}
        acts = [answer for answer in answers.values() if not isinstance(answer, str)]
        reasons = [
            f"{what}: {answer}" if isinstance(answer, str) else what for what, answer in answers.items()
        ]
        lines.append(Effect(group, bool(acts), ", ".join(reasons) or f"no [{group}]"))
        acting += acts
    return Acts("", acting, lines)


def shares_near(position: FloatArray, at: FloatArray, cell_size: float) -> FloatArray:
    """Return shares w_p (n,) of points in the value at a place: Σ w_p = 1, Σ w_p x_p = x (moving least
    squares).

    w_p = k_p (a + b·r_p), r_p = x_p − x, with a kernel k_p that falls to zero 1.5 cells beyond the nearest
    point: fewer would not reach a corner. ``position`` x_p is (n, dim), ``at`` x (dim,), ``cell_size`` h, in
    m. Raise ValueError if no point is within a cell of the place."""
    offset = position - at
    distance = np.sqrt((offset**2).sum(axis=1)) / cell_size
    if distance.min() > 1.0:
        raise ValueError(f"the nearest material point is {distance.min():.3g} cells away")
    kernel = np.maximum(1.0 - distance / (distance.min() + 1.5), 0.0)
    basis = np.column_stack([np.ones(len(offset)), offset])
    target = np.zeros(basis.shape[1])
    target[0] = 1.0
    moments = basis.T @ (kernel[:, None] * basis)
    return np.asarray(kernel * (basis @ np.linalg.lstsq(moments, target, rcond=None)[0]))
