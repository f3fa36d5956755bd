"""Rows with random normals and weights, as the law ``lcp`` meets them."""

from types import SimpleNamespace

import numpy as np

from mpmfw.contact.rows import ContactRows
from mpmfw_contact.lcp import Lcp

DT = 0.1


def problem(seed, dim, count=30, *, couples=False, tilts=False, friction=0.0, nodes=40):
    """Rows between two bodies of ``nodes`` grid nodes each, with random normals about one axis."""
    rng = np.random.default_rng(seed)
    own = Lcp().row_arrays(friction=True)
    rows = ContactRows(dim, couples=couples, tilts=tilts, own=own)
    rows.allocate_friction(cohesion=False)
    rows.make_room(count, 6 * count)
    rows.count = count
    rows.pair[:] = rng.integers(0, 2, count)
    rows.friction[:] = np.array([friction, 2.0 * friction])[rows.pair]
    rows.identity[:] = np.arange(count)
    rows.gap[:] = DT * rng.uniform(-0.5, 1.0, count)
    for c in range(count):
        n = np.eye(dim)[0] + 0.5 * rng.normal(size=dim)
        rows.normal[c] = n / np.linalg.norm(n)
        entries = slice(6 * c, 6 * c + 6)
        rows.start[c + 1] = 6 * c + 6
        rows.dof[entries] = [
            *rng.choice(nodes, 3, replace=False),
            *(nodes + rng.choice(nodes, 3, replace=False)),
        ]
        weights = rng.uniform(0.2, 1.0, (2, 3))
        rows.weight[entries] = (weights / weights.sum(axis=1, keepdims=True) * [[1.0], [-1.0]]).ravel()
        for name in (["couple"] if couples else []) + (["tilt"] if tilts else []):
            tangent = 0.1 * rng.normal(size=(6, dim))
            getattr(rows, name)[entries] = tangent - np.outer(tangent @ rows.normal[c], rows.normal[c])
    mass = rng.uniform(0.5, 2.0, 2 * nodes)
    return SimpleNamespace(
        dim=dim, rows=rows, mass=mass, momentum=rng.normal(size=(2 * nodes, dim)) * mass[:, None],
        friction=np.array([friction, 2.0 * friction]), spacing=(1.0,) * dim,
    )  # fmt: skip


def operator(p):
    """B (n dim, n_nodes dim) of all rows, as a dense matrix, and what maps impulses to momenta."""
    rows, dim, size = p.rows, p.dim, len(p.mass)
    forward, back = np.zeros((rows.count, dim, size, dim)), np.zeros((size, dim, rows.count, dim))
    for c in range(rows.count):
        n = rows.normal[c]
        for k in range(rows.start[c], rows.start[c + 1]):
            i = rows.dof[k]
            block = rows.weight[k] * np.eye(dim)
            if len(rows.couple):
                block = block + np.outer(rows.couple[k], n)
            forward[c, :, i] += block
            back[i, :, c] += block.T + (np.outer(rows.tilt[k], n) if len(rows.tilt) else 0.0)
    return forward.reshape(rows.count * dim, -1), back.reshape(size * dim, -1)
