"""Triangles as they stand in a file: STL, OBJ, PLY and OFF by trimesh, gmsh's .msh by gmsh."""

from __future__ import annotations

import io
import logging
from pathlib import Path
from typing import Any

import numpy as np

from mpmfw.geometry.layout import FloatArray, IntArray
from mpmfw.units import LARGEST

#: Endings of files that trimesh reads, and that of gmsh's own.
BY_TRIMESH = (".stl", ".obj", ".ply", ".off")
BY_GMSH = ".msh"

#: Distance of two nodes of an STL, over its largest coordinate, up to which they are one: four units of
#: single precision.
SINGLE = float(4.0 * np.finfo(np.float32).eps)


def read_surface(path: Path) -> tuple[FloatArray, IntArray]:
    """Read nodes (n, 3) in the file's unit and triangles (k, 3); nodes at one place are one.

    Each triangle of an STL has its own nodes; those that are equal in single precision are one.

    Raises
    ------
    ValueError
        No such file, of another kind, that cannot be read, without triangles or with coordinates that are no
        numbers.
    """
    if not path.is_file():
        raise ValueError(f"mesh file not found: {path}")
    kind = path.suffix.lower()
    if kind == BY_GMSH:
        corners, facets = _by_gmsh(path)
    elif kind in BY_TRIMESH:
        corners, facets = _by_trimesh(path)
    else:
        kinds = ", ".join((*BY_TRIMESH, BY_GMSH))
        raise ValueError(f"{path} has the ending '{kind}'; expected one of {kinds}")
    if not len(facets):
        raise ValueError(f"{path} has no triangles")
    wrong = np.flatnonzero(~(np.abs(corners) <= LARGEST).all(axis=1))
    if len(wrong):
        raise ValueError(
            f"{path} has coordinates that are no finite numbers: {len(wrong)} nodes, the first number "
            f"{wrong[0]}, counted from 0"
        )
    if facets.min() < 0 or facets.max() >= len(corners):
        wrong = np.flatnonzero(((facets < 0) | (facets >= len(corners))).any(axis=1))
        raise ValueError(
            f"{path} has {len(wrong)} triangles with nodes that are not among its {len(corners)}, the first "
            "is triangle "
            f"{wrong[0]}, counted from 0"
        )
    used, facets = np.unique(facets, return_inverse=True)
    # + 0.0: of −0.0 and 0.0 the same
    nodes, joint = np.unique(corners[used] + 0.0, axis=0, return_inverse=True)
    facets = joint.ravel()[facets].reshape(-1, 3)
    if kind == ".stl":
        nodes, facets = _merged(nodes, facets)
    return nodes, facets.astype(np.int64)


def _merged(nodes: FloatArray, facets: IntArray) -> tuple[FloatArray, IntArray]:
    """Take the first of nodes that differ by rounding to single precision."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(nodes).query_pairs(SINGLE * np.abs(nodes).max(), output_type="ndarray")
    near = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(nodes), len(nodes)))
    _, group = connected_components(near, directed=False)
    _, first = np.unique(group, return_index=True)
    return nodes[first], group[facets]


def _by_trimesh(path: Path) -> tuple[FloatArray, IntArray]:
    try:
        import trimesh
    except ImportError as error:
        raise ValueError(f"reading {path.name} needs trimesh: pip install 'mpmfw[mesh]'") from error
    logging.getLogger("trimesh").addHandler(
        logging.NullHandler()
    )  # it prints tracebacks of what it can do without
    try:
        # of the bytes alone: trimesh then opens no file that they name, such as a library of materials
        content, kind = io.BytesIO(path.read_bytes()), path.suffix[1:].lower()
        mesh: Any = trimesh.load(content, file_type=kind, force="mesh", process=False)
        return np.asarray(mesh.vertices, dtype=np.float64).reshape(-1, 3), np.asarray(
            mesh.faces, dtype=np.int64
        )
    except Exception as error:  # readers of strangers' files fail in all ways
        raise ValueError(
            f"{path} is not a {path.suffix[1:].upper()} file that can be read: {error}"
        ) from error


def _by_gmsh(path: Path) -> tuple[FloatArray, IntArray]:
    from mpmfw.geometry.gmsh_file import read_blocks

    nodes, blocks = read_blocks(path, {2: 3})
    return nodes, blocks[2]
