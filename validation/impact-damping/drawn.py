"""What is measured of a run and of the finite elements, and what the figures are drawn of."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

from drawing import against_loss, histories
from noise import Found, found_of, of_finite_elements

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from mpmfw.validation import CaseRun


def of_run(tree: xr.DataTree) -> dict[str, float]:
    """The numbers of :class:`noise.Found`, errors of the force under their window [µs]."""
    return _numbers(found_of(tree))


def of_elements(run: str) -> dict[str, float]:
    """The same of the ``fine`` or ``coarse`` finite elements; energies are not known."""
    return _numbers(of_finite_elements(run))


def _numbers(found: Found) -> dict[str, float]:
    fields = {field.name: getattr(found, field.name) for field in dataclasses.fields(found)}
    numbers = {name: value for name, value in fields.items() if isinstance(value, float)}
    return {**numbers, **{str(window): error for window, error in found.errors.items()}}


def losses(runs: Sequence[CaseRun]) -> Figure:
    """Noise and error of the force over the energy that is lost."""
    return against_loss(_by_label(runs), {run: of_finite_elements(run) for run in ("fine", "coarse")})


def forces(runs: Sequence[CaseRun]) -> Figure:
    """The force over time."""
    return histories(_by_label(runs), of_finite_elements("fine"))


def _by_label(runs: Sequence[CaseRun]) -> dict[str, Found]:
    """Without those of coarser points, which answer a question of their own."""
    own = [run for run in runs if not run.method.label.startswith("points of")]
    return {run.method.label: found_of(run.results) for run in own}
