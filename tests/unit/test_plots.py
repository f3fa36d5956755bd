"""Figures of fields and histories, side by side, and what a notebook asks for."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import EllipseCollection, PolyCollection
from matplotlib.quiver import Quiver
from PIL import Image

import mpmfw
from command_line import called
from drop_for_tests import drop, drop_scene
from mpmfw.errors import SceneError
from mpmfw.geometry.solid import sphere_surface
from mpmfw.plots.animation import movie as movie_of
from mpmfw.plots.plane_cut import cut_lines
from mpmfw.results.point_fields import point_field, point_fields
from mpmfw.results.selection import chosen_frames
from scenes_for_tests import ball_on_a_box

BODIES = ("upper", "floor")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Files of two runs and a comparison."""
    folder = tmp_path_factory.mktemp("plots")
    drop(output=folder / "a.nc")
    drop("gimp", "bardenhagen", output=folder / "b.nc")
    methods = {"contact": ["bardenhagen", "penalty"], "shape": ["gimp", "cpdi"]}
    mpmfw.compare(drop_scene(), **methods).to_netcdf(folder / "c.nc")
    return folder


@pytest.fixture(scope="module")
def a(folder):
    return mpmfw.open(folder / "a.nc")


@pytest.fixture(scope="module")
def b(folder):
    return mpmfw.open(folder / "b.nc")


def shapes_in(axes):
    drawn = [one for one in axes.collections if isinstance(one, PolyCollection | EllipseCollection)]
    return [one for one in drawn if not isinstance(one, Quiver)]


def test_fields_are_those_stored_their_parts_and_a_few_more(a):
    frame = a["particles/upper"].to_dataset().isel(time=3)
    stress = frame["stress"].values
    expected = {
        "von_mises": frame["von_mises"].values,
        "velocity": np.hypot(*frame["velocity"].values.T),
        "velocity_y": frame["velocity"].values[:, 1],
        "stress_xy": stress[:, 0, 1],
        "in_plane_pressure": -0.5 * (stress[:, 0, 0] + stress[:, 1, 1]),
        "volume_ratio": np.linalg.det(frame["deformation_gradient"].values),
        "mass": frame["mass"].values,
    }
    assert set(expected) < set(point_fields(frame))
    for name, values in expected.items():
        np.testing.assert_allclose(point_field(frame, name), values, err_msg=name)
    assert point_field(frame, "in_plane_pressure").attrs["units"] == "Pa"


def test_a_field_is_drawn_at_its_time_on_the_domains(a):
    figure = mpmfw.plots.field(a, "von_mises", 0.0041, arrows=True)
    axes, bar = figure.axes
    assert axes.get_title(loc="left") == "penalty, cpdi, t = 4 ms"
    shapes = shapes_in(axes)
    for one, body in zip(shapes, BODIES, strict=True):
        np.testing.assert_allclose(1e6 * one.get_array(), a[f"particles/{body}/von_mises"].values[2])
    assert bar.get_xlabel() == "von Mises stress [MPa]"
    assert axes.get_aspect() == 1.0
    # Arrows: the forces of all nodes in contact, in one common scale
    arrows = [one for one in axes.collections if isinstance(one, Quiver)]
    drawn = np.concatenate([np.stack([one.U, one.V], axis=1) for one in arrows])
    forces = np.concatenate([a[f"surface/{body}/force"].values[2] for body in BODIES])
    size = np.linalg.norm(forces, axis=1)
    acting = forces[size > 1e-3 * size.max()]
    assert len(acting) > 2
    ratio = drawn[np.abs(acting) > 1e-9] / acting[np.abs(acting) > 1e-9]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda a: mpmfw.plots.field(a, "von_misses"), "no field 'von_misses'; did you mean 'von_mises'"),
        (lambda a: mpmfw.plots.field(a, time=1.0), r"no output at 1 s; expected a time from 0 to 0\.008 s"),
        (lambda a: mpmfw.plots.field(a, bodies=["top"]), r"no body 'top'; one of floor, upper"),
        (lambda a: mpmfw.plots.history(a, "gap"), "no series 'gap'; did you mean 'min_gap'|one of"),
        (lambda a: mpmfw.plots.history(a, "min_gap", pair="uper-floor"), "did you mean 'upper-floor'"),
        (mpmfw.table, "not results of a comparison"),
        (lambda _: mpmfw.plots.side_by_side({}, "von_mises"), "no results to draw"),
        (lambda a: mpmfw.plots.history(a, []), "no series named"),
        (lambda a: mpmfw.animate(a, "a.gif", fps=0), "fps 0: expected 1 or more"),
    ],
)
def test_wrong_names_get_one_message(a, call, message):
    with pytest.raises(SceneError, match=message):
        call(a)


