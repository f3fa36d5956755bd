"""What each method costs, by stage of the step."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.plots.style import combinations, dress, head, journal_style, legend_below, new_figure, on_lines
from mpmfw.state.clock import STEP_STAGES

_STAGE_COLOURS = ("#0072B2", "#56B4E9", "#009E73", "#D55E00", "#E69F00", "#CC79A7")
#: Letters of a bar's name beside which a column leaves room for the bars.
_FOR_A_COLUMN = 24


@journal_style()
def cost_bars(dataset: xr.Dataset) -> Figure:
    """CPU time per material point and step, stacked by stage, one bar for each combination.

    Parameters
    ----------
    dataset
        Of ``mpmfw.compare``.
    """
    runs = list(combinations(dataset))
    labels = [on_lines(f"{contact}, {shape}", 60) for contact, shape, _ in runs]
    longest = max(len(line) for label in labels for line in label.splitlines())
    figure = new_figure(1 if longest <= _FOR_A_COLUMN else 2, 1, 20.0 + 7.0 * len(runs))
    head(figure, dataset)
    axes = figure.subplots()
    left = np.zeros(len(runs))
    for stage, colour in zip(STEP_STAGES, _STAGE_COLOURS, strict=True):
        widths = np.array([_share(run, stage) for _, _, run in runs])
        axes.barh(np.arange(len(runs)), widths, left=left, color=colour, label=stage, height=0.7)
        left = left + widths
    axes.set_yticks(np.arange(len(runs)), labels)
    for row, (_, _, run) in enumerate(runs):
        if left[row] == 0.0:
            axes.text(0.0, row, f" {str(run['status'].item()).partition(':')[0]}", va="center")
    axes.invert_yaxis()
    dress(axes, "CPU time [ns per point and step]", "")
    axes.grid(False, axis="y")
    stages = axes.get_legend_handles_labels()[0]
    legend_below(figure, [stages[:3], stages[3:]])
    return figure


def _share(run: xr.Dataset, stage: str) -> float:
    """Nanoseconds of one stage per particle and step; a run without figures has no bar."""
    work = float(run["steps"]) * float(run["material_points"])
    return float(np.nan_to_num(1e9 * float(run["cpu_stage"].sel(stage=stage)) / work)) if work > 0.0 else 0.0
