"""Bodies given by files of triangles, and one message for each thing that is wrong with a file."""

import os
import random
import re
import signal
from contextlib import nullcontext

import numpy as np
import pytest
from pydantic import ValidationError

from mpmfw.errors import SceneError
from mpmfw.geometry import Ball, Box, SurfaceMesh
from mpmfw.geometry.cut_cells import volume_of
from mpmfw.geometry.layout import neighbours_of
from mpmfw.geometry.solid import joined
from mpmfw.scene import load_scene
from mpmfw_testing.bench import square
from msh_files import write_msh

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


def parts(*surfaces):
    """Several surfaces as one."""
    first = np.cumsum([0, *(len(nodes) for nodes, _ in surfaces)])
    facets = [k + facets for k, (_, facets) in zip(first, surfaces, strict=False)]
    return np.concatenate([nodes for nodes, _ in surfaces]), np.concatenate(facets)


def box_of(lower, upper, *, inwards=False):
    ((nodes, facets),) = Box(lower=lower, upper=upper).surfaces(9.0)
    return nodes, facets[:, ::-1] if inwards else facets


CUBE = box_of((0, 0, 0), (1, 1, 1))
FLIPPED = np.concatenate([FACETS[:7], FACETS[7:8, ::-1], FACETS[8:]])
NOT_FINITE = np.where(np.arange(len(NODES))[:, None] == 3, np.nan, NODES)
#: What is wrong with a surface, by the facts that the message has: how many, which and where.
BAD = {
    r"hole, the first at \(.*\) m \(facets ": (NODES, FACETS[1:]),
    r"flipped triangles: .* \(facets .*7": (NODES, FLIPPED),
    r"1 triangles have no area \(facets \d+\), the first at ": (NODES, np.concatenate([FACETS, [[0, 1, 1]]])),
    r"triangle \d+ goes through triangle \d+ at ": parts(
        (NODES, FACETS), (np.add(NODES, (0.6, 0.0, 0.03)), FACETS)
    ),
    "turned inside out": (NODES, FACETS[:, ::-1]),
    r"320 triangles are there more than once \(facets 0, 1": (NODES, np.concatenate([FACETS, FACETS])),
    "sides have more than two triangles": parts(CUBE, box_of((1, 1, 0), (2, 2, 1))),
    "parts of the surface overlap": parts(CUBE, box_of((0.5, 0, 0), (1.5, 1, 1))),
    "of a cavity inwards": parts(CUBE, box_of((0.2,) * 3, (0.8,) * 3)),
    r"do not bound the body \(facets ": parts(  # thin: no cell of a coarse grid lies within
        box_of((0, 0, 0), (1, 1, 0.04)), box_of((0.05, 0.05, 0.016), (0.95, 0.95, 0.024))
    ),
    "not finite numbers: 1 nodes, the first number 3": (NOT_FINITE, FACETS),
}


HOLLOW = box_of((0.2,) * 3, (0.8,) * 3, inwards=True)


@pytest.mark.parametrize(
    ("others", "volume"),
    [
        ([HOLLOW], 0.784),
        ([HOLLOW, box_of((0.4,) * 3, (0.6,) * 3)], 0.792),
        ([box_of((2, 0, 0), (3, 1, 1))], 2.0),
        ([box_of((1, 0.2, 0.2), (2, 0.8, 0.8))], 1.36),
    ],
)
def test_cavities_islands_and_parts_side_by_side_are_bodies(tmp_path, others, volume):
    path = written(tmp_path / "good.ply", *parts(CUBE, *others))
    assert SurfaceMesh(path=path).exact_volume == pytest.approx(volume)


@pytest.mark.parametrize("message", BAD)
def test_what_is_wrong_with_a_surface_is_said_and_where(tmp_path, message):
    path = written(tmp_path / "bad.ply", *BAD[message])
    with pytest.raises(ValueError, match=r"bad\.ply:? .*" + message):
        SurfaceMesh(path=path)


def test_triangles_far_below_a_cell_are_refused(tmp_path):
    scene, path = square(3, beside=False), written(tmp_path / "ball.stl")
    scene["bodies"]["loaded"]["geometry"] = {"type": "surface_mesh", "path": str(path)}
    for cells, upper in ((1.0, 4.0), (20.0, 80.0)):
        scene["grid"] = {"cell_size": cells, "lower": [-upper] * 3, "upper": [upper] * 3}
        with pytest.raises(SceneError, match="cells long on average") if cells > 1.0 else nullcontext():
            load_scene(scene)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes of POSIX")
def test_no_file_beside_a_mesh_is_opened(tmp_path, monkeypatch):
    """A library of materials or a texture may be a pipe, which nobody writes to."""
    monkeypatch.chdir(tmp_path)
    os.mkfifo("library.mtl")
    written(tmp_path / "plain.obj")
    text = (tmp_path / "plain.obj").read_text()
    (tmp_path / "ball.obj").write_text(f"mtllib library.mtl\nusemtl steel\n{text}")
    text = trimesh.Trimesh(NODES, FACETS, process=False).export(file_type="ply", encoding="ascii").decode()
    (tmp_path / "ball.ply").write_text(text.replace("1.0\n", "1.0\ncomment TextureFile library.mtl\n", 1))
    for kind in ("obj", "ply"):
        signal.alarm(20)  # of a test that hangs
        try:
            assert SurfaceMesh(path=tmp_path / f"ball.{kind}").is_connected
        finally:
            signal.alarm(0)


def mutated(content, draw):
    """A file that was cut, or has another byte, another number, or a line that is lost or there twice."""
    lines, at = content.splitlines(keepends=True), draw.randrange(len(content))
    line, numbers = draw.randrange(len(lines)), list(re.finditer(rb"-?\d+(\.\d+)?", content))
    what = draw.choice(("cut", "byte", "line", "number") if numbers else ("cut", "byte", "line"))
    if what == "cut":
        return content[: at + 1]
    if what == "byte":
        return content[:at] + bytes([draw.randrange(256)]) + content[at + 1 :]
    if what == "line":
        return b"".join([*lines[:line], *[lines[line]] * draw.choice((0, 2)), *lines[line + 1 :]]) or b" "
    found = draw.choice(numbers[: draw.choice((5, 10**9))])
    value = draw.choice((b"999", b"0", b"-1", b"1000000000", b"9" * 20, b"nan", b"1e300", b"1e-300"))
    return content[: found.start()] + value + content[found.end() :]


@pytest.mark.parametrize("kind", ["stl", "stl_ascii", "obj", "ply", "ply_ascii", "off", "msh"])
def test_a_damaged_file_is_read_or_refused_in_one_message(tmp_path, kind, capfd):
    ((nodes, facets),) = BALL.surfaces(0.4)
    mesh, ending = trimesh.Trimesh(nodes, facets, process=False), kind.partition("_")[0]
    path = tmp_path / f"ball.{ending}"
    if kind == "msh":
        pytest.importorskip("gmsh")
        content = write_msh(path, nodes, {"triangle": facets}).read_bytes()
    elif kind == "ply_ascii":
        content = mesh.export(file_type="ply", encoding="ascii")
    else:
        content = mesh.export(file_type=kind)
    content = content if isinstance(content, bytes) else content.encode()
    refused = 0
    for number in range(30):
        path.write_bytes(mutated(content, random.Random(f"{kind} {number}")))
        try:
            SurfaceMesh(path=path)
        except ValidationError as error:
            (problem,) = error.errors()
            refused += 1
            assert path.name in problem["msg"], number
            assert len(problem["msg"]) < 1000 + len(str(path)), number
    assert refused > 5
    assert "Traceback" not in capfd.readouterr().err
