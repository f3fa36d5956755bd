"""Noise of a force, and where the energy goes, of a run and of the finite elements."""

import numpy as np
import xarray as xr
from rings import force_of, measures_of, reference_impulse

from mpmfw.results.analysis import averaged, energy_kept, impulse, relative_l2
from mpmfw.results.references import rings_table
from mpmfw.state.fields import FloatArray

WINDOW = 100e-6  #: of the mean against which noise is told [s]
SHORT = 25e-6  #: of the mean that leaves only what changes from node to node [s]
INTERVAL = 5e-6  #: over which the raw force is a mean [s]


def of_force(time: FloatArray, force: FloatArray) -> dict[str, float]:
    """Return ``noise`` and ``jitter``, and relative L2 errors under the averaging window [µs].

    They are what a mean over WINDOW and over SHORT leave out of the force on the right ring (time,) [N/m], by
    rms, over the rms of the mean over WINDOW.
    """
    own, exact = impulse(time, force), reference_impulse(time)
    size = np.mean(averaged(time, own, WINDOW) ** 2)
    left = [force - averaged(time, own, window) for window in (WINDOW, SHORT)]
    noise, jitter = (float(np.sqrt(np.mean(away**2) / size)) for away in left)
    errors = {
        str(window): relative_l2(time, *(averaged(time, one, 1e-6 * window) for one in (own, exact)))
        for window in (50, 100, 200)
    }
    return {"noise": noise, "jitter": jitter, **errors}


def of_elements(run: str) -> dict[str, float]:
    """Return :func:`of_force` of the shipped ``fine`` or ``coarse`` force, a mean over the same intervals."""
    table = rings_table("force")
    time = INTERVAL * np.arange(641, dtype=np.float64)
    impulses = np.interp(time, table["time"], table[f"{run}_impulse_Ns_per_m"])
    return of_force(time, np.diff(impulses, prepend=impulses[0]) / INTERVAL)


def of_run(tree: xr.DataTree) -> dict[str, float]:
    """Return :func:`of_force`, ``rebound`` velocity [m/s], drift of ``momentum``, and energies over that
    at the start.

    ``lost`` is the kinetic, affine and strain energy that is gone at the end, ``damping`` and ``transfer``
    the parts that dashpots and the transfer took. ``most`` is the largest energy and dissipation together,
    ``least_damping`` the smallest increment of the damping work.
    """
    series = tree["series"].to_dataset()
    start = float(series["kinetic_energy"].isel(time=0).sum())
    kept, last = energy_kept(series), series.isel(time=-1)
    damping, friction = (
        series[name].sum("pair").values / start for name in ("damping_work", "frictional_work")
    )
    springs, judged = float(last["contact_energy"].sum()) / start, measures_of(tree)
    return {
        **of_force(*force_of(series)),
        "lost": 1.0 - float(kept[-1] - springs - (damping[-1] + friction[-1])),
        "damping": float(damping[-1]),
        "transfer": float(last["transfer_dissipation"]) / start,
        "most": float(kept.max()),
        "least_damping": float(np.diff(damping).min()),
        "rebound": judged["rebound"],
        "momentum": judged["momentum"],
    }
