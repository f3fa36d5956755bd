"""Bodies given by files of triangles: what is read, and one message for each thing that is wrong with a file."""

from __future__ import annotations

import numpy as np
import pytest

from mpmfw.errors import SceneError
from mpmfw.geometry import Ball, Box, SurfaceMesh
from mpmfw.geometry.cut_cells import volume_of
from mpmfw.geometry.facets import neighbours_of
from mpmfw.geometry.solid import joined
from mpmfw.scene import load_scene
from msh_files import write_msh
from scenes_for_tests import box

trimesh = pytest.importorskip("trimesh")

BALL = Ball(centre=(0.3, -0.2, 0.4), radius=0.5)
((NODES, FACETS),) = BALL.surfaces(0.2)


def written(path, nodes=NODES, facets=FACETS):
    trimesh.Trimesh(nodes, facets, process=False).export(path)
    return path


@pytest.mark.parametrize("kind", ["stl", "obj", "ply", "off", "msh"])
def test_every_kind_of_file_is_read(tmp_path, kind):
    path = tmp_path / f"ball.{kind}"
    if kind == "msh":
        pytest.importorskip("gmsh")
        write_msh(path, NODES, {"triangle": FACETS})
    else:
        written(path)
    body = SurfaceMesh(path=path)
    ((nodes, facets),) = body.surfaces(9.0)
    assert (len(nodes), len(facets)) == (len(NODES), len(FACETS))
    assert body.exact_volume == pytest.approx(volume_of(NODES, FACETS), rel=1e-5)
    np.testing.assert_allclose(body.centroid, BALL.centroid, atol=1e-6)
    assert body.is_connected


def test_unit_turn_and_place(tmp_path):
    ((nodes, facets),) = Box(lower=(0, 0, 0), upper=(3000, 2000, 1000)).surfaces(9e9)
    path = written(tmp_path / "box.stl", nodes, facets)
    body = SurfaceMesh(path=path, unit="mm", angles=(0, 0, "90 deg"), shift=(0, 0, 5))
    np.testing.assert_allclose(body.bounds, [[-2, 0, 5], [0, 3, 6]], atol=1e-6)
    assert body.exact_volume == pytest.approx(6.0)
    layout = body.lattice(0.5, (0.0, 0.0, 0.0))
    assert layout.volume.sum() == pytest.approx(6.0)
    assert len(layout.volume) == 48


def test_long_sides_are_divided_and_the_surface_stays_closed(tmp_path):
    ((nodes, facets),) = Box(lower=(0, 0, 0), upper=(3, 2, 1)).surfaces(9.0)
    body = SurfaceMesh(path=written(tmp_path / "box.stl", nodes, facets))
    fine, divided = joined(body.surfaces(0.3))
    neighbours_of(divided)
    sides = np.linalg.norm(fine[divided] - fine[np.roll(divided, 1, axis=1)], axis=2)
    assert sides.max() <= 0.3
    assert sides.min() > 0.05
    assert volume_of(fine, divided) == pytest.approx(6.0)


def test_a_hollow_body_has_two_surfaces(tmp_path):
    ((inner, own),) = Ball(centre=BALL.centre, radius=0.3).surfaces(0.2)
    path = written(
        tmp_path / "hollow.ply",
        np.concatenate([NODES, inner]),
        np.concatenate([FACETS, len(NODES) + own[:, ::-1]]),
    )
    body = SurfaceMesh(path=path)
    assert len(body.surfaces(0.2)) == 2
    assert body.is_connected
    volume = volume_of(NODES, FACETS) - volume_of(inner, own)
    assert body.lattice(0.1, (0.0, 0.0, 0.0)).volume.sum() == pytest.approx(volume, rel=1e-6)


def flipped():
    facets = FACETS.copy()
    facets[7] = facets[7, ::-1]
    return NODES, facets


def flat():
    facets = np.concatenate([FACETS, [[0, 1, 1]]])
    return NODES, facets


def crossing():
    ((nodes, facets),) = Ball(centre=(0.9, -0.2, 0.43), radius=0.5).surfaces(0.2)
    return np.concatenate([NODES, nodes]), np.concatenate([FACETS, len(NODES) + facets])


def parts(*surfaces):
    """Several surfaces as one."""
    first = np.cumsum([0, *(len(nodes) for nodes, _ in surfaces)])
    facets = [k + facets for k, (_, facets) in zip(first, surfaces, strict=False)]
    return np.concatenate([nodes for nodes, _ in surfaces]), np.concatenate(facets)


def box_of(lower, upper, *, inwards=False):
    ((nodes, facets),) = Box(lower=lower, upper=upper).surfaces(9.0)
    return nodes, facets[:, ::-1] if inwards else facets


def edge_to(x):
    """A box that has a side in common with the other."""
    return box_of((x, x, 0), (x + 1, x + 1, 1))


