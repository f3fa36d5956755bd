"""Moving pictures: as many frames as outputs, each with the data of its time."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from PIL import Image, ImageSequence

import mpmfw
from drop_for_tests import drop, drop_scene
from mpmfw.errors import MpmfwError
from mpmfw.plots.animation import Movie


@pytest.fixture(scope="module")
def run():
    return drop()


@pytest.fixture(scope="module")
def gif(run, tmp_path_factory):
    """Frames of a picture of the run, as pixels."""
    path = tmp_path_factory.mktemp("gif") / "drop.gif"
    progress = []
    assert mpmfw.animate(run, path, fps=5, progress=lambda *done: progress.append(done)) == path
    assert progress == [(k, 5) for k in range(1, 6)]
    assert list(path.parent.iterdir()) == [path]
    with Image.open(path) as image:
        assert image.info["duration"] == 200
        return [np.asarray(frame.convert("RGB"), dtype=float) for frame in ImageSequence.Iterator(image)]


def pixels(movie):
    movie.figure.set_dpi(150)
    movie.figure.canvas.draw()
    return np.asarray(movie.figure.canvas.buffer_rgba(), dtype=float)[..., :3]


def test_each_frame_shows_the_data_of_its_time(run, gif):
    movie = Movie({"": run})
    movie.figure.set_dpi(150)
    for k in range(len(gif)):
        movie.show(k)
        (axes,) = (one for one in movie.figure.axes if one.get_title(loc="left"))
        assert axes.get_title(loc="left") == f"penalty, cpdi, t = {2 * k} ms"
        patches = [one for one in axes.collections if isinstance(one, PolyCollection)]
        drawn = np.concatenate([one.get_array() for one in patches])
        stored = [run[f"particles/{body}/von_mises"].values[k] for body in ("upper", "floor")]
        np.testing.assert_allclose(1e6 * drawn, np.concatenate(stored))
        centre = np.mean([path.vertices[:4].mean(axis=0) for path in patches[0].get_paths()], axis=0)
        np.testing.assert_allclose(centre, run["particles/upper/position"].values[k].mean(axis=0), rtol=1e-6)
        # What is in the file is that drawing, up to the palette of a gif
        apart = [np.abs(pixels(movie) - other).mean() for other in gif]
        assert int(np.argmin(apart)) == k
        assert apart[k] < 2.0
    values = np.concatenate(
        [run[f"particles/{body}/von_mises"].values.ravel() for body in ("upper", "floor")]
    )
    limits = patches[0].norm.vmin, patches[0].norm.vmax
    np.testing.assert_allclose(limits, [1e-6 * values.min(), 1e-6 * values.max()])


def test_runs_stand_side_by_side_at_the_same_times(run):
    short = mpmfw.run({**drop_scene("gimp"), "time": {"end": 0.004, "output_interval": 0.001}})
    movie = Movie({"long": run, "short": short}, "velocity", every=2)
    assert movie.times == run["time"].values[::2].tolist()
    assert movie.frames == {"long": [0, 2, 4], "short": [0, 4, 4]}
    movie.show(1)
    titles = [axes.get_title(loc="left") for axes in movie.figure.axes[:2]]
    assert titles == ["long, t = 4 ms", "short, t = 4 ms"]


def test_mp4(run, tmp_path):
    path = mpmfw.animate(run, tmp_path / "drop.mp4", every=2)
    assert path.read_bytes()[4:8] == b"ftyp"


def test_an_unfinished_picture_leaves_no_file(run, tmp_path):
    def stop(done, _):
        if done == 2:
            raise OSError("disk full")

    with pytest.raises(MpmfwError, match="cannot write"):
        mpmfw.animate(run, tmp_path / "drop.gif", progress=stop)
    assert list(tmp_path.iterdir()) == []
