"""Which case runs by which method, where: every pair of case, method, shift and turn meets.

Where a case is about springs, methods without any are left out. All methods run with MPMFW_FULL_STABILITY set; else those that
may fail run in a fourth of the cases each.
"""

from __future__ import annotations

from hard_cases import CASES, MUST_HOLD, MUST_STAY_BOUNDED, OTHERS, applies
from hard_scenes import FULL
from placing import SHIFTS, TURNS, covering

Row = tuple[str, str, str, tuple[float, float], int]


def rows(*, full: bool = FULL) -> list[Row]:
    """(case, contact, shape, shift [cells], turn [°]) of all runs."""
    cases = list(CASES)
    made: list[Row] = []
    for methods, every in ((MUST_HOLD + MUST_STAY_BOUNDED, 1), (OTHERS, 1 if full else 4)):
        for springs in (False, True):
            alike = [name for name in cases if CASES[name].springs == springs]
            able = [m for m in methods if applies(alike[0], m[0])]
            for name, method, shift, turn in covering(alike, able, SHIFTS, TURNS):
                if (cases.index(name) + methods.index(method)) % every == 0:
                    made.append((name, *method, shift, turn))
    return sorted(made, key=lambda row: cases.index(row[0]))


def label(row: Row) -> str:
    """``equal-penalty-cpdi-0.31,0.17-30``."""
    case, contact, shape, shift, turn = row
    return f"{case}-{contact}-{shape}-{shift[0]:g},{shift[1]:g}-{turn}"
