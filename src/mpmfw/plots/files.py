"""Choose the figures of a results' file by its content."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.errors import MpmfwError, SceneError
from mpmfw.plots.costs import cost_bars
from mpmfw.plots.histories import history
from mpmfw.plots.outlines import positions
from mpmfw.plots.rolling import contact_force, motion
from mpmfw.plots.scene import (
    body_motion,
    energies,
    gap_history,
    moving_bodies,
    near_pairs,
    pair_forces,
    touching_pairs,
)
from mpmfw.plots.stability import stability_figures
from mpmfw.plots.study import study_figures
from mpmfw.plots.style import at_last, drawn_reference, drawn_values, journal_style
from mpmfw.results import open as open_results
from mpmfw.results.references import RingsReference, RollingReference
from mpmfw.results.replacing import check_new, replace_bytes
from mpmfw.results.round_off import without_round_off
from mpmfw.results.selection import series_of

#: Series of a run that are drawn unasked.
_OVERVIEW = (
    "centre_of_mass",
    "mean_velocity",
    "kinetic_energy",
    "strain_energy",
    "contact_force",
    "min_gap",
)

#: Metadata by format without which two drawings of the same figure would differ.
_UNDATED = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}


def figures_of(dataset: xr.Dataset) -> dict[str, tuple[Figure, str]]:
    """Figures of a comparison or a study that its content allows: ``{name: (figure, caption)}``.

    Parameters
    ----------
    dataset
        Of ``mpmfw.compare``, ``mpmfw.study`` or a map of stability, or the series of a run.
    """
    if dataset.attrs.get("kind") == "study":
        return study_figures(dataset)
    if dataset.attrs.get("kind") == "stability":
        return stability_figures(dataset)
    if "time" not in dataset.dims or dataset.sizes["time"] < 2:
        return {}
    dataset = without_round_off(dataset)
    if "status" not in dataset:
        return {"series": (_overview(dataset), "Series of the bodies and pairs.")}
    reference = drawn_reference(dataset)
    figures: dict[str, tuple[Figure, str]] = {}
    if isinstance(reference, RollingReference):
        figures["motion"] = (
            motion([dataset]),
            "Displacement, velocity and spin of the cylinder against the closed form, and displacement less "
            "the closed form, without the runs whose cylinder sticks.",
        )
    if isinstance(reference, RingsReference) and "contact_force" in dataset:
        figures["force"] = (
            contact_force(dataset),
            "Contact force on the right ring: as stored, averaged over 100 µs, and its impulse, beside the "
            "finite-element reference. The stored force is noisy in every method and not to be compared.",
        )
    elif "outline" in dataset and np.isfinite(at_last(dataset)["outline"].values).any():
        figures["positions"] = (
            positions(dataset),
            "Outlines at the first output (dashed) and at the last, at one scale; bodies that stand still "
            "are grey. Of a cylinder the contact at the end is enlarged, over the cells.",
        )
    if not isinstance(reference, RollingReference) and "force" not in figures:
        figures |= _any_scene(dataset)
    if "min_gap" in dataset and isinstance(reference, RollingReference | RingsReference):
        figures["gap"] = (
            gap_history(dataset),
            "Least distance between the bodies' outlines, in cells; negative where they penetrate.",
        )
    if "cpu_stage" in dataset and np.isfinite(dataset["cpu_stage"].values).any():
        figures["cost"] = (cost_bars(dataset), "CPU time per material point and step, by stage of the step.")
    text = f" {drawn_values(dataset)}." if drawn_values(dataset) else ""
    return {name: (figure, caption + text) for name, (figure, caption) in figures.items()}


def _overview(series: xr.Dataset) -> Figure:
    """Draw the main series of a run, a panel for each."""
    present = [name for name in _OVERVIEW if name in series] or [str(name) for name in series.data_vars][:6]
    return history(xr.DataTree.from_dict({"series": series}), present)


def _any_scene(dataset: xr.Dataset) -> dict[str, tuple[Figure, str]]:
    """Draw a comparison without a closed form: motion, forces, gaps and energies."""
    figures = {}
    if "centre_of_mass" in dataset and moving_bodies(dataset):
        figures["motion"] = (
            body_motion(dataset),
            "Motion of the bodies that do not stand still, the furthest first.",
        )
    if "contact_force" in dataset and touching_pairs(dataset):
        figures["forces"] = (
            pair_forces(dataset),
            "Contact force of every pair that touches, mean over the output interval: across the surface and "
            "along it.",
        )
    if "min_gap" in dataset and near_pairs(dataset):
        figures["gaps"] = (
            gap_history(dataset),
            "Least distance between the outlines of every pair that comes near; negative where they overlap.",
        )
    if {"kinetic_energy", "strain_energy"} <= set(dataset.data_vars):
        figures["energies"] = (energies(dataset), "Energies of all bodies, and what contact has dissipated.")
    return figures


def plot_file(
    path: str | os.PathLike[str], output: str | os.PathLike[str] | None = None, *, force: bool = False
) -> list[Path]:
    """Draw the figures of a run, a comparison or a study.

    Parameters
    ----------
    path
        File of a run, a comparison or a study.
    output
        Name of the figure, or of all where there are several, whose ending says the format, PNG without one;
        next to ``path`` by default.
    force
        Replace figures that exist.

    Returns
    -------
    list of Path
        What was written: ``<stem>.<format>`` for one figure, else ``<stem>-<figure>.<format>``.

    Raises
    ------
    SceneError
        The file holds nothing to draw, or a figure exists.
    MpmfwError
        The file cannot be read, or a figure cannot be written.
    """
    results = open_results(path)
    dataset = series_of(results)
    if isinstance(results, xr.DataTree):
        drawn = {"series": _overview(dataset)} if dataset.sizes.get("time", 0) > 1 else {}
    else:
        drawn = (
            {name: figure for name, (figure, _) in figures_of(dataset).items()}
            if "status" in dataset or "class" in dataset
            else {}
        )
    if not drawn:
        raise SceneError(f"'{os.fspath(path)}' holds no series with two outputs or more to draw")
    first = Path(path).with_suffix(".png") if output is None else Path(output)
    names = {name: first if len(drawn) == 1 else first.with_stem(f"{first.stem}-{name}") for name in drawn}
    for target in names.values():
        check_new(target, force)
    return [write_figure(figure, names[name]) for name, figure in drawn.items()]


def plot_files(paths: Sequence[str | os.PathLike[str]], output: str | os.PathLike[str]) -> Path:
    """Draw the motions of several comparisons of a rolling cylinder, one row each.

    Parameters
    ----------
    paths
        Files of the comparisons.
    output
        Name of the figure, whose ending says the format.

    Raises
    ------
    SceneError
        A file is no comparison of a rolling cylinder.
    MpmfwError
        A file cannot be read, or the figure cannot be written.
    """
    datasets = [series_of(open_results(path)) for path in paths]
    for path, dataset in zip(paths, datasets, strict=True):
        if "status" not in dataset or not isinstance(drawn_reference(dataset), RollingReference):
            raise SceneError(
                f"'{os.fspath(path)}' is no comparison of a rolling cylinder; plot other files one by one, "
                "or side by side with --field or --series"
            )
    return write_figure(motion(datasets), Path(output))


def write_figure(figure: Figure, path: Path) -> Path:
    """Save a figure.

    Parameters
    ----------
    figure
        Any figure of matplotlib.
    path
        File to write, whose ending says the format: ``.png`` (without one as well), ``.pdf``, ``.svg`` …

    Raises
    ------
    MpmfwError
        The file cannot be written; the message names it.
    """
    path = path if path.suffix else path.with_suffix(".png")
    form, content = path.suffix.lower(), io.BytesIO()
    try:
        with journal_style():
            figure.savefig(content, format=form[1:], metadata=_UNDATED.get(form))
    except ValueError as error:
        raise MpmfwError(f"cannot write '{path}': {error}") from error
    replace_bytes(content.getbuffer(), path)
    return path
