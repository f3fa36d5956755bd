"""Choose the figures of a results' file by its content."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.errors import MpmfwError
from mpmfw.plots.costs import cost_bars
from mpmfw.plots.generic import gap_history, series_overview
from mpmfw.plots.rings import contact_force
from mpmfw.plots.rolling import motion, positions
from mpmfw.references import RingsReference, RollingReference, reference_of
from mpmfw.results import open as open_results


def figures_of(dataset: xr.Dataset) -> dict[str, tuple[Figure, str]]:
    """Figures of a comparison that its content allows: ``{name: (figure, caption)}``."""
    if "time" not in dataset.dims or dataset.sizes["time"] < 2:
        return {}
    reference = reference_of(dataset.attrs)
    figures: dict[str, tuple[Figure, str]] = {}
    if isinstance(reference, RollingReference):
        figures["motion"] = (
            motion([dataset]),
            "Displacement and velocity of the cylinder against the closed form.",
        )
        if "outline" in dataset:
            figures["positions"] = (
                positions(dataset),
                "First and last position; the inset shows the gap at the end.",
            )
    elif isinstance(reference, RingsReference) and "contact_force" in dataset:
        figures["force"] = (contact_force(dataset), "Contact force beside the finite-element reference.")
    else:
        figures["series"] = (series_overview(dataset), "Series of the first body and the first pair.")
    if "min_gap" in dataset:
        figures["gap"] = (gap_history(dataset), "Least distance between the bodies' surfaces.")
    if "cpu_stage" in dataset and np.isfinite(dataset["cpu_stage"].values).any():
        figures["cost"] = (cost_bars(dataset), "CPU time by stage of the step.")
    return figures


def plot_file(path: str | os.PathLike[str], output: str | os.PathLike[str] | None = None) -> list[Path]:
    """Draw the figures of a run or a comparison as PNG files.

    Parameters
    ----------
    path
        File of a run or a comparison.
    output
        Name of the figure, or stem of the names where there are several; next to ``path`` by default.

    Returns
    -------
    list of Path
        What was written: ``<stem>.png`` for one figure, else ``<stem>-<figure>.png``.

    Raises
    ------
    MpmfwError
        The file cannot be read or holds nothing to draw, or a figure cannot be written.
    """
    tree = open_results(path)
    if "series" in tree.children:
        dataset = tree["series"].to_dataset()
        drawn = {"series": series_overview(dataset)} if dataset.sizes.get("time", 0) > 1 else {}
    else:
        dataset = tree.to_dataset()
        drawn = (
            {name: figure for name, (figure, _) in figures_of(dataset).items()} if "status" in dataset else {}
        )
    if not drawn:
        raise MpmfwError(f"'{os.fspath(path)}' holds no series with two outputs or more to draw")
    stem = Path(output if output is not None else path).with_suffix("")
    written = []
    for name, figure in drawn.items():
        target = stem.with_name(f"{stem.name}.png" if len(drawn) == 1 else f"{stem.name}-{name}.png")
        try:
            figure.savefig(target)
        except OSError as error:
            raise MpmfwError(f"cannot write '{target}': {error.strerror}") from error
        written.append(target)
    return written
