"""The kernels' formulas in plain NumPy: slow, short and written from the docstrings alone."""

import numpy as np


def owner(table):
    """Point that each entry of the table belongs to."""
    return np.repeat(np.arange(len(table.row) - 1), np.diff(table.row))


def collect(table, values):
    """Sum of entry-wise values at the points."""
    total = np.zeros((len(table.row) - 1, *values.shape[1:]))
    np.add.at(total, owner(table), values)
    return total


def velocity_gradient(table, node_velocity):
    """Σ_i v_i ∇φ_ipᵀ."""
    return collect(table, np.einsum("ka,kb->kab", node_velocity[table.nodes], table.gradient))


def moment(table, position, node_position, node_velocity):
    """B_p = Σ_i φ_ip v_i (x_i − x_p)ᵀ."""
    q = node_position[table.nodes] - position[owner(table)]
    return collect(table, np.einsum("k,ka,kb->kab", table.weight, node_velocity[table.nodes], q))


def spread(table, position, node_position):
    """D_p = Σ_i φ_ip (x_i − x_p)(x_i − x_p)ᵀ."""
    q = node_position[table.nodes] - position[owner(table)]
    return collect(table, np.einsum("k,ka,kb->kab", table.weight, q, q))


def hat(t):
    """Linear basis function of distance t [cells] and its derivative."""
    return np.maximum(0.0, 1.0 - np.abs(t)), np.where(np.abs(t) < 1.0, -np.sign(t), 0.0)


def gimp(t, l):
    """uGIMP function by its four published branches, and its derivative; t, l in cells."""
    d = np.abs(t)
    branches = [d < l, d < 1.0 - l, d < 1.0 + l]
    value = np.select(
        branches, [1.0 - (t * t + l * l) / (2.0 * l), 1.0 - d, (1.0 + l - d) ** 2 / (4.0 * l)], 0.0
    )
    slope = np.select(branches, [-t / l, -np.sign(t), -np.sign(t) * (1.0 + l - d) / (2.0 * l)], 0.0)
    return value, slope


def quadratic(t):
    """Quadratic B-spline of distance t [cells] and its derivative."""
    d = np.abs(t)
    value = np.select([d <= 0.5, d <= 1.5], [0.75 - t * t, 0.5 * (1.5 - d) ** 2], 0.0)
    slope = np.select([d <= 0.5, d <= 1.5], [-2.0 * t, -np.sign(t) * (1.5 - d)], 0.0)
    return value, slope


def cubic(t):
    """Cubic B-spline of distance t [cells] and its derivative."""
    d = np.abs(t)
    value = np.select([d < 1.0, d < 2.0], [2.0 / 3.0 - d**2 + d**3 / 2.0, (2.0 - d) ** 3 / 6.0], 0.0)
    slope = np.select([d < 1.0, d < 2.0], [-2.0 * d + 1.5 * d**2, -0.5 * (2.0 - d) ** 2], 0.0)
    return value, np.sign(t) * slope


def compact(t):
    """K(r) = 1 − |r| + sin(2π|r|) / (2π) of r = t / 2, and its derivative by t."""
    r = np.minimum(np.abs(0.5 * t), 1.0)
    value = 1.0 - r + np.sin(2.0 * np.pi * r) / (2.0 * np.pi)
    return value, 0.5 * np.sign(t) * (np.cos(2.0 * np.pi * r) - 1.0)


def dense_product(basis, position, node_position, h):
    """Tensor product of ``basis`` for every pair: values (n, nodes) and gradients (n, nodes, dim)."""
    value, slope = basis((position[:, None] - node_position[None]) / h)
    dim = position.shape[1]
    gradient = [
        slope[..., a] / h * np.prod([value[..., d] for d in range(dim) if d != a], axis=0) for a in range(dim)
    ]
    return value.prod(axis=-1), np.stack(gradient, axis=-1)


def dense_cpdi(position, deformation_gradient, half_edges, node_position, h):
    """CPDI from its corners: φ_i = 2^−dim Σ_c N_i(x_c), ∇φ_i = 2^−dim Σ_c R^−T s_c N_i(x_c)."""
    dim = position.shape[1]
    edges = deformation_gradient @ half_edges
    value = np.zeros((len(position), len(node_position)))
    gradient = np.zeros((*value.shape, dim))
    for signs in np.stack(np.meshgrid(*[[-1.0, 1.0]] * dim), -1).reshape(-1, dim):
        n, _ = dense_product(hat, position + edges @ signs, node_position, h)
        value += n / 2**dim
        normal = np.linalg.inv(edges).transpose(0, 2, 1) @ signs
        gradient += n[..., None] * normal[:, None] / 2**dim
    return value, gradient


def dense(table, n_nodes):
    """A table as full matrices, values (n, nodes) and gradients (n, nodes, dim)."""
    n, p = len(table.row) - 1, owner(table)
    value = np.zeros((n, n_nodes))
    gradient = np.zeros((n, n_nodes, table.gradient.shape[1]))
    np.add.at(value, (p, table.nodes), table.weight)
    if len(table.gradient):
        np.add.at(gradient, (p, table.nodes), table.gradient)
    return value, gradient


def random_table(rng, points, nodes, width=4):
    """Rows, nodes and weights of a table whose weights sum to 1."""
    weight = rng.random((points, width))
    indices = np.array([rng.choice(nodes, width, replace=False) for _ in range(points)], dtype=np.int32)
    return np.arange(points + 1) * width, indices.ravel(), (weight / weight.sum(1, keepdims=True)).ravel()


def matrix_of(row, nodes, weight, n_nodes):
    """A table as a matrix, (points, nodes)."""
    matrix = np.zeros((len(row) - 1, n_nodes))
    np.add.at(matrix, (np.repeat(np.arange(len(row) - 1), np.diff(row)), nodes), weight)
    return matrix
