"""The first array with a value that is not a number, and the hook after which it had one."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import Any

import numpy as np

from mpmfw.api.contact import ContactRows
from mpmfw.api.types import AnyArray, Grid, hookimpl


class FiniteWatch:
    """Look at what contact writes before and after its hooks, until a value is not a number."""

    name = "contact_finite_watch"

    def __init__(self, contact: Any) -> None:
        self.contact, self.step = contact, 0
        self.first: dict[
            str, object
        ] = {}  #: array, place, hook and step of the first such value; empty if there is none

    @hookimpl(wrapper=True)
    def detect(self, grid: Grid) -> Generator[None, Any, Any]:
        """Rows, before anything acts; the step begins."""
        self.step += 1
        return (yield from self._around("detect", grid))

    @hookimpl(wrapper=True)
    def after_momentum_projection(self, grid: Grid) -> Generator[None, Any, Any]:
        """What acts on the projected momentum."""
        return (yield from self._around("after_momentum_projection", grid))

    @hookimpl(wrapper=True)
    def add_nodal_force(self, grid: Grid) -> Generator[None, Any, Any]:
        """Forces of rows and nodes."""
        return (yield from self._around("add_nodal_force", grid))

    @hookimpl(wrapper=True)
    def after_momentum_update(self, grid: Grid) -> Generator[None, Any, Any]:
        """What acts on the updated momentum."""
        return (yield from self._around("after_momentum_update", grid))

    def _around(self, hook: str, grid: Grid) -> Generator[None, Any, Any]:
        self._look(f"before {hook}", grid)
        result = yield
        self._look(f"in {hook}", grid)
        return result

    def _look(self, when: str, grid: Grid) -> None:
        if self.first:
            return
        for name, index, place in self._not_finite(grid):
            self.first = {
                "first that is no number": f"{name}[{index}]{place}",
                "made": f"{when}, step {self.step}",
            }
            return

    def _not_finite(self, grid: Grid) -> Iterator[tuple[str, int, str]]:
        """Name, index and place of the first such entry of each array, without massless nodes."""
        rows: Any = getattr(self.contact, "rows", None)
        for name in ("normal", "force") if isinstance(rows, ContactRows) else ():
            for index in _bad(getattr(rows, name)[: rows.count])[:1]:
                yield f"rows.{name}", int(index), ""
        has_mass = grid.mass > 0.0
        for name in ("mass", "momentum", "force"):
            array = getattr(grid, name)
            bad = _bad(array)
            for index in bad[has_mass[bad] | (name == "mass")][:1]:
                at = ", ".join(f"{x:.6g}" for x in grid.position[index])
                yield f"grid.{name}", int(index), f", node at ({at}) m"


def _bad(array: AnyArray) -> AnyArray:
    """Indices of the entries, or of the vectors, that have a value which is not finite."""
    return np.flatnonzero(~np.isfinite(array).all(axis=tuple(range(1, array.ndim))))
