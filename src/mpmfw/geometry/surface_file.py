"""Triangles as they stand in a file: STL, OBJ, PLY and OFF by trimesh, gmsh's .msh by gmsh."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mpmfw.geometry.layout import FloatArray, IntArray

#: Endings of files that trimesh reads, and that of gmsh's own.
BY_TRIMESH = (".stl", ".obj", ".ply", ".off")
BY_GMSH = ".msh"


def read_surface(path: Path) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 3) in the file's unit and triangles (k, 3); nodes at one place are one, as each triangle of an STL has its own.

    Raises
    ------
    ValueError
        No such file, of another kind, that cannot be read, without triangles or with coordinates that are no numbers.
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
    if not np.isfinite(corners).all():
        wrong = np.flatnonzero(~np.isfinite(corners).all(axis=1))
        raise ValueError(
            f"{path} has coordinates that are no finite numbers: {len(wrong)} nodes, the first number {wrong[0]}, counted from 0"
        )
    used, facets = np.unique(facets, return_inverse=True)
    # + 0.0: of −0.0 and 0.0 the same
    nodes, joint = np.unique(corners[used] + 0.0, axis=0, return_inverse=True)
    return nodes, joint.ravel()[facets].reshape(-1, 3).astype(np.int64)


def _by_trimesh(path: Path) -> tuple[FloatArray, IntArray]:
    try:
        import trimesh
    except ImportError as error:
        raise ValueError(f"reading {path.name} needs trimesh: pip install 'mpmfw[mesh]'") from error
    try:
        mesh: Any = trimesh.load(path, force="mesh", process=False)
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
