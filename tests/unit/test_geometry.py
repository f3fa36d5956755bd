"""Layouts keep the area, domains fit their volumes, outlines run round the material with it on their left."""

import math
import subprocess
import sys

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from mpmfw.geometry import (
    Ball,
    Box,
    Cylinder,
    Disc,
    MeshFile,
    Particles,
    Polygon,
    Rectangle,
    Ring,
    discretise,
)
from mpmfw.geometry.clipped_lattice import FARTHEST
from mpmfw.geometry.combined import Difference, Union
from mpmfw.geometry.gmsh_file import started_gmsh
from mpmfw.geometry.surface_checks import check_surface
from mpmfw.runs import bodies
from mpmfw.scene import load_scene
from msh_files import write_msh
from scenes_for_tests import block

PLANE = {
    "disc": Disc(centre=(0.3, -0.2), radius=1.6),
    "ring": Ring(centre=(-0.1, 0.4), inner_radius=0.9, outer_radius=1.4),
    "rectangle": Rectangle(lower=(0, -1), upper=(3, 0.3)),
    "turned rectangle": Rectangle(lower=(0, -1), upper=(3, 0.3), angle="30 deg"),
    "polygon": Polygon(
        points=((0, 0), (3, 0), (3, 1), (1, 2), (0, 1.5)), holes=(((1, 0.5), (1.5, 0.5), (1.2, 1)),)
    ),
}
PLANE |= {
    "union": Union(parts=(PLANE["disc"], PLANE["rectangle"])),
    "difference": Difference(parts=(PLANE["polygon"], Disc(centre=(2.0, 0.0), radius=0.3))),
}
SOLID = {
    "box": Box(lower=(0, 0, 0), upper=(1, 2, 0.5)),
    "ball": Ball(centre=(0, 1, 0.2), radius=0.8),
}
SOLID["union in space"] = Union(parts=tuple(SOLID.values()))
NOT_FITTED = {"ball", "union in space"}
#: Of which gmsh fills what lies between straight segments.
POLYGONS = {"polygon", "union", "difference"}


def signed_area(loop):
    return shapely.Polygon(loop).area * (1 if shapely.LinearRing(loop).is_ccw else -1)


def shoelace(corners):
    x, y = corners[..., 0], corners[..., 1]
    return 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)


def assert_consistent(layout, geometry):
    """Everything a layout promises whatever the shape."""
    n, dim = layout.position.shape
    assert dim == geometry.dim
    assert layout.volume.shape == (n,)
    assert layout.half_edges.shape == (n, dim, dim)
    assert (layout.volume > 0).all()
    np.testing.assert_allclose(np.linalg.det(2 * layout.half_edges), layout.volume, rtol=1e-10)
    np.testing.assert_allclose(layout.volume.sum(), geometry.exact_volume, rtol=1e-9)
    if dim == 2:
        np.testing.assert_allclose(shoelace(layout.corners), layout.volume, rtol=1e-10)
    else:
        assert layout.corners is None
        assert layout.outlines == ()


def assert_outlines_enclose(outlines, area, rel):
    """The first outline is an outer one; with holes counted negative the outlines enclose the body."""
    signed = [signed_area(loop) for loop in outlines]
    assert signed[0] > 0
    assert all(s < 0 for s in signed[1:])
    assert sum(signed) == pytest.approx(area, rel=rel)
    assert all(not np.allclose(loop[0], loop[-1]) for loop in outlines)


def assert_same_points(points, among):
    """Each of the points (n, 2) is one of the others (m, 2)."""
    tree = shapely.STRtree(shapely.points(among))
    _, distance = tree.query_nearest(shapely.points(points), return_distance=True, all_matches=False)
    assert distance.max() < 1e-9


def assert_mirrored(points, centre, axis):
    mirrored = points - centre
    mirrored[:, axis] *= -1
    assert_same_points(mirrored + centre, points)