@pytest.mark.parametrize(
    ("arguments", "written"),
    [
        (["a.nc", "--field", "velocity", "--time", "0.004"], "a-velocity.png"),
        (["a.nc", "b.nc", "--field", "stress_yy", "--body", "upper"], "stress_yy.png"),
        (
            ["c.nc", "--series", "min_gap", "--series", "mean_velocity", "--axis", "y"],
            "c-min_gap-mean_velocity.png",
        ),
        (["a.nc", "-o", "vectors.pdf"], "vectors.pdf"),
    ],
)
def test_the_command_draws(folder, monkeypatch, arguments, written):
    monkeypatch.chdir(folder)
    result = called("plot", *arguments)
    assert (result.stdout, result.stderr) == (f"{written}\n", "")
    assert (folder / written).stat().st_size > 10_000


@pytest.mark.parametrize("ending", ["png", "pdf", "svg"])
def test_the_ending_is_the_format_and_two_drawings_are_the_same(a, tmp_path, ending):
    files = [
        mpmfw.plots.write_figure(mpmfw.plots.history(a, ["min_gap"]), tmp_path / f"{k}.{ending}")
        for k in range(2)
    ]
    one, other = (file.read_bytes() for file in files)
    assert one == other
    assert {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}[ending] == one[: 5 if ending == "svg" else 4]
    if ending == "svg":
        assert b">least distance" in one or b"gap" in one  # as text, not as outlines of letters


def test_the_functions_of_a_notebook(a, folder):
    centre = mpmfw.history(a, "centre_of_mass", body="upper", axis="x")
    assert (centre.dims, centre.attrs["units"]) == (("time",), "m")
    np.testing.assert_array_equal(centre, a["series/centre_of_mass"].values[:, 0, 0])
    np.testing.assert_array_equal(mpmfw.gap(a), a["series/min_gap"].values[:, 0])
    xr.testing.assert_identical(mpmfw.gap(a), mpmfw.gap(folder / "a.nc", "upper-floor"))
    xr.testing.assert_identical(a.mpmfw.gap(), mpmfw.gap(a))
    xr.testing.assert_identical(a.mpmfw.history("centre_of_mass", body="upper", axis="x"), centre)
    xr.testing.assert_identical(a.mpmfw.field(time=0.004), mpmfw.field(a, time=0.004))
    stress = mpmfw.field(a, "von_mises", time=0.004)
    stored = [a[f"particles/{body}/von_mises"].values[2] for body in BODIES]
    np.testing.assert_array_equal(stress, np.concatenate(stored))
    assert float(stress["time"]) == pytest.approx(0.004)
    upper = stress.where(stress["body"] == "upper", drop=True)
    np.testing.assert_array_equal(upper["x"], a["particles/upper/position"].values[2, :, 0])
    xr.testing.assert_equal(mpmfw.field(a, time=0.004, body="upper"), upper)
    spin = mpmfw.history(folder / "c.nc", "angular_velocity", body="upper", axis="z")
    assert spin.dims == ("contact", "shape", "time")
    assert mpmfw.gap(folder / "c.nc").dims == ("contact", "shape", "time")


def test_the_front_of_a_study():
    dims = ("contact", "cell_size")
    study = xr.Dataset(
        {
            "error": (dims, [[0.3, 0.1], [0.2, 0.15]]),
            "cpu_time": (dims, [[1.0, 4.0], [2.0, 5.0]]),
            "pareto": (dims, [[True, True], [True, False]]),
        },
        {"contact": ["a", "b"], "cell_size": [0.2, 0.1]},
    )
    front = mpmfw.pareto(study)
    assert front.index.tolist() == [("a", 0.2), ("b", 0.2), ("a", 0.1)]
    assert front["error"].tolist() == [0.3, 0.2, 0.1]
    assert front["cpu_time"].tolist() == [1.0, 2.0, 4.0]


