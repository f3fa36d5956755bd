"""By how much the inertia of the lumped grid body exceeds the true one, as docs/guide/rotation.md derives
it.
"""

import numpy as np
import pytest

from support import make_particles, make_shape, make_test_grid

CELL, EDGE, PLACES = 0.4, 0.2, 40

#: I_grid − I per unit mass for squares of edge l_p, the mean over all places in a cell of size h.
EXCESS = {
    "linear": CELL**2 / 3 - EDGE**2 / 6,
    "gimp": CELL**2 / 3,
    "bspline": CELL**2 / 2 - EDGE**2 / 6,
    "cpdi": CELL**2 / 3 + EDGE**2 / 3,
}


@pytest.mark.parametrize("name", EXCESS)
def test_lumping_adds_the_derived_inertia(name):
    places = 1.0 + CELL * (np.arange(PLACES) + 0.5) / PLACES
    position = np.stack(np.meshgrid(places, places), axis=-1).reshape(-1, 2)
    grid = make_test_grid([([0, 0], [12, 12])], cell_size=CELL, lower=np.zeros(2))
    particles = make_particles(position, volume=EDGE**2)
    phi = make_shape(name, particles, grid).interpolate(particles=particles, grid=grid)
    point = np.repeat(np.arange(particles.count), np.diff(phi.row))
    spread = phi.weight @ np.sum((grid.position[phi.nodes] - position[point]) ** 2, axis=1) / particles.count
    # The midpoint rule over the places errs by h² / (12 PLACES²) in each direction
    assert spread - EDGE**2 / 6 == pytest.approx(EXCESS[name], abs=CELL**2 / (5 * PLACES**2))
