"""Scenes of the hard cases in space, in the units of those in the plane: boxes of three cells that approach
along x.
"""

import math

from hard_scenes import block, rest, scene, solid
from scipy.spatial.transform import Rotation

#: Half of a box's edge [cells], and how far its edges and corners reach when they point along x.
HALF = 1.5
EDGE, CORNER = HALF * math.sqrt(2.0), HALF * math.sqrt(3.0)

#: Turns [rad] about x, then y, then z that bring an edge along y, one along z, or a corner to the front.
EDGE_ALONG_Y = (0.0, math.pi / 4, 0.0)
EDGE_ALONG_Z = (0.0, 0.0, math.pi / 4)
CORNER_AHEAD = tuple(
    Rotation.from_euler("zy", [-math.pi / 4, math.atan(math.sqrt(0.5))]).as_euler("xyz").tolist()
)


def _cube(x, speed, **keys):
    """A cube about (x, 0.1, -0.1) [cells] that moves along x [c], a little askew."""
    centre = (x, 0.1, -0.1) if x < 0.0 else (x, 0.0, 0.0)
    corners = [tuple(c + side * HALF for c in centre) for side in (-1.0, 1.0)]
    return block(corners[0], corners[1], (speed, 0.1 * abs(speed), -0.1 * abs(speed)), **keys)


def meeting(left, right, other=None, gap=0.1):
    """Two cubes, each given by how far it reaches towards the other [cells] and how it is turned, ``gap``
    cells apart.
    """
    bodies = {
        "left": _cube(-0.5 * gap - left[0], 0.02, angles=left[1]),
        "right": _cube(0.5 * gap + right[0], -0.02, angles=right[1], kind="other" if other else "usual"),
    }
    return scene(bodies, extent=10.0, materials={"other": other} if other else None)


FACE = (HALF, (0.0, 0.0, 0.0))


def soft_and_stiff():
    """Faces that touch; the right cube 10⁴ times as stiff."""
    return meeting(FACE, FACE, solid(stiffness=1e4), gap=0.0)


def light_and_heavy():
    """Faces; the right cube 10³ times as dense."""
    return meeting(FACE, FACE, solid(density=1e3))


def edge_on_edge():
    """Edges that cross at a right angle."""
    return meeting((EDGE, EDGE_ALONG_Y), (EDGE, EDGE_ALONG_Z))


def corner_on_face():
    """A corner against a face."""
    return meeting((CORNER, CORNER_AHEAD), FACE)


def edge_on_corner():
    """A corner against an edge, 0.1 cells beside it."""
    return meeting((CORNER, CORNER_AHEAD), (EDGE, EDGE_ALONG_Z))


def thin():
    """A plate half a cell thick that a cube hits."""
    bodies = {
        "cube": block((-3.1, -1.6, -1.4), (-0.1, 1.4, 1.6), (0.02, 0.0, 0.0)),
        "plate": block((0.1, -2.0, -2.0), (0.6, 2.0, 2.0)),
    }
    return scene(bodies, extent=10.0)


def stack():
    """Five cubes of two cells at rest on a ground whose face is y = 0."""
    cubes = {f"cube{k}": block((-1.0, 2.0 * k, -1.0), (1.0, 2.0 * k + 2.0, 1.0)) for k in range(5)}
    return rest(cubes, half_width=2.0, extent=15.0)
