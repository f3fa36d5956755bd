"""Damping the oscillations of an impact's contact force.

Nothing but sanity is gated, of the scene as it is shipped and of the sign of damping. References are of the
fine finite elements. The answer again with a quarter of the material points.
"""
# cost: 190

import numpy as np
from common import over
from rings import drift_of, force_of, reference_impulse

from mpmfw.results.analysis import averaged, energy_kept, impulse, relative_l2
from mpmfw.validation import Runs, methods

WINDOW = 100e-6  #: of the mean against which noise is told [s]


def of_run(tree):
    """Return ``noise``, ``error``, drift of ``momentum``, and energies over that at the start.

    Noise is what a mean over WINDOW leaves out of the force on the right ring, by rms, over the rms of that
    mean, and the error the mean's, in L2. ``lost`` is kinetic, affine and strain energy that is gone at the
    end, ``most`` the largest energy and dissipation together, ``least_damping`` the smallest increment of
    the damping work.
    """
    series = tree["series"].to_dataset()
    time, force = force_of(series)
    mean = averaged(time, impulse(time, force), WINDOW)
    start = float(series["kinetic_energy"].isel(time=0).sum())
    kept = energy_kept(series)
    names = ("damping_work", "frictional_work", "contact_energy")
    damping, friction, springs = (series[name].sum("pair").values / start for name in names)
    return {
        "noise": float(np.sqrt(np.mean((force - mean) ** 2) / np.mean(mean**2))),
        "error": relative_l2(time, mean, averaged(time, reference_impulse(time), WINDOW)),
        "lost": 100.0 * (1.0 - float(kept[-1] - springs[-1] - (damping[-1] + friction[-1]))),
        "most": float(kept.max()),
        "least_damping": float(np.diff(damping).min()),
        "momentum": drift_of(series),
    }


HALF_CELLS = {"bodies.left.particles.size": "0.5 cells", "bodies.right.particles.size": "0.5 cells"}
DAMPED = {"contact.penalty.damping": 1.0}


def flip(share):
    """Return FLIP with a share of PIC."""
    return {"stepping.transfer": "flip", "stepping.pic_fraction": share}


springs = Runs(
    "springs",
    "colliding-rings",
    [
        *methods(
            settings={
                "": {},
                **over("contact.penalty.damping", "damping {:g}", (0.1, 0.3, 1.0)),
                "kappa 0.1": {"contact.penalty.kappa": 0.1},
                "kappa 0.1, damping 1": {"contact.penalty.kappa": 0.1, **DAMPED},
                "kappa 1": {"contact.penalty.kappa": 1.0},
                "kappa 1, damping 0.3": {"contact.penalty.kappa": 1.0, "contact.penalty.damping": 0.3},
                "kappa 1, damping 1": {"contact.penalty.kappa": 1.0, **DAMPED},
                **over("stepping.transfer", "{}", ("flip", "apic", "tpic", "pic")),
                **{f"flip, {100 * share:g} % pic": flip(share) for share in (0.01, 0.05, 0.1)},
                "apic, damping 1": {"stepping.transfer": "apic", **DAMPED},
                "segments of 0.5 h": {f"bodies.{ring}.segment": "0.5 cells" for ring in ("left", "right")},
                "points of 1 mm": HALF_CELLS,
                "points of 1 mm, damping 1": {**HALF_CELLS, **DAMPED},
            },
            when="full",
        ),
        *methods(settings={"": {}, "damping 1": DAMPED}, when="quick"),
    ],
    set={
        **{f"output.{name}": name == "ledger" for name in ("particles", "surface", "ledger")},
        "time.output_interval": "5 us",
    },
    quick=HALF_CELLS,
    binds=["*damping*"],
)


@springs
def test_springs(run):
    run.gates(
        of_run,
        ("force noise, beside 100 us", "noise", 0.5345),
        ("force over 100 us, L2 error", "error", 0.0),
        ("energy lost, of the start", "lost", 0.0, None, "%"),
        ("drift of linear momentum", "momentum", 0.0, (0.0, 1e-12)),
        ("(energy + dissipation) / E0, most", "most", 1.0, (0.0, 1.005)),
    )
    if run.method.matches("*damping*"):
        least = run.of(of_run, "least_damping")
        run.gate("least increment of damping work / E0", least, tolerance=(-1e-12, 1.0), binds=True)
