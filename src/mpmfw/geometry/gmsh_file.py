"""Reads gmsh's files by gmsh."""

from __future__ import annotations

import re
import signal
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from mpmfw.geometry.layout import FloatArray, IntArray
from mpmfw.units import LARGEST

#: gmsh's numbers of elements beside a mesh: at points, and along curves of first and of second order.
BESIDE_THE_POINT = frozenset({15, 1, 8})


@contextmanager
def started_gmsh(needed_for: str) -> Iterator[Any]:
    """Start gmsh silently, unless it runs; a ValueError says what needs it where it is missing."""
    try:
        import gmsh  # type: ignore[import-untyped, import-not-found, unused-ignore]
    except (ImportError, OSError) as error:  # OSError: a system library of gmsh is missing
        raise ValueError(f"{needed_for} needs gmsh: pip install 'mpmfw[mesh]'") from error
    running = gmsh.isInitialized()
    if not running:
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        if hasattr(signal, "SIGPIPE") and threading.current_thread() is threading.main_thread():
            # gmsh sets it to end the process: again an error of Python
            signal.signal(signal.SIGPIPE, signal.getsignal(signal.SIGPIPE))
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        yield gmsh
    finally:
        if not running:
            gmsh.finalize()


def read_blocks(path: Path, kinds: Mapping[int, int]) -> tuple[FloatArray, dict[int, IntArray]]:
    """Read the nodes (n, 3) of a gmsh file and the nodes (k, m) of its elements of each kind.

    ``kinds`` are gmsh's numbers, with their nodes. A ValueError refuses other files and kinds.
    """
    with started_gmsh(f"reading {path.name}") as gmsh:
        content = path.read_bytes()
        if not content.lstrip().startswith(b"$"):
            raise ValueError(f"{path} is not a gmsh mesh that can be read")
        if _largest_count(content) > len(content):  # gmsh would make arrays of that length first
            raise ValueError(f"{path} is not a gmsh mesh that can be read: it announces more than it holds")
        before = gmsh.model.getCurrent() if gmsh.model.list() else None
        try:
            gmsh.open(str(path))
            found = [int(kind) for kind in gmsh.model.mesh.getElementTypes()]
            nodes, blocks = blocks_of(gmsh, kinds)
        except Exception as error:
            raise ValueError(f"{path} is not a gmsh mesh that can be read: {error}") from error
        others = [k for k in found if k not in kinds and k not in BESIDE_THE_POINT]
        names = {k: gmsh.model.mesh.getElementProperties(k)[0] for k in (*others, *kinds)}
        if gmsh.model.list():
            gmsh.model.remove()
        if before in gmsh.model.list():  # an empty one is gone
            gmsh.model.setCurrent(before)
    if others:
        read = " and ".join(names[k] for k in kinds)
        raise ValueError(
            f"{path} has elements of type {', '.join(sorted(names[k] for k in others))}: only {read} are read"
        )
    return nodes, blocks


def blocks_of(gmsh: Any, kinds: Mapping[int, int]) -> tuple[FloatArray, dict[int, IntArray]]:
    """Return the nodes (n, 3) of gmsh's model, and the nodes (k, m) of its elements of each kind."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    found = {k: np.asarray(gmsh.model.mesh.getElementsByType(k)[1], tags.dtype) for k in kinds}
    blocks = {
        k: order[np.searchsorted(tags, found[k], sorter=order)].reshape(-1, m) for k, m in kinds.items()
    }
    return np.reshape(coordinates, (-1, 3)), blocks


def refuse_not_finite(path: Path, nodes: FloatArray) -> None:
    """Refuse a file with coordinates (n, dim) that are not finite numbers, or past the largest one."""
    wrong = np.flatnonzero(~(np.abs(nodes) <= LARGEST).all(axis=1))
    if len(wrong):
        raise ValueError(
            f"{path} has coordinates that are not finite numbers: {len(wrong)} nodes, the first number "
            f"{wrong[0]}, counted from 0"
        )


def _largest_count(content: bytes) -> int:
    """Return the largest number of nodes or elements that a gmsh file announces."""
    _, version, binary, *_ = (*content.split(None, 3), b"", b"", b"")
    sections = re.finditer(rb"^\$(?:Nodes|Elements|NOD|ELM)\s*?\n", content, re.M)
    heads = [content[section.end() : section.end() + 64] for section in sections]
    if version.startswith(b"4") and binary == b"1":
        return max((int(number) for head in heads for number in np.frombuffer(head[:16], "<u8")), default=0)
    words = [word for head in heads for word in head.split()[: 2 if version.startswith(b"4") else 1]]
    return max((int(word) for word in words if word.isdigit()), default=0)