@pytest.mark.parametrize("name", [*PLANE, "box", "ball"])
@settings(max_examples=8)
@given(size=st.floats(0.15, 4.0), offset=st.tuples(*[st.floats(0.0, 0.99)] * 2))
def test_a_lattice_keeps_the_volume(name, size, offset):
    geometry = (PLANE | SOLID)[name]
    layout = discretise(geometry, Particles(size=size, offset=offset), None)
    assert_consistent(layout, geometry)
    centroid = layout.volume @ layout.position / layout.volume.sum()
    np.testing.assert_allclose(centroid, geometry.centroid, atol=1e-9)


@pytest.mark.parametrize("size", [0.25, 0.5])
@pytest.mark.parametrize("thickness", [0.001, 0.01, 0.04])
def test_points_of_a_thin_fin_stay_near_its_end(size, thickness):
    """Small pieces must not join the body one after the other, nor the fin's last: no point would carry the
    fin's end."""
    fin = [[0, 0], [5, 0], [5, thickness], [0.5, thickness], [0.5, 2], [0, 2]]
    layout = discretise(Polygon(points=fin), Particles(size=size), None)
    assert layout.volume.sum() == pytest.approx(0.5 * 2 + 4.5 * thickness)
    assert layout.position[:, 0].max() > 5.0 - (FARTHEST + 1) * size
    for mirrored in ([-1, 1], [1, -1]):
        points = (np.array(fin) * mirrored)[::-1].tolist()
        position = discretise(Polygon(points=points), Particles(size=size), None).position * mirrored
        np.testing.assert_allclose(np.sort(position, axis=0), np.sort(layout.position, axis=0), atol=1e-12)


@pytest.mark.parametrize("name", [name for name in PLANE if name not in ("union", "difference")])
@settings(max_examples=8)
@given(segment=st.floats(0.01, 0.3))
def test_outlines_run_with_the_material_on_their_left(name, segment):
    geometry = PLANE[name]
    outlines = geometry.outlines(segment)
    # A chord of l on a circle of R cuts off an area of l²/(6 R²) of the disc
    curved = name in ("disc", "ring")
    assert_outlines_enclose(outlines, geometry.exact_volume, rel=0.1 * segment if curved else 1e-12)
    for loop in outlines:
        lengths = np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1)
        assert lengths.max() <= segment * (1 + 1e-9)
        assert not curved or np.ptp(lengths) < 1e-12


@pytest.mark.parametrize("name", [n for n in (*PLANE, *SOLID) if n not in NOT_FITTED | POLYGONS])
@settings(max_examples=15)
@given(size=st.floats(0.05, 4.0))
def test_fitted_keeps_the_volume(name, size):
    geometry = (PLANE | SOLID)[name]
    layout = discretise(geometry, Particles(layout="fitted", size=max(size, 0.1)), None)
    assert_consistent(layout, geometry)
    centroid = layout.volume @ layout.position / layout.volume.sum()
    np.testing.assert_allclose(centroid, geometry.centroid, atol=1e-9)


@given(size=st.floats(0.03, 3.0))
@settings(max_examples=30)
def test_fitted_disc_has_well_shaped_quadrilaterals(size):
    layout = discretise(Disc(centre=(0, 0), radius=1), Particles(layout="fitted", size=size), None)
    edge = np.roll(layout.corners, -1, axis=1) - layout.corners
    length = np.linalg.norm(edge, axis=2)
    before = np.roll(edge, 1, axis=1)
    cosine = -(edge * before).sum(axis=2) / (length * np.roll(length, 1, axis=1))
    assert length.max() <= size * (1 + 1e-8)
    assert np.degrees(np.arccos(cosine)).min() > 40
    assert layout.volume.min() > 0.25 * layout.volume.max()
    assert_same_points(np.column_stack([-layout.position[:, 1], layout.position[:, 0]]), layout.position)
    assert_mirrored(layout.position, np.zeros(2), 0)
    assert_mirrored(layout.position, np.zeros(2), 1)


