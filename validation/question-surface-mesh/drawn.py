"""What the figure of the case is drawn of."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from drawing import Found, draw

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mpmfw.validation import CaseRun

_SLIP: dict[str, Any] = {"roll": "slip"}
#: Curves by runs: name, measure, its key, its arguments.
CURVES: dict[str, tuple[tuple[str, str, str | None, dict[str, Any]], ...]] = {
    "rolling": (
        *((name, "questions:of_rolling", name, _SLIP) for name in ("displacement", "acceleration", "spin")),
        ("rolling_noise", "questions:rolling_noise", None, {}),
        ("rolling_step", "questions:of_rolling", "step", _SLIP),
    ),
    "rings": (
        ("impulse", "questions:of_rings", "impulse_curve_error", {}),
        ("rings_noise", "questions:of_rings", "noise", {}),
        ("rings_step", "questions:of_rings", "step", {}),
    ),
    "stiff rings": (
        ("stiff_impulse", "questions:of_rings", "impulse_curve_error", {}),
        ("stiff_noise", "questions:of_rings", "noise", {}),
    ),
}


def values(runs: Sequence[CaseRun]) -> Figure:
    """Everything over the length of a segment."""
    found: Found = {}
    for run in runs:
        size = float(run.method.label.split()[1])
        if run.runs == "blocks":
            length = 10.0 / math.ceil(10.0 / size - 1e-9)  # of ten cells, in equal parts
            name = "stress" if math.log2(size).is_integer() else "stress_between"
            found.setdefault(name, {})[length] = run.read("questions:of_blocks", "departure")
        for name, measure, key, args in CURVES.get(run.runs, ()):
            found.setdefault(name, {})[size] = run.read(measure, key, **args)
    return draw(found)
