"""Moving pictures of a field: one run, or several side by side."""

from __future__ import annotations

import contextlib
import importlib
import os
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter

from mpmfw.errors import SceneError
from mpmfw.plots.field_figure import Drawing, labelled
from mpmfw.results.replacing import replacement
from mpmfw.results.selection import Results, chosen_frames, frame_at, times_of
from mpmfw.state.fields import FloatArray

#: Pixels an inch: a column of 85 mm is 502 wide.
_DPI = 150


def movie(trees: Mapping[str, xr.DataTree], name: str, times: FloatArray, **options: Any) -> Drawing:
    """Return a drawing with the outputs nearest to some times [s]; its panels stand still."""
    drawing = Drawing(
        trees, name, {label: frames_at(tree, times) for label, tree in trees.items()}, **options
    )
    drawing.show(0)
    drawing.figure.canvas.draw()
    drawing.figure.set_layout_engine("none")
    return drawing


def frames_at(tree: xr.DataTree, times: FloatArray) -> list[int]:
    """Return the outputs of a run that are nearest to some times [s]."""
    return [frame_at(tree, np.clip(time, *times_of(tree)[[0, -1]])) for time in times]


def animate(
    results: Results | Mapping[str, Results] | Sequence[Results],
    path: str | os.PathLike[str],
    field: str = "von_mises",
    *,
    fps: int = 20,
    every: int = 1,
    bodies: Sequence[str] | None = None,
    limits: tuple[float, float] | None = None,
    arrows: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Write a moving picture of a field, a frame for each output; runs in 3D need pyvista.

    Parameters
    ----------
    results
        A run, or a comparison or several runs, which stand side by side at the times of the first.
    path
        File to write: ``.gif``, or ``.mp4``, which needs ffmpeg (``pip install mpmfw[animate]``).
    field, bodies, limits, arrows
        As of :func:`mpmfw.plots.field`; the colour scale spans all frames.
    fps, every
        Frames a second; only each ``every``-th output.
    progress
        Called with the number of frames drawn and that of all.

    Raises
    ------
    SceneError
        ``fps`` is below 1, a field, a body or the file's ending is unknown, or ffmpeg is missing.
    MpmfwError
        A file cannot be read or written.
    """
    target = Path(path)
    if fps < 1:
        raise SceneError(f"fps {fps}: expected 1 or more")
    ffmpeg = check_movie(target)
    with labelled(results) as trees, mpl.rc_context():
        first = next(iter(trees.values()))
        times = times_of(first)[list(chosen_frames(first, every))]
        drawing = movie(trees, field, times, bodies=bodies, limits=limits, arrows=arrows)
        writer: AbstractMovieWriter = PillowWriter(fps)
        if ffmpeg is not None:
            mpl.rcParams["animation.ffmpeg_path"] = ffmpeg
            writer = FFMpegWriter(fps, "libx264")
        with replacement(target) as growing, writer.saving(drawing.figure, str(growing), _DPI):
            for index in range(len(times)):
                drawing.show(index)
                writer.grab_frame()
                if progress is not None:
                    progress(index + 1, len(times))
    return target


def check_movie(path: Path) -> str | None:
    """Return the ffmpeg that a file's ending needs, if any."""
    if path.suffix == ".gif":
        return None
    if path.suffix != ".mp4":
        raise SceneError(f"{path}: expected a name that ends in .gif or .mp4")
    ffmpeg = shutil.which("ffmpeg")
    if ffmpeg is None:
        with contextlib.suppress(ImportError, RuntimeError):  # absent, or without a binary for this system
            ffmpeg = str(importlib.import_module("imageio_ffmpeg").get_ffmpeg_exe())
    if ffmpeg is None:
        raise SceneError(f"{path}: needs ffmpeg (pip install 'mpmfw[animate]'), which a .gif does not")
    return ffmpeg
