"""Choose the figures of a results' file by its content."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.errors import MpmfwError, SceneError
from mpmfw.plots import scene
from mpmfw.plots.histories import history
from mpmfw.plots.scene import contact_force, motion, positions
from mpmfw.plots.stability import stability_figures
from mpmfw.plots.study import cost_bars, study_figures
from mpmfw.plots.style import at_last, drawn_reference, drawn_values, journal_style
from mpmfw.results import open as open_results
from mpmfw.results.analysis import without_round_off
from mpmfw.results.references import RingsReference, RollingReference
from mpmfw.results.replacing import check_new, replace_bytes
from mpmfw.results.selection import series_of

#: Series of a run that are drawn unasked.
_OVERVIEW = ["centre_of_mass", "mean_velocity", "kinetic_energy", "strain_energy", "contact_force", "min_gap"]

#: Metadata by format without which two drawings of the same figure would differ.
_UNDATED = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}


def figures_of(dataset: xr.Dataset) -> dict[str, tuple[Figure, str]]:
    """Return the figures of a result, ``{name: (figure, caption)}``."""
    if dataset.attrs.get("kind") == "study":
        return study_figures(dataset)
    if dataset.attrs.get("kind") == "stability":
        return stability_figures(dataset)
    if "time" not in dataset.dims or dataset.sizes["time"] < 2:
        return {}
    dataset = without_round_off(dataset)
    if "status" not in dataset:
        present = [name for name in _OVERVIEW if name in dataset] or list(map(str, dataset.data_vars))[:6]
        figure = history(xr.DataTree.from_dict({"series": dataset}), present)
        return {"series": (figure, "Series of the bodies and pairs.")}
    text = f" {drawn_values(dataset)}." if drawn_values(dataset) else ""
    return {name: (draw(dataset), caption + text) for name, draw, caption in _figures(dataset)}


def _figures(dataset: xr.Dataset) -> Iterator[tuple[str, Callable[[xr.Dataset], Figure], str]]:
    """Yield name, function and caption of each figure that a comparison has."""
    reference, names = drawn_reference(dataset), set(dataset.data_vars)
    rolls = reference.body if isinstance(reference, RollingReference) else ""
    collide = isinstance(reference, RingsReference) and "contact_force" in names
    if rolls:
        text = f"Displacement, velocity and spin of {rolls}, and displacement less the closed form."
        yield "motion", motion, text
    if collide:
        text = "Contact force on the right ring: as stored (noisy), averaged over 100 µs, and its impulse."
        yield "force", contact_force, text
    elif "outline" in names and np.isfinite(at_last(dataset)["outline"].values).any():
        text = "Outlines at the first output (dashed) and at the last; bodies that stand still are grey."
        yield "positions", positions, text
    if not rolls and not collide:
        if "centre_of_mass" in names and (found := scene.moving_bodies(dataset)):
            text = f"Motion of the bodies that do not stand still, furthest first{_most(found)}."
            yield "motion", scene.body_motion, text
        if "contact_force" in names and (found := scene.touching_pairs(dataset)):
            text = f"Contact force of the pairs that touch, across the surface and along it{_most(found)}."
            yield "forces", scene.pair_forces, text
        if "min_gap" in names and (found := scene.near_pairs(dataset)):
            text = f"Gap of the pairs that come near; negative where they overlap{_most(found)}."
            yield "gaps", scene.gap_history, text
        if {"kinetic_energy", "strain_energy"} <= names:
            yield "energies", scene.energies, "Energies of all bodies, and what contact has dissipated."
    if "min_gap" in names and isinstance(reference, RollingReference | RingsReference):
        text = "Least distance between the bodies' outlines, in cells; negative where they penetrate."
        yield "gap", scene.gap_history, text
    if "cpu_stage" in names and np.isfinite(dataset["cpu_stage"].values).any():
        yield "cost", cost_bars, "CPU time per material point and step, by stage of the step."


def _most(found: Sequence[str]) -> str:
    """Return how many bodies or pairs a figure leaves out."""
    return f"; {scene.MOST} of {len(found)}" if len(found) > scene.MOST else ""


def plot_file(
    path: str | os.PathLike[str], output: str | os.PathLike[str] | None = None, *, force: bool = False
) -> list[Path]:
    """Draw the figures of the file of a run, a comparison, a study or a map; return those written.

    Parameters
    ----------
    path
        The file.
    output
        Name of the figure, by default next to ``path``; of several figures ``<stem>-<figure>.<format>``.
    force
        Replace figures that exist.

    Raises
    ------
    SceneError
        The file holds nothing to draw, or a figure exists.
    MpmfwError
        A file cannot be read or written.
    """
    found = figures_of(series_of(open_results(path)))
    drawn = {name: figure for name, (figure, _) in found.items()}
    if not drawn:
        raise SceneError(f"'{os.fspath(path)}' holds no series with two outputs or more to draw")
    first = Path(path).with_suffix(".png") if output is None else Path(output)
    names = {name: first if len(drawn) == 1 else first.with_stem(f"{first.stem}-{name}") for name in drawn}
    for target in names.values():
        check_new(target, force)
    return [write_figure(figure, names[name]) for name, figure in drawn.items()]


def write_figure(figure: Figure, path: Path) -> Path:
    """Save a figure in the format of the path's suffix, by default PNG."""
    path = path if path.suffix else path.with_suffix(".png")
    form, content = path.suffix.lower(), io.BytesIO()
    try:
        with journal_style():
            figure.savefig(content, format=form[1:], metadata=_UNDATED.get(form))
    except ValueError as error:
        raise MpmfwError(f"cannot write '{path}': {error}") from error
    replace_bytes(content.getbuffer(), path)
    return path
