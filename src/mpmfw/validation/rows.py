"""One line of the suite's table: a quantity of a method, beside its reference."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """What a row says."""

    HOLDS = "holds"  #: a gate, and the value is within it
    RED = "RED"  #: a gate that does not hold
    WITHIN = "within"  #: no gate for this method; the value would pass
    OUTSIDE = "outside"  #: no gate for this method; the value would not pass
    SHOWN = "shown"  #: there is no limit
    FAILED = "failed"  #: the run failed, and nothing depends on it


@dataclass(frozen=True)
class Row:
    """A measured quantity.

    Attributes
    ----------
    case, method, quantity
        What was measured, of what.
    value, unit
        NaN where it could not be measured.
    reference
        What it is compared with: a number in the same unit, or words.
    least, most
        Limits of the value; infinite where there are none.
    binds
        Whether the suite fails if the value is outside.
    cpu_time
        Of the run or computation that the value comes from, without compilation [s].
    note
        Why a run failed.
    """

    case: str
    method: str
    quantity: str
    value: float
    unit: str = ""
    reference: float | str = ""
    least: float = -math.inf
    most: float = math.inf
    binds: bool = False
    cpu_time: float = math.nan
    note: str = ""

    @property
    def limited(self) -> bool:
        """Whether there is a limit at all."""
        return math.isfinite(self.least) or math.isfinite(self.most)

    @property
    def verdict(self) -> Verdict:
        """Judge the value; NaN is within no limits."""
        inside = self.least <= self.value <= self.most
        if self.binds:
            return Verdict.HOLDS if inside else Verdict.RED
        if self.note:
            return Verdict.FAILED
        if not self.limited:
            return Verdict.SHOWN
        return Verdict.WITHIN if inside else Verdict.OUTSIDE

    @property
    def tolerance(self) -> str:
        """The limits in words."""
        if not self.limited:
            return ""
        if not math.isfinite(self.least):
            return f"≤ {self.most:.6g}"
        if not math.isfinite(self.most):
            return f"≥ {self.least:.6g}"
        if self.least == -self.most:
            return f"± {self.most:.6g}"
        return f"{self.least:.6g} … {self.most:.6g}"
