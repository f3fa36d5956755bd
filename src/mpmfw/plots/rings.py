"""The contact force of the colliding rings beside the finite-element reference ([H17] figure 4)."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpmfw import analysis
from mpmfw.plots.style import Look, combinations, dress, legend_below, new_figure
from mpmfw.references import RingsReference, reference_of, rings_table

WINDOW = 100e-6  #: of the averaged panel [s]


def contact_force(dataset: xr.Dataset) -> Figure:
    """Contact force over time: as stored, and averaged over 100 µs beside the finite-element reference.

    Parameters
    ----------
    dataset
        Comparison; the reference is drawn if the scene is the one it was computed for.
    """
    figure = new_figure(1, 2)
    raw, mean = figure.subplots(2, 1, sharex=True)
    look, time = Look(dataset), dataset["time"].values
    for turn, (contact, shape, run) in enumerate(combinations(dataset)):
        force = -run["contact_force"].isel(pair=0).sel(axis="x").values  # on the pair's second body
        line = look.line(contact, shape, len(time), turn)
        raw.plot(1e3 * time, 1e-3 * force, **{**line, "marker": "", "linewidth": 0.6})
        mean.plot(1e3 * time, 1e-3 * analysis.running_average(time, force, WINDOW), **line)
    entries = look.key()
    if isinstance(reference_of(dataset.attrs), RingsReference):
        reference = rings_table("force")
        inside = reference["time"] <= time[-1]
        exact = analysis.averaged(reference["time"], reference["fine_impulse_Ns_per_m"], WINDOW)
        mean.plot(reference["time_ms"][inside], 1e-3 * exact[inside], color="black", linewidth=1.0, zorder=5)
        entries.insert(0, Line2D([], [], color="black", linewidth=1.0, label="finite elements, 0.5 mm"))
    dress(raw, "", "force [kN/m]", "mean over each output interval")
    dress(mean, "time [ms]", "force [kN/m]", "mean over 100 µs")
    legend_below(figure, entries)
    return figure
