"""The local spin correction against plain NumPy, and what its operator keeps."""

import itertools
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from interpreted import interpreted
from mpmfw.effects.local_spin import LEAST_SHARE, correct_spin, find_excess
from mpmfw.state.fields import FloatArray
from support import as_grid, as_points

H, FIRST = 0.3, 5  #: cell size, and nodes of another window before this one
EXTENT = {2: (6, 5), 3: (4, 3, 5)}
DIMENSIONS = pytest.mark.parametrize("dim", [2, 3])


@dataclass
class Window:
    """A window of nodes with masses, and points whose second moment is smaller than theirs."""

    shape: tuple[int, ...]
    node: FloatArray
    node_mass: FloatArray
    mass: FloatArray
    position: FloatArray
    deformation: FloatArray
    edges: FloatArray

    @property
    def dim(self):
        return len(self.shape)

    def corrected(self, momentum, start, held=None):
        """Momenta after the kernel."""
        out = momentum.copy()
        change, common = np.zeros_like(out), np.zeros(len(out))
        excess, spacing = np.zeros((3, 3)), (H,) * self.dim
        points = as_points(mass=self.mass, position=self.position, deformation_gradient=self.deformation)
        grid = as_grid(mass=self.node_mass, position=self.node, start_velocity=start, momentum=out)
        total = find_excess(0, len(self.mass), points, self.edges, FIRST, len(out), grid, excess, spacing)
        if total > 0.0:
            correct_spin(
                *(FIRST, len(out), np.array(self.shape), total, excess, grid),
                *(momentum if held is None else held, change, common, spacing),
            )
        return out

    def operator(self):
        """K of (m v) += K Δv as a matrix over the nodes with mass."""
        n = len(self.node) * self.dim
        rows = [
            self.corrected((unit := np.eye(n)[k].reshape(-1, self.dim)) * self.node_mass[:, None], 0.0 * unit)
            - unit * self.node_mass[:, None]
            for k in range(n)
        ]
        matrix = np.array(rows).reshape(n, n)
        carried = np.repeat(self.node_mass > 0.0, self.dim)
        return matrix[np.ix_(carried, carried)]


def window(dim, seed, empty=0.2, points=12):
    """Random nodal masses, a share of them zero, and points near the middle."""
    rng, shape = np.random.default_rng(seed), EXTENT[dim]
    index = np.array(list(itertools.product(*(range(n) for n in shape))), dtype=float)
    node = np.concatenate([np.full((FIRST, dim), 77.0), H * index])
    node_mass = rng.uniform(0.01, 1.0, len(node)) * (rng.random(len(node)) >= empty)
    node_mass[:FIRST] = 3.0
    middle = 0.5 * H * (np.array(shape) - 1)
    position = middle + rng.uniform(-0.25, 0.25, (points, dim)) * H * np.array(shape)
    return Window(
        shape,
        node,
        node_mass,
        np.full(points, node_mass[FIRST:].sum() / points),
        position,
        np.eye(dim) + 0.1 * rng.normal(size=(points, dim, dim)),
        0.05 * rng.normal(size=(points, dim, dim)),
    )


def full(vectors):
    """Vectors of three components."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


@DIMENSIONS
def test_a_held_node_turns_no_cell(dim):
    """The change is that of the momenta in which boundary conditions are met, here all of them."""
    w, rng = window(dim, 5, 0.0), np.random.default_rng(6)
    momentum, start = rng.normal(size=w.node.shape), rng.normal(size=w.node.shape)
    held = start * w.node_mass[:, None]
    np.testing.assert_allclose(w.corrected(momentum, start, held), momentum, atol=1e-13)


@settings(max_examples=15)
@given(dim=st.sampled_from([2, 3]), seed=st.integers(0, 10**6), empty=st.floats(0.0, 0.5))
def test_the_operator_is_symmetric_and_adds_inertia_to_spin_alone(dim, seed, empty):
    w = window(dim, seed, empty)
    k = w.operator()
    scale = max(np.abs(k).max(), 1e-300)
    np.testing.assert_allclose(k, k.T, atol=1e-12 * scale)
    assert np.linalg.eigvalsh(k).min() >= -1e-12 * scale
    x = full(w.node)[w.node_mass > 0.0]
    for a, b in itertools.product(range(dim), range(dim)):
        drift = np.zeros_like(x)
        drift[:, a] = 1.0
        np.testing.assert_allclose(k @ drift[:, :dim].ravel(), 0.0, atol=1e-11 * scale)  # momentum is exact
        strain = np.zeros_like(x)
        strain[:, a] += x[:, b]
        strain[:, b] += x[:, a]
        np.testing.assert_allclose(k @ strain[:, :dim].ravel(), 0.0, atol=1e-10 * scale)  # no curl


def test_with_a_larger_least_share_a_body_keeps_the_lumped_nodes_inertia(monkeypatch):
    """A share below that of an ordinary body's cells changes nothing there."""
    w = window(2, 8, 0.0)
    rng = np.random.default_rng(1)
    momentum = rng.normal(size=w.node.shape)
    corrected = w.corrected(momentum, np.zeros_like(momentum))

    def with_share(share):
        monkeypatch.setitem(globals(), "correct_spin", interpreted(correct_spin, LEAST_SHARE=share))
        found = w.corrected(momentum, np.zeros_like(momentum))
        monkeypatch.undo()
        return np.abs(found - momentum).max() / np.abs(corrected - momentum).max()

    assert with_share(LEAST_SHARE) == pytest.approx(1.0)
    assert with_share(1e-9) == pytest.approx(1.0)
    assert with_share(10.0) < 0.2


@DIMENSIONS
def test_nodes_with_less_inertia_than_the_material_are_left_alone(dim):
    w, rng = window(dim, 9, 0.0), np.random.default_rng(10)
    w.edges *= 100.0
    momentum = rng.normal(size=w.node.shape)
    np.testing.assert_array_equal(w.corrected(momentum, np.zeros_like(momentum)), momentum)
