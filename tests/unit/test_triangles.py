"""Surfaces of boxes and balls: closed, oriented outwards, of the right volume, area and symmetry."""

from __future__ import annotations

import numpy as np
import pytest

from mpmfw.geometry.ball import Ball
from mpmfw.geometry.box import Box
from mpmfw.geometry.facets import closed_loop, neighbours_of, stars_of, tributaries_of
from mpmfw.scene.tables import Body
from mpmfw.sizing import size_of

SOLIDS = {
    "box": Box(lower=(-0.5, 0.1, 0.2), upper=(0.5, 2.1, 0.7)),
    "ball": Ball(centre=(0.3, -0.2, 1.0), radius=1.6),
}
every_solid = pytest.mark.parametrize("name", SOLIDS)


def volume_of(nodes, facets):
    """Volume [m^3] that a closed surface encloses; negative where it is oriented inwards."""
    return np.linalg.det((nodes - nodes.mean(axis=0))[facets]).sum() / 6.0


@every_solid
@pytest.mark.parametrize("edge", [0.1, 0.23, 0.7, 9.0])
def test_surface_is_closed_and_oriented(name, edge):
    ((nodes, facets),) = SOLIDS[name].surfaces(edge)
    neighbours = neighbours_of(facets)
    for a in range(3):
        side = facets[:, [(a + 1) % 3, (a + 2) % 3]]
        other = facets[neighbours[:, a]]
        runs_back = [(other[:, [(b + 2) % 3, (b + 1) % 3]] == side).all(axis=1) for b in range(3)]
        assert np.any(runs_back, axis=0).all()
    assert len(nodes) - len(facets) // 2 == 2  # Euler: as a sphere has, with 3/2 edges a triangle
    assert volume_of(nodes, facets) > 0.0


@pytest.mark.parametrize("edge", [0.1, 0.7])
def test_a_box_has_its_volume_area_and_edges(edge):
    box = SOLIDS["box"]
    ((nodes, facets),) = box.surfaces(edge)
    assert volume_of(nodes, facets) == pytest.approx(box.exact_volume, rel=1e-13)
    assert tributaries_of(nodes, facets).sum() == pytest.approx(
        2 * (1.0 * 2.0 + 1.0 * 0.5 + 2.0 * 0.5), rel=1e-13
    )
    assert longest(nodes, facets) <= edge * (1.0 + 1e-12)
    assert nodes.min(axis=0).tolist() == list(box.lower)
    assert nodes.max(axis=0).tolist() == list(box.upper)


def longest(nodes, facets):
    return np.linalg.norm(nodes[facets] - nodes[np.roll(facets, 1, axis=1)], axis=2).max()


def test_a_ball_has_nodes_on_the_sphere_and_a_volume_of_second_order():
    ball = SOLIDS["ball"]
    lacking = []
    for edge in (0.4, 0.2, 0.1):
        ((nodes, facets),) = ball.surfaces(edge)
        np.testing.assert_allclose(np.linalg.norm(nodes - ball.centroid, axis=1), ball.radius, rtol=1e-14)
        assert longest(nodes, facets) <= edge
        lacking.append(1.0 - volume_of(nodes, facets) / ball.exact_volume)
    assert 0.0 < lacking[2] < 3 / 8 * (0.1 / ball.radius) ** 2  # of equal triangles with this edge
    assert lacking[0] / lacking[1] == pytest.approx(4.0, rel=0.2)
    assert lacking[1] / lacking[2] == pytest.approx(4.0, rel=0.2)


@every_solid
@pytest.mark.parametrize("edge", [0.1, 0.23, 0.7, 9.0])
def test_the_estimate_of_memory_counts_no_fewer_nodes(name, edge):
    solid = SOLIDS[name]
    body = Body(material="m", geometry=solid, particles={"layout": "lattice", "size": 0.2}, segment=edge)
    ((nodes, _),) = solid.surfaces(edge)
    assert len(nodes) <= size_of(body, 0.4).surface_nodes <= 5 * len(nodes)


@every_solid
def test_surfaces_have_the_mirror_planes_of_the_body(name):
    ((nodes, facets),) = SOLIDS[name].surfaces(0.23)
    tributary = tributaries_of(nodes, facets)
    about = nodes - SOLIDS[name].centroid
    for axis in range(3):
        image = about * np.where(np.arange(3) == axis, -1.0, 1.0)
        apart = np.linalg.norm(about[:, np.newaxis] - image, axis=2)
        assert apart.min(axis=1).max() < 1e-8
        np.testing.assert_allclose(tributary[apart.argmin(axis=0)], tributary, rtol=1e-8)


def test_a_surface_with_a_hole_is_refused():
    ((_, facets),) = SOLIDS["box"].surfaces(0.7)
    with pytest.raises(ValueError, match="the surface is not closed"):
        neighbours_of(facets[1:])


def test_polylines_have_the_segments_before_and_after_each_node():
    facets = np.concatenate([closed_loop(5), 5 + closed_loop(4)])
    assert neighbours_of(facets)[:5].tolist() == [[1, 4], [2, 0], [3, 1], [4, 2], [0, 3]]
    first, star = stars_of(facets, 9)
    assert first.tolist() == list(range(0, 19, 2))
    assert star[:10].tolist() == [4, 0, 0, 1, 1, 2, 2, 3, 3, 4]
