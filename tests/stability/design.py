"""Which case runs by which method, where.

Where a case is about springs, methods without any are left out. With MPMFW_FULL_STABILITY set, every pair of
case, method, shift and turn meets. Else every case, and every method that must hold or stay bounded, meets
all shifts and turns; cases and methods meet in part. Methods that may fail run in a fourth of the cases."""

from __future__ import annotations

from typing import Any

from hard_cases import CASES, IN_SPACE, METHODS_IN_SPACE, MUST_HOLD, MUST_STAY_BOUNDED, OTHERS, applies
from hard_scenes import FULL
from places import PLACES_IN_SPACE, SHIFTS, TURNS, covering

Row = tuple[str, str, str, tuple[float, ...], Any]


def rows(*, full: bool = FULL) -> list[Row]:
    """(case, contact, shape, shift [cells], turn [°]) of all runs."""
    cases = list(CASES)
    made: list[Row] = []
    for methods, every in ((MUST_HOLD + MUST_STAY_BOUNDED, 1), (OTHERS, 1 if full else 4)):
        for springs in (False, True):
            alike = [name for name in cases if CASES[name].springs == springs]
            able = [m for m in methods if applies(alike[0], m[0])]
            rows = covering(alike, able, SHIFTS, TURNS)
            if every == 1 and not full:
                rows = fewest(rows, alike)
            for name, method, shift, turn in rows:
                if (cases.index(name) + methods.index(method)) % every == 0:
                    made.append((name, *method, shift, turn))
    return sorted(made, key=lambda row: cases.index(row[0]))


def fewest(rows: list[tuple[Any, ...]], cases: list[str]) -> list[tuple[Any, ...]]:
    """Keep the rows that bring a case or a method to a new shift or turn, beginning in each case with penalty
    contact and CPDI or with the next of the other methods.
    """
    kept: list[tuple[Any, ...]] = []
    seen_by: set[Any] = set()
    for i, case in enumerate(cases):
        own = [row for row in rows if row[0] == case]
        seen: set[Any] = set()
        methods = sorted({row[1] for row in own})
        first = ("penalty", "cpdi") if i % 2 else methods[i // 2 % len(methods)]
        for row in sorted(own, key=lambda row, first=first: row[1] != first):
            by_method = {(row[1], place) for place in row[2:]}
            if not (seen >= set(row[2:]) and seen_by >= by_method):
                seen |= set(row[2:])
                seen_by |= by_method
                kept.append(row)
    return kept


def rows_in_space(*, full: bool = FULL) -> list[Row]:
    """All cases by all methods at all places, or by two methods each, one of which must hold, at two
    places.
    """
    made: list[Row] = []
    for i, case in enumerate(IN_SPACE):
        strict, others = METHODS_IN_SPACE[:2], METHODS_IN_SPACE[2:]
        two = [
            (strict[i % 2], PLACES_IN_SPACE[-1 - i % 4]),
            (others[i % len(others)], PLACES_IN_SPACE[i % 4]),
        ]
        every = [(method, place) for method in METHODS_IN_SPACE for place in PLACES_IN_SPACE]
        made += [(case, *method, *place) for method, place in (every if full else two)]
    return made


def label(row: Row) -> str:
    """``equal-penalty-cpdi-0.31,0.17-30``."""
    case, contact, shape, shift, turn = row
    turns = turn if isinstance(turn, tuple) else (turn,)
    return f"{case}-{contact}-{shape}-{','.join(f'{x:g}' for x in shift)}-{','.join(map(str, turns))}"
