"""Structured meshes of four-node quadrilaterals."""

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Integers: TypeAlias = npt.NDArray[np.int64]

INNER, OUTER = 0.030, 0.040  #: radii of the rings [m]
DISTANCE = 0.004  #: between the two rings at the start [m]


class Mesh(NamedTuple):
    """Nodes and quadrilaterals, both counter-clockwise."""

    points: Floats  #: (n_nodes, 2) [m]
    elements: Integers  #: (n_elements, 4) nodes of each quadrilateral
    outline: Integers  #: (n_outline,) nodes of the outer boundary, body on the left


def ring(size: float, centre: float = 0.0, turn: float = 0.0) -> Mesh:
    """Mesh a ring with quadrilaterals of about ``size``.

    ``size`` is the edge through the thickness [m] and should divide the thickness of 10 mm. Around the
    ring there are 24 cm/size quadrilaterals, 120 at 2 mm: edges of 0.79 to 1.05 ``size``. ``centre`` is x
    of the centre [m]; y is 0. ``turn`` rotates the mesh in its plane, in quadrilaterals: a node lies at
    angle 0 if it is 0.
    """
    around, through = round(0.24 / size), round((OUTER - INNER) / size)
    angle = 2.0 * np.pi * (np.arange(around) + turn) / around
    radius = np.linspace(INNER, OUTER, through + 1)
    directions = np.column_stack([np.cos(angle), np.sin(angle)])
    points = (radius[:, None, None] * directions).reshape(-1, 2)
    points[:, 0] += centre
    node = np.arange(around * (through + 1)).reshape(through + 1, around)
    ahead = np.roll(node, -1, axis=1)
    elements = np.stack([node[:-1], node[1:], ahead[1:], ahead[:-1]], axis=-1).reshape(-1, 4)
    return Mesh(points, elements, node[-1].copy())


def block(columns: int, rows: int) -> Mesh:
    """Mesh the unit square with ``columns`` × ``rows`` rectangles."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, columns + 1), np.linspace(0.0, 1.0, rows + 1))
    node = np.arange((columns + 1) * (rows + 1)).reshape(rows + 1, columns + 1)
    elements = np.stack([node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]], axis=-1).reshape(-1, 4)
    outline = np.concatenate([node[0, :-1], node[:-1, -1], node[-1, :0:-1], node[:0:-1, 0]])
    return Mesh(np.column_stack([x.ravel(), y.ravel()]), elements, outline)
