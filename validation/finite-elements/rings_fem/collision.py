"""The collision of two rings ([H17] section 4.2) from the element size to force, energies and stresses."""

import functools
from typing import NamedTuple

import numpy as np

from mpmfw.results.analysis import averaged, relative_l2
from mpmfw.results.references import rings_table
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
from rings_fem.mesh import DISTANCE, OUTER, Floats, Mesh, ring

SPEED = 30.0  #: of each ring [m/s]
TIMES = (0.0, 0.4e-3, 1.6e-3, 3.2e-3)  #: of [H17] figure 3 [s]
WINDOW = 100e-6  #: of the running average of forces [s]
MARK = 0.1e-3  #: a whole number of steps, so that fields are of the times that are asked for [s]


class Snapshot(NamedTuple):
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


class Collision(NamedTuple):
    """History at every time step, n_times of them with the start, and fields at some times."""

    size: float  #: of the quadrilaterals [m]
    mesh: Mesh  #: both rings at the start; the left one has the first half of nodes and elements
    time: Floats  #: (n_times,) [s]
    force: Floats  #: (n_times,) x-resultant on the right ring [N/m]
    impulse: Floats  #: (n_times,) integral of the force since the start [N s/m]
    kinetic: Floats  #: (n_times,) [J/m]
    energy_error: float  #: largest change of kinetic, strain and spring energy together, over the start
    momentum_error: float  #: largest x-momentum of both rings together, over that of one at the start
    snapshots: list[Snapshot]  #: at the times that were asked for


@functools.cache
def collide(size: float) -> Collision:
    """Let two rings of quadrilaterals of ``size`` [m] collide at ±30 m/s.

    Fields are kept at the steps nearest to :data:`TIMES`; multiples of 0.1 ms are met exactly. A step is 0.4
    of the shortest edge's travel time of the dilatational wave.
    """
    mesh, solid, pair = _two_rings(size)
    edges = np.linalg.norm(mesh.points[mesh.elements] - mesh.points[np.roll(mesh.elements, 1, 1)], axis=2)
    step = MARK / float(np.ceil(MARK * DILATATIONAL / (0.4 * edges.min())))
    history = np.zeros((round(TIMES[-1] / step) + 1, 6))
    motion = Motion(mesh.points.copy(), np.zeros_like(mesh.points), np.zeros_like(mesh.points))
    motion.velocity[: pair.split, 0], motion.velocity[pair.split :, 0] = SPEED, -SPEED
    update_forces(motion, solid, pair, history[0])
    measure(motion, solid, pair, history[0])
    done, snapshots = 1, []
    for time in TIMES:
        until = round(time / step) + 1
        advance(motion, solid, pair, step, history[done:until])
        done = until
        snapshots.append(_snapshot((done - 1) * step, motion, solid))
    return _collision(size, mesh, step, history, snapshots)


def _two_rings(size: float) -> tuple[Mesh, Solid, Pair]:
    """Nodes of the right ring face the middle of segments of the left one."""
    centre = OUTER + 0.5 * DISTANCE
    left, right = ring(size, -centre), ring(size, centre, 0.5)
    split = len(left.points)
    points = np.concatenate([left.points, right.points])
    outlines = left.outline, right.outline + split
    mesh = Mesh(points, np.concatenate([left.elements, right.elements + split]), np.concatenate(outlines))
    modulus = DENSITY * DILATATIONAL**2 / size
    first, second = (outline_of(points, nodes, modulus) for nodes in outlines)
    return mesh, solid_of(mesh), Pair(first, second, split)


def _snapshot(time: float, motion: Motion, solid: Solid) -> Snapshot:
    stress = von_mises(cauchy_stress(motion.points, solid))
    return Snapshot(time, motion.points.copy(), stress, solid.weights)


def _collision(size: float, mesh: Mesh, step: float, history: Floats, snapshots: list[Snapshot]) -> Collision:
    force, kinetic, left = history[:, FORCE], history[:, KINETIC], history[:, MOMENTUM_LEFT]
    mean = 0.5 * step * (force[1:] + force[:-1])  # the trapezoidal rule of the time integration itself
    energy = kinetic + history[:, STRAIN] + history[:, SPRINGS]
    return Collision(
        size=size,
        mesh=mesh,
        time=step * np.arange(len(history), dtype=np.float64),
        force=force,
        impulse=np.concatenate([[0.0], np.cumsum(mean)]),
        kinetic=kinetic,
        energy_error=float(np.abs(energy / energy[0] - 1.0).max()),
        momentum_error=float(np.abs(left + history[:, MOMENTUM_RIGHT]).max() / left[0]),
        snapshots=snapshots,
    )


def distance(collision: Collision, reference: str = "fine") -> dict[str, float]:
    """Compare with the columns of the ``fine`` or of the ``coarse`` reference, 0 to 3.2 ms.

    ``force`` is the relative L2 norm of the difference of the forces averaged over 100 µs, ``impulse`` the
    largest difference of the impulse curves over the total, ``total`` that of the totals, and ``kinetic`` the
    largest difference of the kinetic energies over the start."""
    force, energy, end = rings_table("force"), rings_table("energy"), collision.time[-1] + 1e-9
    time = force["time"][force["time"] <= end]
    own = np.interp(time, collision.time, collision.impulse)
    impulses = force[f"{reference}_impulse_Ns_per_m"][: len(time)]
    forces = force[f"{reference}_force_100us_N_per_m"][: len(time)]
    kinetic = energy[f"{reference}_kinetic_J_per_m"]
    apart = np.interp(energy["time"], collision.time, collision.kinetic) - kinetic
    return {
        "force": relative_l2(time, averaged(time, own, WINDOW), forces),
        "impulse": float(np.abs(own - impulses).max() / impulses[-1]),
        "total": float((own - impulses)[-1] / impulses[-1]),
        "kinetic": float(np.abs(apart[energy["time"] <= end]).max() / kinetic[0]),
    }
