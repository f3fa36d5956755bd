"""How far a collision is from the shipped reference curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.results.analysis import averaged, relative_l2
from mpmfw.results.references import rings_table
from rings_fem.collision import Collision, collide
from rings_fem.compiled import Floats

WINDOW = 100e-6  #: of the running average [s]


@dataclass(frozen=True)
class Distance:
    """Of one collision from one reference curve, 0 to 3.2 ms."""

    force: float  #: relative L2 norm of the difference of the forces averaged over 100 µs
    impulse: float  #: largest difference of the impulse curves, relative to the total impulse
    total: float  #: difference of the total impulses, relative
    kinetic: float  #: largest difference of the kinetic energies, relative to the start


def mean_force(collision: Collision) -> tuple[Floats, Floats]:
    """Times of the reference [s] up to the end, and there the force averaged over 100 µs [N/m]."""
    time = rings_table("force")["time"]
    time = time[time <= collision.time[-1] + 1e-9]
    impulse = np.interp(time, collision.time, collision.impulse)
    return time, averaged(time, impulse, WINDOW)


def distance(collision: Collision, reference: str = "fine") -> Distance:
    """Compare with the columns of the ``fine`` or of the ``coarse`` reference."""
    force, energy = rings_table("force"), rings_table("energy")
    time, mean = mean_force(collision)
    impulses = force[f"{reference}_impulse_Ns_per_m"][: len(time)]
    difference = np.interp(time, collision.time, collision.impulse) - impulses
    kinetic = energy[f"{reference}_kinetic_J_per_m"]
    inside = energy["time"] <= collision.time[-1] + 1e-9
    apart = np.interp(energy["time"], collision.time, collision.kinetic) - kinetic
    return Distance(
        force=relative_l2(time, mean, force[f"{reference}_force_100us_N_per_m"][: len(time)]),
        impulse=float(np.abs(difference).max() / impulses[-1]),
        total=float(difference[-1] / impulses[-1]),
        kinetic=float(np.abs(apart[inside]).max() / kinetic[0]),
    )


def regenerate() -> Collision:
    """Return the curve of 2 mm, the mesh size of [H17], for its program in figure 4."""
    return collide(2e-3)
