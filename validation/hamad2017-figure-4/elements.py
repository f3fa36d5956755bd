"""Finite elements of the resolution of [H17], and what the figures are drawn of."""

from __future__ import annotations

import functools
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).parents[1] / "finite-elements"))

from drawing import Curves, curves_of, forces, impulse_and_energy, methods_compared
from rings_fem import Collision, distance, regenerate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mpmfw.validation import CaseRun, Method


@functools.cache
def collision() -> Collision:
    """Rings of four-node quadrilaterals of 2 mm."""
    return regenerate()


def apart() -> dict[str, float]:
    """Return distances from the fine elements: ``total``, ``impulse``, ``force`` and ``kinetic``."""
    found = distance(collision())
    return {name: float(getattr(found, name)) for name in ("total", "impulse", "force", "kinetic")}


def raw_and_averaged(runs: Sequence[CaseRun]) -> Figure:
    """The force over time."""
    return forces(_curves(runs), collision())


def integrals(runs: Sequence[CaseRun]) -> Figure:
    """Impulse and kinetic energy over time."""
    return impulse_and_energy(_curves(runs), collision())


def every_method(runs: Sequence[CaseRun]) -> Figure:
    """Impulses of all methods."""
    return methods_compared(_curves(runs))


def _curves(runs: Sequence[CaseRun]) -> dict[Method, Curves]:
    return {run.method: curves_of(run.results) for run in runs}
