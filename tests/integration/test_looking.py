"""Pages and views of results: what they show, and where they are served."""

import base64
import html
import json
import re
import sys
from html.parser import HTMLParser

import numpy as np
import pytest
import xarray as xr

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.plots.animation import movie
from mpmfw.plots.bodies import Bodies
from mpmfw.report import pictures, write_report
from scenes_for_tests import ball_on_a_box, two_blocks

FAR = np.array([1e6, 0.0, 0.0])  # m
EVIL = "<script>alert(1)</script><img src=x onerror=alert(1)> {{ 7*6 }}"


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    path = tmp_path_factory.mktemp("looking") / "run.nc"
    mpmfw.run(ball_on_a_box() | {"title": EVIL}, output=path)
    return path


def test_the_page_of_a_run_has_pictures_before_its_scene_and_is_escaped(run, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly.subplots", None)
    write_report(run, tmp_path / "run.html")
    page = (tmp_path / "run.html").read_text(encoding="utf-8")
    assert html.escape(EVIL) in page
    assert "<script>alert(1)" not in page
    assert "<img src=x" not in page
    pictures = re.search(r"slides=(\[.*?\]),part", page)
    shown = [base64.b64decode(text) for text in re.findall(r'"([^"]+)"', pictures[1])]
    assert len(shown) == 3
    assert all(text.startswith(b"\x89PNG") for text in shown)
    assert shown[0] != shown[-1]
    assert page.index("<figure") < page.index("<h2>Scene")
    assert not re.search(r'(src|href)="(?!data:|#)', page)


def test_a_run_in_space_can_be_turned_without_a_network(run, tmp_path):
    pytest.importorskip("plotly")
    tree = mpmfw.open(run)
    renamed = EVIL.replace("/", "")  # a body's name is a text of the file
    groups = {path.replace("ball", renamed): group for path, group in tree.to_dict().items()}
    bodies = {"body": ["solid", renamed]}
    tree = xr.DataTree.from_dict(
        {k: v.assign_coords(bodies if "body" in v.coords else {}) for k, v in groups.items()}
    )
    write_report(tree, tmp_path / "run.html")
    page = (tmp_path / "run.html").read_text(encoding="utf-8")
    loaded, scripts = [], []

    class Loads(HTMLParser):
        def handle_starttag(self, tag, attributes):
            loaded.extend(value for key, value in attributes if key in ("src", "href", "data", "action"))
            scripts.extend([tag] * (tag in ("script", "link", "iframe", "object", "img")))

    Loads().feed(page)
    assert set(scripts) == {"script"}
    assert loaded == []
    assert page.find("<script>alert") == -1
    (call,) = re.findall(r'Plotly.newPlot\(\s*"turning",(.*?)\)\.then', page, re.S)
    traces, _ = json.JSONDecoder().raw_decode(call.strip())
    assert [trace["type"] for trace in traces] == ["mesh3d", "mesh3d"]
    frames = json.loads(re.search(r"Plotly.addFrames\('turning', (\[.*?\])\);", page)[1])
    assert [frame["name"] for frame in frames] == ["0", "1", "2"]
    heights = [np.frombuffer(base64.b64decode(frame["data"][0]["z"]["bdata"]), "f4") for frame in frames]
    np.testing.assert_allclose(heights[2], tree["surface/solid"]["position"].values[2, :, 2], atol=1e-6)
    assert page.index("Plotly.newPlot") < page.index("<h2>Scene")


def test_a_run_far_from_the_origin_is_drawn_to_the_place(run):
    """A million cells away single precision moves points by up to 0.03 cells."""
    pytest.importorskip("plotly")
    groups = mpmfw.open(run).to_dict()
    true = groups["/surface/solid"]["position"].values[2].copy()
    for path, group in groups.items():
        if "position" in group:
            groups[path] = group.assign(position=group["position"].astype(float) + FAR)
    tree = xr.DataTree.from_dict(groups)
    page = str(pictures.turning({"far": tree}, tree["series/time"].values[[2]], "von_mises", None))
    (trace, *_), rest = json.JSONDecoder().raw_decode(re.search(r'"turning",\s*(\[.*)', page, re.S)[1])
    drawn = np.frombuffer(base64.b64decode(trace["x"]["bdata"]), "f4")
    np.testing.assert_allclose(drawn - drawn[0], true[:, 0] - true[0, 0], atol=1e-6)
    assert re.search(r'"text":"x \\u2212 (999999|1000000).* m \[m\]"', page[rest:])


@pytest.fixture(scope="module")
def several():
    """Eight runs of 14 outputs that keep their points."""
    scene = two_blocks("penalty", time={"end": 1.3e-2, "output_interval": 1e-3})
    keep, varied = {"output.particles": True}, {"contact.friction": [0.0, 0.1, 0.2, 0.3]}
    return mpmfw.compare(scene, ["penalty", "none"], ["linear"], varied, set=keep)


def test_the_slider_ends_with_the_last_output_and_says_what_it_leaves_out(several, monkeypatch):
    drawn = []
    monkeypatch.setattr(
        pictures, "movie", lambda trees, *a, **k: drawn.append((trees, a[1])) or movie(trees, *a, **k)
    )
    monkeypatch.setattr(pictures, "_PICTURES", 3)
    shown = pictures.slides(several)
    ((trees, times),) = drawn
    assert len(shown["slides"]) == len(times) == 3
    assert times[-1] == several["particle_time"].values[-1] == pytest.approx(1.3e-2)
    assert len(trees) == 6
    assert "shows 3 of 14 outputs." in shown["slides_say"]
    assert "2 of 8 runs are left out: none, linear, 0.2; none, linear, 0.3." in shown["slides_say"]
    few = pictures.slides(several.isel(particle_time=slice(3), friction=[0]))
    assert "shows all outputs." in few["slides_say"]
    assert "left out" not in few["slides_say"]


def test_the_difference_is_that_from_the_first_contact(several):
    figure, caption = pictures.field_differences(several)["difference"]
    assert "from that with penalty" in caption
    assert "in the run that a title names first." in caption
    titles = [axes.get_title(loc="left").replace("\n", " ") for axes in figure.axes]
    titles = [title.split(", t =")[0] for title in titles if title]
    assert titles == [f"none, linear, {friction} less penalty" for friction in (0.0, 0.1, 0.2, 0.3)]


def test_a_half_space_does_not_shrink_the_picture(run):
    groups = mpmfw.open(run).to_dict()
    wall = groups["/surface/solid"]
    for name, factor in (("near", 2.0), ("far", 100.0)):
        groups[f"/surface/{name}"] = wall.assign(position=factor * wall["position"])
    found = Bodies(xr.DataTree.from_dict(groups))
    assert set(found.rigid) == {"near", "far"}
    np.testing.assert_allclose(found.box([0, 2])[0], [-1.0] * 3, atol=1e-6)
    np.testing.assert_allclose(found.box([0, 2])[1, 2], 0.995, atol=1e-2)  # the ball's top


def test_a_film_in_space_moves(run, tmp_path):
    pytest.importorskip("pyvista")
    path = mpmfw.animate(run, tmp_path / "run.gif", "velocity_x", arrows=True)
    from PIL import Image

    with Image.open(path) as film:
        assert film.n_frames == 3
        first = np.asarray(film.convert("RGB"), dtype=int)
        film.seek(2)
        assert np.abs(first - np.asarray(film.convert("RGB"), dtype=int)).max() > 50


def test_a_view_follows_its_controls_and_is_served_to_this_computer_alone(run, monkeypatch, capsys):
    pytest.importorskip("trame")
    from mpmfw.plots import space as viewer

    served, pages = {}, []
    real = viewer.Viewer

    def watched(*arguments):
        pages.append(real(*arguments))
        monkeypatch.setattr(pages[-1].server, "start", lambda **options: served.update(options))
        return pages[-1]

    monkeypatch.setattr(viewer, "Viewer", watched)
    tree = mpmfw.open(run)
    viewer.view(tree, "velocity_x", open_browser=False)
    assert served["host"] == "127.0.0.1"
    assert served["timeout"] == 0  # else it ends minutes after its last page is closed
    assert served["show_connection_info"] is False
    page = pages[0]
    page.server.controller.on_server_ready()
    assert capsys.readouterr().out == f"http://127.0.0.1:{page.server.port}/ shows the run until Ctrl-C\n"
    last = tree["surface/ball"]["position"].values[-1]
    np.testing.assert_allclose(page.view.meshes["ball"].points, last)
    start = tree["surface/ball"]["position"].values[0]
    page.view.show("velocity_x", 2, (-1.0, 1.0), deformation=10.0, largest_force=1.0)
    np.testing.assert_allclose(page.view.meshes["ball"].points, start + 10.0 * (last - start), atol=1e-5)
    assert "forces" in page.view.plotter.actors


def test_a_view_shows_texts_of_the_file_as_text(run):
    pytest.importorskip("trame")
    from mpmfw.plots.space import Viewer

    tree, field = mpmfw.open(run), EVIL.replace("/", "")
    for points in tree["particles"].children.values():
        points[field] = points["von_mises"].assign_attrs(units=EVIL)
    state = Viewer(tree, field).server.state
    assert state.title == EVIL
    assert field in state.fields
    assert field in state.caption
    assert EVIL in state.caption
    template = state.trame__template_main
    assert "{{ title }}" in template
    assert "alert" not in template
    assert "7*6" not in template


def test_a_view_of_another_file_says_what_the_file_is(tmp_path):
    pytest.importorskip("trame")
    from mpmfw.plots.space import view

    scene = two_blocks("penalty", time={"end": 1e-3, "output_interval": 1e-3})
    mpmfw.compare(scene, ["none", "penalty"], ["linear"], output=tmp_path / "two.nc")
    with pytest.raises(
        SceneError, match=r"two\.nc: expected results of one run, not of kind 'compare'; .*select"
    ):
        view(tmp_path / "two.nc")
    mpmfw.run(scene | {"output": {"particles": False}}, output=tmp_path / "bare.nc")
    with pytest.raises(SceneError, match=r"bare\.nc: the run stored no material points"):
        view(tmp_path / "bare.nc")
