"""How far a collision is from the shipped reference curves."""

import numpy as np

from mpmfw.results.analysis import averaged, relative_l2
from mpmfw.results.references import rings_table
from rings_fem.collision import Collision

WINDOW = 100e-6  #: of the running average [s]


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
