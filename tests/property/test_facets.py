"""Closest points of segments and triangles: against their definition, dense sampling, and rigid motion."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mpmfw.geometry.layout import neighbours_of, stars_of
from mpmfw.geometry.solid import box_surface, sphere_surface
from mpmfw.kernels import Facets, closest_point, kernel, minimum_gap, signed_distance, squared_distance
from mpmfw.kernels.facets import area_vector, project, write_gradients

both = pytest.mark.parametrize("dim", [2, 3])
seeds = st.integers(0, 2**32 - 1)
settled = settings(max_examples=150)


@kernel
def closest(x, corners, share, spacing):
    closest_point(x, corners, share, spacing)
    return squared_distance(x, corners, spacing)


def facet(dim, rng):
    """Corners of a facet that is not too thin, and a point anywhere, or across a part of it."""
    while True:
        corners = rng.normal(size=(dim, dim))
        edges = corners - np.roll(corners, 1, axis=0)
        area = np.zeros(dim)
        area_vector(corners, area, (1.0,) * dim)
        if np.linalg.norm(area) > 0.05 * np.linalg.norm(edges, axis=1).max() ** (dim - 1):
            break
    share = rng.dirichlet(np.ones(dim)) + rng.choice([0.0, 0.0, 1.0]) * rng.normal(size=dim)
    return corners, share @ corners + rng.normal() * area


def found(x, corners):
    """Barycentric coordinates of the closest point, and the squared distance."""
    share = np.zeros(len(x))
    square = closest(x, corners, share, (1.0,) * len(x))
    return share, square


@both
@settled
@given(seed=seeds)
def test_no_point_of_the_facet_is_closer(dim, seed):
    """c is the closest point of a convex set if and only if (x − c)·(y − c) ≤ 0 for every corner y."""
    rng = np.random.default_rng(seed)
    corners, x = facet(dim, rng)
    share, square = found(x, corners)
    assert share.min() >= 0.0
    assert share.sum() == pytest.approx(1.0, abs=1e-12)
    point = share @ corners
    size = 1.0 + np.abs(corners).max() + np.abs(x).max()
    assert ((x - point) @ (corners - point).T).max() <= 1e-12 * size**2
    assert square == pytest.approx((x - point) @ (x - point), rel=1e-9, abs=1e-14 * size**2)
    samples = rng.dirichlet(np.full(dim, 0.7), size=2000) @ corners
    assert ((samples - x) ** 2).sum(axis=1).min() >= square - 1e-12 * size**2


@both
@settled
@given(seed=seeds)
def test_a_rigid_motion_moves_the_closest_point_along(dim, seed):
    rng = np.random.default_rng(seed)
    corners, x = facet(dim, rng)
    turn, _ = np.linalg.qr(rng.normal(size=(dim, dim)))
    shift = rng.normal(size=dim)
    (share, square), (moved, other) = found(x, corners), found(x @ turn + shift, corners @ turn + shift)
    np.testing.assert_allclose(moved @ corners, share @ corners, atol=1e-10 * (1.0 + np.abs(corners).max()))
    assert other == pytest.approx(square, rel=1e-9, abs=1e-13)


@both
@settled
@given(seed=seeds)
def test_gradients_are_the_differences_of_the_coordinates(dim, seed):
    rng = np.random.default_rng(seed)
    corners, x = facet(dim, rng)
    spacing, normal, gradient = (1.0,) * dim, np.zeros(dim), np.zeros((dim, dim))
    project(x, corners, np.zeros(dim), normal, spacing)
    write_gradients(corners, normal, 1.0, gradient, spacing)
    for d, step in enumerate(1e-5 * np.eye(dim)):
        sides = np.zeros((2, dim))
        for place, side in zip((x + step, x - step), sides, strict=True):
            project(place, corners, side, np.zeros(dim), spacing)
        expected = (sides[0] - sides[1]) / 2e-5
        np.testing.assert_allclose(gradient[:, d], expected, atol=1e-6 * np.abs(gradient).max())


def surface_of(nodes, facets):
    """The struct that kernels take."""
    first, star = stars_of(facets, len(nodes))
    return Facets(
        position=nodes, facets=facets, neighbours=neighbours_of(facets), star_first=first, star=star
    )


def crumpled(rng):
    """A closed surface of triangles with bumps and dents, and its nodes."""
    nodes, facets = sphere_surface(np.zeros(3), 1.0, 0.6)
    return nodes * rng.uniform(0.7, 1.3, (len(nodes), 1)), facets


def winding(x, nodes, facets):
    """Solid angle of a closed surface as seen from x, over 4 π (Van Oosterom & Strackee, 1983)."""
    a, b, c = (nodes[facets[:, k]] - x for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    top = np.einsum("nd,nd->n", a, np.cross(b, c))
    below = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return np.arctan2(top, below).sum() / (2.0 * np.pi)


@settings(max_examples=20)
@given(seed=seeds)
def test_the_pseudo_normal_tells_inside_from_outside(seed):
    """Against the solid angle of a crumpled surface; many of the closest points are edges and corners."""
    rng = np.random.default_rng(seed)
    nodes, facets = crumpled(rng)
    surface, spacing = surface_of(nodes, facets), (1.0, 1.0, 1.0)
    for x in rng.uniform(-1.4, 1.4, (60, 3)):
        squares = [squared_distance(x, nodes[corners], spacing) for corners in facets]
        share, normal = np.zeros(3), np.zeros(3)
        m = int(np.argmin(squares))
        gap = signed_distance(x, m, surface, share, normal, spacing)
        assert abs(gap) == pytest.approx(np.sqrt(squares[m]), rel=1e-7)
        assert (gap < 0.0) == (winding(x, nodes, facets) > 0.5)
        np.testing.assert_allclose(share @ nodes[facets[m]] + gap * normal, x, atol=1e-12)


@settings(max_examples=10)
@given(seed=seeds)
def test_the_least_gap_of_two_surfaces_is_that_of_all_nodes_and_facets(seed):
    rng = np.random.default_rng(seed)
    nodes, facets = crumpled(rng)
    shift = rng.normal(size=3)
    other = 0.5 * box_surface(np.zeros(3), np.ones(3), 0.4)[0] + shift * rng.uniform(
        0.2, 1.5
    ) / np.linalg.norm(shift)
    surface = surface_of(nodes, facets)
    share, normal, least = np.zeros(3), np.zeros(3), np.inf
    for x in other:
        m = int(np.argmin([squared_distance(x, nodes[corners], (1.0,) * 3) for corners in facets]))
        least = min(least, signed_distance(x, m, surface, share, normal, (1.0,) * 3))
    together = Facets(**{**surface.members(), "position": np.concatenate([nodes, other])})
    start, stop = len(nodes), len(nodes) + len(other)
    assert minimum_gap(start, stop, 0, len(facets), together, (1.0,) * 3) == pytest.approx(least, abs=1e-13)
