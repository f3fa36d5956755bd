"""The collision of two rings ([H17] section 4.2) from the element size to force, energies and stresses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rings_fem.compiled import Floats
from rings_fem.contact import outline_of
from rings_fem.element import DENSITY, DILATATIONAL, Solid, cauchy_stress, solid_of, von_mises
from rings_fem.explicit import (
    FORCE,
    KINETIC,
    MOMENTUM_LEFT,
    MOMENTUM_RIGHT,
    SPRINGS,
    STRAIN,
    Motion,
    Pair,
    advance,
    measure,
    update_forces,
)
from rings_fem.mesh import DISTANCE, OUTER, Mesh, ring

SPEED = 30.0  #: of each ring [m/s]
TIMES = (0.0, 0.4e-3, 1.6e-3, 3.2e-3)  #: of [H17] figure 3 [s]
MARK = 0.1e-3  #: a whole number of steps, so that fields are of the times that are asked for [s]


@dataclass(frozen=True)
class Snapshot:
    """Both rings at one time."""

    time: float  #: [s]
    points: Floats  #: (n_nodes, 2) current positions [m]
    von_mises: Floats  #: (n_elements, 4) at the quadrature points [Pa]
    volumes: Floats  #: (n_elements, 4) reference volume of each quadrature point [m²]

    @property
    def element_von_mises(self) -> Floats:
        """(n_elements,) mean over each element [Pa]."""
        return np.asarray(np.average(self.von_mises, axis=1, weights=self.volumes))

    @property
    def mean(self) -> float:
        """Mean von Mises stress by reference volume [Pa]."""
        return float(np.average(self.von_mises, weights=self.volumes))

    def percentile(self, share: float) -> float:
        """Von Mises stress [Pa] that ``share`` percent of the reference volume stay below."""
        order = np.argsort(self.von_mises, axis=None)
        filled = np.cumsum(self.volumes.ravel()[order])
        filled -= 0.5 * self.volumes.ravel()[order]
        return float(np.interp(0.01 * share * self.volumes.sum(), filled, self.von_mises.ravel()[order]))


@dataclass(frozen=True)
class Collision:
    """History at every time step, n_times of them with the start, and fields at some times."""

    size: float  #: of the quadrilaterals [m]
    mesh: Mesh  #: both rings at the start; the left one has the first half of nodes and elements
    time: Floats  #: (n_times,) [s]
    force: Floats  #: (n_times,) x-resultant on the right ring [N/m]
    impulse: Floats  #: (n_times,) integral of the force since the start [N s/m]
    kinetic: Floats  #: (n_times,) [J/m]
    strain: Floats  #: (n_times,) [J/m]
    springs: Floats  #: (n_times,) energy of the contact springs [J/m]
    momentum_left: Floats  #: (n_times,) x-momentum [N s/m]
    momentum_right: Floats  #: (n_times,) x-momentum [N s/m]
    snapshots: tuple[Snapshot, ...]  #: at the times that were asked for

    @property
    def energy(self) -> Floats:
        """(n_times,) kinetic, strain and contact energy together [J/m]; constant in the exact solution."""
        return self.kinetic + self.strain + self.springs

    @property
    def energy_error(self) -> float:
        """Largest departure of the energy from the start, relative to the start."""
        return float(np.abs(self.energy / self.energy[0] - 1.0).max())

    @property
    def momentum_error(self) -> float:
        """Largest x-momentum of both rings together, relative to that of one of them at the start."""
        return float(np.abs(self.momentum_left + self.momentum_right).max() / self.momentum_left[0])


def collide(
    size: float = 2e-3,
    *,
    end: float = 3.2e-3,
    times: Sequence[float] = TIMES,
    stiffness: float = 1.0,
    courant: float = 0.4,
    turn: float = 0.5,
) -> Collision:
    """Let two rings collide at ±30 m/s.

    Parameters
    ----------
    size
        Of the quadrilaterals [m].
    end
        Of the motion [s].
    times
        At which fields are kept [s], each at the nearest step; multiples of 0.1 ms are met exactly.
    stiffness
        κ: springs of κ (K + 4G/3) l/size, l the tributary length of a node. Above about 3 the time step would
        have to be shorter, which ``energy_error`` shows.
    courant
        Time step over the shortest edge's travel time of the dilatational wave.
    turn
        Rotation of the right ring's mesh, in quadrilaterals. At 0.5 nodes face the middle of segments; at 0
        one ring is the mirror image of the other, and node meets node.
    """
    mesh, solid, pair = _two_rings(size, stiffness, turn)
    edges = np.linalg.norm(mesh.points[mesh.elements] - mesh.points[np.roll(mesh.elements, 1, 1)], axis=2)
    step = MARK / float(np.ceil(MARK * DILATATIONAL / (courant * edges.min())))
    history = np.zeros((round(end / step) + 1, 6))
    motion = Motion(mesh.points.copy(), np.zeros_like(mesh.points), np.zeros_like(mesh.points))
    motion.velocity[: pair.split, 0], motion.velocity[pair.split :, 0] = SPEED, -SPEED
    update_forces(motion, solid, pair, history[0])
    measure(motion, solid, pair, history[0])
    done, snapshots = 1, []
    for time in sorted(times):
        until = min(round(time / step) + 1, len(history))
        advance(motion, solid, pair, step, history[done:until])
        done = until
        snapshots.append(_snapshot((done - 1) * step, motion, solid))
    advance(motion, solid, pair, step, history[done:])
    return _collision(size, mesh, step, history, snapshots)


def _two_rings(size: float, stiffness: float, turn: float) -> tuple[Mesh, Solid, Pair]:
    centre = OUTER + 0.5 * DISTANCE
    left, right = ring(size, -centre), ring(size, centre, turn)
    split = len(left.points)
    points = np.concatenate([left.points, right.points])
    outlines = left.outline, right.outline + split
    mesh = Mesh(points, np.concatenate([left.elements, right.elements + split]), np.concatenate(outlines))
    modulus = stiffness * DENSITY * DILATATIONAL**2 / size
    first, second = (outline_of(points, nodes, modulus) for nodes in outlines)
    return mesh, solid_of(mesh), Pair(first, second, split)


def _snapshot(time: float, motion: Motion, solid: Solid) -> Snapshot:
    stress = von_mises(cauchy_stress(motion.points, solid))
    return Snapshot(time, motion.points.copy(), stress, solid.weights)


def _collision(
    size: float, mesh: Mesh, step: float, history: Floats, snapshots: Sequence[Snapshot]
) -> Collision:
    force = history[:, FORCE]
    mean = (
        0.5 * step * (force[1:] + force[:-1])
    )  # the trapezoidal rule is what the time integration itself uses
    return Collision(
        size=size,
        mesh=mesh,
        time=step * np.arange(len(history), dtype=np.float64),
        force=force,
        impulse=np.concatenate([[0.0], np.cumsum(mean)]),
        kinetic=history[:, KINETIC],
        strain=history[:, STRAIN],
        springs=history[:, SPRINGS],
        momentum_left=history[:, MOMENTUM_LEFT],
        momentum_right=history[:, MOMENTUM_RIGHT],
        snapshots=tuple(snapshots),
    )
