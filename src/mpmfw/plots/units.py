"""Units as a figure writes them."""

from __future__ import annotations

from typing import Any

import numpy as np

_LARGE = ((1e9, "G"), (1e6, "M"), (1e3, "k"))
_SMALL = ((1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
#: Units with large and with small prefixes; others have none.
_WITH_LARGE, _WITH_SMALL = ("Pa", "N", "J", "W"), ("N", "J", "W", "m")


def readable(unit: str) -> str:
    """Return a CF unit as a fraction: ``kg m s-1 m-1`` as ``kg m/(s m)``."""
    over: list[str] = []
    under: list[str] = []
    for part in unit.split():
        name, sign, power = part.partition("-")
        (under if sign else over).append(f"{name}{power}" if power not in ("", "1") else name)
    over = [part for part in over if part != "1"]
    if not under:
        return " ".join(over)
    below = under[0] if len(under) == 1 else f"({' '.join(under)})"
    return f"{' '.join(over) or '1'}/{below}"


def with_prefix(unit: str, largest: float) -> tuple[float, str]:
    """Return the size of a shown unit, and its name, such as kPa or mm."""
    first = unit.partition(" ")[0]
    prefixes: tuple[tuple[float, str], ...] = _LARGE if first in _WITH_LARGE and largest >= 1.0 else ()
    if first in _WITH_SMALL and (first != "m" or unit == "m") and 0.0 < largest < 0.1:
        prefixes = _SMALL
    for size, prefix in prefixes:
        if largest >= size:
            return size, readable(prefix + unit)
    return 1.0, readable(unit)


def scaled_label(axis: Any, words: str, unit: str) -> str:
    """Return ``words [unit]`` of an axis whose ticks it counts in that unit."""
    curves = [np.abs(np.asarray(line.get_ydata(), float)) for line in axis.axes.get_lines()]
    largest = max((np.nanmax(curve) for curve in curves if np.isfinite(curve).any()), default=0.0)
    size, shown = with_prefix(unit, float(largest))
    count_in(axis, size)
    return in_brackets(words, shown)


def count_in(axis: Any, size: float) -> None:
    """Show ticks of a matplotlib axis in units of ``size``."""
    if size != 1.0:
        axis.set_major_formatter(lambda value, _: f"{value / size:.6g}".replace("-", "\N{MINUS SIGN}"))


def in_brackets(label: str, unit: str) -> str:
    """``label [unit]``, without brackets where there is no unit."""
    return f"{label} [{unit}]" if unit else label


def time_scale(last: float) -> tuple[float, str]:
    """Return the factor and the unit of times up to ``last`` [s]."""
    return (1.0, "s") if last >= 0.1 else (1e3, "ms")


def length_scale(extent: float) -> tuple[float, str]:
    """Return the factor and the unit of a drawing of this extent [m]."""
    return (1.0, "m") if extent >= 0.5 else (1e3, "mm")
