"""Units as a figure writes them."""

from __future__ import annotations

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"))


def readable(unit: str) -> str:
    """A CF unit with a fraction: ``kg m s-1 m-1`` becomes ``kg m/(s m)``; empty for ``1``."""
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
    """The size of one shown unit, and its name: pascals as kPa, MPa or GPa where they are that many."""
    if unit == "Pa":
        for size, prefix in _PREFIXES:
            if largest >= size:
                return size, f"{prefix}Pa"
    return 1.0, readable(unit)


def in_brackets(label: str, unit: str) -> str:
    """``label [unit]``, without brackets where there is no unit."""
    return f"{label} [{unit}]" if unit else label


def time_scale(last: float) -> tuple[float, str]:
    """Factor and unit in which times up to ``last`` [s] are shown: s, or ms below a tenth of a second."""
    return (1.0, "s") if last >= 0.1 else (1e3, "ms")


def length_scale(extent: float) -> tuple[float, str]:
    """Factor and unit in which a drawing of this extent [m] is measured: m, or mm below half a metre."""
    return (1.0, "m") if extent >= 0.5 else (1e3, "mm")