def test_each_frame_shows_the_data_of_its_time(a, tmp_path):
    path, progress = tmp_path / "drop.gif", []
    assert mpmfw.animate(a, path, fps=5, progress=lambda *done: progress.append(done)) == path
    assert progress == [(k, 5) for k in range(1, 6)]
    assert list(tmp_path.iterdir()) == [path]
    with Image.open(path) as image:
        assert (image.info["duration"], image.n_frames) == (200, 5)
    movie = movie_of({"": a}, "von_mises", a["time"].values)
    for k in (0, 3):
        movie.show(k)
        (axes,) = (one for one in movie.figure.axes if one.get_title(loc="left"))
        assert axes.get_title(loc="left") == f"penalty, cpdi, t = {2 * k} ms"
        patches = [one for one in axes.collections if isinstance(one, PolyCollection)]
        drawn = np.concatenate([one.get_array() for one in patches])
        stored = [a[f"particles/{body}/von_mises"].values[k] for body in BODIES]
        np.testing.assert_allclose(1e6 * drawn, np.concatenate(stored))
        centre = np.mean([path.vertices[:4].mean(axis=0) for path in patches[0].get_paths()], axis=0)
        np.testing.assert_allclose(centre, a["particles/upper/position"].values[k].mean(axis=0), rtol=1e-6)
    values = np.concatenate([a[f"particles/{body}/von_mises"].values.ravel() for body in BODIES])
    limits = patches[0].norm.vmin, patches[0].norm.vmax
    np.testing.assert_allclose(limits, [1e-6 * values.min(), 1e-6 * values.max()])


def test_runs_stand_side_by_side_at_the_same_times(a):
    short = mpmfw.run({**drop_scene("gimp"), "time": {"end": 0.004, "output_interval": 0.001}})
    movie = movie_of({"long": a, "short": short}, "velocity", a["time"].values[::2])
    assert movie.frames == {"long": [0, 2, 4], "short": [0, 4, 4]}
    movie.show(1)
    titles = [axes.get_title(loc="left") for axes in movie.figure.axes[:2]]
    assert titles == ["long, t = 4 ms", "short, t = 4 ms"]


def test_the_last_output_is_always_among_the_chosen(a):
    assert len(a["time"]) == 5
    assert [chosen_frames(a, every) for every in (2, 3, 9)] == [[0, 2, 4], [0, 3, 4], [0, 4]]


def test_mp4(a, tmp_path):
    path = mpmfw.animate(a, tmp_path / "drop.mp4", every=2)
    assert path.read_bytes()[4:8] == b"ftyp"


@pytest.fixture(scope="module")
def tree():
    return mpmfw.run(ball_on_a_box())


def test_a_cut_of_a_sphere_is_a_closed_circle():
    nodes, facets = sphere_surface(np.array([0.1, 0.2, 0.3]), 1.0, 0.1)
    lines = cut_lines(nodes, facets, 2, 0.7)
    np.testing.assert_allclose(lines[:, :, 2], 0.7, atol=1e-12)
    radius = np.linalg.norm(lines[:, :, :2] - [0.1, 0.2], axis=2)
    np.testing.assert_allclose(radius, np.sqrt(1.0 - 0.16), rtol=4e-3)
    length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum()
    assert length == pytest.approx(2.0 * np.pi * np.sqrt(1.0 - 0.16), rel=5e-3)


def test_points_on_the_plane_are_drawn_with_the_outlines(tree):
    figure = mpmfw.plots.field(tree, "velocity_z", plane=("y", 0.05))
    panel, bar = figure.axes
    drawn = shapes_in(panel)
    points = [tree[f"particles/{body}"].to_dataset().isel(time=-1) for body in ("solid", "ball")]
    met = [
        np.abs(one["position"].values[:, 1] - 0.05) <= 0.5 * np.cbrt(one["volume"].values) for one in points
    ]
    for discs, one, each in zip(drawn, points, met, strict=True):
        assert len(discs.get_offsets()) == each.sum()
        np.testing.assert_allclose(discs.get_array(), one["velocity"].values[each, 2], rtol=1e-6)
    assert panel.get_title(loc="left").startswith("y = 0.05 m, t = ")
    assert [np.isfinite(line.get_xdata()).sum() > 20 for line in panel.lines] == [True, True]
    metres = panel.get_xlabel().removeprefix("x ")
    assert panel.get_ylabel() == f"z {metres}"
    assert "m/s" in (bar.get_ylabel() or bar.get_xlabel())


def test_a_plane_past_a_body_has_no_outline_of_it(tree):
    """The ball ends at z = -5 mm."""
    panel, _ = mpmfw.plots.field(tree, "velocity_z", plane=("z", -0.4)).axes
    assert len(panel.lines) == len(shapes_in(panel)) == 1


def test_labels_of_bars_do_not_lie_on_each_other(folder):
    """Options make a label of several lines, which is higher than a bar."""
    compared = xr.open_dataset(folder / "c.nc")
    long = "bardenhagen(criterion=position, normal=master)"
    figure = mpmfw.plots.cost_bars(compared.assign_coords(contact=[long, "penalty"]))
    figure.canvas.draw()
    boxes = [label.get_window_extent() for label in figure.axes[0].get_yticklabels()]
    assert len(boxes) == 4
    assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])
