"""Lengths in cells: ``size = "0.5 cells"`` follows the cell size, so that one override refines the whole
scene.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from mpmfw.scene.locator import Path
from mpmfw.units import to_si

_CELLS = re.compile(r"\s*([0-9]*\.?[0-9]+(?:[eE][+-]?[0-9]+)?)\s*cells?\s*")


def with_lengths(core: Mapping[str, Any]) -> dict[str, Any]:
    """The tables with ``segment`` and ``particles.size`` of every body in metres, where they are given in
    cells.

    What is no such text stays as it is, for the models to judge. Where the cell size itself is wrong, a cell
    counts as 1 m, so that the cell size alone is complained of."""
    grid, bodies = core.get("grid"), core.get("bodies")
    if not isinstance(bodies, Mapping):
        return dict(core)
    cell = _metres(grid.get("cell_size")) if isinstance(grid, Mapping) else 1.0
    return {**core, "bodies": {name: _body(body, cell) for name, body in bodies.items()}}


def may_be_in_cells(path: Path) -> bool:
    """Whether the key at the path takes lengths in cells."""
    return path[:1] == ("bodies",) and path[2:] in (("segment",), ("particles", "size"))


def _metres(value: Any) -> float:
    """The cell size [m]; 1 where it is none."""
    try:
        length = to_si(value, "m")
    except ValueError:
        return 1.0
    valid = isinstance(length, int | float) and math.isfinite(length) and length > 0.0
    return float(length) if valid and isinstance(length, int | float) else 1.0


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
