"""Data profiles: the share of problems that each method solves within a cost."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from mpmfw.plots.style import Look, dress, entry, journal_style, legend_below, new_panels
from mpmfw.state.fields import FloatArray


@journal_style()
def profiles(ranking: xr.Dataset) -> Figure:
    """Draw the share of problems over the cost, a panel for each quantity."""
    quantities = [
        name
        for name in ranking["quantity"].values.tolist()
        if ranking["over_best"].sel(quantity=name).notnull().any()
    ]
    by = ranking.attrs["by"]
    methods = [str(name) for name in ranking[by].values]
    look = Look(ranking if by == "contact" else ranking.rename({by: "contact"}))
    columns = math.ceil(len(quantities) / math.ceil(len(quantities) / 3))
    figure, panels = new_panels(len(quantities), 58.0, columns, sharey=True)
    farthest = float(ranking["over_best"].max())
    end = 1.3 * max(farthest, 2.0)
    for axes, quantity in zip(panels, quantities, strict=True):
        for name in methods:
            ratio, share = profile(ranking, quantity, name)
            x, y = np.concatenate([[1.0], ratio, [end]]), np.concatenate([[0.0], share, share[-1:]])
            axes.step(x[: len(y)], 100.0 * y, where="post", color=look.colours[name], linewidth=1.3)
        axes.set_xscale("log")
        axes.set_xlim(0.95, end)
        axes.set_ylim(0.0, 102.0)
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 5.0)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        ylabel = "problems and levels solved [%]" if axes in panels[::columns] else ""
        unit = str(ranking["unit"].sel(quantity=quantity).item())
        title = quantity if unit == "%" else f"{quantity}, levels in {unit}"
        dress(axes, "CPU time over the cheapest method's", ylabel, title)
    order = sorted(methods, key=lambda name: -len(profile(ranking, quantities[0], name)[0]))
    key = [entry(name, color=look.colours[name], linewidth=2.5) for name in order]
    legend_below(figure, [key])
    return figure


def profile(ranking: xr.Dataset, quantity: str, method: str) -> tuple[FloatArray, FloatArray]:
    """Return rising costs over the best (n,), and the share of problems solved within each.

    Source: E. D. Dolan, J. J. Moré (2002), *Mathematical Programming* 91, 201-213.
    """
    by = ranking.attrs["by"]
    ratio = ranking["over_best"].sel({"quantity": quantity, by: method}).values.ravel()
    solved = np.isfinite(ranking["over_best"].sel(quantity=quantity).values).any(axis=-1)
    solvable = solved[ranking["ran"].sel({by: method}).values].sum()
    known = np.sort(ratio[np.isfinite(ratio)])
    return known, np.arange(1, len(known) + 1) / max(int(solvable), 1)
