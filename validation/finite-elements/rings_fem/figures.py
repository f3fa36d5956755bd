"""Figures of collisions: convergence towards the fine reference, and von Mises stress."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from mpmfw.plots.style import dress, new_figure
from mpmfw.results.references import rings_table
from rings_fem.collision import Collision, Snapshot
from rings_fem.comparison import distance, mean_force
from rings_fem.mesh import Mesh

COLOURS = ("#D55E00", "#0072B2", "#009E73")


def convergence(collisions: Sequence[Collision], frequency: dict[float, float]) -> Figure:
    """Force, impulse and errors of collisions of falling element size beside the fine reference.

    Parameters
    ----------
    collisions
        From coarse to fine, three at most.
    frequency
        Relative error of the breathing frequency by element size [m].
    """
    figure = new_figure(2, 2, 52.0)
    panels = figure.subplot_mosaic([["force", "force"], ["impulse", "error"]])
    reference = rings_table("force")
    inside = reference["time"] <= collisions[0].time[-1] + 1e-9
    time, impulse = reference["time"][inside], reference["fine_impulse_Ns_per_m"][inside]
    exact = reference["fine_force_100us_N_per_m"][inside]
    panels["force"].plot(
        1e3 * time, 1e-3 * exact, color="black", linewidth=1.6, label="reference, 9-node, 0.5 mm"
    )
    for collision, colour in zip(collisions, COLOURS, strict=False):
        own = np.interp(time, collision.time, collision.impulse)
        label = f"4-node, {1e3 * collision.size:g} mm"
        panels["force"].plot(
            1e3 * time, 1e-3 * mean_force(collision)[1], color=colour, linewidth=0.9, label=label
        )
        panels["impulse"].plot(
            1e3 * time, 100.0 * (own - impulse) / impulse[-1], color=colour, linewidth=0.9, label=label
        )
    panels["impulse"].axhline(0.0, color="black", linewidth=1.2)
    _draw_errors(panels["error"], collisions, frequency)
    dress(panels["force"], "time [ms]", "force [kN/m]", "(a) contact force, mean over 100 µs")
    dress(
        panels["impulse"], "time [ms]", "error [% of the total]", "(b) impulse, departure from the reference"
    )
    dress(panels["error"], "element size [mm]", "relative error", "(c) errors over the element size")
    panels["force"].legend(ncols=2, loc="upper left", bbox_to_anchor=(0.11, 1.0))
    panels["error"].legend(ncols=2, loc="lower center")
    return figure


def _draw_errors(axes: Any, collisions: Sequence[Collision], frequency: dict[float, float]) -> None:
    sizes = np.array([1e3 * collision.size for collision in collisions])
    errors = [distance(collision) for collision in collisions]
    axes.loglog(
        sizes, [e.force for e in errors], "o-", color="#CC79A7", markersize=4, label="force, 100 µs ($L_2$)"
    )
    axes.loglog(
        sizes, [e.impulse for e in errors], "s-", color="#E69F00", markersize=4, label="impulse curve"
    )
    axes.loglog(
        [1e3 * size for size in frequency],
        np.abs(list(frequency.values())),
        "^-",
        color="#56B4E9",
        markersize=4,
        label="breathing frequency",
    )
    guide = np.array([sizes.min(), sizes.max()])
    least = min(abs(error) for error in frequency.values())
    axes.loglog(
        guide, 0.4 * least * (guide / guide[0]) ** 2, "--", color="0.4", linewidth=0.8, label="second order"
    )
    axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
    axes.minorticks_off()
    axes.set_ylim(1e-6, 0.5)  # room for the legend


def draw_von_mises(axes: Any, snapshot: Snapshot, mesh: Mesh, most: float = 20e6) -> PolyCollection:
    """Draw each element in its deformed shape in mm, coloured by its mean stress in MPa, 0 to ``most`` [Pa]."""
    drawn = PolyCollection(
        list(1e3 * snapshot.points[mesh.elements]),
        array=1e-6 * snapshot.element_von_mises,
        cmap="turbo",
        linewidth=0.2,
    )
    drawn.set_edgecolor("face")
    drawn.set_clim(0.0, 1e-6 * most)
    axes.add_collection(drawn)
    axes.set_xlim(-90.0, 90.0)
    axes.set_ylim(-62.0, 62.0)
    axes.set_aspect("equal")
    return drawn


def stresses(collision: Collision) -> Figure:
    """Von Mises stress at the times of [H17] figure 3, on its scale of 0 to 20 MPa."""
    figure = new_figure(2, 2, 46.0)
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    for axes, snapshot in zip(panels.flat, collision.snapshots, strict=True):
        drawn = draw_von_mises(axes, snapshot, collision.mesh)
        dress(axes, "x [mm]", "y [mm]", f"{1e3 * snapshot.time:.1f} ms")
        axes.label_outer()
    bar = figure.colorbar(drawn, ax=panels, shrink=0.7, extend="max")
    bar.set_label("von Mises stress [MPa]")
    return figure
