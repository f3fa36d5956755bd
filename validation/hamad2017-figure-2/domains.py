"""The discretisation of penalty contact, and what the figure is drawn of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from drawing import positions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mpmfw.state.fields import FloatArray
    from mpmfw.validation import CaseRun


def counted(runs: Sequence[CaseRun]) -> dict[str, float]:
    """``segments`` of both surfaces; of each body its material ``points`` and the longest ``edge`` of a
    domain [m].
    """
    tree = next(run.results for run in runs if run.method.recommended)
    found = {
        "segments": float(sum(group.sizes["surface_node"] for group in tree["surface"].children.values()))
    }
    for body, group in tree["particles"].children.items():
        corners = np.asarray(group["corners"].isel(time=0))
        found |= {f"points {body}": float(len(corners)), f"edge {body}": _longest_edge(corners)}
    return found


def _longest_edge(corners: FloatArray) -> float:
    """Longest edge of quadrilaterals (n, 4, 2) [m]."""
    return float(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max())


def draw(runs: Sequence[CaseRun]) -> Figure:
    """Draw the first and the last position with penalty contact and with classical contact."""
    return positions({run.method: run.results for run in runs if not run.method.label})
