"""Surfaces of solids: closed, oriented, of the right volume and symmetry; and the cells that they cut."""

import numpy as np
import pytest

from mpmfw.geometry.cut_cells import cut_cells, volume_of
from mpmfw.geometry.extrusion import Cylinder
from mpmfw.geometry.layout import tributaries_of
from mpmfw.geometry.solid import Ball, Box, turning

SOLIDS = {
    "box": Box(lower=(-0.5, 0.1, 0.2), upper=(0.5, 2.1, 0.7)),
    "ball": Ball(centre=(0.3, -0.2, 1.0), radius=1.6),
    "cylinder": Cylinder(centre=(0.1, 0.2, 0.3), radius=0.8, length=1.2, axis="x"),
}


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


@pytest.mark.parametrize("name", SOLIDS)
def test_surfaces_have_the_mirror_planes_of_the_body(name):
    ((nodes, facets),) = SOLIDS[name].surfaces(0.23)
    tributary = tributaries_of(nodes, facets)
    about = nodes - SOLIDS[name].centroid
    for axis in range(3):
        image = about * np.where(np.arange(3) == axis, -1.0, 1.0)
        apart = np.linalg.norm(about[:, np.newaxis] - image, axis=2)
        assert apart.min(axis=1).max() < 1e-8
        np.testing.assert_allclose(tributary[apart.argmin(axis=0)], tributary, rtol=1e-8)


def test_cells_are_cut_exactly():
    """The parts that a tetrahedron of edges 2 has in the eight cells at its corner, by hand."""
    corners = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]], dtype=float)
    facets = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    cuts = cut_cells(corners[facets], (2, 2, 2))
    exact = np.array([[[5 / 6, 1 / 6], [1 / 6, 0]], [[1 / 6, 0], [0, 0]]])
    np.testing.assert_allclose(cuts.volume, exact, atol=1e-15)
    np.testing.assert_allclose(cuts.moment.sum(axis=(0, 1, 2)), np.full(3, 4 / 3 * 0.5), rtol=1e-14)
    np.testing.assert_allclose(cuts.moment[1, 0, 0], np.array([1.25, 0.25, 0.25]) / 6, rtol=1e-14)
    np.testing.assert_allclose(cuts.faces[0][1, 0, 0], 0.5, rtol=1e-14)


def test_turns_are_about_x_then_y_then_z():
    quarter = np.pi / 2
    np.testing.assert_allclose(turning((quarter, 0.0, 0.0)) @ [0, 1, 0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(turning((quarter, quarter, 0.0)) @ [0, 1, 0], [1, 0, 0], atol=1e-15)
    box = Box(lower=(0, 0, 0), upper=(3, 2, 1), angles=(0.0, 0.0, quarter))
    np.testing.assert_allclose(np.ptp(box.bounds, axis=0), [2, 3, 1], atol=1e-12)
    np.testing.assert_allclose(box.axes[0], [0, 1, 0], atol=1e-15)
