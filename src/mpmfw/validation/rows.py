"""What a case records: rows of its table, and figures."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpmfw.errors import ResultsWarning
from mpmfw.runs.run import run as run_scene
from mpmfw.scene import Scene, load_scene

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

#: Least and largest value, or a number t for ± t.
Tolerance = float | tuple[float, float] | None


class Verdict(StrEnum):
    """What a row says."""

    HOLDS = "holds"  #: a gate, and the value is within it
    RED = "RED"  #: a gate that does not hold, or holds though it is known not to
    KNOWN = "known red"  #: a gate that is known not to hold
    WITHIN = "within"  #: no gate for this method; the value would pass
    OUTSIDE = "outside"  #: no gate for this method; the value would not pass
    SHOWN = "shown"  #: there is no limit
    FAILED = "failed"  #: the run failed, and nothing depends on it


@dataclass(frozen=True)
class Row:
    """A quantity of a method beside its reference and its limits.

    ``binds``: the suite fails if the value is outside. ``seconds``: CPU time of the run, without compilation.
    ``note``: why a run failed. ``reason``: why a gate is known not to hold.
    """

    case: str
    method: str
    quantity: str
    value: float
    reference: float | str = ""
    unit: str = ""
    least: float = -math.inf
    most: float = math.inf
    binds: bool = False
    seconds: float = math.nan
    note: str = ""
    reason: str = ""

    @property
    def inside(self) -> bool:
        """Return whether the value is within its limits; NaN is not."""
        return self.least <= self.value <= self.most

    @property
    def verdict(self) -> Verdict:
        """Judge the value."""
        if self.binds:
            if self.reason:
                return Verdict.RED if self.inside else Verdict.KNOWN
            return Verdict.HOLDS if self.inside else Verdict.RED
        if self.note:
            return Verdict.FAILED
        if math.isinf(self.least) and math.isinf(self.most):
            return Verdict.SHOWN
        return Verdict.WITHIN if self.inside else Verdict.OUTSIDE

    def __str__(self) -> str:
        value = self.note or f"{self.value:.4g} {self.unit}".rstrip()
        cured = ", which holds, and is marked as known red" if self.reason and self.inside else ""
        return f"{self.method}, {self.quantity}: {value} ({self.least:g} … {self.most:g}){cured}"


@dataclass
class Case:
    """A case while it is checked: folder, version, and what was recorded."""

    folder: Path
    quick: bool = False
    rows: list[Row] = field(default_factory=list)
    figures: dict[str, Figure] = field(default_factory=dict)
    _seconds: float = math.nan

    def scene(self, given: str | Mapping[str, Any], method: Any, values: Mapping[str, Any]) -> Scene:
        """Return a file of the case, a shipped scene or a mapping as a scene, with values and method."""
        chosen = {"contact.method": method.contact, "shape.method": method.shape} if method else {}
        chosen = {key: name for key, name in chosen.items() if name}
        if isinstance(given, str) and (self.folder / given).exists():
            given = str(self.folder / given)
        return load_scene(given, set={**chosen, **values, **(method.set if method else {})})

    def run(self, scene: Scene) -> xr.DataTree:
        """Run a scene, as ``mpmfw.run``; settling that ends with a warning is in the rows."""
        self._seconds = math.nan
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ResultsWarning)
            tree = run_scene(scene)
        self._seconds = float(tree.attrs["cpu_time"]) + float(tree.attrs.get("settle_time", 0.0))
        return tree

    def show(self, *row: Any, **named: Any) -> None:
        """Record a value that decides nothing; arguments as of :meth:`gate`."""
        self.gate(*row, **{**named, "binds": False})

    def gate(
        self,
        quantity: str,
        value: float | None,
        reference: float | str = "",
        tolerance: Tolerance = None,
        unit: str = "",
        method: Any = "",
        binds: bool | None = None,
        note: str = "",
    ) -> None:
        """Record a value beside its reference; None has no row, and no ``tolerance`` no limits.

        If it ``binds``, by default of recommended methods, the suite fails where the value is outside.
        """
        if value is None:
            return
        binds = (isinstance(method, str) or method.recommended) if binds is None else binds
        row = (self.folder.name, str(method), quantity, float(value), reference, unit, *limits(tolerance))
        seconds = math.nan if note else self._seconds
        self.rows.append(Row(*row, binds and tolerance is not None, seconds, note))

    def failed(self, method: Any, why: str, binds: bool | None = None, at: str = "") -> None:
        """Record why a method got no result at a place; red of the recommended, or as ``binds`` says."""
        binds = not isinstance(method, str) and method.recommended if binds is None else binds
        quantity, limits = f"{at}: run" if at else "run", (0.0, math.inf)
        self.gate(quantity, math.nan, "ends", limits, method=method, binds=binds, note=why)

    def figure(self, name: str, figure: Figure) -> None:
        """Keep a figure as ``<case>-<name>.png``, or ``<case>.png`` without a name."""
        self.figures[f"{self.folder.name}-{name}" if name else self.folder.name] = figure

    @contextmanager
    def timed(self) -> Iterator[None]:
        """Take the CPU time of the block as that of the rows recorded afterwards."""
        start = time.process_time()
        try:
            yield
        finally:
            self._seconds = time.process_time() - start


def limits(tolerance: Tolerance) -> tuple[float, float]:
    """Return the least and the largest value."""
    if tolerance is None:
        return -math.inf, math.inf
    return tolerance if isinstance(tolerance, tuple) else (-tolerance, tolerance)
