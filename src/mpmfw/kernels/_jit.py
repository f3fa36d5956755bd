"""Compilation of kernels: one set of options, and a disk cache that notices every edit.

numba's cache is keyed by the file that holds the kernel and misses an edit in a file that it imports (stale callers), and its
key leaves out options such as ``nogil``. The cache folder is therefore named by a hash of all kernel sources: those of
``mpmfw.kernels`` and of the top-level package that the kernel stands in.
"""

from __future__ import annotations

import functools
import hashlib
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import ParamSpec, TypeVar

import numba
import platformdirs
from numba.core import config

Params = ParamSpec("Params")
Result = TypeVar("Result")

#: ``fastmath`` stays off (results are bitwise repeatable); division by zero gives inf, as in NumPy.
OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": False, "boundscheck": False}


@functools.cache
def _hash_of(package: Path) -> str:
    """Hash of every Python file below ``package``, names and contents."""
    digest = hashlib.sha256()
    for source in sorted(package.rglob("*.py")):
        digest.update(source.relative_to(package).as_posix().encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()


def cache_folder(module: str) -> Path:
    """Folder of the compiled kernels of ``module``; ``NUMBA_CACHE_DIR``, if set, is its parent."""
    root = Path(os.environ.get("NUMBA_CACHE_DIR") or platformdirs.user_cache_path("mpmfw") / "kernels")
    own = Path(__file__).parent
    top = sys.modules[module.partition(".")[0]].__file__
    hashes = [_hash_of(own)]
    if top is not None and Path(top).name == "__init__.py" and module.partition(".")[0] != "mpmfw":
        hashes.append(_hash_of(Path(top).parent))
    key = hashlib.sha256(repr((hashes, OPTIONS, numba.__version__)).encode()).hexdigest()
    return root / key[:16]


def kernel(function: Callable[Params, Result]) -> Callable[Params, Result]:
    """Compile ``function`` with numba at its first call, kept on disk between processes."""
    previous = config.CACHE_DIR
    config.CACHE_DIR = str(cache_folder(function.__module__))
    try:
        compiled: Callable[Params, Result] = numba.njit(cache=True, **OPTIONS)(function)
    finally:
        config.CACHE_DIR = previous
    return compiled


def device(function: Callable[Params, Result]) -> Callable[Params, Result]:
    """Compile ``function`` to be called from kernels alone; it is compiled into its callers and needs no cache entry."""
    compiled: Callable[Params, Result] = numba.njit(**OPTIONS)(function)
    return compiled
