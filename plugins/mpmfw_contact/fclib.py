"""Contact problems of ``lcp`` as files of FCLIB, the collection of frictional contact problems, which other solvers read.

Source: V. Acary, M. Brémond, T. Koziara & F. Pérignon (2014), FCLIB: a collection of discrete 3D frictional contact problems,
INRIA RT-0444; the layout of the files is that of its C header. A local problem asks for forces r and velocities u at n places,

    u = W r + q,   0 ≤ u_N ⊥ r_N ≥ 0,   |r_T| ≤ μ r_N,   u_T = −s r_T with s ≥ 0 where |r_T| = μ r_N, and 0 elsewhere,

each with the normal component first. Here r are impulses [N s/m in 2D, N s in 3D], and u_N is the velocity with which a place
opens beyond the gap that may close, u·n + b of :mod:`mpmfw_contact.lcp`. Needs h5py (``pip install "mpmfw[fclib]"``).
"""

from __future__ import annotations

import dataclasses
import os
from typing import Any, Self

import numpy as np
from scipy import sparse

from mpmfw.api import ContactRows, FloatArray, IntArray, MpmfwError
from mpmfw_contact.lcp import Lcp

#: What the file calls a matrix in compressed columns and in compressed rows; a number of entries is one of triplets.
COLUMNS, ROWS = -1, -2


@dataclasses.dataclass(frozen=True)
class LocalProblem:
    """A frictional contact problem at n places in ``dim`` dimensions, with a solution if it has one.

    Attributes
    ----------
    delassus
        W, (n dim, n dim) [1/kg]; not symmetric where the normal is varied with the facet.
    velocity
        q, (n dim,) [m/s].
    friction
        μ, (n,).
    dim
        2 or 3.
    impulse
        r, (n dim,), a solution; None if there is none.
    title, description
        In words.
    """

    delassus: sparse.csr_matrix
    velocity: FloatArray
    friction: FloatArray
    dim: int
    impulse: FloatArray | None = None
    title: str = ""
    description: str = ""

    def residual(self, impulse: FloatArray | None = None) -> float:
        """How far impulses (n dim,) are from a solution: ‖r − P(r − û)‖ / (1 + √‖q‖), FCLIB's first merit function.

        P projects on Coulomb's cone, û is u with u_N + μ abs(u_T) for u_N (De Saxcé & Feng 1998). Of its own
        solution if ``impulse`` is None.

        Raises
        ------
        ValueError
            It has no solution, and none is given.
        """
        given = self.impulse if impulse is None else impulse
        if given is None:
            raise ValueError("the problem has no solution; give one")
        r = given.reshape(-1, self.dim)
        u = (self.delassus @ given + self.velocity).reshape(-1, self.dim)
        bound = u.copy()
        bound[:, 0] += self.friction * np.linalg.norm(u[:, 1:], axis=1)
        missed = np.linalg.norm(r - _on_cone(r - bound, self.friction))
        return float(missed / (1.0 + np.sqrt(np.linalg.norm(self.velocity))))

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the problem, and its solution if it has one, as a file of FCLIB.

        Raises
        ------
        MpmfwError
            The file cannot be written, or h5py is not installed.
        """
        matrix = self.delassus.tocsr()
        try:
            with _hdf5().File(os.fspath(path), "w") as file:
                local = file.create_group("fclib_local")
                counts = {"nzmax": matrix.nnz, "m": matrix.shape[0], "n": matrix.shape[1], "nz": ROWS}
                for name, count in counts.items():
                    _put(local, f"W/{name}", np.array([count], dtype="i4"))
                for name, index in {"p": matrix.indptr, "i": matrix.indices}.items():
                    _put(local, f"W/{name}", index.astype("i4"))
                _put(local, "W/x", matrix.data)
                _put(local, "spacedim", np.array([self.dim], dtype="i4"))
                _put(local, "vectors/q", self.velocity)
                _put(local, "vectors/mu", self.friction)
                words = {"title": self.title, "description": self.description, "math_info": ""}
                for name, text in words.items():
                    _put(local, f"info/{name}", np.bytes_(text.encode()))
                if self.impulse is not None:
                    _put(file, "solution/r", self.impulse)
                    _put(file, "solution/u", self.delassus @ self.impulse + self.velocity)
        except OSError as error:
            raise MpmfwError(f"cannot write '{os.fspath(path)}': {error}") from error

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Self:
        """Read a file of FCLIB with a local problem.

        Raises
        ------
        MpmfwError
            The file cannot be read, has no local problem or one with bilateral constraints, or h5py is not installed.
        """
        name = os.fspath(path)
        try:
            with _hdf5().File(name) as file:
                if "fclib_local" not in file:
                    raise MpmfwError(f"'{name}' has no group fclib_local; expected a local problem of FCLIB")
                local = file["fclib_local"]
                if "V" in local:
                    raise MpmfwError(f"'{name}' has bilateral constraints (V); expected contact alone")
                info = {
                    key: local[f"info/{key}"][()].decode()
                    for key in ("title", "description")
                    if f"info/{key}" in local
                }
                solution = file["solution/r"][...] if "solution/r" in file else None
                q, mu, dim = local["vectors/q"][...], local["vectors/mu"][...], int(local["spacedim"][0])
                return cls(_matrix(local["W"]), q, mu, dim, solution, **info)
        except (OSError, KeyError, ValueError, TypeError) as error:
            raise MpmfwError(f"cannot read '{name}' as a problem of FCLIB: {error}") from error


def last_problem(simulation: Any, title: str = "") -> LocalProblem:
    """The problem that ``lcp`` solved in the last step, with its solution.

    Parameters
    ----------
    simulation
        ``mpmfw.Simulation`` of a scene with ``lcp``, after a step; nothing in it changes.
    title
        What the file will call it; scene and time if left out.

    Raises
    ------
    MpmfwError
        The contact has another law, or as :func:`problem_of`.
    """
    contact: Any = simulation.contact
    law = getattr(contact, "law", None)
    if not isinstance(law, Lcp):
        raise MpmfwError(f"contact '{getattr(contact, 'name', 'none')}' solves no problem; expected lcp")
    time, scene = simulation.state.time, simulation.scene
    found = problem_of(contact.rows, simulation.state.grid.mass)
    return dataclasses.replace(found, title=title or f"{scene.title or 'mpmfw'}, {time:.6g} s")


def problem_of(rows: ContactRows, mass: FloatArray) -> LocalProblem:
    """The problem of rows that ``lcp`` has solved, as they are after that.

    Parameters
    ----------
    rows
        With the impulses; those that take no part are left out.
    mass
        Of the grid's nodes, (n_nodes,) [kg/m].

    Raises
    ------
    MpmfwError
        They have cohesion, which FCLIB's cone has not.
    """
    dim, own = rows.dim, rows.own
    places = np.flatnonzero(own.compliance[: rows.count] > 0.0)
    if len(rows.cohesion) and rows.cohesion[places].any():
        raise MpmfwError(
            "contact 'lcp' has cohesion, which a problem of FCLIB cannot have; expected friction alone"
        )
    frame = _frames(rows.normal[places])
    forward, back = _operators(rows, places, frame, len(mass))
    inverse = np.divide(1.0, mass, out=np.zeros_like(mass), where=mass > 0.0)
    velocity = np.einsum("cad,cd->ca", frame, own.velocity[places])
    velocity[:, 0] += own.allowed[places]
    return LocalProblem(
        (forward @ sparse.diags(np.repeat(inverse, dim)) @ back).tocsr(),
        velocity.ravel(),
        rows.friction[places] if len(rows.friction) else np.zeros(len(places)),
        dim,
        np.einsum("cad,cd->ca", frame, rows.force[places]).ravel(),
        description="step of the material point method: velocities of grid nodes, impulses on rows of contact",
    )


def _operators(rows: ContactRows, places: IntArray, frame: FloatArray, nodes: int) -> tuple[Any, Any]:
    """B (n dim, n_nodes dim) of nodal velocities in the places' own directions, and what takes impulses in these to momenta."""
    dim = frame.shape[2]
    shape = len(places) * dim, nodes * dim
    at, blocks, turned = [], [], []
    for row, c in enumerate(places):
        entries = slice(rows.start[c], rows.start[c + 1])
        n = rows.normal[c]
        block = rows.weight[entries, None, None] * np.eye(dim)
        if len(rows.couple):
            block = block + rows.couple[entries, :, None] * n
        tilted = block + (n[:, None] * rows.tilt[entries, None, :] if len(rows.tilt) else 0.0)
        blocks.append(frame[row] @ block)
        turned.append(frame[row] @ tilted)
        nodes_of = np.asarray(rows.dof[entries])
        at.append(
            np.stack(
                np.broadcast_arrays(
                    row * dim + np.arange(dim)[None, :, None], nodes_of[:, None, None] * dim + np.arange(dim)
                )
            )
        )
    if not at:
        return sparse.csr_matrix(shape), sparse.csr_matrix(shape[::-1])
    row, column = np.concatenate([each.reshape(2, -1) for each in at], axis=1)
    forward = sparse.csr_matrix((np.concatenate([each.ravel() for each in blocks]), (row, column)), shape)
    back = sparse.csr_matrix((np.concatenate([each.ravel() for each in turned]), (column, row)), shape[::-1])
    return forward, back