@pytest.mark.parametrize("offset", [(), (0.3, 0.0), (0.5, 0.5), (0.37, 0.81)])
@pytest.mark.parametrize("name", [*PLANE])
def test_no_piece_falls_below_a_quarter_of_a_cell(name, offset):
    size = 0.1
    layout = discretise(PLANE[name], Particles(size=size, offset=offset), None)
    # Along the axes the cells of a rectangle are fitted to it, here to the size exactly
    assert layout.volume.min() >= (0.25 - 1e-9) * size**2
    assert layout.volume.max() < 2.3 * size**2


def write_mesh(path, points, cells):
    return write_msh(path, [(x, y, 0.0) for x, y in points], cells)


def ring_mesh(path, n=12):
    angle = 2 * np.pi * np.arange(n) / n
    unit = np.column_stack([np.cos(angle), np.sin(angle)])
    after = (np.arange(n) + 1) % n
    quads = np.column_stack([np.arange(n), n + np.arange(n), n + after, after])
    return write_mesh(path, np.concatenate([unit, 2 * unit]), {"quad": quads})


# One square as two triangles, one of them clockwise, beside a square as a quad
MIXED_POINTS = [(0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (2, 1)]
MIXED_CELLS = {"triangle": [(0, 1, 2), (0, 3, 2)], "quad": [(1, 4, 5, 2)]}


@pytest.mark.parametrize("layout", ["lattice", "fitted"])
def test_mesh_of_triangles_and_quads(tmp_path, layout):
    body = MeshFile(path=write_mesh(tmp_path / "mixed.msh", MIXED_POINTS, MIXED_CELLS))
    result = discretise(body, Particles(layout=layout, size=0.25), 0.25)
    assert body.exact_volume == pytest.approx(2)
    np.testing.assert_allclose(body.centroid, [1.0, 0.5])
    assert body.is_connected
    assert_consistent(result, body)
    assert_outlines_enclose(result.outlines, 2.0, rel=1e-12)
    assert len(result.outlines) == 1
    assert len(result.outlines[0]) == 6 * 4
    assert len(result.volume) == (8 * 4 if layout == "lattice" else 2 * 3 + 1)


def test_ring_shaped_mesh_has_two_outlines(tmp_path):
    body = MeshFile(path=ring_mesh(tmp_path / "ring.msh"))
    area = 12 * 0.5 * math.sin(math.pi / 6) * 3
    assert body.exact_volume == pytest.approx(area)
    outlines = sorted(body.outlines(10.0), key=signed_area, reverse=True)
    assert [len(loop) for loop in outlines] == [12, 12]
    assert_outlines_enclose(outlines, area, rel=1e-12)
    for layout in ("lattice", "fitted"):
        assert_consistent(discretise(body, Particles(layout=layout, size=0.2), None), body)


BREAKING = """
import os
from mpmfw.geometry.gmsh_file import started_gmsh
with started_gmsh("the test"):
    pass
reader, writer = os.pipe()
os.close(reader)
try:
    os.write(writer, b"x")
except BrokenPipeError:
    print("told")
"""


def test_a_broken_pipe_is_an_error_after_gmsh_too():
    """It ended the process: a run that died in a pool took all others with it."""
    pytest.importorskip("gmsh")
    done = subprocess.run([sys.executable, "-c", BREAKING], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "told\n")


def test_the_caller_s_model_of_gmsh_stays_the_current_one(tmp_path):
    """What the caller draws next would go to another."""
    gmsh = pytest.importorskip("gmsh")
    path = write_mesh(tmp_path / "square.msh", SQUARE, {"quad": [(0, 1, 2, 3)]})
    with started_gmsh("the test"):
        for name in ("own", "another"):
            gmsh.model.add(name)
            gmsh.model.occ.addRectangle(0.0, 0.0, 0.0, 1.0, 1.0)
            gmsh.model.occ.synchronize()
        gmsh.model.setCurrent("own")
        MeshFile(path=path)
        assert gmsh.model.getCurrent() == "own"


SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2)]
BAD_MESHES = {
    "overlap": ([(0, 0), (1, 0), (0, 1), (1, 1)], {"triangle": [(0, 1, 2), (0, 1, 3)]}),
    "non-convex": ([(0, 0), (2, 0), (0.2, 0.2), (0, 2)], {"quad": [(0, 1, 2, 3)]}),
    "not finite numbers: 1 nodes, the first number 2": (
        [(0, 0), (1, 0), (math.nan, 1), (0, 1)], {"quad": [(0, 1, 2, 3)]},
    ),
    "elements overlap: they cover 4 of their 8": (SQUARE, {"quad": [(0, 1, 2, 3)] * 2}),
    "elements of type Tetrahedron 4": (SQUARE, {"tetra": [(0, 1, 2, 3)]}),
}  # fmt: skip


