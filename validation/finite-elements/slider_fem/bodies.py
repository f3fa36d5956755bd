"""The block and the plane that it slides on, of the scenes of the sliding block."""

from typing import NamedTuple

import numpy as np
from rings_fem.element import Solid, solid_of
from rings_fem.mesh import Floats, Integers, Mesh, block

LENGTH, HEIGHT = 0.6, 0.3  #: of the block [m]
#: Left and bottom of the plane from the block's lower left corner, length and height [m]
PLANE = (-0.43, -0.213, 2.0, 0.213)
BULK, SHEAR = 12e6, 6e6  #: of the block; the plane's are twice that [Pa]
DENSITY = 1000.0  #: [kg/m³]
MODULUS = BULK + 4.0 * SHEAR / 3.0  #: M of the block, the softer body [Pa]
GRAVITY = 10.0  #: [m/s²]


class Incline(NamedTuple):
    """Both bodies at the start; the block's nodes come first."""

    size: float  #: of the block's quadrilaterals [m]
    points: Floats  #: (n_nodes, 2) [m]
    block: Solid
    plane: Solid
    mass: Floats  #: (n_nodes,) lumped [kg/m]
    free: Floats  #: (n_nodes,) 1, or 0 where the node is fixed
    n_block: int  #: number of the block's nodes
    bottom: Integers  #: (n_bottom,) nodes of the block's lower face, in the order of x
    top: Integers  #: (n_top,) nodes of the plane's upper face, in the order of x
    stiffness: Floats  #: (n_bottom,) of the spring of each node, M l / h [N/m per m]


def incline(size: float) -> Incline:
    """Mesh the block with squares of ``size`` [m], the plane with such of about the same."""
    body = _rectangle(size, 0.0, 0.0, LENGTH, HEIGHT)
    n = len(body.points)
    under = _rectangle(size, *PLANE)
    tops = np.flatnonzero(np.isclose(under.points[:, 1], 0.0, atol=1e-9))
    x, y = under.points.T
    held = np.isclose(y, PLANE[1]) | np.isin(x, [x.min(), x.max()])
    points = np.concatenate([body.points, under.points])
    solids = (
        solid_of(Mesh(points, body.elements, body.outline), BULK, SHEAR, DENSITY),
        solid_of(Mesh(points, under.elements + n, under.outline + n), 2.0 * BULK, 2.0 * SHEAR, DENSITY),
    )
    bottom = np.flatnonzero(body.points[:, 1] == 0.0)
    bottom = bottom[np.argsort(body.points[bottom, 0])]
    edges = np.diff(body.points[bottom, 0])
    tributary = 0.5 * (np.append(edges, 0.0) + np.append(0.0, edges))
    free = np.ones(len(points))
    free[n:][held] = 0.0
    return Incline(
        size=size,
        points=points,
        block=solids[0],
        plane=solids[1],
        mass=solids[0].mass + solids[1].mass,
        free=free,
        n_block=n,
        bottom=bottom,
        top=n + tops[np.argsort(under.points[tops, 0])],
        stiffness=MODULUS * tributary / size,
    )


def _rectangle(size: float, left: float, bottom: float, length: float, height: float) -> Mesh:
    unit = block(round(length / size), round(height / size))
    points = np.array([left, bottom]) + unit.points * np.array([length, height])
    return Mesh(points, unit.elements, unit.outline)
