"""A run in space as a plane across it shows it, and rendered."""

from __future__ import annotations

import numpy as np
import pytest

import mpmfw
from mpmfw.geometry.solids import sphere_surface
from mpmfw.plots import plane_cut, rendered
from mpmfw.plots.plane_cut import cut_lines
from scenes_for_tests import ball_on_a_box


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
    figure = plane_cut(tree, "velocity_z", normal="y", at=0.05)
    panel, bar = figure.axes
    discs, *lines = panel.collections
    points = [tree[f"particles/{body}"].to_dataset().isel(time=-1) for body in ("solid", "ball")]
    met = [
        np.abs(one["position"].values[:, 1] - 0.05) <= 0.5 * np.cbrt(one["volume"].values) for one in points
    ]
    assert len(discs.get_offsets()) == sum(each.sum() for each in met)
    drawn = np.concatenate([one["velocity"].values[each, 2] for one, each in zip(points, met, strict=True)])
    np.testing.assert_allclose(np.sort(discs.get_array()), np.sort(drawn), rtol=1e-6)
    assert len(lines) == 2
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("x [m]", "z [m]")
    assert "m/s" in bar.get_ylabel()


def bright(figure):
    """Number of pixels of the picture that are not white."""
    (picture,) = figure.axes[0].images
    return int((np.asarray(picture.get_array()) < 250).any(axis=2).sum())


def test_bodies_are_rendered_in_the_colours_of_a_field_with_its_scale(tree):
    figure = rendered(tree, "von_mises")
    panel, bar = figure.axes
    points = [tree[f"particles/{body}"].to_dataset().isel(time=-1) for body in ("solid", "ball")]
    assert panel.get_title("left").startswith("t = ")
    assert "von Mises stress" in bar.get_ylabel()
    assert bright(figure) > 1e5
    assert bright(rendered(tree, "velocity_z", bodies=["ball"])) < bright(figure)
    speed = np.concatenate([one["velocity"].values[:, 2] for one in points])
    scale = np.array(rendered(tree, "velocity_z").axes[1].get_ylim())
    np.testing.assert_allclose(
        scale / scale[0], np.array([speed.min(), speed.max()]) / speed.min(), atol=1e-6
    )
