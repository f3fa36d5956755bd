"""Why stress at an interface of triangles depends on their size: what the nodes' shares of area make of the
grid's functions.
"""

from __future__ import annotations

import numpy as np
import pytest

from mpmfw.geometry.facets import tributaries_of
from mpmfw.geometry.solids import box_surface


def weights(edge):
    """Σ A_s N_i(x_s) over the nodes of a square of 6 by 6 cells, at its inner grid nodes; exact is 1."""
    nodes, facets = box_surface(np.zeros(3), np.array([6.0, 6.0, 1.0]), edge)
    share = tributaries_of(nodes, facets[(nodes[facets][:, :, 2] == 1.0).all(axis=1)])
    hats = [np.maximum(1.0 - np.abs(nodes[:, a, np.newaxis] - np.arange(1, 6)), 0.0) for a in range(2)]
    return np.einsum("s,si,sj->ij", share, *hats)


@pytest.mark.parametrize("parts", [2, 3, 4, 5])
def test_segments_that_divide_a_cell_integrate_its_functions_exactly(parts):
    np.testing.assert_allclose(weights(1.0 / parts), 1.0, rtol=1e-13)


def test_others_err_by_the_square_of_the_segment():
    """Between nodes lie the kinks of the functions: of each axis at most e²/4 h² at the middle one, e²/8 h²
    at the outer two.
    """
    found = weights(0.3)
    assert found.min() == pytest.approx(0.990, abs=1e-3)
    assert found.max() == pytest.approx(1.020, abs=1e-3)
    assert np.abs(weights(0.15) - 1.0).max() < 0.3 * np.abs(found - 1.0).max()