@pytest.mark.parametrize("message", BAD_MESHES)
def test_bad_meshes_are_refused(tmp_path, message):
    path = write_mesh(tmp_path / "bad.msh", *BAD_MESHES[message])
    with pytest.raises(ValidationError, match=rf"bad\.msh.*{message}"):
        MeshFile(path=path)


def test_a_gmsh_file_that_announces_more_than_it_holds_is_refused_before_it_is_read(tmp_path):
    head = b"$MeshFormat\n4.1 1 8\n" + np.array([1], "<i4").tobytes() + b"\n$EndMeshFormat\n$Nodes\n"
    (tmp_path / "large.msh").write_bytes(head + np.array([1, 300_000_000, 1, 1], "<u8").tobytes())
    with pytest.raises(ValidationError, match="announces more than it holds"):
        MeshFile(path=tmp_path / "large.msh")


def test_files_that_are_no_meshes_are_refused(tmp_path):
    (tmp_path / "text.msh").write_text("no mesh\n")
    for name, said in (("absent", "mesh file not found"), ("text", "is not a gmsh mesh")):
        with pytest.raises(ValidationError, match=said):
            MeshFile(path=tmp_path / f"{name}.msh")


def test_impossible_layouts_are_refused():
    with pytest.raises(ValidationError, match="offset shifts a lattice"):
        Particles(layout="fitted", size=1, offset=(0.5,))
    with pytest.raises(ValidationError, match="less than 1"):
        Particles(size=1, offset=(1.0,))
    with pytest.raises(ValueError, match="offset has 3 entries for a body in 2D"):
        discretise(PLANE["disc"], Particles(size=1, offset=(0.1, 0.1, 0.1)), None)
    with pytest.raises(ValueError, match="a ball has no fitted layout"):
        discretise(SOLID["ball"], Particles(layout="fitted", size=1), None)
    with pytest.raises(ValueError, match="segment length must be positive"):
        discretise(PLANE["disc"], Particles(size=1), 0.0)


@pytest.mark.parametrize("layout", ["lattice", "fitted"])
def test_bodies_that_are_alike_share_a_layout(layout, monkeypatch):
    """Three discs that are alike and a smaller one lie where each would by itself."""
    calls = []
    monkeypatch.setattr(bodies, "discretise", lambda *asked: calls.append(asked) or discretise(*asked))
    scene = block(contact={"method": "separate"}, grid__lower=[-8, -8], grid__upper=[28, 12])
    solid = scene["bodies"].pop("solid") | {"particles": {"layout": layout, "size": 0.5}}
    for k, centre in enumerate([(0.03, 0.07), (5.0, 0.0), (10.0, 2.0), (15.0, 0.0)]):
        geometry = {"type": "disc", "centre": centre, "radius": 1.5 if k == 3 else 2.0}
        scene["bodies"][f"disc{k}"] = {**solid, "geometry": geometry}
    scene = load_scene(scene)
    layouts = bodies.lay_out(scene)
    assert len(calls) == 2
    for body, found in zip(scene.bodies.values(), layouts, strict=True):
        own = discretise(body.geometry, body.particles, body.segment_length(scene.grid.cell_size))
        for name in ("position", "volume", "half_edges", "corners", "outlines"):
            np.testing.assert_allclose(getattr(found, name), getattr(own, name), rtol=1e-9, atol=1e-12)