BAD = {
    r"not closed: 3 sides have a triangle on one side only: the surface has a hole, the first at \(.*\) m \(facets ": lambda: (
        NODES,
        FACETS[1:],
    ),
    r"flipped triangles: both neighbours run 3 sides in the same direction, the first at .* \(facets .*7": flipped,
    r"1 triangles have no area \(facets \d+\), the first at ": flat,
    r"the surface crosses itself: triangle \d+ goes through triangle \d+ at ": crossing,
    "are turned inside out; expected their normals to point outwards": lambda: (NODES, FACETS[:, ::-1]),
    r"320 triangles are there more than once \(facets 0, 1, 2, 3, 4, …\), the first at": lambda: (
        NODES,
        np.concatenate([FACETS, FACETS]),
    ),
    "sides have more than two triangles": lambda: parts(edge_to(0.0), edge_to(1.0)),
    r"parts of the surface overlap: .* \(facets .*\), the first at": lambda: parts(
        box_of((0, 0, 0), (1, 1, 1)), box_of((0.5, 0, 0), (1.5, 1, 1))
    ),
    r"parts of the surface overlap: triangles lie within another part, or": lambda: parts(
        (NODES, FACETS), (NODES + np.array([0.6, 0.0, 0.0]), FACETS)
    ),
    r"parts of the surface overlap: triangles lie within": lambda: parts(
        box_of((0, 0, 0), (1, 1, 1)), box_of((0.2, 0.2, 0), (0.8, 0.8, 0.5))
    ),
    r"parts of the surface overlap: triangles": lambda: parts(
        box_of((0, 0, 0), (1, 1, 1)), box_of((0.5, 0.2, 0.2), (1.5, 0.8, 0.8), inwards=True)
    ),
    "turned inside out; expected their normals to point inwards, being a cavity": lambda: parts(
        box_of((0, 0, 0), (1, 1, 1)), box_of((0.2, 0.2, 0.2), (0.8, 0.8, 0.8))
    ),
    r"coordinates that are no finite numbers: 1 nodes, the first number 3, counted": lambda: (
        np.where(np.arange(len(NODES))[:, None] == 3, np.nan, NODES),
        FACETS,
    ),
}


@pytest.mark.parametrize(
    ("others", "volume"),
    [
        ([box_of((0.2, 0.2, 0.2), (0.8, 0.8, 0.8), inwards=True)], 0.784),
        (
            [
                box_of((0.2, 0.2, 0.2), (0.8, 0.8, 0.8), inwards=True),
                box_of((0.4, 0.4, 0.4), (0.6, 0.6, 0.6)),
            ],
            0.792,
        ),
        ([box_of((2, 0, 0), (3, 1, 1))], 2.0),
        ([box_of((1, 0.2, 0.2), (2, 0.8, 0.8))], 1.36),
    ],
)
def test_cavities_islands_and_parts_side_by_side_are_bodies(tmp_path, others, volume):
    path = written(tmp_path / "good.ply", *parts(box_of((0, 0, 0), (1, 1, 1)), *others))
    assert SurfaceMesh(path=path).exact_volume == pytest.approx(volume)


@pytest.mark.parametrize("message", BAD)
def test_what_is_wrong_with_a_surface_is_said_and_where(tmp_path, message):
    path = written(tmp_path / "bad.ply", *BAD[message]())
    with pytest.raises(ValueError, match=r"bad\.ply:? .*" + message):
        SurfaceMesh(path=path)


def test_files_that_hold_no_surface_are_refused(tmp_path):
    with pytest.raises(ValueError, match=r"mesh file not found: .*absent\.stl"):
        SurfaceMesh(path=tmp_path / "absent.stl")
    (tmp_path / "notes.txt").write_text("no mesh")
    with pytest.raises(ValueError, match=r"notes\.txt has the ending '\.txt'; expected one of \.stl"):
        SurfaceMesh(path=tmp_path / "notes.txt")
    for kind in ("stl", "ply", "obj", "off"):
        (tmp_path / f"text.{kind}").write_text("no mesh\n")
        with pytest.raises(ValueError, match=rf"text\.{kind} (is not a|has no triangles)"):
            SurfaceMesh(path=tmp_path / f"text.{kind}")
    with pytest.raises(ValueError, match="unit 'stone'"):
        SurfaceMesh(path=written(tmp_path / "ball.stl"), unit="stone")


def scene_of(path, **geometry):
    scene = box(time__end=0.002, time__output_interval=0.002)
    scene["bodies"]["solid"]["geometry"] = {"type": "surface_mesh", "path": str(path), **geometry}
    return scene


def test_millimetres_given_as_metres_are_suspected(tmp_path):
    path = written(tmp_path / "ball.stl", 1000.0 * (NODES - BALL.centroid), FACETS)
    with pytest.raises(
        SceneError, match=r"read in 'm' the body is 1000 m across.*is the file in millimetres, unit = 'mm'\?"
    ):
        load_scene(scene_of(path))
    load_scene(scene_of(path, unit="mm"))
    path = written(tmp_path / "small.stl", NODES - BALL.centroid, FACETS)
    with pytest.raises(SceneError, match=r"read in 'mm' the body is 0\.001 m.*is the file in metres"):
        load_scene(scene_of(path, unit="mm"))


def test_sides_that_are_next_to_nothing_are_said(tmp_path):
    speck = box_of((0, 0, 0), (1e-8, 1e-8, 1e-8))
    path = written(tmp_path / "speck.ply", *parts(speck, box_of((0.1, 0.1, 0.1), (1, 1, 1))))
    with pytest.raises(
        SceneError,
        match=r"a side of the triangles is .* cells long \(facet \d+, at \(.*\) m\); expected 1e-06",
    ):
        load_scene(scene_of(path))


def test_triangles_far_below_a_cell_are_refused(tmp_path):
    ((nodes, facets),) = Ball(centre=(0, 0, 0), radius=0.5).surfaces(0.03)
    path = written(tmp_path / "ball.stl", nodes, facets)
    scene = scene_of(path)
    scene["grid"] = {"cell_size": 2.0, "lower": [-20] * 3, "upper": [20] * 3}
    with pytest.raises(SceneError, match=r"sides of the triangles are 0\.01\d* cells long on the mean"):
        load_scene(scene)
