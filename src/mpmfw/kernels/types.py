"""Names of array types in the signatures of kernels."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from mpmfw.kernels._struct import Struct

Floats: TypeAlias = npt.NDArray[np.float64]
Ints: TypeAlias = npt.NDArray[np.int64]
Indices: TypeAlias = npt.NDArray[np.int32]
Flags: TypeAlias = npt.NDArray[np.bool_]
Float: TypeAlias = Any  #: a compiled scalar: numpy's and Python's float at once
Lanes: TypeAlias = Any  #: numbers of several points, or an array of them (:mod:`mpmfw.kernels.lanes`)
Points: TypeAlias = Struct  #: arrays of the material points, ``mpmfw.api.Particles``
Nodes: TypeAlias = Struct  #: arrays of the grid's nodes, ``mpmfw.api.Grid``
Table: TypeAlias = Struct  #: an interpolation table, ``mpmfw.api.Stencil``
Faceted: TypeAlias = Any  #: surfaces, :class:`mpmfw.kernels.Facets` or another struct with its members
