"""The highest frequency of a body, which sets the time step, with the local spin correction and without."""

from dataclasses import dataclass

import numpy as np
import pytest

from interpreted import interpreted
from mpmfw.effects.local_spin import correct_spin, find_excess
from mpmfw.kernels import struct
from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import FloatArray
from mpmfw.step.schemes import project
from scenes_for_tests import BULK, SHEAR, one_body, with_changes

LAME = BULK - 2.0 * SHEAR / 3.0
H = 0.25


@dataclass
class Linear:
    """Small motions about rest: ω² M a = S a on the grid, M diagonal."""

    mass: FloatArray
    stiffness: FloatArray
    operator: FloatArray  #: K of (m v) += K Δv

    @property
    def ratio(self):
        """Highest frequency with the correction, over that without: of M⁻¹ + M⁻¹ K M⁻¹ in place of M⁻¹."""
        root = 1.0 / np.sqrt(self.mass)
        lumped = root[:, None] * self.stiffness * root
        factor = np.linalg.cholesky(np.eye(len(root)) + root[:, None] * self.operator * root)
        squares = [np.linalg.eigvalsh(a)[-1] for a in (factor.T @ lumped @ factor, lumped)]
        return float(np.sqrt(squares[0] / squares[1]))


def linearised(scene):
    """The scene's body at rest."""
    sim = Simulation(with_changes(scene, bodies__solid__rotation="spin"))
    sim.start()
    p, g = sim.state.particles, sim.state.grid
    phi = sim.hook.interpolate(particles=p, grid=g)
    project(p, phi, g)
    n, dim = len(g.mass), g.dim
    gradient = np.zeros((p.count, n, dim))
    np.add.at(gradient, (np.repeat(np.arange(p.count), np.diff(phi.row)), phi.nodes), phi.gradient)
    dots = np.einsum("p,pid,pje->idje", p.volume, gradient, gradient)
    trace = np.einsum("idjd->ij", dots)
    stiffness = (
        LAME * dots
        + SHEAR * dots.transpose(0, 3, 2, 1)
        + SHEAR * np.einsum("ij,de->idje", trace, np.eye(dim))
    )
    carried = np.repeat(g.mass > 1e-12 * g.mass.max(), dim)
    rows, excess = [], np.zeros((3, 3))
    edges = sim.manager.get_plugin("local_spin").half_edges
    total = find_excess(0, p.count, p, edges, 0, n, g, excess, g.spacing)
    assert total > 0.0
    for k in range(n * dim):
        momentum = (np.eye(1, n * dim, k).reshape(n, dim)) * g.mass[:, None]
        corrected = momentum.copy()
        grid = struct(mass=g.mass, start_velocity=np.zeros((n, dim)), momentum=corrected)
        change, common = np.zeros((n, dim)), np.zeros(n)
        correct_spin(0, n, g.window_shape[0], total, excess, grid, momentum, change, common, g.spacing)
        rows.append((corrected - momentum).ravel())
    keep = np.ix_(carried, carried)
    return Linear(
        np.repeat(g.mass, dim)[carried],
        stiffness.reshape(n * dim, -1)[keep],
        np.array(rows)[keep],
    )


def rectangle(lower, upper, shape):
    grid = {"cell_size": H, "lower": [-0.75, -0.75], "upper": [1.25, 1.25]}
    geometry = {"type": "rectangle", "lower": lower, "upper": upper}
    return one_body(geometry, size=H / 2, shape__method=shape, grid=grid)


@pytest.mark.parametrize(("cells", "shape"), [(2, "gimp"), (4, "cpdi"), (2, "bspline")])
def test_the_highest_frequency_stays(cells, shape):
    rng = np.random.default_rng(cells)
    for _ in range(2):
        lower = rng.uniform(-0.4, -0.15, 2)
        upper = lower + H * cells * rng.uniform(0.8, 1.2, 2)
        assert linearised(rectangle(lower.tolist(), upper.tolist(), shape)).ratio < 1.02


def test_a_film_that_barely_reaches_its_outer_nodes_keeps_its_frequency(
    monkeypatch,
):
    """With linear functions these nodes weigh next to nothing, and so do the cells; all of X on them would be
    too much: without a least share the film has frequencies of its own.
    """
    for beyond in (1e-1, 1e-6):
        film = rectangle([-0.43, beyond * H - H / 4], [0.57, beyond * H + H / 4], "linear")
        assert linearised(film).ratio < 1.02
    film = rectangle([-0.43, 1e-3 * H - H / 4], [0.57, 1e-3 * H + H / 4], "linear")
    assert linearised(film).ratio < 1.02
    monkeypatch.setitem(globals(), "correct_spin", interpreted(correct_spin, LEAST_SHARE=0.0))
    assert linearised(film).ratio > 1.2
