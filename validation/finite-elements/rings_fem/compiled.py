"""Compilation of the loops, with the annotations kept, and the array types.

numba keeps compiled code by the file of a loop and misses an edit of a file that it imports. The folder of
the code is therefore named by a hash of all files of the packages beside this one."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt
from numba import njit
from numba.core import config

Floats: TypeAlias = npt.NDArray[np.float64]
Integers: TypeAlias = npt.NDArray[np.int64]

Function = TypeVar("Function", bound=Callable[..., object])

_config: Any = config  # numba's annotations differ between versions
_HERE = Path(__file__).parent
_SOURCES = hashlib.sha256(
    b"".join(source.read_bytes() for source in sorted(_HERE.parent.glob("*_fem/*.py")))
).hexdigest()
_ROOT = Path(os.environ.get("NUMBA_CACHE_DIR", _HERE / "__pycache__"))


def compiled(function: Function) -> Function:
    """Compile a function at its first call; the code is kept on disk where that can be written."""
    previous, kept = _config.CACHE_DIR, os.access(_ROOT if _ROOT.exists() else _ROOT.parent, os.W_OK)
    _config.CACHE_DIR = str(_ROOT / f"rings-fem-{_SOURCES[:16]}")
    try:
        loop: Any = njit(cache=kept, error_model="numpy")(function)
    finally:
        _config.CACHE_DIR = previous
    kept_annotations: Function = loop
    return kept_annotations