def _frames(normal: FloatArray) -> FloatArray:
    """Orthonormal directions (n, dim, dim) of places, the normal (n, dim) first."""
    _, _, directions = np.linalg.svd(normal[:, None, :])
    directions[:, 0] = normal
    return np.asarray(directions)


def _on_cone(r: FloatArray, friction: FloatArray) -> FloatArray:
    """The nearest points of Coulomb's cones to r, (n, dim)."""
    along, across = r[:, 0], np.linalg.norm(r[:, 1:], axis=1)
    inside = across <= friction * along
    share = np.maximum((along + friction * across) / (1.0 + friction**2), 0.0)
    direction = r[:, 1:] / np.where(across > 0.0, across, 1.0)[:, None]
    projected = np.column_stack([share, (friction * share)[:, None] * direction])
    return np.where(inside[:, None], r, projected)


def _matrix(group: Any) -> sparse.csr_matrix:
    """A matrix of a file, in compressed columns, compressed rows or triplets."""
    shape, kind = (int(group["m"][0]), int(group["n"][0])), int(group["nz"][0])
    data, i, p = group["x"][...], group["i"][...], group["p"][...]
    if kind == COLUMNS:
        return sparse.csc_matrix((data, i, p), shape).tocsr()
    if kind == ROWS:
        return sparse.csr_matrix((data, i, p), shape)
    return sparse.coo_matrix((data[:kind], (p[:kind], i[:kind])), shape).tocsr()


def _put(group: Any, name: str, value: Any) -> None:
    group.create_dataset(name, data=value)


def _hdf5() -> Any:
    """The package h5py, which nothing else needs."""
    try:
        import h5py
    except ModuleNotFoundError as error:
        raise MpmfwError('files of FCLIB need h5py: pip install "mpmfw[fclib]"') from error
    return h5py
