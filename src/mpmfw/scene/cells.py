"""Lengths in cells: ``size = "0.5 cells"`` follows the cell size, so that one override refines the whole scene."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from mpmfw.units import to_si

_CELLS = re.compile(r"\s*([0-9]*\.?[0-9]+(?:[eE][+-]?[0-9]+)?)\s*cells?\s*")


def with_lengths(core: Mapping[str, Any]) -> dict[str, Any]:
    """The tables with ``segment`` and ``particles.size`` of every body in metres, where they are given in cells.

    What is no such text stays as it is, for the models to judge; so does everything where the cell size itself is wrong.
    """
    grid, bodies = core.get("grid"), core.get("bodies")
    cell = _metres(grid.get("cell_size")) if isinstance(grid, Mapping) else None
    if cell is None or not isinstance(bodies, Mapping):
        return dict(core)
    return {**core, "bodies": {name: _body(body, cell) for name, body in bodies.items()}}


def _metres(value: Any) -> float | None:
    try:
        length = to_si(value, "m")
    except ValueError:
        return None
    return float(length) if isinstance(length, int | float) and not isinstance(length, bool) else None


def _body(body: Any, cell: float) -> Any:
    if not isinstance(body, Mapping):
        return body
    changed = dict(body)
    if "segment" in body:
        changed["segment"] = _length(body["segment"], cell)
    particles = body.get("particles")
    if isinstance(particles, Mapping) and "size" in particles:
        changed["particles"] = {**particles, "size": _length(particles["size"], cell)}
    return changed


def _length(value: Any, cell: float) -> Any:
    found = _CELLS.fullmatch(value) if isinstance(value, str) else None
    return float(found.group(1)) * cell if found else value
