"""Pictures of counterexamples: the bodies' points and outlines, and what contact did to the grid's nodes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmfw.plots.style import dress
from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Picture
from mpmfw_testing.contact.motion import Motion

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")


def impulses_at(motion: Motion, step: int | None = None) -> Picture:
    """Draw the bodies before a step and its nodal impulses; by default the largest step's."""

    def picture(axes: Any) -> None:
        chosen = motion.largest_step if step is None and motion.nodal else (step or 0)
        _bodies(axes, motion, chosen)
        if motion.nodal and motion.nodal[chosen].magnitude() > 0.0:
            _arrows(axes, motion, chosen)
        _finish(axes)

    return picture


def impulse_history(motion: Motion, direction: FloatArray, what: str) -> Picture:
    """Component of the impulse on the first body along ``direction``, step by step, over time."""

    def picture(axes: Any) -> None:
        time = np.cumsum(motion.dt)
        axes.plot(1e3 * time, motion.impulse[:, 0] @ direction, ".-", color=COLOURS[0], markersize=3)
        axes.axhline(0.0, color="0.5", linewidth=0.6)
        dress(axes, "time [ms]", f"{what}, each step [N s/m]")

    return picture


def histories(curves: Mapping[str, tuple[FloatArray, FloatArray]], what: str) -> Picture:
    """Curves over time by label: times [s] and values."""

    def picture(axes: Any) -> None:
        styles = ("-", "--", ":", "-.")
        for k, (label, (time, values)) in enumerate(curves.items()):
            axes.plot(1e3 * time, values, styles[k % 4], color=COLOURS[k % 4], label=label, linewidth=1.1)
        dress(axes, "time [ms]", what)
        if len(curves) > 1:
            axes.legend()

    return picture


def places(first: Motion, second: Motion, back: Callable[[FloatArray], FloatArray] = np.asarray) -> Picture:
    """Draw the points at the end of two runs; ``back`` undoes the second's placement."""

    def picture(axes: Any) -> None:
        for motion, turn, colour, marker, label in (
            (first, np.asarray, COLOURS[0], "o", "reference"),
            (second, back, COLOURS[1], "x", "changed scene, put back"),
        ):
            x = turn(motion.positions[-1])
            axes.plot(x[:, 0], x[:, 1], marker, color=colour, markersize=2.5, fillstyle="none", label=label)
        _finish(axes)

    return picture


def _bodies(axes: Any, motion: Motion, step: int) -> None:
    state = motion.simulation.state
    for body in state.bodies:
        x = motion.positions[step][body.particles]
        axes.plot(
            x[:, 0],
            x[:, 1],
            ".",
            color=COLOURS[body.index % 4],
            markersize=2.5,
            label=f"points of '{body.name}'",
        )


def _arrows(axes: Any, motion: Motion, step: int) -> None:
    """Arrows on the nodes, of one body's colour each, the longest a cell and a half."""
    nodal, state = motion.nodal[step], motion.simulation.state
    longest = np.linalg.norm(nodal.impulse, axis=1).max()
    scale = 1.5 * state.grid.cell_size / longest
    for index in np.unique(nodal.field):
        own = nodal.of(int(index))
        arrow = scale * own.impulse
        axes.quiver(
            own.position[:, 0],
            own.position[:, 1],
            arrow[:, 0],
            arrow[:, 1],
            color=COLOURS[int(index) % 4],
            angles="xy",
            scale_units="xy",
            scale=1.0,
            width=0.006,
            zorder=3,
        )
    axes.plot(
        [], [], "-", color="0.2", label=f"nodal impulses of step {step + 1}, longest {longest:.3g} N s/m"
    )


def _finish(axes: Any) -> None:
    dress(axes, "x [m]", "y [m]")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend()
