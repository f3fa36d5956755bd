"""The block's motion down the incline: central differences with a lumped mass."""

from dataclasses import dataclass

import numpy as np
from rings_fem.element import add_internal_force
from rings_fem.mesh import Floats

from mpmfw.kernels import kernel
from slider_fem.bodies import DENSITY, GRAVITY, MODULUS, Incline, incline
from slider_fem.contact import add_springs, project
from slider_fem.flutter import rest

RAMP = 0.15  #: time in which gravity is tilted [s]
JUDGED = (0.2, 0.45)  #: times over which the acceleration is fitted [s]

SPRINGS, IMPULSES = 0, 1


@dataclass(frozen=True)
class Slide:
    """History at every time step."""

    time: Floats  #: (n_times,) [s]
    x: Floats  #: (n_times,) of the block's centre of mass [m]
    y: Floats  #: (n_times,) [m]
    normal: Floats  #: (n_times,) N [N/m]
    tangential: Floats  #: (n_times,) T, positive against the motion down the incline [N/m]


def acceleration_of(time: Floats, x: Floats) -> float:
    """Acceleration [m/s²] of the least-squares parabola over :data:`JUDGED`."""
    inside = (time >= JUDGED[0] - 1e-9) & (time <= JUDGED[1] + 1e-9)
    return float(2.0 * np.polyfit(time[inside], x[inside], 2)[0])


def slide(
    size: float,
    friction: float,
    tilt: float,
    *,
    contact: str = "springs",
    viscosity: float = 0.0,
    end: float = JUDGED[1],
) -> Slide:
    """Let the block, at rest under gravity at zero tilt, slide while gravity is tilted smoothly.

    ``size`` is that of the quadrilaterals [m]. Gravity is g (sin ϑ, -cos ϑ), ϑ = θ (1 - cos(π t / 0.15
    s)) / 2 until 0.15 s, with θ the ``tilt`` [rad]. ``contact`` is ``springs`` or ``impulses``
    (:mod:`slider_fem.contact`). With the ``viscosity`` β [s] of a Kelvin-Voigt solid the elements' forces are
    those of x + β v. A step is 0.4 of the shortest edge's travel time of the dilatational wave in the plane,
    before viscosity; ``end`` is that of the motion [s].
    """
    bodies = incline(size)
    wave = float(np.sqrt(MODULUS / DENSITY))
    damping = viscosity * wave / size
    limit = 0.4 * size / wave * (np.sqrt(1.0 + damping**2) - damping)
    limit /= np.sqrt(2.0)  # the plane's moduli are twice as large
    count = int(np.ceil(end / limit))
    points = rest(bodies, rigid_contact=contact == "impulses")
    velocity, history = np.zeros_like(points), np.zeros((count, 5))
    kind = {"springs": SPRINGS, "impulses": IMPULSES}[contact]
    advance(points, velocity, bodies, kind, friction, tilt, viscosity, end / count, history)
    return Slide(*np.ascontiguousarray(history.T))


@kernel
def advance(
    points: Floats,
    velocity: Floats,
    bodies: Incline,
    kind: int,
    friction: float,
    tilt: float,
    viscosity: float,
    step: float,
    history: Floats,
) -> None:
    """Take ``len(history)`` time steps of ``step`` [s], each of which

    1. finds the forces of elements and springs at the present positions,
    2. accelerates the nodes by them and by gravity,
    3. projects the velocities, if contact is by impulses,
    4. moves the nodes, and records (5,) what :class:`Slide` has.
    """
    inverse_mass = np.where(
        bodies.free > 0.0, bodies.free / np.where(bodies.mass > 0.0, bodies.mass, 1.0), 0.0
    )
    kept, impulse = np.zeros(len(bodies.bottom)), np.zeros((len(bodies.bottom), 2))
    force, weight = np.empty_like(points), bodies.mass[: bodies.n_block].sum()
    for n in range(len(history)):
        turned = tilt * 0.5 * (1.0 - np.cos(np.pi * min(n * step / RAMP, 1.0)))
        g = (GRAVITY * np.sin(turned), -GRAVITY * np.cos(turned))
        force[:] = 0.0
        ahead = points + viscosity * velocity
        add_internal_force(ahead, bodies.block, force)
        add_internal_force(ahead, bodies.plane, force)
        told = (0.0, 0.0)
        if kind == SPRINGS:
            told = add_springs(
                points, velocity, bodies.bottom, bodies.top, bodies.stiffness, friction, step, kept, force
            )
        for node in range(len(points)):
            for axis in range(2):
                velocity[node, axis] += step * (
                    force[node, axis] * inverse_mass[node] + g[axis] * bodies.free[node]
                )
        if kind == IMPULSES:
            told = project(points, velocity, bodies.bottom, bodies.top, inverse_mass, friction, step, impulse)
        points += step * velocity
        x, y = 0.0, 0.0
        for node in range(bodies.n_block):
            x += bodies.mass[node] * points[node, 0] / weight
            y += bodies.mass[node] * points[node, 1] / weight
        history[n, 0], history[n, 1], history[n, 2] = (n + 1) * step, x, y
        history[n, 3], history[n, 4] = told
