"""Forces and motions that pass by surface nodes are those of B written out; corners seen without angles."""

import numpy as np
import pytest

from interpreted import interpreted
from mpmfw.contact.surfaces.detection import Surfaces
from mpmfw.geometry.layout import neighbours_of, stars_of
from mpmfw.kernels import Facets, signed_distance
from mpmfw.kernels.contact import relative_motion
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import ball_on_a_box, two_blocks

SCENES = {
    "plane": two_blocks("penalty", allow_overlap=True, bodies__left__geometry__upper=[0.01, 0.25]),
    "space": ball_on_a_box(),
    "tilts": two_blocks("hamad2017", allow_overlap=True, bodies__left__geometry__upper=[0.01, 0.25]),
}


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_factors_agree_with_entries(monkeypatch, scene):
    by_factors = Simulation(scene)
    monkeypatch.setattr(Surfaces, "configure", lambda *_, **__: None)
    both = by_factors, Simulation(scene)
    results, rng = [], np.random.default_rng(3)
    velocity, force, stiffness = rng.normal(size=(3, 10_000, 3))
    for simulation in both:
        simulation.advance(2)
        rows, grid = simulation.contact.last_rows, simulation.state.grid
        n, dim = rows.count, grid.dim
        rows.force[:n] = force[:n, :dim]
        rows.force[: n // 3] = 0.0  # rows that do not act
        nodal, motion, bound = np.zeros_like(grid.force), np.zeros((n, dim)), np.zeros(n)
        for _ in range(2):  # scratch is left as it was found
            nodal[:] = 0.0
            rows.add_to(nodal, grid.spacing)
            rows.motion_of(np.ascontiguousarray(velocity[: len(nodal), :dim]), 0.1, motion, grid.spacing)
            largest = rows.couplings(
                np.where(stiffness[:n, 0] > 0.0, stiffness[:n, 1] ** 2, 0.0), grid, bound
            )
        assert n > 10
        assert largest == bound.max() > 0.0
        results.append((nodal, motion, bound))
    factors, entries = both[0].contact.last_rows, both[1].contact.last_rows
    assert factors.surface is not None
    assert entries.surface is None
    assert len(entries.tilt) > 0 or scene is not SCENES["tilts"]
    for one, other in zip(*results, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9 * np.abs(other).max())


def test_what_went_wrong_in_a_row_is_not_lost():
    """Forces that are NaN, and entries of B, which a law has read without a need for them."""
    simulation = Simulation(SCENES["plane"])
    simulation.advance(2)
    rows, grid = simulation.contact.last_rows, simulation.state.grid
    motion, nodal = np.zeros((rows.count, 2)), np.zeros_like(grid.force)
    relative_motion(rows, rows.count, grid.velocity, 1.0, motion, grid.spacing)
    assert np.isnan(motion).all()
    rows.force[: rows.count] = 0.0
    rows.force[0, 0] = np.nan
    rows.add_to(nodal, grid.spacing)
    assert np.isnan(nodal).any()
    detection = simulation.contact.detection
    detection.configure(frozenset({"entries"}), forces=True)
    assert detection.writes_entries


@pytest.mark.parametrize("seed", range(20))
def test_a_corner_seen_without_angles_has_the_same_side(seed):
    """``CLEAR`` says when the facets' sides decide: never with 2, where the sum of the normals does."""
    rng = np.random.default_rng(seed)
    position = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float) + rng.normal(
        0, 0.2, (4, 3)
    )
    facets = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    first, star = stars_of(facets, 4)
    tetrahedron = Facets(
        position=position, facets=facets, neighbours=neighbours_of(facets), star_first=first, star=star
    )
    x = position[0] + rng.normal(0, 0.3, 3)
    found = [
        (interpreted(signed_distance, CLEAR=clear)(x, 0, tetrahedron, *places, (1.0,) * 3), *places)
        for clear, places in ((1e-9, np.zeros((2, 3))), (2.0, np.zeros((2, 3))))
    ]
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)