def test_a_union_and_a_difference_have_the_volumes_of_their_parts():
    """Of a disc on the corner of a square, and of a cylinder through a box, a quarter each."""
    square, disc = Rectangle(lower=(0, 0), upper=(2, 2)), Disc(centre=(2, 2), radius=1.0)
    quarter = np.pi / 4
    assert Union(parts=(square, disc)).exact_volume == pytest.approx(4 + 3 * quarter, rel=1e-6)
    cut = Difference(parts=(square, disc))
    assert cut.exact_volume == pytest.approx(4 - quarter, rel=1e-6)
    ((outline, _),) = cut.surfaces(0.1)
    far = np.linalg.norm(outline - 2.0, axis=1)
    on_arc = outline[far < 1.0 + 1e-3]
    assert np.abs(far[far < 1.0 + 1e-3] - 1.0).max() < 1e-6  # nodes lie on the circle
    assert len(on_arc) == math.ceil(0.5 * np.pi / 0.1) + 1
    corners = np.array([[0, 0], [2, 0], [2, 1], [1, 2], [0, 2]])
    assert np.linalg.norm(outline[:, None] - corners, axis=2).min(axis=0).max() < 1e-6
    fitted = discretise(cut, Particles(layout="fitted", size=0.1), 0.1)
    between = shapely.Polygon(fitted.outlines[0]).area  # straight segments on the arc
    assert fitted.volume.sum() == pytest.approx(between, rel=1e-9)
    assert between == pytest.approx(4 - quarter, rel=1e-3)
    box, shaft = Box(lower=(0, 0, 0), upper=(2, 2, 1)), Cylinder(centre=(2, 2, 0.5), radius=1.0, length=3)
    drilled = Difference(parts=(box, shaft))
    assert drilled.exact_volume == pytest.approx(4 - quarter, rel=1e-3)
    assert Union(parts=(box, shaft)).exact_volume == pytest.approx(4 + 3 * np.pi - quarter, rel=1e-3)
    for nodes, facets in drilled.surfaces(0.3):
        check_surface(nodes, facets)
    assert drilled.lattice(0.1, (0.0,) * 3).volume.sum() == pytest.approx(drilled.exact_volume, rel=1e-9)


def test_parts_without_a_hole_between_them_are_one_piece():
    left, right = (Rectangle(lower=(x, 0), upper=(x + 1, 1)) for x in (0, 1.5))
    bar = Rectangle(lower=(0.5, 0.4), upper=(2, 0.6))
    assert not Union(parts=(left, right)).is_connected
    assert Union(parts=(left, right, bar)).is_connected
    half = Difference(parts=(left, Union(parts=(bar, right))))
    assert half.exact_volume == pytest.approx(0.9)


@pytest.mark.parametrize(
    ("kind", "parts", "said"),
    [
        (Difference, (Disc(centre=(0, 0), radius=1), Disc(centre=(0, 0), radius=2)), "nothing is left"),
        (Union, (Disc(centre=(0, 0), radius=1), Ball(centre=(0, 0, 0), radius=2)), "expected one of both"),
        (Union, (Disc(centre=(0, 0), radius=1),), "at least 2"),
    ],
)
def test_parts_that_make_no_body_are_refused(kind, parts, said):
    with pytest.raises(ValidationError, match=said):
        kind(parts=parts)
