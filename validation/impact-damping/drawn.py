"""What is measured of a run and of the finite elements, and what the figures are drawn of."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from noise import Found, found_of, of_finite_elements

if TYPE_CHECKING:
    import xarray as xr


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
