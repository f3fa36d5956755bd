"""Solve Sulsky's colliding discs by the project's finite elements: ``discs_fem.py SIZE``, of elements [m].

Prints coefficient of restitution, time of contact [s] and the largest relative error of the energy."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "validation" / "finite-elements"))

from rings_fem.contact import outline_of
from rings_fem.element import solid_of
from rings_fem.explicit import (
    FORCE,
    KINETIC,
    MOMENTUM_LEFT,
    SPRINGS,
    STRAIN,
    Motion,
    Pair,
    advance,
    measure,
    update_forces,
)
from rings_fem.mesh import Mesh

from mpmfw.geometry import Disc

BULK, SHEAR, DENSITY, END = 1000.0 / 1.2, 1000.0 / 2.6, 1000.0, 3.0
SPEED, HALF = 0.1 * np.sqrt(2.0), 0.3 * np.sqrt(2.0)


def joined(corners):
    """Return nodes, quadrilaterals and the nodes of the outline of a disc, counter-clockwise."""
    flat = corners.reshape(-1, 2)
    _, index, cells = np.unique(np.round(flat, 9), axis=0, return_index=True, return_inverse=True)
    place = flat[index] - flat[index].mean(axis=0)
    rim = np.flatnonzero(np.hypot(*place.T) > 0.199)
    return flat[index], cells.reshape(-1, 4), rim[np.argsort(np.arctan2(*place[rim].T[::-1]))]


def solve(size):
    """Return the coefficient of restitution, the time of contact [s] and the error of the energy."""
    left = Disc(centre=(-HALF, 0.0), radius=0.2).fitted(size).corners
    turned = Disc(centre=(0.0, 0.0), radius=0.2).fitted(size).corners @ np.array([[0.8, 0.6], [-0.6, 0.8]])
    # the meshes are not mirror images, so that nodes meet edges
    bodies = joined(left), joined(turned + np.array([HALF, 0.0]))
    points, cells, outlines = (list(parts) for parts in zip(*bodies, strict=True))
    split, points = len(points[0]), np.concatenate(points)
    cells, outlines = (np.concatenate([one[0], one[1] + split]) for one in (cells, outlines))
    outlines = np.split(outlines, [len(bodies[0][2])])
    edges = points[cells] - points[np.roll(cells, 1, axis=1)]
    modulus = BULK + 4.0 * SHEAR / 3.0
    pair = Pair(*(outline_of(points, nodes, modulus / size) for nodes in outlines), split)
    solid = solid_of(Mesh(points, cells, np.concatenate(outlines)), BULK, SHEAR, DENSITY)
    step = 0.3 * np.linalg.norm(edges, axis=2).min() / np.sqrt(modulus / DENSITY)
    history = np.zeros((int(np.ceil(END / step)) + 1, 6))
    motion = Motion(points.copy(), np.zeros_like(points), np.zeros_like(points))
    motion.velocity[:split, 0], motion.velocity[split:, 0] = SPEED, -SPEED
    update_forces(motion, solid, pair, history[0])
    measure(motion, solid, pair, history[0])
    advance(motion, solid, pair, END / (len(history) - 1), history[1:])
    energy = history[:, [KINETIC, STRAIN, SPRINGS]].sum(axis=1)
    touching = END * np.flatnonzero(history[:, FORCE]) / (len(history) - 1)
    restitution = -history[-1, MOMENTUM_LEFT] / history[0, MOMENTUM_LEFT]
    return restitution, np.ptp(touching), np.abs(energy / energy[0] - 1.0).max()


if __name__ == "__main__":
    print(*solve(float(sys.argv[1])))
